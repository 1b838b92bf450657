// SPDX-License-Identifier: BSD-2-Clause
// URDF text: elements with attributes whose numbers read back to the same bits, and a list of what URDF cannot say.
#pragma once

#include <dyn/model/model.hpp>

#include <tinyxml2.h>

#include <map>
#include <string>
#include <vector>

namespace dyn::urdf {

class Output {
 public:
  void open(const char* element) { printer_.OpenElement(element); }
  void close() { printer_.CloseElement(); }
  void put(const char* attribute, const std::string& value) { printer_.PushAttribute(attribute, value.c_str()); }
  void put(const char* attribute, double value) { put(attribute, std::vector<double>{value}); }
  /// Throws Error(model) for a number that is not finite, which URDF does not have.
  void put(const char* attribute, const std::vector<double>& values);
  void put(const char* attribute, const Vec3<double>& x) { put(attribute, std::vector<double>{x.x, x.y, x.z}); }
  /// Writes an element that has one attribute.
  template <class Value>
  void element(const char* name, const char* attribute, const Value& value) {
    open(name);
    put(attribute, value);
    close();
  }
  /// Writes the attributes of a pose, as far as they are not zero.
  void putPose(const SE3<double>& X, const char* xyz = "xyz", const char* rpy = "rpy");
  /// Writes <origin>, unless the pose is the identity.
  void origin(const SE3<double>& X);

  /// Counts something that URDF cannot say, with its first owner.
  void lose(const std::string& what, const std::string& owner = {});
  /// Returns a line for each kind of what was lost.
  std::vector<std::string> lost() const;
  std::string text() const { return printer_.CStr(); }

 private:
  struct Loss {
    int count = 0;
    std::string first;
  };
  tinyxml2::XMLPrinter printer_;
  std::map<std::string, Loss> lost_;
};

/// Writes <joint>, which connects two links.
void writeJoint(Output& out, const JointDescription& joint, const std::string& parent, const std::string& child, bool master_is_joint);
/// Whether the joint needs an element in <libdyn>, too.
bool needsExtension(const JointDescription& joint, bool master_is_joint);
/// Writes that element: its type, parameters and parts, and the values for which <joint> has no place.
void writeExtension(Output& out, const JointDescription& joint, bool master_is_joint);
/// Writes values as attributes; texts that would read back as numbers are lost.
void writeParameters(Output& out, const Parameters& parameters, const std::string& owner);

}  // namespace dyn::urdf
