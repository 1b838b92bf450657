// The cheapest of all ways to answer many questions with yes or no, where answers that do not go together cost something.
#pragma once

#include <memory>

namespace dyn {

/// Costs are not negative; those of one kind for the same questions add up.
class MinimumCut {
 public:
  MinimumCut();
  ~MinimumCut();
  /// Another question, numbered from 0.
  int add();
  void costsIfNo(int question, int cost);
  void costsIfYes(int question, int cost);
  /// If the answers are yes to `question` and no to `other`.
  void costsIf(int question, int other, int cost);
  /// Rules that out.
  void follows(int question, int other);

  /// Finds the answers, in about linear time for graphs like those of formulas (Boykov and Kolmogorov 2004).
  void solve();
  bool answer(int question) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace dyn
