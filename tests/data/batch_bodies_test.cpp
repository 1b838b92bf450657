// SPDX-License-Identifier: BSD-2-Clause
// Sums over bodies and factors of M in many states give what single states give.
#include "support/cam_model.hpp"
#include "support/catch.hpp"
#include "support/difference.hpp"
#include "support/random_model.hpp"
#include "support/registry.hpp"
#include "support/skip.hpp"
#include "support/states.hpp"

#include <dyn/spatial/eigen.hpp>

#include <alloc_guard.hpp>

using namespace dyn;
using namespace dyn::test;

namespace {

constexpr Need derivatives = Need::derivatives;

CompactModel tree(bool coupled) {
  Model description = randomTree(registry(), 22, 6, true);
  if (coupled) addDependent(description);
  return compile(description, registry());
}

}  // namespace

TEST_CASE("centres of mass and energies of a batch are those of single states", "[batch]") {
  const CompactModel model = tree(GENERATE(false, true));
  const States s(model, 11, 3);
  BatchData batch(model, 11, Need::state, 2);
  Data data(model);
  const auto moving = centerOfMass(model, batch, s.q, s.v, s.a);
  for (int k = 0; k < 11; ++k) {
    const CenterOfMass one = centerOfMass(model, data, s.q.col(k), s.v.col(k), s.a.col(k));
    CHECK(off(moving.position.col(k), toEigen(one.position)) < 1e-14);
    CHECK(off(moving.velocity.col(k), toEigen(one.velocity)) < 1e-13);
    CHECK(off(moving.acceleration.col(k), toEigen(one.acceleration)) < 1e-12);
  }
  const Eigen::MatrixXd position = moving.position, velocity = moving.velocity;
  const auto with_v = centerOfMass(model, batch, s.q, s.v);
  CHECK(off(with_v.velocity, velocity) < 1e-14);
  CHECK(with_v.acceleration.rows() == 0);
  const auto still = centerOfMass(model, batch, s.q);
  CHECK(still.position == position);
  CHECK(still.velocity.rows() == 0);
  const Eigen::MatrixXd kinetic = computeKineticEnergy(model, batch, s.q, s.v), potential = computePotentialEnergy(model, batch, s.q);
  REQUIRE(kinetic.rows() == 1);
  for (int k = 0; k < 11; ++k) {
    CHECK(kinetic(0, k) == approx(computeKineticEnergy(model, data, s.q.col(k), s.v.col(k))).epsilon(1e-13));
    CHECK(potential(0, k) == approx(computePotentialEnergy(model, data, s.q.col(k))).epsilon(1e-13));
  }
}

TEST_CASE("Jacobians of the centre of mass of a batch are those of single states", "[batch]") {
  const CompactModel model = tree(GENERATE(false, true));
  const States s(model, 9, 4);
  BatchData batch(model, 9, derivatives);
  BatchDataFloat floats(model, 9, derivatives);
  Data data(model);
  const auto J = jacobianCenterOfMass(model, batch, s.q);
  const auto Jf = jacobianCenterOfMass(model, floats, s.q.cast<float>().eval());
  for (int k = 0; k < 9; ++k) {
    const Eigen::MatrixXd one = jacobianCenterOfMass(model, data, s.q.col(k));
    CHECK(off(J.col(k), one.reshaped()) < 1e-14);
    CHECK(off(Jf.col(k).cast<double>(), one.reshaped()) < 1e-5);
  }
}

TEST_CASE("factors of a batch solve with M, state by state", "[batch]") {
  const CompactModel model = compile(randomTree(registry(), 25, 8, true), registry());
  const int states = GENERATE(1, 8, 21);
  const States s(model, states, 5);
  BatchData batch(model, 23, derivatives, 3);
  BatchDataFloat floats(model, 23, derivatives);
  Data data(model, derivatives);
  cholesky::decompose(model, batch, s.q);
  cholesky::decompose(model, floats, s.q.cast<float>().eval());
  aba(model, batch, s.q, s.v, s.a);  // other algorithms leave the factors
  for (const Eigen::MatrixXd& b : {s.v, s.a}) {
    const Eigen::MatrixXd x = cholesky::solve(model, batch, b);
    const Eigen::MatrixXd xf = cholesky::solve(model, floats, b.cast<float>().eval()).cast<double>();
    for (int k = 0; k < states; ++k) {
      const Eigen::VectorXd expected = computeMinverse(model, data, s.q.col(k)) * b.col(k);
      CHECK(off(x.col(k), expected) < 1e-10);
      CHECK(off(xf.col(k), expected) < 5e-2);
    }
  }
}

TEST_CASE("factors and sums of a batch have the same bits for any number of threads", "[batch]") {
  const CompactModel model = compile(randomTree(registry(), 25, 9, true), registry());
  const States s(model, 50, 6);
  const auto all = [&](int threads) {
    BatchData batch(model, 50, derivatives, threads);
    cholesky::decompose(model, batch, s.q);
    std::vector<Eigen::MatrixXd> out{cholesky::solve(model, batch, s.v), jacobianCenterOfMass(model, batch, s.q)};
    const auto x = centerOfMass(model, batch, s.q, s.v, s.a);
    out.insert(out.end(), {x.position, x.velocity, x.acceleration, computeKineticEnergy(model, batch, s.q, s.v)});
    out.push_back(computePotentialEnergy(model, batch, s.q));
    return out;
  };
  const auto one = all(1);
  for (const int threads : {2, 5}) CHECK(all(threads) == one);
}

TEST_CASE("factors of a batch name a singular state, and the others are right", "[batch]") {
  const CompactModel cam = compile(camModel(), registry());
  BatchData batch(cam, 10, derivatives);
  Eigen::MatrixXd q = Eigen::MatrixXd::Constant(1, 10, 1.0);
  const Eigen::MatrixXd one = Eigen::MatrixXd::Ones(1, 10);
  CHECK_THROWS_WITH(cholesky::solve(cam, batch, one), containing("call cholesky::decompose first"));
  cholesky::decompose(cam, batch, q);
  const Eigen::MatrixXd right = cholesky::solve(cam, batch, one);
  q(0, 6) = 0;
  CHECK_THROWS_WITH(cholesky::decompose(cam, batch, q), containing("state 6") && containing("'cam'") && containing("singular"));
  const Eigen::MatrixXd x = cholesky::solve(cam, batch, one);
  for (int k = 0; k < 10; ++k) CHECK((k == 6 ? std::isnan(x(0, k)) : x(0, k) == right(0, k)));
  CHECK_THROWS_WITH(cholesky::solve(cam, batch, one.leftCols(4)), containing("b is 1 x 4"));
  BatchData without(cam, 10);
  CHECK_THROWS_WITH(cholesky::decompose(cam, without, q), containing("Need::derivatives"));
  CHECK_THROWS_WITH(jacobianCenterOfMass(cam, without, q), containing("Need::derivatives"));
  const CompactModel coupled = tree(true);
  BatchData dependent(coupled, 3, derivatives);
  CHECK_THROWS_WITH(cholesky::decompose(coupled, dependent, neutral(coupled).replicate(1, 3).eval()), containing("dependent joints"));
}

TEST_CASE("sums and factors of a batch allocate nothing", "[batch]") {
  if (!tool::canCountAllocations()) DYN_SKIP("a sanitizer owns malloc in this build");
  const CompactModel model = tree(false);
  const States s(model, 37, 1);
  BatchData batch(model, 37, derivatives, 2);
  const long before = tool::allocationCount();
  centerOfMass(model, batch, s.q, s.v, s.a);
  jacobianCenterOfMass(model, batch, s.q);
  computeKineticEnergy(model, batch, s.q, s.v);
  computePotentialEnergy(model, batch, s.q);
  cholesky::decompose(model, batch, s.q);
  cholesky::solve(model, batch, s.v);
  CHECK(tool::allocationCount() == before);
}
