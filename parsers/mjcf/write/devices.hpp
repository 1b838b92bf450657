// SPDX-License-Identifier: BSD-2-Clause
// Actuators, tendons and sensors that a description keeps.
#pragma once

#include "joints.hpp"

namespace dyn::mjcf {

/// Writes the devices that came from MJCF and refer to nothing but joints of one degree of freedom, and to tendons of such joints. Others are lost.
void writeDevices(const Model& model, const Joints& joints, xml::Output& out);

}  // namespace dyn::mjcf
