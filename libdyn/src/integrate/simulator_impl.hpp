// SPDX-License-Identifier: BSD-2-Clause
// Contents of a Simulator.
#pragma once

#include "integrate/passing.hpp"
#include "integrate/stepper.hpp"
#include "integrate/unilateral.hpp"

#include <optional>
#include <string>
#include <vector>

namespace dyn {

struct Simulator::Impl {
  /// Whole steps that end within this fraction of dt of a requested time end exactly there.
  static constexpr double slack = 1e-9;
  /// Joints that come to rest within this fraction of a step rest from its beginning. Otherwise steps would become ever shorter.
  static constexpr double soon = 0x1p-20;
  /// Most steps in one call of advance(). At a tenth of a microsecond each they take a day.
  static constexpr double most_steps = 0x1p40;
  /// A motion is stiff if many_steps adaptive steps, shortened only by the tolerance, advance less than least_share * many_steps * dt.
  static constexpr int many_steps = 10000;
  static constexpr double least_share = 1e-5;

  SimulatorOptions options;
  std::optional<ConstraintSet> constraints;
  EquationsOfMotion equations;
  std::unique_ptr<Stepper> stepper;
  Moment now, next;
  Eigen::VectorXd shown_q, shown_v;  ///< a state within a step
  double anchor = 0;                 ///< whole steps are counted from this time
  long steps = 0;                    ///< whole steps since anchor
  bool whole_step = true;            ///< true if the last step was whole
  double trial;                      ///< next step of adaptive integrators [s]
  int counted_steps = 0;             ///< steps counted by countStep() so far
  double counted_time = 0;           ///< [s] by which these advanced
  bool working = false;              ///< within a call that steps or starts (see Work), and in its callbacks

  std::optional<Unilateral> unilateral;
  bool contact_step = false, has_impact = false;  ///< whether the last step had lasting contacts; whether an impulse follows it
  Eigen::VectorXd after_impact;
  Eigen::VectorXd contact_u, contact_v, shown_u;  ///< displacement and velocity of a contact step, in axes held at its start; a part of contact_u
  std::vector<Unilateral::Gap> gaps_before, gaps_halfway, gaps_after;
  std::vector<std::int64_t> closing, closing_pairs;  ///< keys of closing contacts, and the key of each contact's pair
  std::vector<std::int64_t> lost;                    ///< pairs of closing contacts whose keys are not seen at the step's beginning
  bool now_closed = false;                           ///< `now` has been projected: loops are closed and its velocity keeps them closed
  std::vector<std::int64_t> touching;                ///< keys of contacts and limits that the last step touched

  // These are indexed by Unilateral::rubbing().
  std::vector<char> resting;  ///< at rest at the step's beginning, or so soon after it that friction treats them as resting
  std::vector<char> halted;   ///< at rest only soon after the step's beginning
  std::vector<char> stopped;  ///< at rest at the step's end
  std::vector<char> turned;   ///< reversed within the step
  double cut = 0;             ///< [s] length of a step that ends where a joint comes to rest; 0 for other steps

  std::vector<Event> events;
  std::vector<int> signs;                                     ///< signs of the events' functions at `now`; 0: no side is known
  std::vector<int> untold;                                    ///< events at `now` that have not been reported yet
  std::vector<Looks> event_looks;                             ///< samples of the events' functions, by event
  std::array<Eigen::VectorXd, looks + 1> looked_q, looked_v;  ///< state at each sample of a step
  Eigen::VectorXd change;                                     ///< change of the velocity in a step
  Eigen::MatrixXd velocities;                                 ///< velocities at `now`, within the step and at `next`

  Impl(const CompactModel& model, const ConstraintSet* constraints, const SimulatorOptions& options);
  Unilateral& contacts();
  /// Throws Error(argument) in a callback of this simulation: the call would change the state that is being computed.
  void requireIdle(const char* function) const;

  /// Starts from this state, with statistics at zero. If it throws Error(argument | simulation), everything stays as it was.
  void start(Moment from);
  /// Steps from `now` to `next` by at most until - now.time and returns the step's length. If it throws, `now` stays as it was.
  double stepTowards(double until);
  /// Makes `next` the new `now`.
  void commit();

  /// Takes the stepper's step to `next`. If constraint rows become dependent within the step, the equations with all rows may have no solution. The
  /// step is then repeated without the rows that add hardly anything; the projection after the step restores them.
  StepOutcome stepOrPass(double h);
  /// Tries a step to `next`. Returns false, with the reason in `why`, if the step cannot be taken.
  bool attempt(double h, double until, std::string& why);
  /// The same, but throws Error(simulation) if the step cannot be taken.
  void stepBy(double h, double until);
  /// Throws Error(argument) if more than most_steps steps lead to this time.
  void checkSteps(double until) const;
  double adaptiveStep(double most);
  /// Throws Error(simulation) if this step completes many_steps steps that hardly advance.
  void countStep(double h);
  bool rubs() const { return equations.joint_friction.size() > 0; }
  bool restsAt(std::size_t rubbing, const Eigen::VectorXd& v) const;
  /// Returns `left`, or at most dt if a joint rests: adaptive integrators must check such a joint every dt.
  double longestStep(double left) const;
  /// Sets equations.joint_friction before a smooth step of h.
  void holdJoints(double h);
  /// After a smooth step: brings the joints that friction holds to rest.
  void settleJoints();
  /// Brings the joints marked in `stopped` to rest in `next`.
  void stopJoints();
  /// The same, with those marked in `turned` added.
  void stopTurned();
  /// Marks in `turned` the joints whose velocity in v has the opposite sign of that at `now`. Returns whether there are any.
  bool markTurned(const Eigen::VectorXd& v);
  /// Returns the fraction of the last step at which the first joint has reversed; infinity if none does.
  double firstTurn();
  /// After a smooth step of h: moves `next` to where the first joint comes to rest within the step. Returns the length of the step.
  double comeToRest(double h);
  void project();
  /// True if a projected smooth step of h left the branch that the loops moved along. Where branches meet, a step may end on another branch; the
  /// accelerations at its ends then do not explain the change of its velocity.
  bool hasStrayed(double h);
  /// Repeats the step with a length so short that it stays on the branch. Returns this length.
  double followBranch(double h);
  /// Throws Error(simulation) if x is not finite. h is the step that led to x, 0 if none did.
  void checkFinite(const Moment& x, double h) const;

  /// Fills looked_q and looked_v with the states of the last step at all samples.
  void lookWithin();
  /// Computes the state at the fraction theta of the last step.
  void between(double theta, double* q, double* v);
  /// After a smooth step of h to `next`: changes `next` to what contacts and limits allow. Returns the length of the step.
  double touch(double h);
  /// Computes the state after this fraction of the contact step's displacement from now.q.
  void glide(double share, double* q, double* v);
  /// Shortens the step to the first impact among `closing` and computes the velocity after it. Returns the length of the step.
  double collide(double h, double speed);
  /// Fills `lost`. Where corners of two bodies coincide, contacts may have other keys in nearly equal poses. All contacts of such a pair take part.
  void findLost(const std::vector<Unilateral::Gap>& seen);
  /// Returns the fraction of the last step at which a joint first passes a limit; infinity if none does.
  double firstLimit();
  /// Returns the fraction of the step at which a contact first closes; infinity if none does. By conservative advancement (Mirtich 1996, sec. 2.3)
  /// it moves on to the first state where something may touch, and repeats. `near`: something touches, or is too near to say.
  double firstContact(double h, bool& near);
  /// Counts the contacts and limits that are touched now and were not before.
  void countTouched(const std::vector<std::int64_t>& now_touching);
  /// Takes a contact step of at most h and at most dt with the contacts in `closing`. Returns its length.
  double rest(double h);
  /// Returns the lowest gap among the contacts in `closing`, at the fraction theta of the last step.
  double lowestGap(double theta, double h);
  /// Takes the last step again, with this length.
  void retake(double h);

  void show(double t, const double* q, const double* v, const Observer& observer) const;
  /// Finds on which side of zero each event's function is.
  void readEvents(const Moment& at, std::vector<int>& sides) const;
  double valueOf(const Event& event, double t, const double* q, const double* v) const;
  /// True if event k counts when its function leaves the side of zero that it is on at `now`.
  bool counts(std::size_t k) const;
  /// Returns the value of event k, with the sign changed so that it is positive on that side and negative beyond zero.
  double onItsSide(std::size_t k, double t, const double* q, const double* v) const;
  /// Returns the fraction of the last step at which the first event leaves its side, and its index in `which`; infinity if none does.
  double firstChange(double h, std::size_t& which);
  /// After a step of h: returns the first event in it and moves `next` just past the event; -1 if there is none. Even then the step may be shorter.
  int findEvent(double h);
  /// Removes the first event from `untold` and returns it; -1 if there is none.
  int tellEvent();
};

/// Marks a call that steps or starts for as long as this object lives. Throws Error(argument) within another such call.
class Work {
 public:
  Work(Simulator::Impl& x, const char* function) : x_(x) {
    x.requireIdle(function);
    x.working = true;
  }
  ~Work() { x_.working = false; }
  Work(const Work&) = delete;
  Work& operator=(const Work&) = delete;

 private:
  Simulator::Impl& x_;
};

}  // namespace dyn
