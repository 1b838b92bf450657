// Contacts, limits and friction of joints in a simulation: which are near, and steps and impacts under those that are taken part in.
#pragma once

#include "integrate/chart.hpp"
#include "integrate/law.hpp"

#include <dyn/constraint/friction.hpp>
#include <dyn/integrate/contacts.hpp>

#include <optional>
#include <vector>

namespace dyn {

class Unilateral {
 public:
  /// `base`: constraints that hold beside, or null.
  Unilateral(const CompactModel& model, const ConstraintSet* base);

  /// A degree of freedom whose joint has friction.
  struct Rubbing {
    std::string joint;
    int dof, coordinate;  ///< in the model, in the joint
  };
  const std::vector<Rubbing>& rubbing() const { return rubbing_; }

  void watchLimits();
  void setFinder(ContactFinder finder) { finder_ = std::move(finder); }
  int limits() const { return static_cast<int>(limits_.size()); }
  /// That of a limit by number, as look() has it.
  double limitGap(int limit, const double* q) const {
    const Limit& x = limits_[static_cast<std::size_t>(limit)];
    return x.upper ? x.bound - q[x.q] : q[x.q] - x.bound;
  }
  bool watches() const { return !limits_.empty() || static_cast<bool>(finder_); }

  /// Contacts and limits by number: those of `gaps` in the same order as long as the finder tells of the same.
  struct Gap {
    std::int64_t key;   ///< the same from call to call
    double value;       ///< [m, rad]
    std::int64_t pair;  ///< the same for all contacts of two frames
  };
  /// That of the same contact; null if there is none.
  static const Gap* find(const std::vector<Gap>& gaps, std::int64_t key);
  /// See ContactFinder. Of one that does not look ahead nothing is known.
  bool hasFinder() const { return static_cast<bool>(finder_); }
  bool looksAhead() const { return finder_.looksAhead(); }
  Approach approach(double t, const double* q, const Eigen::MatrixXd& velocities, double seconds);
  /// [m] What is farther away need not be looked at from now on.
  void setReach(double reach) { reach_ = reach; }
  /// How fast the contact that look() has seen last under this key closes at q and v; of one that it has not seen 0.
  double closingSpeed(std::int64_t key, const double* q, const double* v);
  /// At q; a view of what the next call overwrites.
  const std::vector<Gap>& look(double t, const double* q);

  /// Chooses, of what look() has seen last, those for which `takes` says so, and no friction.
  template <class F>
  void choose(F&& takes) {
    choose(takes, {});
  }
  /// And the friction of those of rubbing() that are marked.
  template <class F>
  void choose(F&& takes, const std::vector<char>& resting) {
    chosen_.clear();
    for (std::size_t k = 0; k < gaps_.size(); ++k)
      if (takes(gaps_[k])) chosen_.push_back(k);
    rest(resting);
  }
  /// Nothing but this friction.
  void chooseFriction(const std::vector<char>& resting) {
    chosen_.clear();
    rest(resting);
  }
  bool anyChosen() const { return !chosen_.empty(); }

  /// The velocity after dt under the chosen ones: see contactStep. It is in axes held at the start (see
  /// Chart::pointInHeldAxes), and forces that depend on velocity are those halfway to where they alone lead: Euler's step would make it longer. Gaps
  /// at the end are looked at once: where bodies roll it is not the same point that touches.
  const double* step(Law& law, double t, const double* q, const double* v, double dt);
  /// Writes into law.joint_friction what holds the chosen joints over dt, as well as it can.
  void hold(Law& law, double t, const double* q, const double* v, double dt);
  /// After hold() or step(): marks those of rubbing() that friction has held.
  void markHeld(std::vector<char>& held) const;
  /// The velocity with the chosen joints at rest, by an impulse.
  const double* stop(Law& law, double t, const double* q, const double* v);
  /// Where step() leads in dt, in the same axes: along the velocity, and out of what it is already in. That gives no speed: bodies are not thrown.
  const Eigen::VectorXd& displacement() const { return displacement_; }
  const Chart& chart() const { return chart_; }
  /// The velocity after an impact in all of the chosen ones, whose gaps are taken as closed.
  const double* impact(Law& law, double t, const double* q, const double* v, double restitution);

 private:
  struct Limit {
    std::string joint;
    int q;
    bool upper;
    double bound;
  };
  /// The constraint set of the chosen ones. Those of the last few choices are kept: joints come to the same limits, feet to the same ground.
  struct Bound {
    std::vector<std::int64_t> keys;
    std::vector<ContactPoint> points;
    std::vector<std::size_t> resting;
    ConstraintData data;
    std::vector<FrictionCone> cones, smooth;  ///< of keys, of resting, and the loose ones; the second without friction
    std::vector<FrictionCone> loose;          ///< coordinates of joints of which only others rest
  };

  detail::ContactViews contactStep(const double* q, const double* v, const double* tau, double dt, const std::vector<FrictionCone>& cones,
                                   double restitution);
  /// Moves displacement_ by a part of how deep the chosen ones are.
  void pushOut(const double* q, double dt);
  /// tau_, so that the forces of velocity become those of the middle.
  void centreForces(Law& law, const double* q, const double* v, double dt);
  void rest(const std::vector<char>& resting);
  /// What the chosen joints' friction can do at most.
  void limitFriction(Law& law, const double* q);
  void takeFriction(Law& law, const detail::ContactViews& x, double dt);
  void bind();
  ConstraintDescription describe(std::size_t gap) const;
  const ContactPoint* pointOf(std::size_t gap) const;
  /// velocity_, in axes held at the start, after contactStep has made v this.
  void holdAxes(const double* v, const double* v_after, double dt);

  CompactModel model_;
  Chart chart_;
  ConstraintSet base_;
  std::vector<Limit> limits_;
  std::vector<Rubbing> rubbing_;
  ContactFinder finder_;
  double reach_ = 0;
  std::vector<ContactPoint> points_;
  std::vector<Gap> gaps_;                      ///< of limits, then of points
  std::vector<std::size_t> chosen_, resting_;  ///< of gaps, of rubbing
  std::vector<char> slides_;                   ///< of the latter in the last step
  std::vector<Bound> bound_;                   ///< the last used first
  Data data_;
  Eigen::VectorXd velocity_, displacement_, middle_v_, turning_, tau_, undone_, zero_, end_q_;
  std::vector<double> start_gaps_;  ///< of the chosen ones
};

}  // namespace dyn
