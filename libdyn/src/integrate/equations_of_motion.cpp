// SPDX-License-Identifier: BSD-2-Clause
#include "integrate/equations_of_motion.hpp"

#include "algorithm/support/inputs.hpp"
#include "number_text.hpp"

#include <dyn/algorithm/aba.hpp>
#include <dyn/algorithm/center_of_mass.hpp>
#include <dyn/algorithm/configuration.hpp>
#include <dyn/algorithm/derivatives.hpp>
#include <dyn/constraint/assembly.hpp>
#include <dyn/constraint/derivatives.hpp>
#include <dyn/error.hpp>

#include <cmath>

namespace dyn {

namespace {

Need withCouplings(const CompactModel& model, Need needs) { return model.impl().couplings.empty() ? needs : needs | Need::mass_matrix; }

}  // namespace

void refuseCallback(const char* callback, double t, const std::string& why) {
  throw Error(ErrorCode::simulation, std::string(callback) + " threw at t = " + number(t) + " s: " + why);
}

EquationsOfMotion::EquationsOfMotion(const CompactModel& model, const ConstraintSet* constraints, Need needs)
    : model_(model),
      data_(model, withCouplings(model, needs)),
      tau_(Eigen::VectorXd::Zero(model.nv())),
      kept_tau_(tau_),
      moved_q_(model.nq()),
      moved_v_(model.nv()),
      direction_(tau_),
      zero_(tau_),
      fext_(model.joints().size()) {
  if (constraints) constraints_.emplace(*constraints, needs);
  if (!model.impl().friction.empty()) {
    joint_friction = friction_limits_ = zero_;
    expanded_.resize(model.impl().friction.size());
  }
  if (has(needs, Need::derivatives)) {
    tau_by_q_.resize(model.nv(), model.nv());
    tau_by_v_.resize(model.nv(), model.nv());
  }
}

void EquationsOfMotion::callController(double t, const double* q, const double* v, double* tau) {
  VectorMap out(tau, model_.nv());
  out.setZero();
  if (!controller) return;
  guardCallback("the controller", t, [&] { controller(t, configuration(q), velocity(v), out); });
  if (!fault.empty() || out.allFinite() || !atFiniteState(q, v)) return;
  for (const JointRecord& joint : model_.joints())
    for (int k = 0; k < joint.nv; ++k)
      if (const double x = out[joint.idx_v + k]; !std::isfinite(x) && fault.empty())
        fault = "at t = " + number(t) + " s the controller's tau[" + std::to_string(joint.idx_v + k) + "], of joint '" + joint.name + "', is " +
                number(x);
}

void EquationsOfMotion::callForces(double t, const double* q, const double* v) {
  for (Force<double>& f : fext_) f = Force<double>{};
  guardCallback("the function of forces", t, [&] { forces(t, configuration(q), velocity(v), fext_.data(), static_cast<int>(fext_.size())); });
  const auto finite = [](const Vec3<double>& x) { return std::isfinite(x.x) && std::isfinite(x.y) && std::isfinite(x.z); };
  for (std::size_t k = 0; k < fext_.size(); ++k)
    if (fault.empty() && !(finite(fext_[k].linear) && finite(fext_[k].angular)) && atFiniteState(q, v))
      fault = "at t = " + number(t) + " s the external force on joint '" + model_.joints()[k].name + "' is not finite";
}

const double* EquationsOfMotion::acceleration(double t, const double* q, const double* v) {
  ++statistics.evaluations;
  callController(t, q, v, tau_.data());
  addFriction(q, v);
  const VectorView at_q{q, model_.nq()}, at_v{v, model_.nv()}, tau{tau_.data(), model_.nv()};
  const Force<double>* f = nullptr;
  if (forces) {
    callForces(t, q, v);
    f = fext_.data();
  }
  const std::size_t count = f ? fext_.size() : 0;
  if (!constraints_) return detail::aba(model_, data_, at_q, at_v, tau, f, count);
  return detail::constraintDynamics(model_, data_, at_q, at_v, tau, *constraints_, ConstraintMethod::articulated, f, count).motion;
}

const double* EquationsOfMotion::applied(double t, const double* q, const double* v) {
  callBack(t, q, v);
  addFriction(q, v);
  return tau_.data();
}

const Eigen::VectorXd& EquationsOfMotion::frictionLimits(const double* q) {
  const CompactImpl& m = model_.impl();
  readInputs("Simulator", model_, data_, {q, model_.nq()}, nullptr, nullptr);
  expanded_ = m.friction;
  const auto at = [&](int body) -> double& { return expanded_[static_cast<std::size_t>(m.index[static_cast<std::size_t>(body)].idx_v)]; };
  // A dependent joint turns |ratio| times as fast as its master, in either direction.
  for (std::size_t k = m.couplings.size(); k-- > 0;) at(m.couplings[k].master) += std::abs(data_.impl().G[k]) * at(m.couplings[k].body);
  for (int k = 0; k < model_.nv(); ++k)
    friction_limits_[k] = expanded_[static_cast<std::size_t>(m.couplings.empty() ? k : m.v_of_user[static_cast<std::size_t>(k)])];
  return friction_limits_;
}

void EquationsOfMotion::undoFriction(const double* q, const double* v, double* tau) {
  if (joint_friction.size() == 0) return;
  frictionLimits(q);
  for (int k = 0; k < model_.nv(); ++k) tau[k] += friction_limits_[k] * ((v[k] > 0) - (v[k] < 0));
}

void EquationsOfMotion::addFriction(const double* q, const double* v) {
  if (joint_friction.size() == 0) return;
  undoFriction(q, v, tau_.data());
  tau_ += joint_friction;
}

void EquationsOfMotion::callBack(double t, const double* q, const double* v) {
  callController(t, q, v, tau_.data());
  if (!forces) return;
  callForces(t, q, v);
  const VectorView at_q{q, model_.nq()}, at_v{v, model_.nv()}, zero{zero_.data(), model_.nv()};
  tau_ += VectorResult(detail::rnea(model_, data_, at_q, at_v, zero, nullptr, 0), model_.nv());
  tau_ -= VectorResult(detail::rnea(model_, data_, at_q, at_v, zero, fext_.data(), fext_.size()), model_.nv());
}

void EquationsOfMotion::differentiateController(double t, const double* q, const double* v) {
  const int n = model_.nv();
  tau_by_q_.setZero();
  tau_by_v_.setZero();
  if (controller_derivatives && !forces) {
    guardCallback("the controller's derivatives", t, [&] {
      controller_derivatives(t, configuration(q), velocity(v), MatrixMap(tau_by_q_.data(), n, n), MatrixMap(tau_by_v_.data(), n, n));
    });
    return;
  }
  // Finite differences: their error costs iterations, not accuracy.
  kept_tau_ = tau_;
  const Eigen::VectorXd& here = kept_tau_;
  for (int k = 0; k < n; ++k) {
    const double h = 0x1p-26;
    direction_[k] = h;
    detail::integrate(model_, {q, model_.nq()}, {direction_.data(), n}, {moved_q_.data(), model_.nq()});
    direction_[k] = 0;
    callBack(t, moved_q_.data(), v);
    tau_by_q_.col(k) = (tau_ - here) / h;
    const double hv = h * std::max(1.0, std::abs(v[k]));
    moved_v_ = velocity(v);
    moved_v_[k] += hv;
    callBack(t, q, moved_v_.data());
    tau_by_v_.col(k) = (tau_ - here) / hv;
  }
  tau_ = here;
}

void EquationsOfMotion::derivatives(double t, const double* q, const double* v, MatrixMap by_q, MatrixMap by_v) {
  const int n = model_.nv();
  const bool driven = controller || forces;
  callBack(t, q, v);
  if (driven) differentiateController(t, q, v);
  addFriction(q, v);
  const VectorView at_q{q, model_.nq()}, at_v{v, n}, tau{tau_.data(), n};
  const double *dq, *dv, *dtau;
  if (constraints_) {
    const auto x = detail::constraintDynamicsDerivatives(model_, data_, at_q, at_v, tau, *constraints_);
    dq = x.motion_dq, dv = x.motion_dv, dtau = x.motion_dtau;
  } else {
    const auto x = detail::abaDerivatives(model_, data_, at_q, at_v, tau, nullptr, 0);
    dq = x.by_q, dv = x.by_v, dtau = x.inertia;
  }
  by_q = MatrixResult(dq, n, n);
  by_v = MatrixResult(dv, n, n);
  if (!driven) return;
  by_q.noalias() += MatrixResult(dtau, n, n).lazyProduct(tau_by_q_);
  by_v.noalias() += MatrixResult(dtau, n, n).lazyProduct(tau_by_v_);
}

double EquationsOfMotion::speed(const double* q, const double* v) {
  return std::sqrt(std::max(0.0, detail::kineticEnergy(model_, data_, {q, model_.nq()}, {v, model_.nv()})));
}

double EquationsOfMotion::energy(const double* q, const double* v) {
  return detail::kineticEnergy(model_, data_, {q, model_.nq()}, {v, model_.nv()}) + detail::potentialEnergy(model_, data_, {q, model_.nq()});
}

double EquationsOfMotion::power(double t, const double* q, const double* v) {
  const double given = velocity(v).dot(VectorResult(applied(t, q, v), model_.nv()));
  // Dissipation is the part of the forces of rnea that is odd in v.
  const auto needed = [&](const double* velocities) {
    return velocity(v).dot(
        VectorResult(detail::rnea(model_, data_, {q, model_.nq()}, {velocities, model_.nv()}, {zero_.data(), model_.nv()}, nullptr, 0), model_.nv()));
  };
  moved_v_ = -velocity(v);
  return given - 0.5 * (needed(v) - needed(moved_v_.data()));
}

double EquationsOfMotion::constraintError(const double* q, const double* v) {
  if (!constraints_ || constraints_->set().rows() == 0) return 0;
  const auto x = detail::constraintMotion(model_, data_, {q, model_.nq()}, {v, model_.nv()}, *constraints_);
  return VectorResult(x.error, constraints_->set().rows()).cwiseAbs().maxCoeff();
}

bool EquationsOfMotion::project(double* q, double* v) {
  if (!constraints_ || constraints_->set().rows() == 0) return true;
  const auto x = detail::projectConfiguration(model_, data_, {q, model_.nq()}, *constraints_, {});
  if (!x.closed) return false;
  std::copy_n(x.q, model_.nq(), q);
  projectVelocity(q, v);
  return true;
}

void EquationsOfMotion::projectVelocity(const double* q, double* v) {
  std::copy_n(detail::impulseDynamics(model_, data_, {q, model_.nq()}, {v, model_.nv()}, 0.0, *constraints_).motion, model_.nv(), v);
}

}  // namespace dyn
