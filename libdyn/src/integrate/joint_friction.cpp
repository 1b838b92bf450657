// SPDX-License-Identifier: BSD-2-Clause
// Coulomb friction of joints. During a step it is a constant force, so that methods of any order have smooth equations of motion. On a joint that
// moves it acts against the motion. On a joint at rest it keeps the joint there as far as it can; it is found like contact forces, at velocity
// level. A step ends where a joint comes to rest; the next step finds whether the joint stays there.
#include "at.hpp"
#include "integrate/simulator_impl.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dyn {

namespace {

bool any(const std::vector<char>& marks) {
  return std::any_of(marks.begin(), marks.end(), [](char mark) { return mark != 0; });
}

}  // namespace

bool Simulator::Impl::restsAt(std::size_t rubbing, const Eigen::VectorXd& v) const {
  return v[unilateral->rubbing()[rubbing].dof] == 0 || halted[rubbing];
}

double Simulator::Impl::longestStep(double left) const {
  for (std::size_t k = 0; k < resting.size(); ++k)
    if (restsAt(k, now.v)) return std::min(left, options.dt);
  return left;
}

void Simulator::Impl::holdJoints(double h) {
  if (!rubs()) return;
  now.has_acceleration = false;
  const Eigen::VectorXd& limits = equations.frictionLimits(now.q.data());
  for (std::size_t k = 0; k < resting.size(); ++k) {
    const int dof = unilateral->rubbing()[k].dof;
    resting[k] = restsAt(k, now.v);
    equations.joint_friction[dof] = resting[k] ? 0 : now.v[dof] > 0 ? -limits[dof] : limits[dof];
  }
  equations.cancelled = 0;
  if (!any(resting)) return;
  if (infoOf(options.integrator).implicit)
    equations.cancelled = VectorResult(equations.acceleration(now.time, now.q.data(), now.v.data()), now.v.size()).cwiseAbs().maxCoeff();
  unilateral->chooseFriction(resting);
  unilateral->hold(equations, now.time, now.q.data(), now.v.data(), h);
}

void Simulator::Impl::settleJoints() {
  std::fill(stopped.begin(), stopped.end(), 0);
  if (!any(resting)) return;
  unilateral->markHeld(stopped);
  // Friction that was too weak to hold a joint, but at the step's end drives the joint along its velocity, has stopped it.
  for (std::size_t k = 0; k < resting.size(); ++k) {
    const int dof = unilateral->rubbing()[k].dof;
    if (resting[k] && equations.joint_friction[dof] * next.v[dof] > 0) stopped[k] = 1;
  }
  stopJoints();
}

void Simulator::Impl::stopJoints() {
  if (!any(stopped) || !next.q.allFinite() || !next.v.allFinite()) return;
  unilateral->chooseFriction(stopped);
  next.v = VectorResult(unilateral->stop(equations, next.time, next.q.data(), next.v.data()), next.v.size());
  for (std::size_t k = 0; k < stopped.size(); ++k)
    if (stopped[k]) next.v[unilateral->rubbing()[k].dof] = 0;
  next.has_acceleration = false;
}

void Simulator::Impl::stopTurned() {
  for (std::size_t k = 0; k < turned.size(); ++k) stopped[k] = stopped[k] || turned[k];
  stopJoints();
}

bool Simulator::Impl::markTurned(const Eigen::VectorXd& v) {
  for (std::size_t k = 0; k < resting.size(); ++k) {
    const int dof = unilateral->rubbing()[k].dof;
    turned[k] = !resting[k] && now.v[dof] * v[dof] < 0;
  }
  return any(turned);
}

double Simulator::Impl::firstTurn() {
  const auto& rubbing = unilateral->rubbing();
  lookWithin();
  double first = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < rubbing.size(); ++k) {
    if (resting[k]) continue;
    const int dof = rubbing[k].dof;
    const double way = now.v[dof] > 0 ? 1 : -1;
    Looks along;
    for (int look = 0; look <= looks; ++look) along[at(look)] = way * looked_v[at(look)][dof];
    first = std::min(first, firstNegative(along, [&](double theta) {
                       between(theta, shown_q.data(), shown_v.data());
                       return way * shown_v[dof];
                     }));
  }
  return first;
}

double Simulator::Impl::comeToRest(double h) {
  if (!rubs()) return h;
  for (double first = firstTurn(); first <= 1; first = firstTurn()) {
    const auto turnsBefore = [&](double theta) {
      between(theta, shown_q.data(), shown_v.data());
      return markTurned(shown_v);
    };
    // Joints of one mechanism come to rest at the same time, up to rounding.
    if (!turnsBefore(std::min(1.0, first + soon)) && !turnsBefore(first)) markTurned(next.v);
    if (first > soon) {
      cut = first * h;
      stepBy(cut, now.time + cut);
      stopTurned();
      project();
      whole_step = false;
      return cut;
    }
    for (std::size_t k = 0; k < turned.size(); ++k) halted[k] = halted[k] || turned[k];
    stepBy(h, next.time);
    project();
  }
  return h;
}

}  // namespace dyn
