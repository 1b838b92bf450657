// SPDX-License-Identifier: BSD-2-Clause
// Results do not depend on how the axes of bodies are chosen. Where placements only exchange axes, or joint offsets are zero, kernels leave out
// multiplications with zeros.
#include "support/difference.hpp"
#include "support/random_model.hpp"
#include "support/registry.hpp"

#include <dyn/algorithm/batch_derivatives.hpp>

#include <array>

using namespace dyn;
using namespace dyn::test;

namespace {

std::vector<double> numbers(const Vec3<double>& v) { return {v.x, v.y, v.z}; }

Vec3<double> alongAxis(int k, double length) {
  Vec3<double> out{};
  out[k] = length;
  return out;
}

/// A rotation about none, one or both of the other two axes, by angles from rounding errors up to 3 rad.
Mat3<double> tilt(Random& random, int axis) {
  const double sizes[] = {5e-12, 7e-9, 4e-6, 0.5, 3};
  Vec3<double> angle{};
  for (const int k : {1, 2})
    if (random.below(3) > 0) angle[(axis + k) % 3] = sizes[random.below(5)] * random.uniform(-1, 1);
  return exp3(angle);
}

/// Two descriptions of one robot: one as it is, and one with each body's frame rotated at random. Joint axes are positive or negative coordinate
/// axes of the parent. Some placements are rotated about that axis or tilted from it. Some joint offsets are zero or along a coordinate axis, and
/// some axes cross the parent's axis elsewhere. Two joints in three are on the body before.
struct Described {
  std::array<Model, 2> models;
  std::vector<Mat3<double>> turned{Mat3<double>::identity()};
};
Described describe(int n, std::uint64_t seed, const char* other, double armature) {
  Random random(seed);
  Described out;
  std::vector<Vec3<double>> axes{{}};
  for (int i = 0; i < n; ++i) {
    const int parent = i % 3 == 2 ? random.below(i + 1) : i, direction = random.below(6);
    const Vec3<double> axis = alongAxis(direction % 3, direction < 3 ? 1 : -1);
    Vec3<double> p = random.vector(0.3);
    if (i % 2 == 0) p = p.x * axes[static_cast<std::size_t>(parent)] + p.y * axis;
    if (i % 7 == 3) p = {};
    if (i % 7 == 5) p = alongAxis(random.below(3), p.x);
    SE3<double> placement{i % 4 == 0 ? exp3(random.uniform(-3, 3) * axis) : Mat3<double>::identity(), p};
    if (i % 4 == 1) placement.R = tilt(random, direction % 3);
    axes.push_back(axis);
    const Inertia<double> inertia = random.inertia();
    out.turned.push_back(random.pose().R);

    JointDescription joint;
    joint.name = "j" + std::to_string(i);
    joint.type = i % 5 == 4 ? other : "revolute";
    joint.parameters["axis"] = numbers(axis);
    joint.placement = placement;
    if (armature > 0) joint.armature = {armature};
    const std::string body = "b" + std::to_string(i);
    out.models[0].addBody(body, parent, joint, inertia);

    const Mat3<double> back = transpose(out.turned.back()), of_parent = transpose(out.turned[static_cast<std::size_t>(parent)]);
    joint.parameters["axis"] = numbers(back * axis);
    joint.placement = {of_parent * placement.R * out.turned.back(), of_parent * placement.p};
    out.models[1].addBody(body, parent, joint, inertia.transformed({back, {}}));
  }
  return out;
}

}  // namespace

TEST_CASE("robots whose placements exchange axes move as they do in frames turned at random", "[property]") {
  const auto seed = static_cast<std::uint64_t>(GENERATE(range(1, 7)));
  // Prismatic joints move the origin of their body and interrupt runs of revolute joints.
  const Described described = describe(37, seed, seed % 2 == 0 ? "prismatic" : "revolute", seed % 3 == 0 ? 0.1 : 0);
  const CompactModel model = compile(described.models[0], registry()), turned = compile(described.models[1], registry());
  Random random(seed);
  const Eigen::VectorXd q = random.vector(model.nv(), 2), v = random.vector(model.nv(), 1), a = random.vector(model.nv(), 1);
  Data data(model, Need::mass_matrix | Need::derivatives), expected(turned, Need::mass_matrix | Need::derivatives);

  const Eigen::MatrixXd M = crba(turned, expected, q), ddq = aba(turned, expected, q, v, a), inverse = computeMinverse(turned, expected, q);
  const Eigen::MatrixXd tau = rnea(turned, expected, q, v, a);
  const Eigen::MatrixXd dtau = computeRNEADerivatives(turned, expected, q, v, a).dtau_dq;
  const Eigen::MatrixXd map = ccrba(turned, expected, q, v).Ag;
  CHECK(off(crba(model, data, q), M) <= 1e-13);
  CHECK(off(rnea(model, data, q, v, a), tau) <= 1e-13);
  CHECK(off(aba(model, data, q, v, a), ddq) <= 1e-11);
  CHECK(off(computeMinverse(model, data, q), inverse) <= 1e-11);
  CHECK(off(computeRNEADerivatives(model, data, q, v, a).dtau_dq, dtau) <= 1e-13);
  CHECK(off(ccrba(model, data, q, v).Ag, map) <= 1e-13);

  forwardKinematics(model, data, q);
  forwardKinematics(turned, expected, q);
  for (int i = 1; i <= 37; ++i) {
    const int joint = model.jointId("j" + std::to_string(i - 1));
    const SE3<double> back{transpose(described.turned[static_cast<std::size_t>(i)]), {}};
    CHECK(off(toEigen(jointPlacement(model, data, joint)), toEigen(jointPlacement(turned, expected, joint) * back)) <= 1e-13);
  }

  const int states = 9;
  const auto repeated = [&](const Eigen::VectorXd& x) { return Eigen::MatrixXd(x.replicate(1, states)); };
  BatchData batch(model, states, Need::mass_matrix | Need::derivatives);
  CHECK(off(crba(model, batch, repeated(q)), repeated(M.reshaped())) <= 1e-13);
  CHECK(off(rnea(model, batch, repeated(q), repeated(v), repeated(a)), repeated(tau.reshaped())) <= 1e-13);
  CHECK(off(aba(model, batch, repeated(q), repeated(v), repeated(a)), repeated(ddq.reshaped())) <= 1e-11);
  CHECK(off(computeMinverse(model, batch, repeated(q)), repeated(inverse.reshaped())) <= 1e-11);
  CHECK(off(computeRNEADerivatives(model, batch, repeated(q), repeated(v), repeated(a)).dtau_dq, repeated(dtau.reshaped())) <= 1e-13);
}
