// SPDX-License-Identifier: BSD-2-Clause
// Actuators, tendons and sensors, which a description keeps as its file has them.
#pragma once

#include <dyn/model/joint_description.hpp>

#include <string>

namespace dyn {

/// An actuator, tendon or sensor. libdyn keeps it for programs that use it; no algorithm does.
struct DeviceDescription {
  /// The kinds of devices.
  enum class Kind {
    actuator,  ///< drives joints
    tendon,    ///< ties joints or bodies
    sensor     ///< measures
  };
  Kind kind = Kind::actuator;  ///< what it is
  std::string type{},          ///< the format's word for it, such as "motor" or "jointpos"
      name{},                  ///< may be empty, and need not be unique
      text{};                  ///< the element in XML, completed by its default class; it names joints, frames and others as its file does
  Where where{};               ///< where the description was read, for messages
};

}  // namespace dyn
