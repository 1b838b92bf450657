// SPDX-License-Identifier: BSD-2-Clause
#include "integrate/unilateral.hpp"

#include "algorithm/support/turning.hpp"

#include <dyn/algorithm/aba.hpp>
#include <dyn/algorithm/configuration.hpp>
#include <dyn/algorithm/kinematics.hpp>
#include <dyn/algorithm/rnea.hpp>
#include <dyn/error.hpp>

#include <algorithm>
#include <cmath>

namespace dyn {

namespace {

constexpr std::size_t most_bound = 16;

/// [s] Duration so short that only impulses count.
constexpr double instant = 0x1p-60;
/// Fraction of a negative gap that one step removes.
constexpr double recovered = 0.2;
/// [m/s] A penetration of less than this speed times the step is left as it is.
constexpr double creep = 1e-6;
/// [m/s, rad/s] Speed that the solver cannot tell from rest. Its forces may differ by its tolerance from their cones, and again from the last ones.
constexpr double still = 2 * ContactSettings{}.tolerance;

bool same(const ContactPoint& a, const ContactPoint& b) {
  const auto equal = [](const Vec3<double>& x, const Vec3<double>& y) { return x.x == y.x && x.y == y.y && x.z == y.z; };
  return a.id == b.id && a.frame == b.frame && a.other == b.other && equal(a.point, b.point) && equal(a.normal, b.normal) && a.friction == b.friction;
}

}  // namespace

Unilateral::Unilateral(const CompactModel& model, const ConstraintSet* base)
    : model_(model),
      chart_(model),
      base_(base ? *base : ConstraintSet(model, {})),
      data_(model, Need::derivatives),
      velocity_(model.nv()),
      displacement_(model.nv()),
      middle_v_(model.nv()),
      turning_(model.nv()),
      tau_(model.nv()),
      undone_(model.nv()),
      zero_(Eigen::VectorXd::Zero(model.nv())),
      end_q_(model.nq()) {
  const CompactImpl& m = model.impl();
  if (m.friction.empty()) return;
  std::vector<double> friction = m.friction;
  const auto at = [&](int body) -> double& { return friction[static_cast<std::size_t>(m.index[static_cast<std::size_t>(body)].idx_v)]; };
  for (std::size_t k = m.couplings.size(); k-- > 0;) at(m.couplings[k].master) += at(m.couplings[k].body);
  for (const JointRecord& joint : model.joints())
    for (int k = 0; k < joint.nv; ++k) {
      const auto dof = static_cast<std::size_t>(joint.idx_v + k);
      if (friction[m.couplings.empty() ? dof : static_cast<std::size_t>(m.v_of_user[dof])] > 0) rubbing_.push_back({joint.name, joint.idx_v + k, k});
    }
}

void Unilateral::watchLimits() {
  const ModelLimits& limits = model_.limits();
  for (const JointRecord& joint : model_.joints()) {
    if (joint.nq != 1 || joint.nv != 1) continue;
    const auto q = static_cast<std::size_t>(joint.idx_q);
    if (std::isfinite(limits.lower[q])) limits_.push_back({joint.name, joint.idx_q, false, limits.lower[q]});
    if (std::isfinite(limits.upper[q])) limits_.push_back({joint.name, joint.idx_q, true, limits.upper[q]});
  }
}

const Unilateral::Gap* Unilateral::find(const std::vector<Gap>& gaps, std::int64_t key) {
  const auto found = std::find_if(gaps.begin(), gaps.end(), [key](const Gap& gap) { return gap.key == key; });
  return found == gaps.end() ? nullptr : &*found;
}

const std::vector<Unilateral::Gap>& Unilateral::look(double t, const double* q) {
  gaps_.clear();
  points_.clear();
  for (std::size_t k = 0; k < limits_.size(); ++k)
    gaps_.push_back({-static_cast<std::int64_t>(k) - 1, limitGap(static_cast<int>(k), q), -static_cast<std::int64_t>(k) - 1});
  if (finder_) guardCallback("the finder of contacts", t, [&] { finder_({q, model_.nq()}, points_, reach_); });
  for (const ContactPoint& point : points_) gaps_.push_back({point.id, point.gap, (static_cast<std::int64_t>(point.frame) << 32) + point.other});
  return gaps_;
}

Approach Unilateral::approach(double t, const double* q, const Eigen::MatrixXd& velocities, double seconds) {
  Approach out;
  guardCallback("the finder of contacts", t, [&] {
    out = finder_.approach({q, model_.nq()}, {velocities.data(), velocities.rows(), velocities.cols()}, seconds);
  });
  return out;
}

double Unilateral::closingSpeed(std::int64_t key, const double* q, const double* v) {
  const auto found = std::find_if(gaps_.begin(), gaps_.end(), [key](const Gap& gap) { return gap.key == key; });
  if (found == gaps_.end()) return 0;
  const auto gap = static_cast<std::size_t>(found - gaps_.begin());
  const ContactPoint* p = pointOf(gap);
  if (p == nullptr) {
    const double rate = v[model_.joints()[static_cast<std::size_t>(model_.jointId(limits_[gap].joint))].idx_v];
    return limits_[gap].upper ? rate : -rate;
  }
  forwardKinematics(model_, data_, VectorResult(q, model_.nq()), VectorResult(v, model_.nv()));
  const auto frameAt = [&](int frame) { return frame == 0 ? SE3<double>{} : framePlacement(model_, data_, frame); };
  const Vec3<double> x = frameAt(p->frame).act(p->point), normal = frameAt(p->other).R * p->normal;
  const auto velocityAt = [&](int frame) {
    if (frame == 0) return Vec3<double>{};
    const Motion<double> m = frameVelocity(model_, data_, frame, ReferenceFrame::LOCAL_WORLD_ALIGNED);
    return m.linear + cross(m.angular, x - frameAt(frame).p);
  };
  return dot(normal, velocityAt(p->other) - velocityAt(p->frame)) / std::sqrt(dot(normal, normal));
}

const ContactPoint* Unilateral::pointOf(std::size_t gap) const { return gap < limits_.size() ? nullptr : &points_[gap - limits_.size()]; }

ConstraintDescription Unilateral::describe(std::size_t gap) const {
  if (const ContactPoint* p = pointOf(gap)) {
    const auto name = [&](int frame) {
      if (frame < 0 || frame >= static_cast<int>(model_.frames().size()))
        throw Error(ErrorCode::simulation,
                    "the finder of contacts speaks of frame " + std::to_string(frame) + ", and there are " + std::to_string(model_.frames().size()));
      return model_.frames()[static_cast<std::size_t>(frame)].name;
    };
    return frictionContact("contact " + std::to_string(p->id), name(p->frame), p->point, p->normal, p->other == 0 ? "universe" : name(p->other));
  }
  ConstraintDescription lock = lockJoint(limits_[gap].joint);
  lock.name = limits_[gap].joint + (limits_[gap].upper ? " upper limit" : " lower limit");
  return lock;
}

void Unilateral::rest(const std::vector<char>& resting) {
  resting_.clear();
  for (std::size_t k = 0; k < resting.size(); ++k)
    if (resting[k]) resting_.push_back(k);
  bind();
}

void Unilateral::bind() {
  if (chosen_.empty() && resting_.empty()) return;
  const auto fits = [&](const Bound& b) {
    if (b.keys.size() != chosen_.size() || b.resting != resting_) return false;
    for (std::size_t k = 0; k < chosen_.size(); ++k) {
      const ContactPoint* p = pointOf(chosen_[k]);
      if (b.keys[k] != gaps_[chosen_[k]].key || (p && !same(*p, b.points[k]))) return false;
    }
    return true;
  };
  const auto found = std::find_if(bound_.begin(), bound_.end(), fits);
  if (found != bound_.end()) {
    std::rotate(bound_.begin(), found, found + 1);
    return;
  }
  std::vector<ConstraintDescription> more;
  std::vector<FrictionCone> cones;
  std::vector<std::int64_t> keys;
  std::vector<ContactPoint> points;
  for (const std::size_t gap : chosen_) {
    const ContactPoint* p = pointOf(gap);
    FrictionCone cone;
    cone.constraint = base_.count() + static_cast<int>(more.size());
    cone.friction = p ? p->friction : 0;
    cone.downwards = !p && limits_[gap].upper;
    cones.push_back(cone);
    keys.push_back(gaps_[gap].key);
    points.push_back(p ? *p : ContactPoint{});
    more.push_back(describe(gap));
  }
  std::vector<FrictionCone> loose;
  for (auto k = resting_.begin(); k != resting_.end();) {
    const std::string& joint = rubbing_[*k].joint;
    FrictionCone cone;
    cone.constraint = base_.count() + static_cast<int>(more.size());
    cone.both_ways = true;
    const int coordinates = model_.joints()[static_cast<std::size_t>(model_.jointId(joint))].nv;
    for (cone.coordinate = 0; cone.coordinate < coordinates; ++cone.coordinate) {
      const bool rests = k != resting_.end() && rubbing_[*k].joint == joint && rubbing_[*k].coordinate == cone.coordinate;
      (rests ? cones : loose).push_back(cone);
      if (rests) ++k;
    }
    more.push_back(lockJoint(joint));
    more.back().name = joint + " friction";
  }
  cones.insert(cones.end(), loose.begin(), loose.end());
  std::vector<FrictionCone> smooth = cones;
  for (FrictionCone& cone : smooth) cone.friction = 0;
  if (bound_.size() >= most_bound) bound_.pop_back();
  bound_.insert(bound_.begin(), Bound{std::move(keys), std::move(points), resting_, ConstraintData(ConstraintSet(base_, more)), std::move(cones),
                                      std::move(smooth), std::move(loose)});
}

void Unilateral::centreForces(EquationsOfMotion& equations, const double* q, const double* v, double dt) {
  const VectorResult configuration(q, model_.nq()), velocity(v, model_.nv());
  undone_.setZero();
  equations.undoFriction(q, v, undone_.data());
  middle_v_ = aba(model_, data_, configuration, velocity, undone_);
  middle_v_ -= aba(model_, data_, configuration, zero_, zero_);
  addTurning(model_.impl(), v, middle_v_.data());
  middle_v_ = velocity + 0.5 * dt * middle_v_;
  const auto effects = [&](const double* at) {
    turning_.setZero();
    addTurning(model_.impl(), at, turning_.data());
    turning_ = -turning_;
    return rnea(model_, data_, configuration, VectorResult(at, model_.nv()), turning_);
  };
  tau_ += effects(v);
  tau_ -= effects(middle_v_.data());
  tau_ -= undone_;
  equations.undoFriction(q, middle_v_.data(), tau_.data());
}

void Unilateral::limitFriction(EquationsOfMotion& equations, const double* q) {
  if (resting_.empty()) return;
  const Eigen::VectorXd& limits = equations.frictionLimits(q);
  for (std::size_t k = 0; k < resting_.size(); ++k) {
    const int dof = rubbing_[resting_[k]].dof;
    bound_.front().cones[chosen_.size() + k].friction = limits[dof];
    equations.joint_friction[dof] = 0;
  }
}

void Unilateral::takeFriction(EquationsOfMotion& equations, const detail::ContactViews& x, double dt) {
  const Bound& bound = bound_.front();
  slides_.clear();
  for (std::size_t k = 0; k < resting_.size(); ++k) {
    const FrictionCone& cone = bound.cones[chosen_.size() + k];
    const int dof = rubbing_[resting_[k]].dof;
    const double impulse = x.force[bound.data.set().firstRow(cone.constraint) + cone.coordinate];
    equations.joint_friction[dof] = impulse / dt;
    const bool along = x.motion[dof] * impulse <= 0 && std::abs(x.motion[dof]) > still;
    slides_.push_back(std::abs(impulse) >= cone.friction * dt && along);
  }
}

void Unilateral::markHeld(std::vector<char>& held) const {
  std::fill(held.begin(), held.end(), 0);
  for (std::size_t k = 0; k < resting_.size(); ++k) held[resting_[k]] = !slides_[k];
}

void Unilateral::hold(EquationsOfMotion& equations, double t, const double* q, const double* v, double dt) {
  limitFriction(equations, q);
  const detail::ContactViews x = contactStep(q, v, equations.applied(t, q, v), dt, bound_.front().cones, 0);
  if (!x.converged) ++equations.statistics.inexact_contacts;
  takeFriction(equations, x, dt);
}

const double* Unilateral::stop(EquationsOfMotion& equations, double t, const double* q, const double* v) {
  return contactStep(q, v, equations.applied(t, q, v), instant, bound_.front().loose, 0).motion;
}

void Unilateral::holdAxes(const double* v, const double* v_after, double dt) {
  turning_.setZero();
  addTurning(model_.impl(), v, turning_.data());
  velocity_ = VectorResult(v_after, model_.nv()) + dt * turning_;
}

const double* Unilateral::step(EquationsOfMotion& equations, double t, const double* q, const double* v, double dt) {
  const int n = model_.nv();
  limitFriction(equations, q);
  tau_ = VectorResult(equations.applied(t, q, v), n);
  centreForces(equations, q, v, dt);
  Bound& bound = bound_.front();
  start_gaps_.clear();
  bool points = false;
  for (std::size_t k = 0; k < chosen_.size(); ++k) {
    start_gaps_.push_back(gaps_[chosen_[k]].value);
    bound.cones[k].gap = std::max(start_gaps_[k], 0.0);
    points = points || pointOf(chosen_[k]);
  }
  detail::ContactViews x = contactStep(q, v, tau_.data(), dt, bound.cones, 0);
  if (points) {
    holdAxes(v, x.motion, dt);
    displacement_ = dt * velocity_;
    chart_.pointInHeldAxes(q, displacement_.data(), velocity_.data(), end_q_.data());
    look(t + dt, end_q_.data());
    for (std::size_t k = 0; k < bound.keys.size(); ++k) {
      if (bound.keys[k] < 0) continue;
      const Gap* end = find(gaps_, bound.keys[k]);
      const int normal = bound.data.set().firstRow(bound.cones[k].constraint) + 2;
      if (end) bound.cones[k].gap += end->value - (start_gaps_[k] + dt * x.velocity[normal]);
    }
    x = contactStep(q, v, tau_.data(), dt, bound.cones, 0);
  }
  if (!x.converged) ++equations.statistics.inexact_contacts;
  takeFriction(equations, x, dt);
  holdAxes(v, x.motion, dt);
  for (std::size_t k = 0; k < resting_.size(); ++k)
    if (!slides_[k]) velocity_[rubbing_[resting_[k]].dof] = 0;
  displacement_ = dt * velocity_;
  if (*std::min_element(start_gaps_.begin(), start_gaps_.end()) < -creep * dt) pushOut(q, dt);
  return velocity_.data();
}

void Unilateral::pushOut(const double* q, double dt) {
  Bound& bound = bound_.front();
  for (std::size_t k = 0; k < start_gaps_.size(); ++k) bound.smooth[k].gap = recovered * std::min(start_gaps_[k], 0.0);
  tau_ = nonLinearEffects(model_, data_, VectorResult(q, model_.nq()), zero_);
  displacement_ += dt * VectorResult(contactStep(q, zero_.data(), tau_.data(), dt, bound.smooth, 0).motion, model_.nv());
}

const double* Unilateral::impact(EquationsOfMotion& equations, double t, const double* q, const double* v, double restitution) {
  std::vector<FrictionCone>& cones = bound_.front().cones;
  for (FrictionCone& cone : cones) cone.gap = 0;
  const detail::ContactViews x = contactStep(q, v, equations.applied(t, q, v), instant, cones, restitution);
  if (!x.converged) ++equations.statistics.inexact_contacts;
  return x.motion;
}

detail::ContactViews Unilateral::contactStep(const double* q, const double* v, const double* tau, double dt, const std::vector<FrictionCone>& cones,
                                             double restitution) {
  ContactSettings settings;
  settings.restitution = restitution;
  return detail::contactStep(model_, data_, {q, model_.nq()}, {v, model_.nv()}, {tau, model_.nv()}, dt, bound_.front().data, cones.data(),
                             cones.size(), settings);
}

}  // namespace dyn
