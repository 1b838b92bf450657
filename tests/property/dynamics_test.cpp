// SPDX-License-Identifier: BSD-2-Clause
// Identities between the algorithms, on random trees of all joint types.
#include "support/catch.hpp"
#include "support/random_model.hpp"
#include "support/registry.hpp"

#include <Eigen/Cholesky>

using namespace dyn;
using namespace dyn::test;

namespace {

/// A compiled tree with a state away from singular configurations of its joints.
struct Subject {
  CompactModel model;
  Data data;
  Eigen::VectorXd q, v, a, tau;

  explicit Subject(const Model& description, std::uint64_t seed, const CompileOptions& options = {})
      : model(compile(description, registry(), options)), data(model, Need::mass_matrix) {
    Random random(seed + 1000);
    // q is far enough from neutral that motion subspaces which vanish there (a cam's) do not vanish here.
    q = integrate(model, neutral(model), Eigen::VectorXd(random.vector(model.nv(), 0.4).array() + 0.8));
    v = random.vector(model.nv(), 1);
    a = random.vector(model.nv(), 2);
    tau = random.vector(model.nv(), 5);
  }
};

double relative(const Eigen::Ref<const Eigen::MatrixXd>& x, const Eigen::Ref<const Eigen::MatrixXd>& y) {
  return (x - y).cwiseAbs().maxCoeff() / std::max(1e-300, std::max(x.cwiseAbs().maxCoeff(), y.cwiseAbs().maxCoeff()));
}

/// Derivative of f along q(t) = q (+) t v, by Richardson extrapolation of central differences.
template <class F>
Eigen::MatrixXd alongMotion(const CompactModel& model, const Eigen::VectorXd& q, const Eigen::VectorXd& v, F&& f) {
  const auto central = [&](double h) {
    return Eigen::MatrixXd((f(integrate(model, q, Eigen::VectorXd(h * v))) - f(integrate(model, q, Eigen::VectorXd(-h * v)))) / (2 * h));
  };
  constexpr double h = 1e-3;
  const Eigen::MatrixXd d1 = central(h), d2 = central(h / 2), d3 = central(h / 4);
  const Eigen::MatrixXd e1 = (4 * d2 - d1) / 3, e2 = (4 * d3 - d2) / 3;
  return (16 * e2 - e1) / 15;
}

}  // namespace

TEST_CASE("rnea inverts aba, and M's columns are its differences", "[property]") {
  const int seed = GENERATE(range(1, 30));
  const bool losses = seed % 2 == 0;
  Subject s(randomTree(registry(), 4 + seed % 17, static_cast<std::uint64_t>(seed), losses), static_cast<std::uint64_t>(seed));
  const Eigen::VectorXd ddq = aba(s.model, s.data, s.q, s.v, s.tau);
  const Eigen::VectorXd tau = rnea(s.model, s.data, s.q, s.v, ddq);
  const Eigen::MatrixXd M = crba(s.model, s.data, s.q);
  // The error of the round trip is relative to the terms of tau, |M| |ddq|.
  const Eigen::VectorXd terms = M.cwiseAbs() * ddq.cwiseAbs() + s.tau.cwiseAbs();
  CHECK(((tau - s.tau).cwiseAbs().array() / terms.maxCoeff()).maxCoeff() < 1e-12);

  CHECK((M - M.transpose()).cwiseAbs().maxCoeff() == 0);
  CHECK(Eigen::LLT<Eigen::MatrixXd>(M).info() == Eigen::Success);
  const Eigen::VectorXd bias = nonLinearEffects(s.model, s.data, s.q, s.v);
  Eigen::MatrixXd columns(s.model.nv(), s.model.nv());
  for (Eigen::Index k = 0; k < s.model.nv(); ++k) columns.col(k) = rnea(s.model, s.data, s.q, s.v, Eigen::VectorXd::Unit(s.model.nv(), k)) - bias;
  CHECK(relative(columns, M) < 1e-11);
}

TEST_CASE("the mass matrix is right wherever joints of other shapes interrupt a limb of revolute ones", "[property]") {
  constexpr int joints = 7;
  const int interruptions = GENERATE(range(0, 1 << joints));
  const bool flies = GENERATE(false, true);
  Random random(static_cast<std::uint64_t>(interruptions));
  Model limb;
  if (flies) limb.addBody("base", 0, {.name = "root", .type = "free_flyer"}, random.inertia());
  for (int i = 0; i < joints; ++i) {
    const char* other = i % 2 == 0 ? "prismatic" : "spherical";
    JointDescription joint{.name = "j" + std::to_string(i), .type = interruptions >> i & 1 ? other : "revolute"};
    joint.parameters = exampleParameters(registry().jointType(joint.type, {}).info(), static_cast<std::uint64_t>(i));
    joint.placement = random.pose();
    const auto nv = static_cast<std::size_t>(degreesOfFreedom(joint, registry()));
    joint.armature.assign(nv, 0.1 * i);
    limb.addBody("b" + std::to_string(i), static_cast<int>(limb.bodies.size()) - 1, joint, random.inertia());
  }
  Subject s(limb, 1);
  const Eigen::MatrixXd M = crba(s.model, s.data, s.q);
  const Eigen::VectorXd gravity = generalizedGravity(s.model, s.data, s.q), rest = Eigen::VectorXd::Zero(s.model.nv());
  Eigen::MatrixXd columns(s.model.nv(), s.model.nv());
  for (Eigen::Index k = 0; k < s.model.nv(); ++k) columns.col(k) = rnea(s.model, s.data, s.q, rest, Eigen::VectorXd::Unit(s.model.nv(), k)) - gravity;
  INFO(interruptions << (flies ? ", flying" : ""));
  CHECK(relative(columns, M) < 1e-12);
  CHECK(M == M.transpose());
}

TEST_CASE("power of the joints is the rate of energy", "[property]") {
  const int seed = GENERATE(range(1, 20));
  Subject s(randomTree(registry(), 3 + seed % 15, static_cast<std::uint64_t>(seed)), static_cast<std::uint64_t>(seed));
  const Eigen::VectorXd tau = rnea(s.model, s.data, s.q, s.v, s.a);
  // E along q(t) with velocity v + t a. The second-order term of q(t) does not enter the first derivative of E at t = 0.
  const auto energy = [&](double t) {
    const Eigen::VectorXd q = integrate(s.model, s.q, Eigen::VectorXd(t * s.v)), v = s.v + t * s.a;
    return computeKineticEnergy(s.model, s.data, q, v) + computePotentialEnergy(s.model, s.data, q);
  };
  const auto central = [&](double h) { return (energy(h) - energy(-h)) / (2 * h); };
  const double rate = (16 * ((4 * central(2.5e-4) - central(5e-4)) / 3) - (4 * central(5e-4) - central(1e-3)) / 3) / 15;
  const double power = s.v.dot(tau);
  CHECK(rate == approx(power).epsilon(1e-8).margin(1e-8 * s.v.cwiseAbs().dot(tau.cwiseAbs())));
}

TEST_CASE("Jacobians map v to velocities, and their rates are their derivatives", "[property]") {
  const int seed = GENERATE(range(1, 20));
  Subject s(randomTree(registry(), 3 + seed % 12, static_cast<std::uint64_t>(seed)), static_cast<std::uint64_t>(seed));
  const int tool = s.model.frameId("tool");
  REQUIRE(tool >= 0);
  for (const auto reference : {ReferenceFrame::LOCAL, ReferenceFrame::WORLD, ReferenceFrame::LOCAL_WORLD_ALIGNED}) {
    Eigen::MatrixXd J(6, s.model.nv()), dJ(6, s.model.nv());
    computeFrameJacobian(s.model, s.data, s.q, tool, reference, J);
    forwardKinematics(s.model, s.data, s.q, s.v, s.a);
    Eigen::MatrixXd stacked = Eigen::MatrixXd::Zero(12, s.model.nv());
    getFrameJacobian(s.model, s.data, tool, reference, stacked.bottomRows(6));
    CHECK(stacked.bottomRows(6) == J);
    CHECK(stacked.topRows(6).isZero(0));
    CHECK(relative(J * s.v, toEigen(frameVelocity(s.model, s.data, tool, reference))) < 1e-12);

    computeFrameJacobianTimeVariation(s.model, s.data, s.q, s.v, tool, reference, dJ);
    const Eigen::MatrixXd difference = alongMotion(s.model, s.q, s.v, [&](const Eigen::VectorXd& q) {
      Eigen::MatrixXd Jt(6, s.model.nv());
      computeFrameJacobian(s.model, s.data, q, tool, reference, Jt);
      return Jt;
    });
    CHECK((dJ - difference).cwiseAbs().maxCoeff() < 1e-9 * (dJ.cwiseAbs().maxCoeff() + J.cwiseAbs().maxCoeff()));
  }
}

TEST_CASE("joints have velocities, accelerations and Jacobians as frames do", "[property]") {
  const int seed = GENERATE(range(1, 8));
  Subject s(randomTree(registry(), 3 + seed % 12, static_cast<std::uint64_t>(seed)), static_cast<std::uint64_t>(seed));
  Eigen::MatrixXd J(6, s.model.nv()), dJ(6, s.model.nv()), again(6, s.model.nv());
  for (int j = 1; j < s.model.njoints(); ++j)
    for (const auto reference : {ReferenceFrame::LOCAL, ReferenceFrame::WORLD, ReferenceFrame::LOCAL_WORLD_ALIGNED}) {
      computeJointJacobian(s.model, s.data, s.q, j, reference, J);
      computeJointJacobianTimeVariation(s.model, s.data, s.q, s.v, j, reference, dJ);
      forwardKinematics(s.model, s.data, s.q, s.v, s.a);
      getJointJacobian(s.model, s.data, j, reference, again);
      CHECK(J == again);
      CHECK(relative(J * s.v, toEigen(jointVelocity(s.model, s.data, j, reference))) < 1e-12);
      // The derivative of the velocity's coordinates is the spatial acceleration, but in LOCAL_WORLD_ALIGNED, whose origin moves, it is the classical
      // one.
      Vector6<double> rate = toEigen(jointAcceleration(s.model, s.data, j, reference));
      if (reference == ReferenceFrame::LOCAL_WORLD_ALIGNED) rate = toEigen(jointClassicalAcceleration(s.model, s.data, j, reference));
      CHECK((J * s.a + dJ * s.v - rate).norm() < 1e-11 * (1 + rate.norm() + (dJ.cwiseAbs() * s.v.cwiseAbs()).norm()));
    }
  CHECK_THROWS_WITH(computeJointJacobian(s.model, s.data, s.q, s.model.njoints(), ReferenceFrame::LOCAL, J), containing("does not exist"));
}

TEST_CASE("the centre of mass moves as its Jacobian says", "[property]") {
  const int seed = GENERATE(range(1, 12));
  Subject s(randomTree(registry(), 3 + seed % 15, static_cast<std::uint64_t>(seed)), static_cast<std::uint64_t>(seed));
  const Eigen::MatrixXd J = jacobianCenterOfMass(s.model, s.data, s.q);
  const CenterOfMass c = centerOfMass(s.model, s.data, s.q, s.v, s.a);
  CHECK(relative(J * s.v, toEigen(c.velocity)) < 1e-11);
  const Eigen::MatrixXd rate =
      alongMotion(s.model, s.q, s.v, [&](const Eigen::VectorXd& q) { return Eigen::MatrixXd(jacobianCenterOfMass(s.model, s.data, q) * s.v); });
  CHECK(relative(Eigen::MatrixXd(J * s.a + rate), toEigen(c.acceleration)) < 1e-8);
}

TEST_CASE("external forces act as J^T f, in rnea and in aba", "[property]") {
  const int seed = GENERATE(range(1, 12));
  Subject s(randomTree(registry(), 3 + seed % 10, static_cast<std::uint64_t>(seed)), static_cast<std::uint64_t>(seed));
  Random random(static_cast<std::uint64_t>(seed));
  ExternalForces fext(s.model.joints().size());
  Eigen::VectorXd generalised = Eigen::VectorXd::Zero(s.model.nv());
  for (int j = 1; j < s.model.njoints(); ++j) {
    fext[static_cast<std::size_t>(j)] = {random.vector(3), random.vector(3)};
    int frame = -1;  // a frame of this joint
    for (std::size_t f = 0; f < s.model.frames().size() && frame < 0; ++f)
      if (s.model.frames()[f].joint == j) frame = static_cast<int>(f);
    REQUIRE(frame >= 0);
    Eigen::MatrixXd J(6, s.model.nv());
    computeFrameJacobian(s.model, s.data, s.q, frame, ReferenceFrame::LOCAL, J);
    const SE3<double>& jMf = s.model.frames()[static_cast<std::size_t>(frame)].placement;
    generalised += J.transpose() * toEigen(jMf.actInv(fext[static_cast<std::size_t>(j)]));
  }
  const Eigen::VectorXd without = rnea(s.model, s.data, s.q, s.v, s.a);
  const Eigen::VectorXd with = rnea(s.model, s.data, s.q, s.v, s.a, fext);
  CHECK((without - generalised - with).norm() < 1e-11 * (without.norm() + generalised.norm()));
  const Eigen::VectorXd ddq = aba(s.model, s.data, s.q, s.v, with, fext);
  CHECK((ddq - s.a).norm() < 1e-8 * (1 + s.a.norm()));
}

TEST_CASE("results do not depend on the order in which bodies were added", "[property]") {
  const int seed = GENERATE(range(1, 10));
  const Model original = randomTree(registry(), 10, static_cast<std::uint64_t>(seed));
  // Adds the bodies breadth first instead of depth first, last children first.
  Model shuffled;
  shuffled.name = original.name;
  shuffled.gravity = original.gravity;
  std::vector<int> queue{0}, index(original.bodies.size(), 0);
  for (std::size_t k = 0; k < queue.size(); ++k)
    for (std::size_t i = original.bodies.size() - 1; i >= 1; --i) {
      if (original.bodies[i].parent != queue[k]) continue;
      const BodyDescription& b = original.bodies[i];
      index[i] = shuffled.addBody(b.name, index[static_cast<std::size_t>(b.parent)], b.joint, b.inertia);
      queue.push_back(static_cast<int>(i));
    }
  Subject a(original, 1), b(shuffled, 1);
  const auto copy = [&](const Eigen::VectorXd& from, Eigen::VectorXd& to, bool q) {
    for (const JointRecord& r : a.model.joints()) {
      const int j = b.model.jointId(r.name);
      const JointRecord& t = b.model.joints()[static_cast<std::size_t>(j)];
      if (q) to.segment(t.idx_q, t.nq) = from.segment(r.idx_q, r.nq);
      if (!q) to.segment(t.idx_v, t.nv) = from.segment(r.idx_v, r.nv);
    }
  };
  copy(a.q, b.q, true);
  copy(a.v, b.v, false);
  copy(a.a, b.a, false);
  const Eigen::VectorXd ta = rnea(a.model, a.data, a.q, a.v, a.a), tb = rnea(b.model, b.data, b.q, b.v, b.a);
  Eigen::VectorXd expected(tb.size());
  copy(ta, expected, false);
  CHECK(relative(expected, tb) < 1e-13);
}

TEST_CASE("a reduced model moves as the full one with those joints held", "[property]") {
  const int seed = GENERATE(range(1, 15));
  const Model full = randomTree(registry(), 9, static_cast<std::uint64_t>(seed), true);
  Subject s(full, static_cast<std::uint64_t>(seed));
  std::vector<LockedJoint> lock;
  for (const int j : {2, 5, 6}) {
    const int id = s.model.findJoint("j" + std::to_string(j));
    if (id < 0) continue;  // a fixed joint
    const JointRecord& r = s.model.joints()[static_cast<std::size_t>(id)];
    lock.push_back({r.name, std::vector<double>(s.q.data() + r.idx_q, s.q.data() + r.idx_q + r.nq)});
    s.v.segment(r.idx_v, r.nv).setZero();
    s.a.segment(r.idx_v, r.nv).setZero();
  }
  const CompactModel reduced = compile(reduce(full, registry(), lock), registry());
  Data data(reduced, Need::mass_matrix);
  Eigen::VectorXd q(reduced.nq()), v(reduced.nv()), a(reduced.nv()), expected(reduced.nv());
  const Eigen::VectorXd tau = rnea(s.model, s.data, s.q, s.v, s.a);
  for (const JointRecord& r : reduced.joints()) {
    const JointRecord& f = s.model.joints()[static_cast<std::size_t>(s.model.jointId(r.name))];
    REQUIRE(f.nv == r.nv);
    q.segment(r.idx_q, r.nq) = s.q.segment(f.idx_q, f.nq);
    v.segment(r.idx_v, r.nv) = s.v.segment(f.idx_v, f.nv);
    a.segment(r.idx_v, r.nv) = s.a.segment(f.idx_v, f.nv);
    expected.segment(r.idx_v, r.nv) = tau.segment(f.idx_v, f.nv);
  }
  CHECK(relative(rnea(reduced, data, q, v, a), expected) < 1e-11);
  CHECK(reduced.frames().size() == s.model.frames().size());
  forwardKinematics(s.model, s.data, s.q);
  forwardKinematics(reduced, data, q);
  for (int f = 0; f < static_cast<int>(reduced.frames().size()); ++f) {
    const SE3<double> X = framePlacement(reduced, data, f),
                      Y = framePlacement(s.model, s.data, s.model.frameId(reduced.frames()[static_cast<std::size_t>(f)].name));
    for (int k = 0; k < 9; ++k) CHECK(X.R.m[k] == approx(Y.R.m[k]).margin(1e-13));
    for (int k = 0; k < 3; ++k) CHECK(X.p[k] == approx(Y.p[k]).margin(1e-13));
  }
}
