// SPDX-License-Identifier: BSD-2-Clause
// Finds the cheapest answers to many yes-or-no questions, where answers and pairs of answers have costs.
#pragma once

#include <memory>

namespace dyn {

/// Costs must not be negative. Costs of one kind for the same question or pair add up.
class MinimumCut {
 public:
  MinimumCut();
  ~MinimumCut();
  /// Adds a question and returns its number, from 0 on.
  int add();
  void costsIfNo(int question, int cost);
  void costsIfYes(int question, int cost);
  /// Adds a cost for answering yes to `question` and no to `other`.
  void costsIf(int question, int other, int cost);
  /// Forbids the answers yes to `question` and no to `other` together.
  void follows(int question, int other);

  /// Finds the cheapest answers. Takes about linear time for expression graphs (Boykov and Kolmogorov 2004).
  void solve();
  bool answer(int question) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace dyn
