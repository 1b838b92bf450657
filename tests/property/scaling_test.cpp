// SPDX-License-Identifier: BSD-2-Clause
// There are no absolute thresholds: if units of length, mass and time change by powers of two, results change by powers of two, bit for bit.
#include "support/catch.hpp"
#include "support/random_model.hpp"
#include "support/registry.hpp"

#include <cmath>

using namespace dyn;
using namespace dyn::test;

namespace {

/// A tree of joints whose parameters have no units, so that only placements and inertias have units.
Model tree(std::uint64_t seed) {
  Random random(seed);
  const char* types[] = {"free_flyer", "revolute", "prismatic", "spherical", "continuous", "universal", "translation", "planar", "spherical_zyx"};
  Model model;
  model.gravity = random.vector(10);
  for (int i = 0; i < 14; ++i) {
    JointDescription joint;
    joint.name = "j" + std::to_string(i);
    joint.type = types[i < 9 ? i : random.below(9)];
    const JointTypeInfo& info = registry().jointType(joint.type, {}).info();
    joint.parameters = exampleParameters(info, seed + static_cast<std::uint64_t>(i));
    joint.placement = random.pose();
    model.addBody("b" + std::to_string(i), i == 0 ? 0 : random.below(i) + 1, joint, random.inertia());
  }
  return model;
}

struct Units {
  double length, mass, time;
};

Vec3<double> scaled(const Vec3<double>& x, double s) { return s * x; }

Model in(Model model, const Units& u) {
  model.gravity = scaled(model.gravity, u.length / (u.time * u.time));
  for (BodyDescription& b : model.bodies) {
    b.joint.placement.p = scaled(b.joint.placement.p, u.length);
    b.inertia.mass *= u.mass;
    b.inertia.com = scaled(b.inertia.com, u.length);
    b.inertia.rotational = (u.mass * u.length * u.length) * b.inertia.rotational;
  }
  return model;
}

/// The factor of each coordinate or velocity if lengths are scaled by `length`: `length` for translations, 1 for rotations.
Eigen::VectorXd lengthsOf(const CompactModel& m, double length, bool positions) {
  Eigen::VectorXd s = Eigen::VectorXd::Ones(positions ? m.nq() : m.nv());
  for (const JointRecord& r : m.joints()) {
    const int count = r.type == "free_flyer" || r.type == "translation" ? 3 : r.type == "planar" ? 2 : r.type == "prismatic" ? 1 : 0;
    s.segment(positions ? r.idx_q : r.idx_v, count).setConstant(length);
  }
  return s;
}

}  // namespace

TEST_CASE("units that are powers of two change exponents and no bit of the mantissas", "[property]") {
  const auto seed = static_cast<std::uint64_t>(GENERATE(range(1, 6)));
  const Units u = GENERATE(Units{0x1p10, 1, 1}, Units{1, 0x1p-12, 1}, Units{0x1p-20, 0x1p-40, 1}, Units{0x1p30, 0x1p60, 0x1p-5});
  const Model model = tree(seed);
  const CompactModel a = compile(model, registry()), b = compile(in(model, u), registry());
  Data da(a, Need::mass_matrix), db(b, Need::mass_matrix);
  Random random(seed);
  const Eigen::VectorXd q = integrate(a, neutral(a), Eigen::VectorXd(random.vector(a.nv(), 1))), v = random.vector(a.nv(), 1),
                        acc = random.vector(a.nv(), 1);
  const Eigen::VectorXd x = lengthsOf(a, u.length, false), qb = q.cwiseProduct(lengthsOf(a, u.length, true));
  const Eigen::VectorXd vb = v.cwiseProduct(x) / u.time, accb = acc.cwiseProduct(x) / (u.time * u.time);
  const double energy = u.mass * u.length * u.length / (u.time * u.time);
  const Eigen::VectorXd force = energy * x.cwiseInverse();

  const Eigen::VectorXd tau = rnea(a, da, q, v, acc);
  CHECK(rnea(b, db, qb, vb, accb) == tau.cwiseProduct(force));
  const Eigen::MatrixXd M = crba(a, da, q);
  CHECK(crba(b, db, qb) == force.asDiagonal() * M * (u.time * u.time * x.cwiseInverse()).asDiagonal());
  const Eigen::VectorXd ddq = aba(a, da, q, v, tau);
  CHECK(aba(b, db, qb, vb, Eigen::VectorXd(tau.cwiseProduct(force))) == ddq.cwiseProduct(x) / (u.time * u.time));
  CHECK(computeKineticEnergy(b, db, qb, vb) == computeKineticEnergy(a, da, q, v) * energy);
  CHECK(computePotentialEnergy(b, db, qb) == computePotentialEnergy(a, da, q) * energy);
}

TEST_CASE("a base far away or at a thousand kilometres a second changes nothing within", "[property]") {
  const auto seed = static_cast<std::uint64_t>(GENERATE(range(1, 6)));
  const CompactModel m = compile(tree(seed), registry());
  Data data(m, Need::mass_matrix);
  Random random(seed);
  Eigen::VectorXd q = integrate(m, neutral(m), Eigen::VectorXd(random.vector(m.nv(), 1))), v = random.vector(m.nv(), 1);
  const Eigen::VectorXd acc = random.vector(m.nv(), 1);
  REQUIRE(m.joints()[1].type == "free_flyer");
  const Eigen::MatrixXd M = crba(m, data, q);
  const Eigen::VectorXd tau = rnea(m, data, q, v, acc), ddq = aba(m, data, q, v, tau);
  q.head(3) << 1e9, -3e8, 2e12;
  CHECK(crba(m, data, q) == M);
  CHECK(rnea(m, data, q, v, acc) == tau);
  CHECK(aba(m, data, q, v, tau) == ddq);
  // With a faster base its spatial acceleration changes by v x w, but the forces stay the same.
  Eigen::VectorXd fast = v;
  const Vec3<double> boost{1e6, -3e5, 7e5}, w{v[3], v[4], v[5]};
  for (int k = 0; k < 3; ++k) fast[k] += boost[k];
  // The classical acceleration must stay the same, and a_spatial = a_classical - w x v.
  const Vec3<double> change = cross(boost, w);
  Eigen::VectorXd shifted = acc;
  for (int k = 0; k < 3; ++k) shifted[k] += change[k];
  const Eigen::VectorXd moving = rnea(m, data, q, fast, shifted);
  // Adding w x v to a and subtracting it again costs the rounding errors of a, 1e6 u.
  CHECK((moving - tau).cwiseAbs().maxCoeff() < 4e6 * 0x1p-53 * (1 + M.cwiseAbs().maxCoeff()) * 10);
}
