// SPDX-License-Identifier: BSD-2-Clause
// Contacts, limits and joint friction in a simulation: finds the near ones, and computes steps and impacts under the chosen ones.
#pragma once

#include "integrate/chart.hpp"
#include "integrate/equations_of_motion.hpp"

#include <dyn/constraint/friction.hpp>
#include <dyn/integrate/contacts.hpp>

#include <optional>
#include <vector>

namespace dyn {

class Unilateral {
 public:
  /// `base` are constraints that always hold, or null.
  Unilateral(const CompactModel& model, const ConstraintSet* base);

  /// A degree of freedom whose joint has friction.
  struct Rubbing {
    std::string joint;
    int dof, coordinate;  ///< index in the model, and in the joint
  };
  const std::vector<Rubbing>& rubbing() const { return rubbing_; }

  void watchLimits();
  void setFinder(ContactFinder finder) { finder_ = std::move(finder); }
  int limits() const { return static_cast<int>(limits_.size()); }
  /// Returns the gap of a limit by number, as look() does [m, rad].
  double limitGap(int limit, const double* q) const {
    const Limit& x = limits_[static_cast<std::size_t>(limit)];
    return x.upper ? x.bound - q[x.q] : q[x.q] - x.bound;
  }
  bool watches() const { return !limits_.empty() || static_cast<bool>(finder_); }

  /// Gap of a contact or limit. The order of gaps is the same as long as the finder reports the same contacts.
  struct Gap {
    std::int64_t key;   ///< the same from call to call
    double value;       ///< [m, rad]
    std::int64_t pair;  ///< the same for all contacts of two frames
  };
  /// Returns the gap with this key; null if there is none.
  static const Gap* find(const std::vector<Gap>& gaps, std::int64_t key);
  /// See ContactFinder. approach() may be called only if looksAhead().
  bool hasFinder() const { return static_cast<bool>(finder_); }
  bool looksAhead() const { return finder_.looksAhead(); }
  Approach approach(double t, const double* q, const Eigen::MatrixXd& velocities, double seconds);
  /// From now on the finder need not report contacts that are farther away than this [m].
  void setReach(double reach) { reach_ = reach; }
  /// Returns how fast the contact or limit with this key closes at q and v, by what the last look() has seen; 0 if look() has not seen it.
  double closingSpeed(std::int64_t key, const double* q, const double* v);
  /// Returns all gaps at q. The next call overwrites them.
  const std::vector<Gap>& look(double t, const double* q);

  /// Chooses, from what look() has seen last, the gaps for which `takes` returns true, and no joint friction.
  template <class F>
  void choose(F&& takes) {
    choose(takes, {});
  }
  /// The same, with the friction of the marked degrees of freedom of rubbing().
  template <class F>
  void choose(F&& takes, const std::vector<char>& resting) {
    chosen_.clear();
    for (std::size_t k = 0; k < gaps_.size(); ++k)
      if (takes(gaps_[k])) chosen_.push_back(k);
    rest(resting);
  }
  /// Chooses only this joint friction.
  void chooseFriction(const std::vector<char>& resting) {
    chosen_.clear();
    rest(resting);
  }
  bool anyChosen() const { return !chosen_.empty(); }

  /// Returns the velocity after dt under the chosen contacts, limits and friction (see contactStep), in axes held at the start (see
  /// Chart::pointInHeldAxes). Forces that depend on velocity are those halfway along the change of velocity that they alone cause, because Euler's
  /// step would increase the speed. The gaps at the end are looked at once, because the point that touches changes where bodies roll.
  const double* step(EquationsOfMotion& equations, double t, const double* q, const double* v, double dt);
  /// Writes into equations.joint_friction the friction that holds the chosen joints over dt, as well as it can.
  void hold(EquationsOfMotion& equations, double t, const double* q, const double* v, double dt);
  /// After hold() or step(): marks the degrees of freedom of rubbing() that friction has held.
  void markHeld(std::vector<char>& held) const;
  /// Returns the velocity after an impulse that brings the chosen joints to rest.
  const double* stop(EquationsOfMotion& equations, double t, const double* q, const double* v);
  /// Returns the displacement of step() in dt, in the same axes: the velocity's part, and a part that reduces penetrations. The latter adds no speed.
  const Eigen::VectorXd& displacement() const { return displacement_; }
  const Chart& chart() const { return chart_; }
  /// Returns the velocity after an impact in all chosen contacts and limits, whose gaps count as closed.
  const double* impact(EquationsOfMotion& equations, double t, const double* q, const double* v, double restitution);

 private:
  struct Limit {
    std::string joint;
    int q;
    bool upper;
    double bound;
  };
  /// The constraint set of a choice. The sets of the last few choices are kept, because joints return to the same limits and feet to the same ground.
  struct Bound {
    std::vector<std::int64_t> keys;
    std::vector<ContactPoint> points;
    std::vector<std::size_t> resting;
    ConstraintData data;
    std::vector<FrictionCone> cones, smooth;  ///< cones of keys, of resting, and the loose ones; `smooth` has them without friction
    std::vector<FrictionCone> loose;          ///< cones of moving coordinates in joints where other coordinates rest
  };

  detail::ContactViews contactStep(const double* q, const double* v, const double* tau, double dt, const std::vector<FrictionCone>& cones,
                                   double restitution);
  /// Adds to displacement_ a motion that removes part of the penetration of the chosen contacts.
  void pushOut(const double* q, double dt);
  /// Changes tau_, so that forces that depend on velocity become those at the middle of the step.
  void centreForces(EquationsOfMotion& equations, const double* q, const double* v, double dt);
  /// Chooses the marked joint friction and binds the choice.
  void rest(const std::vector<char>& resting);
  /// Sets the largest friction forces of the chosen joints at q.
  void limitFriction(EquationsOfMotion& equations, const double* q);
  /// Takes joint_friction and slides_ from the result of a contact step.
  void takeFriction(EquationsOfMotion& equations, const detail::ContactViews& x, double dt);
  /// Makes bound_.front() the set of the present choice.
  void bind();
  ConstraintDescription describe(std::size_t gap) const;
  const ContactPoint* pointOf(std::size_t gap) const;
  /// Computes velocity_ in axes held at the start, where contactStep has changed v to v_after.
  void holdAxes(const double* v, const double* v_after, double dt);

  CompactModel model_;
  Chart chart_;
  ConstraintSet base_;
  std::vector<Limit> limits_;
  std::vector<Rubbing> rubbing_;
  ContactFinder finder_;
  double reach_ = 0;
  std::vector<ContactPoint> points_;
  std::vector<Gap> gaps_;                      ///< gaps of limits, then of points_
  std::vector<std::size_t> chosen_, resting_;  ///< indices into gaps_, into rubbing_
  std::vector<char> slides_;                   ///< by resting_: whether friction did not hold it in the last step
  std::vector<Bound> bound_;                   ///< most recently used first
  Data data_;
  Eigen::VectorXd velocity_, displacement_, middle_v_, turning_, tau_, undone_, zero_, end_q_;
  std::vector<double> start_gaps_;  ///< gaps at the start, by chosen_
};

}  // namespace dyn
