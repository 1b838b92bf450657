// What a Simulator holds.
#pragma once

#include "integrate/passing.hpp"
#include "integrate/stepper.hpp"
#include "integrate/unilateral.hpp"

#include <optional>
#include <string>
#include <vector>

namespace dyn {

struct Simulator::Impl {
  /// Of dt: whole steps that end this near to a time asked for end there.
  static constexpr double slack = 1e-9;
  /// Of a step: joints that come to rest that soon rest from its beginning, so that steps do not become ever shorter.
  static constexpr double soon = 0x1p-20;
  /// In one call of advance(): at a tenth of a microsecond each they take a day.
  static constexpr double most_steps = 0x1p40;
  /// A motion is stiff if so many adaptive steps, made short by the tolerance alone, lead less than this share of as many dt further.
  static constexpr int many_steps = 10000;
  static constexpr double least_share = 1e-5;

  SimulatorOptions options;
  std::optional<ConstraintSet> constraints;
  Law law;
  std::unique_ptr<Stepper> stepper;
  Moment now, next;
  Eigen::VectorXd shown_q, shown_v;  ///< a state between
  double anchor = 0;                 ///< whole steps are counted from this time
  long steps = 0;                    ///< since then
  bool whole_step = true;            ///< the last one
  double trial;                      ///< next step of adaptive integrators [s]
  int counted_steps = 0;             ///< of the many
  double counted_time = 0;           ///< [s] that these took
  bool working = false;              ///< within a call that steps or starts, and so within its callbacks

  std::optional<Unilateral> unilateral;
  bool contact_step = false, has_impact = false;  ///< what the last step was, and whether an impulse follows it
  Eigen::VectorXd after_impact;
  Eigen::VectorXd contact_u, contact_v, shown_u;  ///< a contact step's way and velocity, in axes held at its start, and a part of the way
  std::vector<Unilateral::Gap> gaps_before, gaps_halfway, gaps_after;
  std::vector<std::int64_t> closing, closing_pairs;  ///< contacts, and the frames of each
  std::vector<std::int64_t> lost;                    ///< of the latter those of which some are called otherwise at the step's beginning
  bool now_closed = false;                           ///< `now` has been projected, so that loops are closed and its velocity keeps them so
  std::vector<std::int64_t> touching;                ///< what the last step touched

  // By Unilateral::rubbing().
  std::vector<char> resting;  ///< at the step's beginning, or so near to it that friction takes them for that
  std::vector<char> halted;   ///< the latter
  std::vector<char> stopped;  ///< at the step's end
  std::vector<char> turned;   ///< on the way
  double cut = 0;             ///< [s] of the step that ends where a joint comes to rest; 0 of others

  std::vector<Event> events;
  std::vector<int> signs;                                     ///< of the events' functions at `now`; 0: no side is known
  std::vector<int> untold;                                    ///< events that have happened at `now`, beside those that have been told
  std::vector<Looks> event_looks;                             ///< by event
  std::array<Eigen::VectorXd, looks + 1> looked_q, looked_v;  ///< the state at each look
  Eigen::VectorXd change;                                     ///< of the velocity in a step
  Eigen::MatrixXd velocities;                                 ///< at now, at each look and at next

  Impl(const CompactModel& model, const ConstraintSet* constraints, const SimulatorOptions& options);
  Unilateral& contacts();
  /// Throws Error(argument) in a callback of this simulation, which would change what is being computed.
  void requireIdle(const char* function) const;

  /// From this state, with statistics at zero. Throws Error(argument | simulation) and leaves everything as it was.
  void start(Moment from);
  /// From `now` to `next` by at most until - now.time; returns by how much. Throws and leaves `now` as it was.
  double stepTowards(double until);
  /// `next` becomes `now`.
  void commit();

  /// The stepper's step to `next`. Where rows come to depend on each other within it, equations that ask for all of them may have no solution:
  /// then again with those left out that hardly add anything, which the projection after the step brings back.
  StepOutcome stepOrPass(double h);
  /// A step to `next`; false, and why, if there is none.
  bool attempt(double h, double until, std::string& why);
  void stepBy(double h, double until);
  /// Throws Error(argument) for more steps than any simulation takes.
  void checkSteps(double until) const;
  double adaptiveStep(double most);
  /// Throws Error(simulation) if this step is the last of many that lead nowhere.
  void countStep(double h);
  bool rubs() const { return law.joint_friction.size() > 0; }
  bool restsAt(std::size_t rubbing, const Eigen::VectorXd& v) const;
  /// Of adaptive integrators: what rests is looked at every dt.
  double longestStep(double left) const;
  /// Before a smooth step of h: law.joint_friction.
  void holdJoints(double h);
  /// After it: joints that friction holds are at rest.
  void settleJoints();
  /// `next` with the marked joints at rest.
  void stopJoints();
  /// And those that have turned.
  void stopTurned();
  /// `turned`: joints that move the one way at `now` and the other by v. Whether there are any.
  bool markTurned(const Eigen::VectorXd& v);
  /// The share of the last step at which the first joint has turned; infinity if none does.
  double firstTurn();
  /// After a smooth step of h: `next` where first a joint comes to rest within it; returns by how much.
  double comeToRest(double h);
  void project();
  /// Whether a smooth step of h, which has been projected, left the branch that the loops moved along: where branches meet, a step may end on
  /// another. Accelerations at its ends do not explain how its velocity changed then.
  bool hasStrayed(double h);
  /// The step in a part so short that it keeps to the branch; returns its length.
  double followBranch(double h);
  /// Throws Error(simulation); h is the step that led there, 0 if none did.
  void checkFinite(const Moment& x, double h) const;

  /// The last step's states at all looks.
  void lookWithin();
  /// The state at the share theta of the last step.
  void between(double theta, double* q, double* v);
  /// After a smooth step of h to `next`: `next` as contacts and limits let it be; returns by how much.
  double touch(double h);
  /// This share of the contact step's way from now.q, and the velocity there.
  void glide(double share, double* q, double* v);
  double collide(double h, double speed);
  /// Where corners of two bodies lie upon each other their contacts may have other names in poses that hardly differ: then all of the pair take part.
  void findLost(const std::vector<Unilateral::Gap>& seen);
  /// The share of the last step at which a joint's limit is passed first; infinity if none is.
  double firstLimit();
  /// The share at which a contact is closed first, by conservative advancement (Mirtich 1996, sec. 2.3): as long as nothing can touch, on to the
  /// state where something may; infinity if there is none. `near`: whether something touches or is too near to say.
  double firstContact(double h, bool& near);
  /// Counts what is touched now and was not before.
  void countTouched(const std::vector<std::int64_t>& now_touching);
  double rest(double h);
  /// Of the closing ones.
  double lowestGap(double theta, double h);
  /// The last step once more, of this length.
  void retake(double h);

  void show(double t, const double* q, const double* v, const Observer& observer) const;
  /// On which side of zero each event's function is.
  void readEvents(const Moment& at, std::vector<int>& sides) const;
  double valueOf(const Event& event, double t, const double* q, const double* v) const;
  /// Whether leaving the side that event k is on at `now` is what it asks for.
  bool counts(std::size_t k) const;
  /// Its value, positive on that side and negative where it is left.
  double onItsSide(std::size_t k, double t, const double* q, const double* v) const;
  /// The share of the last step at which the first event leaves its side, and which; infinity if none does.
  double firstChange(double h, std::size_t& which);
  /// After a step of h: the first event in it, `next` then being just past it; -1 if there is none. The step may be shorter then even so.
  int findEvent(double h);
  /// One of `untold`, which is told then; -1 if there is none.
  int tellEvent();
};

/// A call that steps or starts, as long as it lives. Throws Error(argument) within another.
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
