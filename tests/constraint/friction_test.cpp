// SPDX-License-Identifier: BSD-2-Clause
// Contacts with friction compared with closed forms: blocks on slopes, tables on four legs, balls that roll on a sliding box.
#include "constraint/support.hpp"

#include <cmath>

using namespace dyn;
using namespace dyn::test;

namespace {

using Vector = Eigen::VectorXd;

int addFreeBody(Model& model, const std::string& name, const Inertia<double>& inertia) {
  JointDescription joint;
  joint.name = name + "_joint";
  joint.type = "free_flyer";
  return model.addBody(name, 0, joint, inertia);
}

Inertia<double> boxOf(double mass, double half) {
  return {mass, {}, {mass * half * half * 2 / 3, 0, 0, mass * half * half * 2 / 3, 0, mass * half * half * 2 / 3}};
}

/// A box of 2 kg that stands on its four lower corners, with the contact normal along z. Twelve unknown forces act on six degrees of freedom, so the
/// forces are not unique.
struct Box {
  CompactModel model;
  Data data;
  ConstraintData contacts;
  std::vector<FrictionCone> cones;

  static Model description(const Vec3<double>& gravity) {
    Model m;
    m.gravity = gravity;
    addFreeBody(m, "box", boxOf(2, 0.1));
    return m;
  }
  static std::vector<ConstraintDescription> corners() {
    std::vector<ConstraintDescription> out;
    out.reserve(4);
    for (int k = 0; k < 4; ++k)
      out.push_back(frictionContact("corner" + std::to_string(k), "box", {k < 2 ? 0.1 : -0.1, k % 2 ? 0.1 : -0.1, -0.1}, {0, 0, 1}));
    return out;
  }
  Box(const Vec3<double>& gravity, double friction)
      : model(compile(description(gravity), registry())), data(model), contacts(ConstraintSet(model, corners())) {
    for (int k = 0; k < 4; ++k) cones.push_back({k, friction});
  }
  ContactStep step(const Vector& v, double dt, const ContactSettings& settings = {}) {
    return contactStep(model, data, neutral(model), v, Vector::Zero(6), dt, contacts, cones, settings);
  }
};

/// Gravity in the axes of a slope with this angle; x points downhill.
Vec3<double> slope(double angle) { return {9.81 * std::sin(angle), 0, -9.81 * std::cos(angle)}; }

}  // namespace

TEST_CASE("a block on a slope stays while friction holds it, and slides with what is left", "[friction]") {
  const double angle = 0.4, dt = 1e-2;
  for (const double friction : {0.0, 0.2, 0.6, 2.0}) {
    Box box(slope(angle), friction);
    const ContactStep x = box.step(Vector::Zero(6), dt);
    INFO("friction " << friction << ", " << x.iterations << " iterations");
    CHECK(x.converged);
    const double a = std::max(0.0, 9.81 * (std::sin(angle) - friction * std::cos(angle)));
    CHECK(std::abs(x.v_after[0] - a * dt) <= 1e-8);
    for (Eigen::Index k = 1; k < 6; ++k) CHECK(std::abs(x.v_after[k]) <= 1e-8);
    double normal = 0, tangential = 0;
    for (Eigen::Index k = 0; k < 4; ++k) {
      CHECK(x.impulse[3 * k + 2] >= 0);
      CHECK(std::hypot(x.impulse[3 * k], x.impulse[3 * k + 1]) <= friction * x.impulse[3 * k + 2] * (1 + 1e-14));
      normal += x.impulse[3 * k + 2];
      tangential += std::hypot(x.impulse[3 * k], x.impulse[3 * k + 1]);
    }
    CHECK(std::abs(normal - 2 * 9.81 * std::cos(angle) * dt) <= 1e-7);
    if (a > 0) CHECK(std::abs(tangential - friction * normal) <= 1e-7);
    CHECK(x.residual.penetration <= 1e-8);
    CHECK(x.residual.complementarity <= 1e-8);
  }
}

TEST_CASE("friction is Coulomb's cone and not a pyramid", "[friction]") {
  // Friction slows a sliding block down by the same amount whatever the direction.
  const double dt = 1e-2, friction = 0.3;
  Box box({0, 0, -9.81}, friction);
  for (int k = 0; k < 8; ++k) {
    const double angle = 0.2 + k * M_PI / 4;
    Vector v = Vector::Zero(6);
    v[0] = std::cos(angle);
    v[1] = std::sin(angle);
    // Friction acts at the base, so the block tends to tip over. At this friction no corner lifts off within the step.
    const ContactStep x = box.step(v, dt);
    CHECK(x.converged);
    CHECK(std::abs(x.v_after[0] - (1 - friction * 9.81 * dt) * v[0]) <= 1e-8);
    CHECK(std::abs(x.v_after[1] - (1 - friction * 9.81 * dt) * v[1]) <= 1e-8);
  }
}

TEST_CASE("what moves apart is not held, what falls bounces as it is told", "[friction]") {
  Box box({0, 0, -9.81}, 0.5);
  const double dt = 1e-3;
  Vector v = Vector::Zero(6);
  v[2] = 1;
  const ContactStep apart = box.step(v, dt);
  CHECK(apart.converged);
  CHECK(apart.impulse.cwiseAbs().maxCoeff() <= 1e-9);
  CHECK(std::abs(apart.v_after[2] - (1 - 9.81 * dt)) <= 1e-10);
  v[2] = -1;
  for (const double restitution : {0.0, 0.5, 1.0}) {
    ContactSettings settings;
    settings.restitution = restitution;
    const ContactStep x = box.step(v, dt, settings);
    CHECK(x.converged);
    CHECK(std::abs(x.v_after[2] - restitution) <= 1e-8);
  }
}

TEST_CASE("balls roll on a box that slides: closed form of the rolling benchmark", "[friction]") {
  // A force of 150 N pushes a box of 10 kg over the ground with friction 0.4. On the box 25 balls of 1 kg roll without slip.
  const int balls = 25;
  const double M = 10, m = 1, radius = 0.1, half = 0.5, dt = 1e-3, force = 150, mu1 = 0.4, mu2 = 0.8;
  Model description;
  addFreeBody(description, "box", boxOf(M, half));
  std::vector<ConstraintDescription> set;
  std::vector<FrictionCone> cones;
  for (int k = 0; k < 4; ++k) {
    set.push_back(frictionContact("corner" + std::to_string(k), "box", {k < 2 ? half : -half, k % 2 ? half : -half, -half}, {0, 0, 1}));
    cones.push_back({k, mu1});
  }
  const double I = 0.4 * m * radius * radius;
  for (int k = 0; k < balls; ++k) {
    const std::string name = "ball" + std::to_string(k);
    addFreeBody(description, name, {m, {}, {I, 0, 0, I, 0, I}});
    set.push_back(frictionContact(name, name, {0, 0, -radius}, {0, 0, 1}, "box"));
    cones.push_back({4 + k, mu2});
  }
  const CompactModel model = compile(description, registry());
  Data data(model);
  ConstraintData contacts(ConstraintSet(model, set));
  Vector q = neutral(model), tau = Vector::Zero(model.nv());
  q[2] = half;
  for (int k = 0; k < balls; ++k) {
    const JointRecord& joint = model.joints()[static_cast<std::size_t>(model.jointId("ball" + std::to_string(k) + "_joint"))];
    q[joint.idx_q] = 0.2 * (k % 5 - 2);
    const int row = k / 5;
    q[joint.idx_q + 1] = 0.2 * (row - 2);
    q[joint.idx_q + 2] = 2 * half + radius;
  }
  const JointRecord& box = model.joints()[static_cast<std::size_t>(model.jointId("box_joint"))];
  // The force acts at the height of the ground, so that the box does not tip.
  tau[box.idx_v] = force;
  tau[box.idx_v + 4] = -force * half;
  ContactSettings settings;
  settings.max_iterations = 20000;
  const ContactStep x = contactStep(model, data, q, Vector::Zero(model.nv()), tau, dt, contacts, cones, settings);
  const double f1 = mu1 * (M + balls * m) * 9.81, f2 = (force - f1) / M / (3.5 / m + balls / M), a_box = (force - f1 - balls * f2) / M,
               a_ball = f2 / m;
  INFO(x.iterations << " iterations, penetration " << x.residual.penetration << ", complementarity " << x.residual.complementarity);
  CHECK(x.converged);
  CHECK(std::abs(x.v_after[box.idx_v] / dt - a_box) <= 1e-5);
  for (int k = 0; k < balls; ++k) {
    const JointRecord& joint = model.joints()[static_cast<std::size_t>(model.jointId("ball" + std::to_string(k) + "_joint"))];
    CHECK(std::abs(x.v_after[joint.idx_v] / dt - a_ball) <= 1e-5);
  }
}

TEST_CASE("the ground carries a ball that rolls as one that lies", "[friction]") {
  const double radius = 0.1, dt = 1e-2, I = 0.4 * radius * radius, spin = 10;
  Model description;
  addFreeBody(description, "ball", {1, {}, {I, 0, 0, I, 0, I}});
  const CompactModel model = compile(description, registry());
  Data data(model);
  ConstraintData contact(ConstraintSet(model, {frictionContact("ground", "ball", {0, 0, -radius}, {0, 0, 1})}));
  Vector q = neutral(model), v = Vector::Zero(6);
  q[2] = radius;
  v[0] = spin * radius;
  v[4] = spin;
  const ContactStep x = contactStep(model, data, q, v, Vector::Zero(6), dt, contact, {{0, 0.5}});
  CHECK(x.converged);
  CHECK(std::abs(x.impulse[2] - 9.81 * dt) <= 1e-8);
  CHECK(std::hypot(x.impulse[0], x.impulse[1]) <= 1e-8);
  CHECK(std::abs(x.velocity[2]) <= 1e-8);
  // v_after is in body axes, which rotate, so its rate is -w x v.
  CHECK(std::abs(x.v_after[2] - dt * spin * spin * radius) <= 1e-8);
}

TEST_CASE("forces that explain a motion are found in their cones", "[friction]") {
  const CompactModel model = compile(randomTree(registry(), 10, 3), registry());
  Data data(model, Need::derivatives);
  Random random(5);
  std::vector<ConstraintDescription> set = {frictionContact("a", "b3", {0.1, 0, 0}, random.vector()),
                                            frictionContact("b", "b7", {0, 0.2, 0}, random.vector()), frictionContact("c", "tool", {}, {0, 0, 1})};
  ConstraintData contacts(ConstraintSet(model, set));
  const std::vector<FrictionCone> cones = {{0, 0.5}, {1, 0.7}, {2, 0.3}};
  const Vector q = integrate(model, neutral(model), random.vector(model.nv(), 1)), v = random.vector(model.nv(), 1),
               tau = random.vector(model.nv(), 5);
  Vector known(9);
  known << 0.5, -0.3, 3, 0.1, 0.9, 2, 0, 0, 0;  // two forces within their cones, and no force
  const Eigen::MatrixXd J = computeConstraintJacobian(model, data, q, contacts);
  const Vector a = aba(model, data, q, v, tau + J.transpose() * known);
  ContactSettings settings;
  settings.max_iterations = 20000;
  const ContactForces x = contactForces(model, data, q, v, a, tau, contacts, cones, settings);
  CHECK(x.converged);
  CHECK((x.lambda - known).cwiseAbs().maxCoeff() <= 1e-5);
  CHECK(x.left.cwiseAbs().maxCoeff() <= 1e-5);
  // Contacts cannot pull, so they cannot explain this motion.
  Vector pulls = Vector::Zero(9);
  pulls[2] = -3;
  const Vector pulled = aba(model, data, q, v, tau + J.transpose() * pulls);
  const ContactForces y = contactForces(model, data, q, v, pulled, tau, contacts, cones, settings);
  CHECK(y.converged);
  CHECK(y.left.cwiseAbs().maxCoeff() > 0.01);
  for (Eigen::Index k = 0; k < 3; ++k)
    CHECK(std::hypot(y.lambda[3 * k], y.lambda[3 * k + 1]) <= cones[static_cast<std::size_t>(k)].friction * y.lambda[3 * k + 2] + 1e-12);
}

TEST_CASE("a joint's own friction holds it both ways, as well as it can", "[friction]") {
  Model description;
  description.gravity = {};
  JointDescription joint;
  joint.name = "joint";
  joint.type = "translation";
  description.addBody("body", 0, joint, boxOf(2, 0.1));
  const CompactModel model = compile(description, registry());
  Data data(model);
  ConstraintData lock(ConstraintSet(model, {lockJoint("joint")}));
  std::vector<FrictionCone> cones(3, {.constraint = 0, .friction = 10, .both_ways = true});
  for (int k = 0; k < 3; ++k) cones[static_cast<std::size_t>(k)].coordinate = k;
  const double dt = 1e-2;
  const Vector tau = Eigen::Vector3d(8, 12, -15), v = Eigen::Vector3d(0, 0, 0.01);
  const ContactStep x = contactStep(model, data, neutral(model), v, tau, dt, lock, cones);
  CHECK(x.converged);
  CHECK(std::abs(x.v_after[0]) < 1e-9);
  CHECK(std::abs(x.v_after[1] - dt * 2 / 2) < 1e-9);
  CHECK(std::abs(x.v_after[2] - (0.01 - dt * 5 / 2)) < 1e-9);
  CHECK(std::abs(x.impulse[0] + 8 * dt) < 1e-8);
  CHECK(x.impulse[1] == -10 * dt);
  CHECK(x.impulse[2] == 10 * dt);
  CHECK(x.residual.complementarity < 1e-9);
  CHECK_THROWS_WITH(contactStep(model, data, neutral(model), v, tau, dt, lock, {{.constraint = 0, .both_ways = true, .coordinate = 3}}),
                    containing("no degree of freedom 3"));
}

TEST_CASE("what is no cone is refused", "[friction]") {
  Box box({0, 0, -9.81}, 0.5);
  const auto refused = [&](const std::vector<FrictionCone>& cones) {
    try {
      contactStep(box.model, box.data, neutral(box.model), Vector::Zero(6), Vector::Zero(6), 1e-3, box.contacts, cones);
    } catch (const Error& e) {
      return std::string(e.what());
    }
    return std::string("accepted");
  };
  CHECK_THAT(refused({{0, -0.1}}), containing("friction is negative"));
  CHECK_THAT(refused({{9, 0.1}}), containing("the set has 4"));
  CHECK_THAT(refused({{1, 0.1}, {1, 0.1}}), containing("two cones"));
  CHECK_THROWS_WITH(frictionContact("c", "box", {}, {0, 0, 0}), containing("normal has no direction"));
  ConstraintData held(ConstraintSet(box.model, {frameContact("box")}));
  CHECK_THROWS_WITH(contactStep(box.model, box.data, neutral(box.model), Vector::Zero(6), Vector::Zero(6), 1e-3, held, {{0, 0.5}}),
                    containing("no point contact"));
  CHECK_THROWS_WITH(contactStep(box.model, box.data, neutral(box.model), Vector::Zero(6), Vector::Zero(6), -1, box.contacts, box.cones),
                    containing("must be positive"));
}

TEST_CASE("a contact step from a state that is not finite does not claim to have converged", "[friction]") {
  Box box({0, 0, -9.81}, 0.5);
  Vector v = Vector::Zero(6);
  v[0] = std::nan("");
  CHECK_FALSE(box.step(v, 1e-2).converged);
  Vector q = neutral(box.model);
  q[3] = std::nan("");
  CHECK_FALSE(contactStep(box.model, box.data, q, Vector::Zero(6), Vector::Zero(6), 1e-2, box.contacts, box.cones).converged);
}
