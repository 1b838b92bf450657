// SPDX-License-Identifier: BSD-2-Clause
#include "notes.hpp"

namespace dyn::xml {

void Notes::count(const std::string& what, const Where& here) {
  Found& found = found_[what];
  if (found.times++ == 0 || (here.file == found.first.file && here.line < found.first.line)) found.first = here;
}

std::vector<std::string> Notes::lines(const std::string& main) const {
  std::vector<std::string> out;
  for (const auto& [what, found] : found_)
    out.push_back(what + ", " + std::to_string(found.times) + (found.times == 1 ? " time" : " times") + ", first at " +
                  (found.first.file == main ? "line " : found.first.file + ":") + std::to_string(found.first.line));
  return out;
}

}  // namespace dyn::xml
