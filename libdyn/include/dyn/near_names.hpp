// SPDX-License-Identifier: BSD-2-Clause
// Suggests names that the user may have meant, for messages.
#pragma once

#include <dyn/export.hpp>

#include <string>
#include <vector>

namespace dyn {

/// Returns "; did you mean 'left_hand' or 'left_hand_2'?" with up to three names that resemble `name`, or "" if none does. The cost grows with
/// the number and the square of the length of the names; names of more than 200 letters are left out.
DYN_API std::string nearNames(const std::string& name, const std::vector<std::string>& all);

/// Returns the names of records, in their order.
template <class Records>
std::vector<std::string> namesOf(const Records& records) {
  std::vector<std::string> names;
  for (const auto& record : records) names.push_back(record.name);
  return names;
}

}  // namespace dyn
