// SPDX-License-Identifier: BSD-2-Clause
#include "types.hpp"

#include <dyn_sdk/joint_plugin.hpp>

namespace dyn::mjcf {

namespace {

/// Returns a parameter that is a list of so many numbers.
const std::vector<double>& numbersIn(const JointDescription& joint, const char* name, std::size_t count) {
  const auto found = joint.parameters.find(name);
  const auto* x = found == joint.parameters.end() ? nullptr : std::get_if<std::vector<double>>(&found->second);
  if (x == nullptr || x->size() != count)
    refuse(joint, std::string("its parameter '") + name + "' must be " + (count == 1 ? "one number" : "three numbers"));
  return *x;
}

}  // namespace

void refuse(const JointDescription& joint, const std::string& why) {
  throw Error(ErrorCode::model, "cannot be written as MJCF: " + why, {joint.where.file, joint.where.line, joint.name});
}

const Space& spaceOf(const JointDescription& joint) {
  static const Space all[] = {{"fixed", {}, 0},
                              {"revolute", {0}, 1},
                              {"continuous", {1, 0}, 1},
                              {"prismatic", {0}, 1},
                              {"helical", {0}, 1},
                              {"cylindrical", {0, 0}, 2},
                              {"universal", {0, 0}, 2},
                              {"spherical", {0, 0, 0, 1}, 3},
                              {"spherical_zyx", {0, 0, 0}, 3},
                              {"translation", {0, 0, 0}, 3},
                              {"planar", {0, 0, 1, 0}, 3},
                              {"free_flyer", {0, 0, 0, 0, 0, 0, 1}, 6}};
  for (const Space& space : all)
    if (joint.type == space.type) return space;
  refuse(joint, "its type '" + joint.type + "' is not made of free, ball, hinge and slide, the joints of MuJoCo; .dyn.json holds every type");
}

const std::vector<JointDescription>& partsOf(const JointDescription& joint) {
  const auto found = joint.parameters.find("parts");
  const auto* parts = found == joint.parameters.end() ? nullptr : std::get_if<std::vector<JointDescription>>(&found->second);
  if (parts == nullptr || parts->empty()) refuse(joint, "it has no parts");
  return *parts;
}

Vec3<double> vectorIn(const JointDescription& joint, const char* name) {
  const std::vector<double>& x = numbersIn(joint, name, 3);
  return {x[0], x[1], x[2]};
}

double pitchOf(const JointDescription& joint) { return numbersIn(joint, "pitch", 1)[0]; }

Mat3<double> planeOf(const JointDescription& joint) {
  if (!joint.parameters.count("axis")) return Mat3<double>::identity();
  Vec3<long double> n;
  if (!sdk::unitVector(numbersIn(joint, "axis", 3).data(), n)) refuse(joint, "its axis must be a finite vector other than zero");
  return sdk::frameWithZ(n);
}

}  // namespace dyn::mjcf
