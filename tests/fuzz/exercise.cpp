// SPDX-License-Identifier: BSD-2-Clause
#include "exercise.hpp"

#include "fuzz.hpp"

#include <dyn/geometry/collision.hpp>
#include <dyn/geometry/distance.hpp>

#include <algorithm>
#include <cmath>

namespace dyn::fuzz {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double plain = 1e6;  ///< results of numbers between 1 / plain and plain in magnitude cannot overflow

bool isPlain(double x) { return x == 0 || (std::fabs(x) <= plain && std::fabs(x) >= 1 / plain); }
bool isPlain(const Vec3<double>& x) { return isPlain(x.x) && isPlain(x.y) && isPlain(x.z); }

bool isPlain(const JointDescription& joint) {
  for (const auto& [name, value] : joint.parameters) {
    if (const auto* numbers = std::get_if<std::vector<double>>(&value))
      if (!std::all_of(numbers->begin(), numbers->end(), [](double x) { return isPlain(x); })) return false;
    if (const auto* parts = std::get_if<std::vector<JointDescription>>(&value))
      if (!std::all_of(parts->begin(), parts->end(), [](const JointDescription& part) { return isPlain(part); })) return false;
  }
  for (const auto* list : {&joint.damping, &joint.friction, &joint.armature})
    if (!std::all_of(list->begin(), list->end(), [](double x) { return isPlain(x); })) return false;
  return isPlain(joint.placement.p) && joint.coupling.type.empty();
}

bool isPlain(const Inertia<double>& Y) {
  const auto& I = Y.rotational;
  for (const double x : {Y.mass, I.xx, I.xy, I.yy, I.xz, I.yz, I.zz})
    if (!isPlain(x)) return false;
  return isPlain(Y.com);
}

bool isPlain(const Model& model) {
  if (!isPlain(model.gravity) || model.bodies.size() > 60) return false;
  return std::all_of(model.bodies.begin(), model.bodies.end(), [](const BodyDescription& b) { return isPlain(b.joint) && isPlain(b.inertia); });
}

class Exercise {
 public:
  Exercise(const Model& description, const CompactModel& model) : model_(model), data_(model, Need::derivatives), plain_(isPlain(description)) {}

  void at(const VectorXd& q, const VectorXd& v, const VectorXd& a) {
    const int n = model_.nv();
    const VectorXd tau = rnea(model_, data_, q, v, a), bias = nonLinearEffects(model_, data_, q, v);
    const MatrixXd M = crba(model_, data_, q);
    require(tau.allFinite() && bias.allFinite() && M.allFinite(), "rnea or crba is not finite");
    if (n == 0 || !tau.allFinite() || !M.allFinite()) return;
    const double size = M.cwiseAbs().maxCoeff();
    require((M - M.transpose()).cwiseAbs().maxCoeff() <= 1e-12 * size, "M is not symmetric");
    const double kinetic = computeKineticEnergy(model_, data_, q, v);
    computePotentialEnergy(model_, data_, q);
    const double sum = v.cwiseAbs().sum();
    require(std::fabs(kinetic - 0.5 * v.dot(M * v)) <= 1e-9 * size * sum * sum, "the kinetic energy is not v M v / 2");
    require(computeRNEADerivatives(model_, data_, q, v, a).dtau_dq.allFinite(), "rnea's derivatives are not finite");
    forwardKinematics(model_, data_, q, v, a);
    for (int f = 0; f < static_cast<int>(model_.frames().size()); ++f) framePlacement(model_, data_, f);
    succeeds([&] { computeCoriolisMatrix(model_, data_, q, v); });
    succeeds([&] { ccrba(model_, data_, q, v); });
    succeeds([&] { computeMinverse(model_, data_, q); });
    succeeds([&] { computeJointTorqueRegressor(model_, data_, q, v, a); });
    succeeds([&] { computeABADerivatives(model_, data_, q, v, tau); });
    succeeds([&] { forward(q, v, tau, bias, size); });
    succeeds([&] {
      const VectorXd there = integrate(model_, q, v), back = difference(model_, q, there);
      require(there.allFinite() && back.allFinite(), "integrate or difference is not finite");
    });
  }

 private:
  /// Checks that rnea(aba(tau)) is tau. The residual is small relative to the terms that cancel in it, whatever the condition of M.
  void forward(const VectorXd& q, const VectorXd& v, const VectorXd& tau, const VectorXd& bias, double size) {
    const VectorXd found = aba(model_, data_, q, v, tau);
    if (!plain_ || !found.allFinite() || found.size() == 0) return;
    const VectorXd again = rnea(model_, data_, q, v, found);
    const double terms = size * found.cwiseAbs().sum() + tau.cwiseAbs().maxCoeff() + bias.cwiseAbs().maxCoeff();
    // Gravity forces may cancel in tau, but their rounding errors remain.
    const double rounding = 1e-11 * (1 + size) * (1 + model_.mass()) * (1 + std::sqrt(dot(model_.gravity(), model_.gravity())));
    require((again - tau).cwiseAbs().maxCoeff() <= 1e-5 * terms + rounding, "rnea(aba(tau)) is not tau");
  }
  void require(bool holds, const char* what) const {
    if (plain_ && !holds) finding(what);
  }

  const CompactModel& model_;
  Data data_;
  bool plain_;
};

}  // namespace

void exercise(const Model& description, const CompactModel& model, std::uint64_t seed) {
  if (model.nv() > 60) return;
  succeeds([&] {
    Exercise e(description, model);
    const VectorXd zero = VectorXd::Zero(model.nv());
    e.at(neutral(model), zero, zero);
    std::srand(static_cast<unsigned>(seed));  // seeds Eigen's Random
    const VectorXd v = VectorXd::Random(model.nv()), a = VectorXd::Random(model.nv());
    e.at(randomConfiguration(model, seed), v, a);
    BatchData batch(model, 5);
    const MatrixXd Q = neutral(model).replicate(1, 5), V = v.replicate(1, 5);
    rnea(model, batch, Q, V, V);
    aba(model, batch, Q, V, V);
  });
}

void exerciseVolumes(const Model& description, const CompactModel& model) {
  GeometryOptions options;
  options.missing = GeometryOptions::Missing::skip;
  const GeometryModel geometry = compileGeometry(model, description, options);
  if (geometry.pairs().size() > 100) return;
  Data state(model);
  GeometryData volumes(geometry);
  updateGeometryPlacements(model, state, geometry, volumes, neutral(model));
  computeCollisions(geometry, volumes);
  computeDistances(geometry, volumes);
}

}  // namespace dyn::fuzz
