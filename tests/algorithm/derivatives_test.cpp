// SPDX-License-Identifier: BSD-2-Clause
// Derivatives compared with differences of the algorithms themselves, for every loaded joint type, plugins included.
#include "support/catch.hpp"
#include "support/difference.hpp"
#include "support/random_model.hpp"
#include "support/registry.hpp"

#include <functional>
#include <limits>

using namespace dyn;
using namespace dyn::test;

namespace {

/// df/dx at x = 0 by Richardson extrapolation of central differences. The relative error is about 1e-11 for smooth f of size 1. Spline joints are
/// smooth only between knots.
Eigen::VectorXd derivative(const std::function<Eigen::VectorXd(double)>& f) {
  constexpr int rounds = 3;
  Eigen::VectorXd table[rounds][rounds];
  double h = 0.001;
  for (int i = 0; i < rounds; ++i, h /= 2) {
    table[i][0] = (f(h) - f(-h)) / (2 * h);
    double power = 4;
    for (int k = 1; k <= i; ++k, power *= 4) table[i][k] = (power * table[i][k - 1] - table[i - 1][k - 1]) / (power - 1);
  }
  return table[rounds - 1][rounds - 1];
}

struct State {
  Eigen::VectorXd q, v, a;
  ExternalForces fext;
};

State stateOf(const CompactModel& model, std::uint64_t seed, bool forces) {
  Random random(seed);
  State s{integrate(model, neutral(model), Eigen::VectorXd(random.vector(model.nv(), 0.3).array() + 0.6)),
          random.vector(model.nv(), 1),
          random.vector(model.nv(), 2),
          {}};
  s.v.array() += (s.v.array() >= 0).select(Eigen::ArrayXd::Constant(model.nv(), 0.1), -0.1);  // keeps away from the jump of friction at v = 0
  if (forces)
    for (std::size_t j = 0; j < model.joints().size(); ++j) s.fext.push_back({random.vector(5), random.vector(5)});
  return s;
}

/// Derivatives of f(q, v, a). Column k is the derivative along tangent direction k of q, or by entry k of v or a.
struct Differences {
  Eigen::MatrixXd by_q, by_v, by_a;
};
Differences differences(const CompactModel& model, const State& s, const std::function<Eigen::VectorXd(const State&)>& f) {
  const Eigen::Index n = model.nv(), rows = f(s).size();
  Differences out{Eigen::MatrixXd(rows, n), Eigen::MatrixXd(rows, n), Eigen::MatrixXd(rows, n)};
  for (Eigen::Index k = 0; k < n; ++k) {
    const auto moved = [&](auto change) {
      return [&, change](double h) {
        State t = s;
        change(t, h);
        return f(t);
      };
    };
    out.by_q.col(k) = derivative(moved([&](State& t, double h) { t.q = integrate(model, s.q, Eigen::VectorXd(h * Eigen::VectorXd::Unit(n, k))); }));
    out.by_v.col(k) = derivative(moved([&](State& t, double h) { t.v[k] += h; }));
    out.by_a.col(k) = derivative(moved([&](State& t, double h) { t.a[k] += h; }));
  }
  return out;
}

void checkModel(const CompactModel& model, std::uint64_t seed, bool forces) {
  INFO("model " << model.name() << ", seed " << seed << ", forces " << forces);
  Data data(model, Need::derivatives), other(model, Need::derivatives);
  const State s = stateOf(model, seed, forces);
  const auto inverse = [&](const State& t) -> Eigen::VectorXd {
    return forces ? rnea(model, other, t.q, t.v, t.a, t.fext) : rnea(model, other, t.q, t.v, t.a);
  };
  const Differences expected = differences(model, s, inverse);
  const RNEADerivatives x = forces ? computeRNEADerivatives(model, data, s.q, s.v, s.a, s.fext) : computeRNEADerivatives(model, data, s.q, s.v, s.a);
  CHECK(off(x.dtau_dq, expected.by_q) < 1e-9);
  CHECK(off(x.dtau_dv, expected.by_v) < 1e-9);
  CHECK(off(x.dtau_da, expected.by_a) < 1e-9);
  CHECK(off(x.dtau_da, crba(model, other, s.q)) < 1e-14);

  const auto forward = [&](const State& t) -> Eigen::VectorXd {
    return forces ? aba(model, other, t.q, t.v, t.a, t.fext) : aba(model, other, t.q, t.v, t.a);
  };
  const Differences accelerations = differences(model, s, forward);
  const ABADerivatives y = forces ? computeABADerivatives(model, data, s.q, s.v, s.a, s.fext) : computeABADerivatives(model, data, s.q, s.v, s.a);
  CHECK(off(y.ddq, forward(s)) < 1e-12);  // aba eliminates in another order; both have the same error budget against the truth
  CHECK(off(y.ddq_dq, accelerations.by_q) < 1e-8);
  CHECK(off(y.ddq_dv, accelerations.by_v) < 1e-8);
  CHECK(off(y.ddq_dtau, accelerations.by_a) < 1e-8);
  CHECK(Eigen::MatrixXd(y.ddq_dtau) == Eigen::MatrixXd(y.ddq_dtau).transpose());
  const Eigen::MatrixXd from_factors = computeMinverse(model, data, s.q);
  CHECK(off(from_factors, y.ddq_dtau) < 1e-12);
}

void checkCentroidal(const CompactModel& model, std::uint64_t seed) {
  INFO("model " << model.name() << ", seed " << seed);
  Data data(model, Need::derivatives), other(model, Need::derivatives);
  const State s = stateOf(model, seed, false);
  const CentroidalMomentum h = ccrba(model, data, s.q, s.v);
  CHECK(off(h.Ag * s.v, h.hg) < 1e-13);
  const CenterOfMass c = centerOfMass(model, other, s.q, s.v);
  CHECK(off(h.hg.head<3>(), model.mass() * Eigen::Vector3d(c.velocity.x, c.velocity.y, c.velocity.z)) < 1e-13);
  const Eigen::MatrixXd Ag = h.Ag;
  const CentroidalRate rate = computeCentroidalMomentumTimeVariation(model, data, s.q, s.v, s.a);
  CHECK(off(rate.Ag, Ag) < 1e-14);
  CHECK(off(rate.dhg, Ag * s.a + rate.dAg * s.v) < 1e-12);
  const Eigen::VectorXd along = derivative(
      [&](double t) -> Eigen::VectorXd { return ccrba(model, other, integrate(model, s.q, Eigen::VectorXd(t * s.v)), s.v).Ag.reshaped(); });
  CHECK(off(rate.dAg.reshaped(), along) < 1e-9);
  const CentroidalDerivatives x = computeCentroidalDynamicsDerivatives(model, data, s.q, s.v, s.a);
  const Differences momentum = differences(model, s, [&](const State& t) -> Eigen::VectorXd { return ccrba(model, other, t.q, t.v).hg; });
  CHECK(off(x.dhg_dq, momentum.by_q) < 1e-9);
  CHECK(off(Ag, momentum.by_v) < 1e-9);
  const Differences force = differences(
      model, s, [&](const State& t) -> Eigen::VectorXd { return computeCentroidalMomentumTimeVariation(model, other, t.q, t.v, t.a).dhg; });
  CHECK(off(x.dhgdot_dq, force.by_q) < 1e-9);
  CHECK(off(x.dhgdot_dv, force.by_v) < 1e-9);
  CHECK(off(x.dhgdot_da, force.by_a) < 1e-9);
  const auto eigen = [](const Vec3<double>& y) { return Eigen::VectorXd(toEigen(y)); };
  const CenterOfMassDerivatives center = computeCenterOfMassDerivatives(model, data, s.q, s.v, s.a);
  const Differences velocity =
      differences(model, s, [&](const State& t) -> Eigen::VectorXd { return eigen(centerOfMass(model, other, t.q, t.v).velocity); });
  const Differences acceleration =
      differences(model, s, [&](const State& t) -> Eigen::VectorXd { return eigen(centerOfMass(model, other, t.q, t.v, t.a).acceleration); });
  CHECK(off(center.vcom_dq, velocity.by_q) < 1e-9);
  CHECK(off(center.acom_dq, acceleration.by_q) < 1e-9);
  CHECK(off(center.acom_dv, acceleration.by_v) < 1e-9);
}

}  // namespace

TEST_CASE("centroidal momentum, its map and derivatives, for all joint types, several trees, and followers", "[centroidal]") {
  const auto seed = static_cast<std::uint64_t>(GENERATE(range(1, 6)));
  checkCentroidal(compile(randomTree(registry(), 14, seed), registry()), seed);
  Model coupled = randomTree(registry(), 22, seed + 3);
  addDependent(coupled);
  checkCentroidal(compile(coupled, registry()), seed);
}

TEST_CASE("derivatives of rnea and aba are those of rnea and aba, for all joint types", "[derivatives]") {
  const auto seed = static_cast<std::uint64_t>(GENERATE(range(1, 9)));
  checkModel(compile(randomTree(registry(), 14, seed, true), registry()), seed, false);
  checkModel(compile(randomTree(registry(), 9, seed), registry()), seed, true);
}

TEST_CASE("derivatives of one joint of each type", "[derivatives]") {
  for (const JointType* type : registry().jointTypes()) {
    if (type->info().name == std::string("fixed")) continue;
    INFO(type->info().name);
    checkModel(compile(treeOf(registry(), {type->info().name}, 3, 7), registry()), 1, true);
  }
}

TEST_CASE("derivatives of joints that follow others", "[derivatives]") {
  Model description = randomTree(registry(), 22, 4, true);
  addDependent(description);
  checkModel(compile(description, registry()), 2, false);
  checkModel(compile(description, registry()), 3, true);
}

TEST_CASE("derivatives of joints' and frames' velocities and accelerations, in all references", "[kinematics]") {
  const auto seed = static_cast<std::uint64_t>(GENERATE(range(1, 5)));
  Model description = randomTree(registry(), seed == 4 ? 22 : 14, seed);
  if (seed == 4) addDependent(description);
  const CompactModel model = compile(description, registry());
  const ReferenceFrame reference = GENERATE(ReferenceFrame::LOCAL, ReferenceFrame::WORLD, ReferenceFrame::LOCAL_WORLD_ALIGNED);
  Data data(model, Need::derivatives), other(model);
  const State s = stateOf(model, seed, false);
  const int frame = model.frameId("tool"), joint = model.njoints() - 1, n = model.nv();
  computeForwardKinematicsDerivatives(model, data, s.q, s.v, s.a);
  Eigen::MatrixXd v_dq(6, n), v_dv(6, n), again(6, n), a_dq(6, n), a_dv(6, n), a_da(6, n);
  const auto check = [&](const auto& velocityOf, const auto& accelerationOf) {
    const Differences velocity = differences(model, s, [&](const State& t) -> Eigen::VectorXd {
      forwardKinematics(model, other, t.q, t.v, t.a);
      return toEigen(velocityOf());
    });
    const Differences acceleration = differences(model, s, [&](const State& t) -> Eigen::VectorXd {
      forwardKinematics(model, other, t.q, t.v, t.a);
      return toEigen(accelerationOf());
    });
    CHECK(off(v_dq, velocity.by_q) < 1e-9);
    CHECK(off(v_dv, velocity.by_v) < 1e-9);
    CHECK(again == v_dq);
    CHECK(off(a_dq, acceleration.by_q) < 1e-9);
    CHECK(off(a_dv, acceleration.by_v) < 1e-9);
    CHECK(off(a_da, acceleration.by_a) < 1e-9);
  };
  getFrameVelocityDerivatives(model, data, frame, reference, v_dq, v_dv);
  getFrameAccelerationDerivatives(model, data, frame, reference, again, a_dq, a_dv, a_da);
  check([&] { return frameVelocity(model, other, frame, reference); }, [&] { return frameAcceleration(model, other, frame, reference); });
  getJointVelocityDerivatives(model, data, joint, reference, v_dq, v_dv);
  getJointAccelerationDerivatives(model, data, joint, reference, again, a_dq, a_dv, a_da);
  check([&] { return jointVelocity(model, other, joint, reference); }, [&] { return jointAcceleration(model, other, joint, reference); });
}

TEST_CASE("the Coriolis matrix gives C v, and dM/dt - 2 C is skew", "[coriolis]") {
  const auto seed = static_cast<std::uint64_t>(GENERATE(range(1, 6)));
  Model description = randomTree(registry(), 18, seed);
  if (seed == 4) {
    description = randomTree(registry(), 22, 4);
    addDependent(description);
  }
  const CompactModel model = compile(description, registry());
  Data data(model, Need::derivatives), other(model, Need::derivatives);
  const State s = stateOf(model, seed, false);
  const Eigen::MatrixXd C = computeCoriolisMatrix(model, data, s.q, s.v);
  const Eigen::VectorXd bias = nonLinearEffects(model, other, s.q, s.v), gravity = generalizedGravity(model, other, s.q);
  CHECK(off(C * s.v, bias - gravity) < 1e-12);
  const Eigen::VectorXd rate =
      derivative([&](double t) -> Eigen::VectorXd { return crba(model, other, integrate(model, s.q, Eigen::VectorXd(t * s.v))).reshaped(); });
  const Eigen::MatrixXd skew = rate.reshaped(model.nv(), model.nv()) - 2 * C;
  CHECK(off(skew, -skew.transpose()) < 1e-9);
}

TEST_CASE("the factors of M solve, multiply, and give forward dynamics", "[cholesky]") {
  const auto seed = static_cast<std::uint64_t>(GENERATE(range(1, 9)));
  const CompactModel model = compile(randomTree(registry(), 20, seed), registry());
  Data data(model, Need::derivatives), other(model, Need::derivatives);
  const State s = stateOf(model, seed, false);
  const Eigen::Index n = model.nv();
  const Eigen::MatrixXd M = crba(model, data, s.q);
  cholesky::decompose(model, data);
  Eigen::MatrixXd U = Eigen::MatrixXd::Identity(n, n), Ut = U, X = U, Y = U;
  cholesky::Uv(model, data, U);
  cholesky::Utv(model, data, Ut);
  cholesky::Mv(model, data, X);
  cholesky::solve(model, data, Y);
  CHECK(Ut == U.transpose());
  CHECK(U.isUpperTriangular(0));
  CHECK((U.diagonal().array() == 1).all());
  // Entries are nonzero only for joints on one root path.
  const auto& joints = model.joints();
  const auto isAncestor = [&](int i, int j) {
    while (j > i) j = joints[static_cast<std::size_t>(j)].parent;
    return i == j;
  };
  for (int i = 1; i < model.njoints(); ++i)
    for (int j = i + 1; j < model.njoints(); ++j) {
      const JointRecord &a = joints[static_cast<std::size_t>(i)], &b = joints[static_cast<std::size_t>(j)];
      if (!isAncestor(i, j)) CHECK((U.block(a.idx_v, b.idx_v, a.nv, b.nv).array() == 0).all());
    }
  CHECK(off(X, M) < 1e-13);
  CHECK(off(M * Y, Eigen::MatrixXd::Identity(n, n)) < 1e-9);
  Eigen::VectorXd x = s.v;
  cholesky::solve(model, data, x);
  CHECK(off(x, Y * s.v) < 1e-9);
  const Eigen::VectorXd tau = s.a;
  CHECK(off(forwardDynamics(model, data, s.q, s.v, tau), aba(model, other, s.q, s.v, tau)) < 1e-8);
  CHECK_THROWS_WITH(cholesky::solve(model, data, x.head(1)), containing("X is 1 x 1"));
}

TEST_CASE("products with the factors take several columns as they take one", "[cholesky]") {
  const auto seed = static_cast<std::uint64_t>(GENERATE(range(1, 9)));
  const CompactModel model = compile(randomTree(registry(), GENERATE(1, 3, 20), seed), registry());
  Data data(model, Need::derivatives);
  crba(model, data, stateOf(model, seed, false).q);
  cholesky::decompose(model, data);
  const Eigen::Index n = model.nv();
  const double marker = 7, nan = std::numeric_limits<double>::quiet_NaN();
  for (const int columns : {0, 1, 2, 3, 4, 7, 8, 9, 17}) {
    Eigen::MatrixXd given(n, columns);
    for (int k = 0; k < columns; ++k) given.col(k) = Random(seed + static_cast<std::uint64_t>(k)).vector(static_cast<int>(n), 1);
    const auto compare = [&](const auto& product, double budget) {
      Eigen::MatrixXd together = Eigen::MatrixXd::Constant(n + 3, columns, marker), spread = given;
      together.topRows(n) = given;
      product(together.topRows(n));
      CHECK((together.bottomRows(3).array() == marker).all());
      if (columns > 1) spread.col(1).setConstant(nan);
      product(spread);
      for (int k = 0; k < columns; ++k) {
        Eigen::VectorXd alone = given.col(k);
        product(alone);
        CHECK(off(together.col(k), alone) < budget);
        if (k != 1) CHECK(off(spread.col(k), alone) < budget);  // NaN stays in its column
      }
    };
    compare([&](auto&& x) { cholesky::solve(model, data, x); }, 1e-12);
    compare([&](auto&& x) { cholesky::Mv(model, data, x); }, 1e-14);
    compare([&](auto&& x) { cholesky::Uv(model, data, x); }, 1e-14);
    compare([&](auto&& x) { cholesky::Utv(model, data, x); }, 1e-14);
  }
}

TEST_CASE("what was not a number leaves nothing behind in factors and inverses", "[cholesky]") {
  const CompactModel model = compile(randomTree(registry(), 24, 5), registry());
  Data used(model, Need::derivatives), fresh(model, Need::derivatives);
  const State s = stateOf(model, 5, false);
  const Eigen::VectorXd bad = Eigen::VectorXd::Constant(model.nq(), std::numeric_limits<double>::quiet_NaN());
  crba(model, used, bad);
  cholesky::decompose(model, used);
  CHECK(!computeMinverse(model, used, bad).allFinite());
  CHECK(!computeABADerivatives(model, used, bad, s.v, s.a).ddq.allFinite());
  const auto results = [&](Data& data) {
    Eigen::MatrixXd x = crba(model, data, s.q);
    cholesky::decompose(model, data);
    cholesky::solve(model, data, x);
    const ABADerivatives by = computeABADerivatives(model, data, s.q, s.v, s.a);
    Eigen::MatrixXd all(model.nv(), 4 * model.nv());
    all << x, by.ddq_dq, by.ddq_dv, by.ddq_dtau;
    return all;
  };
  CHECK(results(used) == results(fresh));
}

TEST_CASE("factors of models with followers are refused", "[cholesky]") {
  Model description = randomTree(registry(), 22, 4);
  addDependent(description);
  const CompactModel model = compile(description, registry());
  Data data(model, Need::derivatives);
  crba(model, data, neutral(model));
  CHECK_THROWS_WITH(cholesky::decompose(model, data), containing("follow"));
}

TEST_CASE("gravity's derivative is that of rnea at rest", "[derivatives]") {
  const CompactModel model = compile(randomTree(registry(), 14, 3), registry());
  Data data(model, Need::derivatives);
  const State s = stateOf(model, 3, false);
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(model.nv());
  const Eigen::MatrixXd expected = computeRNEADerivatives(model, data, s.q, zero, zero).dtau_dq;
  CHECK(Eigen::MatrixXd(computeGeneralizedGravityDerivatives(model, data, s.q)) == expected);
}

TEST_CASE("derivatives say what they need", "[derivatives]") {
  const CompactModel model = compile(randomTree(registry(), 5, 1), registry());
  Data data(model);
  const Eigen::VectorXd q = neutral(model), v = Eigen::VectorXd::Zero(model.nv());
  CHECK_THROWS_WITH(computeRNEADerivatives(model, data, q, v, v), containing("Need::derivatives"));
  CHECK_THROWS_WITH(computeMinverse(model, data, q), containing("Need::derivatives"));
  Data good(model, Need::derivatives);
  CHECK_THROWS_WITH(computeABADerivatives(model, good, q, v, Eigen::VectorXd(v.head(1))), containing("tau"));
}
