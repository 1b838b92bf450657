// SPDX-License-Identifier: BSD-2-Clause
// The result of writing a model in a format that cannot say everything.
#pragma once

#include <string>
#include <vector>

namespace dyn {

/// A model as the text of a file, and what the file's format cannot say.
struct Written {
  std::string text;               ///< the file
  std::vector<std::string> lost;  ///< a line for each kind of loss, with how often it occurs and where first
};

}  // namespace dyn
