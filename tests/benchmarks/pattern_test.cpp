// SPDX-License-Identifier: BSD-2-Clause
// The variant library is a fair contender only if it gives libdyn's results.
#include "support/catch.hpp"
#include "support/random_model.hpp"
#include "support/registry.hpp"

#include <pattern/library.hpp>

using namespace dyn;
using namespace dyn::test;

namespace {

/// Gives two joints in three a coordinate axis, because these axes have joint classes of their own.
CompactModel withCoordinateAxes(Model model) {
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    auto& parameters = model.bodies[i].joint.parameters;
    if (i % 3 != 0 && parameters.count("axis"))
      parameters["axis"] = std::vector<double>{i % 4 == 0 ? 1.0 : 0.0, i % 4 == 1 ? -1.0 : 0.0, i % 4 > 1 ? 1.0 : 0.0};
  }
  return compile(model, registry());
}

}  // namespace

TEST_CASE("the variant library computes what libdyn computes", "[pattern]") {
  const CompactModel model = withCoordinateAxes(treeOf(registry(), {"free_flyer", "revolute", "continuous", "prismatic", "spherical"}, 60, 5));
  Data data(model, Need::mass_matrix);
  Random random(4);
  const Eigen::VectorXd q = randomConfiguration(model, 3), v = random.vector(model.nv(), 1), a = random.vector(model.nv(), 1);
  const benchmark::Contest contest = benchmark::patternContest(model);
  REQUIRE(contest.contenders.size() == 4);
  for (const benchmark::Contender& c : contest.contenders) {
    INFO(c.algorithm);
    c.run(q.data(), v.data(), a.data());
    Eigen::VectorXd expected(c.size);
    if (c.algorithm == "fk") {
      forwardKinematics(model, data, q);
      expected.head(12).setZero();
      for (int j = 1; j < model.njoints(); ++j) {
        const SE3<double> X = jointPlacement(model, data, j);
        std::copy(X.R.m, X.R.m + 9, &expected[12 * j]);
        std::copy(&X.p.x, &X.p.x + 3, &expected[12 * j + 9]);
      }
    } else if (c.algorithm == "rnea") {
      expected = rnea(model, data, q, v, a);
    } else if (c.algorithm == "crba") {
      expected = crba(model, data, q).reshaped();
    } else {
      expected = aba(model, data, q, v, a);
    }
    const Eigen::Index first = c.algorithm == "fk" ? 12 : 0;
    const Eigen::VectorXd off = Eigen::Map<const Eigen::VectorXd>(c.result, c.size) - expected;
    CHECK(off.tail(c.size - first).cwiseAbs().maxCoeff() < 1e-9 * expected.cwiseAbs().maxCoeff());
  }
  CHECK_THROWS_WITH(benchmark::patternContest(compile(treeOf(registry(), {"planar"}, 3, 5), registry())), containing("'planar'"));
}
