// SPDX-License-Identifier: BSD-2-Clause
// Answers of least cost, compared with the best of all possible answers.
#include "support/catch.hpp"
#include "support/random_model.hpp"

#include <codegen/minimum_cut.hpp>

#include <algorithm>
#include <limits>
#include <vector>

using namespace dyn;
using namespace dyn::test;

TEST_CASE("a minimum cut is the cheapest of all answers", "[codegen]") {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    Random random(seed);
    const int n = 1 + random.below(8);
    struct Pair {
      int yes, no, cost;  // cost of the answer yes for `yes` with no for `no`; 0 forbids it
    };
    std::vector<int> if_yes, if_no;
    std::vector<Pair> pairs;
    MinimumCut cut;
    for (int i = 0; i < n; ++i) {
      CHECK(cut.add() == i);
      if_yes.push_back(0);
      if_no.push_back(0);
      // The costs are given in several parts, which add up.
      for (int part = random.below(4); part >= 0; --part) {
        const int yes = random.below(4), no = random.below(4);
        if_yes.back() += yes;
        if_no.back() += no;
        cut.costsIfYes(i, yes);
        cut.costsIfNo(i, no);
      }
    }
    for (int k = random.below(3 * n); k > 0; --k) {
      const Pair pair{random.below(n), random.below(n), random.below(6)};
      if (pair.yes == pair.no) continue;
      pairs.push_back(pair);
      if (pair.cost == 0) cut.follows(pair.yes, pair.no);
      if (pair.cost > 0) cut.costsIf(pair.yes, pair.no, pair.cost);
    }
    constexpr int not_allowed = 1000000;
    const auto costOf = [&](const auto& answer) {
      int sum = 0;
      for (int i = 0; i < n; ++i) sum += answer(i) ? if_yes[static_cast<std::size_t>(i)] : if_no[static_cast<std::size_t>(i)];
      for (const Pair& pair : pairs)
        if (answer(pair.yes) && !answer(pair.no)) sum += pair.cost == 0 ? not_allowed : pair.cost;
      return sum;
    };
    int least = std::numeric_limits<int>::max();
    for (unsigned all = 0; all < 1U << n; ++all) least = std::min(least, costOf([&](int i) { return (all >> i & 1) != 0; }));
    cut.solve();
    INFO("seed " << seed);
    CHECK(costOf([&](int i) { return cut.answer(i); }) == least);
  }
}
