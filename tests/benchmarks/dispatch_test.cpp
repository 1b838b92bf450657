// SPDX-License-Identifier: BSD-2-Clause
// The contenders of `dyn profile` must give libdyn's results; otherwise their times would mean nothing.
#include "support/catch.hpp"
#include "support/random_model.hpp"
#include "support/registry.hpp"

#include <dispatch/dispatch.hpp>

#include <map>

using namespace dyn;
using namespace dyn::test;

namespace {

void checkContest(const CompactModel& model, std::size_t ways) {
  Data data(model, Need::mass_matrix);
  Random random(3);
  const Eigen::VectorXd q = integrate(model, neutral(model), Eigen::VectorXd(random.vector(model.nv(), 0.4).array() + 0.8));
  const Eigen::VectorXd v = random.vector(model.nv(), 1), a = random.vector(model.nv(), 1);
  const Eigen::VectorXd tau = rnea(model, data, q, v, a), ddq = aba(model, data, q, v, a);
  const Eigen::MatrixXd M = crba(model, data, q);
  const std::map<std::string, Eigen::VectorXd> expected = {
      {"rnea", tau}, {"aba", ddq}, {"crba", Eigen::Map<const Eigen::VectorXd>(M.data(), M.size())}};
  const benchmark::Contest contest = benchmark::dispatchContest(model);
  REQUIRE(contest.contenders.size() == 4 * ways);
  std::map<std::string, std::vector<double>> first;
  for (const benchmark::Contender& c : contest.contenders) {
    INFO(c.algorithm << ", " << c.dispatch);
    c.run(q.data(), v.data(), a.data());
    const std::vector<double> result(c.result, c.result + c.size);
    // All ways of dispatch run the same kernels on the same numbers, so results are equal bit for bit.
    const auto [known, is_first] = first.emplace(c.algorithm, result);
    if (!is_first) CHECK(known->second == result);
    if (!expected.count(c.algorithm)) continue;
    const Eigen::VectorXd& x = expected.at(c.algorithm);
    REQUIRE(c.size == x.size());
    CHECK((Eigen::Map<const Eigen::VectorXd>(c.result, c.size) - x).cwiseAbs().maxCoeff() < 1e-9 * x.cwiseAbs().maxCoeff());
  }
}

}  // namespace

TEST_CASE("four ways of dispatch give the same results, for every type of the closed set", "[dispatch]") {
  const std::vector<std::string> all = {"free_flyer", "revolute",  "continuous",    "prismatic",   "helical", "cylindrical",
                                        "universal",  "spherical", "spherical_zyx", "translation", "planar",  "ellipsoid"};
  checkContest(compile(treeOf(registry(), all, 24, 1), registry()), 3);
  checkContest(compile(treeOf(registry(), {"revolute"}, 12, 2), registry()), 4);
  std::vector<std::string> flying(20, "revolute");
  flying.front() = "free_flyer";
  checkContest(compile(treeOf(registry(), flying, 20, 3), registry()), 4);
}

TEST_CASE("what a closed set cannot hold is said", "[dispatch]") {
  const CompactModel model = compile(treeOf(registry(), {"revolute", "cam_follower"}, 5, 4), registry());
  checkContest(model, 1);
  CHECK_THAT(benchmark::dispatchContest(model).missing, containing("'cam_follower'") && containing("static_variant"));
}
