// SPDX-License-Identifier: BSD-2-Clause
#include "xml/output.hpp"

#include <array>
#include <charconv>
#include <cmath>

namespace dyn::xml {

void Output::put(const char* attribute, const std::vector<double>& values) {
  std::string text;
  for (const double x : values) {
    if (!std::isfinite(x))
      throw Error(ErrorCode::model, std::string("cannot be written: ") + attribute + " is not finite, and " + format_ + " has finite numbers");
    std::array<char, 32> digits{};
    const char* const end = std::to_chars(digits.data(), digits.data() + digits.size(), x).ptr;
    text += text.empty() ? "" : " ";
    text.append(digits.data(), static_cast<std::size_t>(end - digits.data()));
  }
  put(attribute, text);
}

void Output::lose(const std::string& what, const std::string& owner) {
  Loss& loss = lost_[what];
  if (loss.count++ == 0) loss.first = owner;
}

void Output::loseFolder(const std::string& path, const std::string& file) {
  if (!file.empty() && !path.empty() && path.front() != '/' && path.find("://") == std::string::npos)
    lose(std::string("the folder in which relative paths of files begin, which is now that of the ") + format_, path);
}

void Output::loseGroups(const Model& model) {
  for (const GroupDescription& group : model.groups) lose("groups (an SRDF has them)", group.name);
  for (const EndEffectorDescription& e : model.end_effectors) lose("end effectors (an SRDF has them)", e.name);
  for (const VirtualJointDescription& joint : model.virtual_joints) lose("virtual joints (an SRDF has them)", joint.name);
  for (const std::string& joint : model.passive_joints) lose("passive joints (an SRDF has them)", joint);
}

std::vector<std::string> Output::lost() const {
  std::vector<std::string> out;
  for (const auto& [what, loss] : lost_) {
    const std::string first = loss.first.empty() ? "" : (loss.count > 1 ? ", first of '" : " of '") + loss.first + "'";
    out.push_back(what + (loss.count > 1 ? ", " + std::to_string(loss.count) + " times" : "") + first);
  }
  return out;
}

std::string Output::text() const { return std::string("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n") + printer_.CStr(); }

}  // namespace dyn::xml
