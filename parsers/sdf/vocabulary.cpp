// SPDX-License-Identifier: BSD-2-Clause
#include "vocabulary.hpp"

#include <algorithm>
#include <cstring>
#include <limits>
#include <sstream>
#include <unordered_map>
#include <vector>

namespace dyn::sdf {

namespace {

using tinyxml2::XMLElement;
using Names = std::vector<std::string>;

/// The elements that are read, by the element around them. Elements without a row have only text, or their inside is of no interest.
const std::unordered_map<std::string, Names>& known() {
  static const std::unordered_map<std::string, Names> all{
      {"sdf", {"world", "model"}},
      {"world", {"model", "include", "frame", "gravity"}},
      {"model", {"link", "joint", "model", "include", "frame", "pose", "static", "self_collide"}},
      {"include", {"uri", "name", "pose", "static", "placement_frame"}},
      {"frame", {"pose"}},
      {"link", {"pose", "inertial", "collision", "visual"}},
      {"inertial", {"pose", "mass", "inertia"}},
      {"inertia", {"ixx", "ixy", "ixz", "iyy", "iyz", "izz"}},
      {"collision", {"pose", "geometry"}},
      {"visual", {"pose", "geometry", "material", "transparency", "cast_shadows", "meta", "laser_retro", "visibility_flags"}},
      {"geometry", {"box", "cylinder", "plane", "sphere", "mesh", "capsule", "ellipsoid", "heightmap", "image", "polyline", "empty"}},
      {"box", {"size"}},
      {"cylinder", {"radius", "length"}},
      {"capsule", {"radius", "length"}},
      {"sphere", {"radius"}},
      {"plane", {"normal", "size"}},
      {"mesh", {"uri", "scale"}},
      {"joint",
       {"parent", "child", "pose", "axis", "axis2", "thread_pitch", "screw_thread_pitch", "gearbox_ratio", "gearbox_reference_body", "physics"}},
      {"axis", {"xyz", "dynamics", "limit", "mimic", "use_parent_model_frame"}},
      {"axis2", {"xyz", "dynamics", "limit", "mimic", "use_parent_model_frame"}},
      {"dynamics", {"damping", "friction", "spring_reference", "spring_stiffness"}},
      {"limit", {"lower", "upper", "effort", "velocity"}},
      {"mimic", {"multiplier", "offset", "reference"}},
      {"physics", {"simbody"}},
      {"simbody", {"must_be_loop_joint"}}};
  return all;
}

/// How many numbers an element has.
int numbersOf(const std::string& name, const std::string& parent) {
  static const std::unordered_map<std::string, int> all{{"mass", 1},
                                                        {"ixx", 1},
                                                        {"ixy", 1},
                                                        {"ixz", 1},
                                                        {"iyy", 1},
                                                        {"iyz", 1},
                                                        {"izz", 1},
                                                        {"xyz", 3},
                                                        {"lower", 1},
                                                        {"upper", 1},
                                                        {"effort", 1},
                                                        {"velocity", 1},
                                                        {"damping", 1},
                                                        {"friction", 1},
                                                        {"radius", 1},
                                                        {"length", 1},
                                                        {"normal", 3},
                                                        {"scale", 3},
                                                        {"spring_reference", 1},
                                                        {"spring_stiffness", 1},
                                                        {"thread_pitch", 1},
                                                        {"offset", 1},
                                                        {"reference", 1},
                                                        {"multiplier", 1},
                                                        {"screw_thread_pitch", 1},
                                                        {"gearbox_ratio", 1}};
  if (name == "gravity") return parent == "world" ? 3 : 0;
  if (name == "size") return parent == "box" ? 3 : (parent == "plane" ? 2 : 0);
  const auto found = all.find(name);
  return found == all.end() ? 0 : found->second;
}

}  // namespace

void Vocabulary::check(const XMLElement& e) {
  const XMLElement* around = e.Parent() != nullptr ? e.Parent()->ToElement() : nullptr;
  if (around == nullptr) return;
  const std::string name = e.Name(), parent = around->Name();
  const auto row = known().find(parent);
  if (row == known().end()) return;
  // Elements with a prefix belong to other programs.
  if (std::find(row->second.begin(), row->second.end(), name) == row->second.end())
    return notes_.add("ignored: <" + name.substr(0, 60) + "> in <" + parent + ">" + where_, e.GetLineNum());
  const bool pose = name == "pose";
  int count = numbersOf(name, parent);
  if ((count == 0 && !pose) || e.GetText() == nullptr) return;
  if (pose) count = e.Attribute("rotation_format") && std::strcmp(e.Attribute("rotation_format"), "quat_xyzw") == 0 ? 7 : 6;
  std::vector<double> numbers;
  std::string text = e.GetText();
  if (parent == "limit") {
    std::istringstream words(text);
    std::string word, more;
    words >> word;
    if ((word == "inf" || word == "-inf" || word == "+inf") && !(words >> more)) return;
  }
  if (!xml::onlyNumbers(text, numbers))
    d_.fail(e, "<" + name + ">: '" + text.substr(0, 60) + "' is no list of finite numbers (decimal point, no unit)", ErrorCode::syntax);
  if (static_cast<int>(numbers.size()) != count)
    d_.fail(
        e, "<" + name + "> must have " + std::to_string(count) + (count == 1 ? " number" : " numbers") + ", it has " + std::to_string(numbers.size()),
        ErrorCode::syntax);
}

}  // namespace dyn::sdf
