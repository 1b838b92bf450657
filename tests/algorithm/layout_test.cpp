// SPDX-License-Identifier: BSD-2-Clause
// States in other libraries' layouts: compared with layouts written by hand for one model, and converted there and back for many models.
#include "support/catch.hpp"
#include "support/random_model.hpp"
#include "support/registry.hpp"

#include <dyn/algorithm/layout.hpp>

using namespace dyn;
using namespace dyn::test;

namespace {

/// A floating base, a revolute joint, a spherical joint and a continuous joint.
CompactModel robot() {
  Random random(1);
  Model model;
  const char* types[] = {"free_flyer", "revolute", "spherical", "continuous"};
  for (int i = 0; i < 4; ++i) {
    JointDescription joint;
    joint.name = types[i];
    joint.type = types[i];
    if (i % 2 == 1) joint.parameters["axis"] = std::vector<double>{0, 0, 1};
    model.addBody(std::string(types[i]) + "_link", i, joint, random.inertia());
  }
  return compile(model, registry());
}

std::vector<double> list(const Eigen::VectorXd& x) { return {x.data(), x.data() + x.size()}; }

}  // namespace

TEST_CASE("each library's layout is as its documentation has it", "[layout]") {
  const CompactModel model = robot();
  Eigen::VectorXd q(14), v(11);
  // The base is rotated by 90 degrees about z, so its x axis is the y axis of the world.
  const double h = std::sqrt(0.5);
  q << 1, 2, 3, 0, 0, h, h, 0.5, h, 0, 0, h, 0, 1;
  v << 10, 0, 0, 0, 20, 0, 0.7, 1, 2, 3, 0.9;
  const auto near = [](const Eigen::VectorXd& x, std::vector<double> y) {
    REQUIRE(static_cast<std::size_t>(x.size()) == y.size());
    for (std::size_t i = 0; i < y.size(); ++i) CHECK(x[static_cast<Eigen::Index>(i)] == approx(y[i]).margin(1e-14));
  };
  const StateVectors pinocchio = toLayout(model, Layout::pinocchio, q, v);
  CHECK(list(pinocchio.q) == list(q));
  CHECK(list(pinocchio.v) == list(v));
  const StateVectors rbdl = toLayout(model, Layout::rbdl, q, v);
  near(rbdl.q, {1, 2, 3, 0, 0, h, 0.5, h, 0, 0, M_PI / 2, h, h});
  near(rbdl.v, {0, 10, 0, 0, 20, 0, 0.7, 1, 2, 3, 0.9});
  const StateVectors mujoco = toLayout(model, Layout::mujoco, q, v);
  near(mujoco.q, {1, 2, 3, h, 0, 0, h, 0.5, h, h, 0, 0, M_PI / 2});
  near(mujoco.v, {0, 10, 0, 0, 20, 0, 0.7, 1, 2, 3, 0.9});
  const StateVectors drake = toLayout(model, Layout::drake, q, v);
  near(drake.q, {h, 0, 0, h, 1, 2, 3, 0.5, h, h, 0, 0, M_PI / 2});
  near(drake.v, {-20, 0, 0, 0, 10, 0, 0.7, 1, -3, 2, 0.9});
}

TEST_CASE("every layout leads back to the state it came from", "[layout]") {
  const auto seed = static_cast<std::uint64_t>(GENERATE(range(1, 10)));
  const CompactModel model = compile(randomTree(registry(), 16, seed), registry());
  Random random(seed);
  const Eigen::VectorXd q = randomConfiguration(model, seed), v = random.vector(model.nv(), 2);
  for (const auto layout : {Layout::pinocchio, Layout::rbdl, Layout::mujoco, Layout::drake}) {
    const StateVectors there = toLayout(model, layout, q, v);
    CHECK(there.q.size() == layoutNq(model, layout));
    const StateVectors back = fromLayout(model, layout, there.q, there.v);
    CHECK((back.q - q).cwiseAbs().maxCoeff() < 1e-14);
    CHECK((back.v - v).cwiseAbs().maxCoeff() < 1e-14);
  }
}

TEST_CASE("a rotation of zeros is refused in every layout, and the joint named", "[layout]") {
  const CompactModel model = robot();
  const Eigen::VectorXd v = Eigen::VectorXd::Zero(model.nv());
  for (const auto layout : {Layout::pinocchio, Layout::rbdl, Layout::mujoco, Layout::drake})
    for (const int j : {1, 3}) {
      const JointRecord& joint = model.joints()[static_cast<std::size_t>(j)];
      Eigen::VectorXd q = neutral(model);
      const Eigen::VectorXd there = toLayout(model, layout, q, v).q;
      q.segment(joint.idx_q + joint.nq - 4, 4).setZero();
      CHECK_THROWS_WITH(toLayout(model, layout, q, v), containing(joint.name) && containing("zero"));
      // The neutral quaternion consists of a one and zeros. Without the ones it is zero in every layout.
      const Eigen::VectorXd zeros = (there.array() == 1).select(0, there);
      CHECK_THROWS_WITH(fromLayout(model, layout, zeros, v), containing("zero"));
      q.segment(joint.idx_q + joint.nq - 4, 4).setConstant(std::numeric_limits<double>::quiet_NaN());
      CHECK(!fromLayout(model, layout, toLayout(model, layout, q, v).q, v).q.allFinite());
    }
  Eigen::VectorXd q = neutral(model);
  q.tail(2).setZero();
  CHECK_THROWS_WITH(toLayout(model, Layout::mujoco, q, v), containing("continuous") && containing("zero"));
}
