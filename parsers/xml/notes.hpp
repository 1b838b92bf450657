// SPDX-License-Identifier: BSD-2-Clause
// Remarks about a model, each kind once.
#pragma once

#include <dyn/error.hpp>

#include <map>
#include <string>
#include <vector>

namespace dyn::xml {

class Notes {
 public:
  /// Counts one occurrence of something.
  void count(const std::string& what, const Where& here);
  /// Returns "WHAT, 3 times, first at line 7" for each, in alphabetical order. Files other than `main` are named.
  std::vector<std::string> lines(const std::string& main) const;

 private:
  struct Found {
    int times = 0;
    Where first;
  };
  std::map<std::string, Found> found_;
};

}  // namespace dyn::xml
