// SPDX-License-Identifier: BSD-2-Clause
#include "contacts.hpp"

#include <CLI/CLI.hpp>

#include <algorithm>

namespace dyn::tool {

std::vector<ConstraintDescription> readContacts(const std::vector<std::string>& words) {
  std::vector<ConstraintDescription> contacts;
  for (const std::string& word : words) {
    const std::size_t colon = word.rfind(':');
    const std::string frame = word.substr(0, colon), kind = colon == std::string::npos ? "" : word.substr(colon + 1);
    if (kind != "6d" && kind != "3d") throw CLI::ValidationError("--contacts " + word, "a contact is FRAME:6d or FRAME:3d, as in left_sole_link:6d");
    contacts.push_back(kind == "6d" ? frameContact(frame) : pointContact(frame));
  }
  return contacts;
}

std::vector<ConstraintDescription> lowestLeaves(const CompactModel& model) {
  const auto count = static_cast<std::size_t>(model.njoints());
  std::vector<bool> leaf(count, true);
  for (const JointRecord& joint : model.joints()) leaf[static_cast<std::size_t>(joint.parent)] = false;
  Data data(model);
  forwardKinematics(model, data, neutral(model));
  double lowest = HUGE_VAL, highest = -HUGE_VAL;
  std::vector<double> height(count, HUGE_VAL);
  for (std::size_t j = 1; j < count; ++j) {
    const double z = jointPlacement(model, data, static_cast<int>(j)).p.z;
    if (leaf[j]) height[j] = z;
    lowest = std::min(lowest, height[j]);
    highest = std::max(highest, z);
  }
  std::vector<std::string> frames;
  for (std::size_t j = 1; j < count; ++j) {
    if (height[j] > lowest + 0.01 * (highest - lowest)) continue;
    const auto carried = [&](const FrameRecord& frame) { return frame.joint == static_cast<int>(j); };
    frames.push_back(std::find_if(model.frames().begin(), model.frames().end(), carried)->name);
  }
  std::vector<ConstraintDescription> contacts;
  contacts.reserve(frames.size());
  for (const std::string& frame : frames) contacts.push_back(frames.size() <= 2 ? frameContact(frame) : pointContact(frame));
  return contacts;
}

}  // namespace dyn::tool
