// SPDX-License-Identifier: BSD-2-Clause
// Derivatives of a batch of states equal those of single states.
#include "support/cam_model.hpp"
#include "support/catch.hpp"
#include "support/difference.hpp"
#include "support/random_model.hpp"
#include "support/registry.hpp"

using namespace dyn;
using namespace dyn::test;

namespace {

template <class T>
using Matrix = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>;

template <class T>
void checkAll(const CompactModel& model, int states, int threads, std::uint64_t seed, double tolerance, double solved) {
  INFO(model.name() << ", " << states << " states");
  Matrix<T> q(model.nq(), states), v(model.nv(), states), a(model.nv(), states);
  Random random(seed);
  for (int k = 0; k < states; ++k) {
    q.col(k) = integrate(model, neutral(model), random.vector(model.nv(), 0.8)).template cast<T>();
    v.col(k) = random.vector(model.nv(), 1).template cast<T>();
    a.col(k) = random.vector(model.nv(), 2).template cast<T>();
  }
  BasicBatchData<T> batch(model, states, Need::derivatives, threads);
  Data data(model, Need::derivatives);
  const auto check = [&](double allowed, const auto& results, auto&& single) {
    for (int k = 0; k < states; ++k) {
      const Eigen::VectorXd qk = q.col(k).template cast<double>(), vk = v.col(k).template cast<double>(), ak = a.col(k).template cast<double>();
      const std::vector<Eigen::MatrixXd> expected = single(qk, vk, ak);
      REQUIRE(results.size() == expected.size());
      for (std::size_t r = 0; r < results.size(); ++r) {
        INFO("state " << k << ", result " << r);
        CHECK(off(results[r].col(k).template cast<double>(), expected[r].reshaped()) < allowed);
      }
    }
  };
  using Results = std::vector<detail::StatesResult<T>>;
  {
    const auto x = computeRNEADerivatives(model, batch, q, v, a);
    check(tolerance, Results{x.dtau_dq, x.dtau_dv, x.dtau_da}, [&](auto& qk, auto& vk, auto& ak) -> std::vector<Eigen::MatrixXd> {
      const RNEADerivatives y = computeRNEADerivatives(model, data, qk, vk, ak);
      return {y.dtau_dq, y.dtau_dv, y.dtau_da};
    });
  }
  {
    const auto x = computeABADerivatives(model, batch, q, v, a);
    check(solved, Results{x.ddq, x.ddq_dq, x.ddq_dv, x.ddq_dtau}, [&](auto& qk, auto& vk, auto& ak) -> std::vector<Eigen::MatrixXd> {
      const ABADerivatives y = computeABADerivatives(model, data, qk, vk, ak);
      return {y.ddq, y.ddq_dq, y.ddq_dv, y.ddq_dtau};
    });
  }
  check(tolerance, Results{computeGeneralizedGravityDerivatives(model, batch, q)},
        [&](auto& qk, auto&, auto&) -> std::vector<Eigen::MatrixXd> { return {computeGeneralizedGravityDerivatives(model, data, qk)}; });
  check(solved, Results{computeMinverse(model, batch, q)},
        [&](auto& qk, auto&, auto&) -> std::vector<Eigen::MatrixXd> { return {computeMinverse(model, data, qk)}; });
  check(tolerance, Results{computeCoriolisMatrix(model, batch, q, v)},
        [&](auto& qk, auto& vk, auto&) -> std::vector<Eigen::MatrixXd> { return {computeCoriolisMatrix(model, data, qk, vk)}; });
  {
    const auto x = ccrba(model, batch, q, v);
    check(tolerance, Results{x.hg, x.Ag}, [&](auto& qk, auto& vk, auto&) -> std::vector<Eigen::MatrixXd> {
      const CentroidalMomentum y = ccrba(model, data, qk, vk);
      return {y.hg, y.Ag};
    });
  }
  {
    const auto x = computeCentroidalMomentumTimeVariation(model, batch, q, v, a);
    check(tolerance, Results{x.hg, x.dhg, x.Ag, x.dAg}, [&](auto& qk, auto& vk, auto& ak) -> std::vector<Eigen::MatrixXd> {
      const CentroidalRate y = computeCentroidalMomentumTimeVariation(model, data, qk, vk, ak);
      return {y.hg, y.dhg, y.Ag, y.dAg};
    });
  }
  {
    const auto x = computeCentroidalDynamicsDerivatives(model, batch, q, v, a);
    check(tolerance, Results{x.dhg_dq, x.dhgdot_dq, x.dhgdot_dv, x.dhgdot_da}, [&](auto& qk, auto& vk, auto& ak) -> std::vector<Eigen::MatrixXd> {
      const CentroidalDerivatives y = computeCentroidalDynamicsDerivatives(model, data, qk, vk, ak);
      return {y.dhg_dq, y.dhgdot_dq, y.dhgdot_dv, y.dhgdot_da};
    });
  }
}

}  // namespace

TEST_CASE("derivatives of a batch are those of its states, for all joint types", "[batch]") {
  const auto seed = static_cast<std::uint64_t>(GENERATE(range(1, 5)));
  checkAll<double>(compile(randomTree(registry(), 14, seed, true), registry()), 11, 2, seed, 1e-12, 1e-9);
}

TEST_CASE("derivatives of batches of any number of degrees of freedom, the inverse symmetric to the last bit", "[batch]") {
  const int bodies = GENERATE(range(1, 10));
  const CompactModel model = compile(treeOf(registry(), {"revolute", "prismatic"}, bodies, 5), registry());
  checkAll<double>(model, 9, 1, 3, 1e-12, 1e-9);
  const int n = model.nv(), states = 9;
  Eigen::MatrixXd q(model.nq(), states);
  Random random(2);
  for (int k = 0; k < states; ++k) q.col(k) = integrate(model, neutral(model), random.vector(n, 0.8));
  BatchData batch(model, states, Need::derivatives);
  const Eigen::MatrixXd inverses = computeMinverse(model, batch, q);
  for (int k = 0; k < states; ++k) {
    const Eigen::MatrixXd inverse = inverses.col(k).reshaped(n, n);
    CHECK(inverse == inverse.transpose());
  }
}

TEST_CASE("derivatives of a batch of floats have the digits of floats", "[batch]") {
  // The bodies have similar inertias, because a solution with M loses as many digits as the condition number of M has.
  checkAll<float>(compile(treeOf(registry(), {"free_flyer", "revolute", "universal", "spherical"}, 6, 3), registry()), 17, 1, 2, 1e-4, 1e-2);
}

TEST_CASE("derivatives of batches about flying roots, whatever their joints resist with", "[batch]") {
  const bool armature = GENERATE(false, true), damping = GENERATE(false, true);
  INFO("armature " << armature << ", damping " << damping);
  Model description = randomTree(registry(), 11, 7);
  description.bodies[1].joint = {};
  description.bodies[1].joint.name = "base";
  description.bodies[1].joint.type = "free_flyer";
  Random random(8);
  int parent = 0;
  for (const char* type : {"free_flyer", "revolute", "prismatic", "spherical", "revolute", "spherical", "universal"}) {
    JointDescription joint;
    joint.name = "second" + std::to_string(parent);
    joint.type = type;
    joint.parameters = exampleParameters(registry().jointType(type, {}).info(), 3);
    joint.placement = random.pose();
    parent = description.addBody(joint.name + " body", parent, joint, random.inertia());
  }
  for (std::size_t i = 1; i < description.bodies.size(); ++i) {
    BodyDescription& body = description.bodies[i];
    const auto nv = static_cast<std::size_t>(degreesOfFreedom(body.joint, registry()));
    if (armature) body.joint.armature.assign(nv, random.uniform(0, 0.2));
    if (damping) body.joint.damping.assign(nv, random.uniform(0, 1));
  }
  checkAll<double>(compile(description, registry()), 10, 1, 4, 1e-12, 1e-9);
}

TEST_CASE("derivatives of batches with followers", "[batch]") {
  Model description = randomTree(registry(), 22, 4, true);
  addDependent(description);
  checkAll<double>(compile(description, registry()), 5, 2, 3, 1e-12, 1e-9);
  addDependent(description, "2", {0.1, 0.5, -0.3});
  addDependent(description, "3", {-0.2, 1.5, 0.2, 0.1});
  checkAll<double>(compile(description, registry()), 19, 2, 3, 1e-12, 1e-9);
}

TEST_CASE("numbers that no path connects are zero, whatever has been written there", "[batch]") {
  Model description = randomTree(registry(), 25, 7);
  description.bodies[1].joint = {};
  description.bodies[1].joint.name = "base";
  description.bodies[1].joint.type = "free_flyer";  // makes the inverse full
  const CompactModel model = compile(description, registry());
  const int most = 21;
  Eigen::MatrixXd q(model.nq(), most), v(model.nv(), most), a(model.nv(), most);
  Random random(3);
  for (int k = 0; k < most; ++k) {
    q.col(k) = integrate(model, neutral(model), random.vector(model.nv(), 0.8));
    v.col(k) = random.vector(model.nv(), 1);
    a.col(k) = random.vector(model.nv(), 2);
  }
  BatchData batch(model, most, Need::derivatives);
  const auto check = [&](int states, int fill) {
    INFO(states << " states after " << fill);
    const auto of = [&](const Eigen::MatrixXd& x, int count) { return Eigen::MatrixXd(x.leftCols(count)); };
    if (fill > 0) computeABADerivatives(model, batch, of(q, fill), of(v, fill), of(a, fill));
    BatchData fresh(model, most, Need::derivatives);
    const auto x = computeRNEADerivatives(model, batch, of(q, states), of(v, states), of(a, states));
    const auto y = computeRNEADerivatives(model, fresh, of(q, states), of(v, states), of(a, states));
    CHECK(x.dtau_dq == y.dtau_dq);
    CHECK(x.dtau_dv == y.dtau_dv);
    CHECK(x.dtau_da == y.dtau_da);
    CHECK((x.dtau_da.array() == 0).any());
    CHECK(crba(model, batch, of(q, states)) == crba(model, fresh, of(q, states)));
  };
  check(3, most);
  check(most, 0);
  check(most, 5);
  check(2, 1);
  check(most, 0);
}

TEST_CASE("what is wrong with a batch of derivatives is said with the state", "[batch]") {
  const CompactModel model = compile(camModel(), registry());
  BatchData batch(model, 10, Need::derivatives);
  Eigen::MatrixXd q = Eigen::MatrixXd::Constant(1, 10, 1.0);
  const Eigen::MatrixXd zero = Eigen::MatrixXd::Zero(1, 10);
  const Eigen::MatrixXd good = computeMinverse(model, batch, q);
  q(0, 6) = 0;
  CHECK_THROWS_WITH(computeMinverse(model, batch, q), containing("state 6") && containing("'cam'") && containing("computeMinverse"));
  CHECK_THROWS_WITH(computeABADerivatives(model, batch, q, zero, zero), containing("state 6") && containing("'cam'"));
  q(0, 6) = 1;
  CHECK(Eigen::MatrixXd(computeMinverse(model, batch, q)) == good);
  CHECK_THROWS_WITH(computeRNEADerivatives(model, batch, q, zero, Eigen::MatrixXd()), containing("a is 0 x 0"));
  BatchData without(model, 10);
  CHECK_THROWS_WITH(computeMinverse(model, without, q), containing("Need::derivatives"));
}
