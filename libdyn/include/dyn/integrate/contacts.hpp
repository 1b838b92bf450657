// What may touch in a simulation: points of bodies and surfaces of others, told anew for every configuration.
#pragma once

#include <dyn/compile/compact_model.hpp>
#include <dyn/data/views.hpp>

#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace dyn {

/// A point of one body near the surface of another.
struct ContactPoint {
  std::int64_t id = 0;    ///< not negative; from call to call the same for the same place of the two bodies' surfaces, and of no other
  int frame = 0;          ///< whose point it is, by number of CompactModel::frames()
  Vec3<double> point{};   ///< in its axes [m]
  int other = 0;          ///< whose surface it is; 0: the world
  Vec3<double> normal{};  ///< of the surface, away from it, in the other's axes; of any length but zero
  double gap = 0;         ///< [m] between point and surface; negative inside
  double friction = 0;    ///< coefficient
};

/// An Approach says what a step of a simulation may bring together.
struct DYN_API Approach {
  double clear =
      std::numeric_limits<double>::infinity();  ///< [s] Nothing that is apart now comes to touch before this, but for what `soonest` counts.
  /// [s] The same of what is so near that the step's end tells more than its beginning; infinity where nothing is.
  double soonest = std::numeric_limits<double>::infinity();
  double reach = 0;  ///< [m] No two things come nearer to each other than by this within the step.

  /// Two things that are `gap` [m] apart and come nearer at no more than `speed` [m/s] in the next `seconds`. By `room` [m] the one may be in the
  /// other before it is seen on the far side.
  void add(double gap, double speed, double seconds, double room);
};

/// A finder tells a simulation what touches; it is called several times a step. A function of q that appends the points that are near enough to
/// matter is one. The library's own finders are told how far away things may matter, and say for how long nothing can touch: then no body passes
/// another unseen, whatever its speed. They keep scratch that their copies share, so each thread needs a finder of its own.
class DYN_API ContactFinder {
 public:
  /// `reach` [m]: what is farther away need not be told of.
  using Find = std::function<void(VectorResult q, double reach, std::vector<ContactPoint>& found)>;
  /// Velocities, nv rows, that occur in the next `seconds`: bounds of the motion are made of them.
  using Look = std::function<Approach(VectorResult q, MatrixResult velocities, double seconds)>;

  ContactFinder() = default;
  template <class F>
    requires std::is_invocable_v<F&, VectorResult, std::vector<ContactPoint>&>
  ContactFinder(F find)  // NOLINT: a function is one
      : find_([find = std::move(find)](const VectorResult& q, double, std::vector<ContactPoint>& found) mutable { find(q, found); }) {}
  ContactFinder(Find find, Look look) : find_(std::move(find)), look_(std::move(look)) {}

  explicit operator bool() const { return static_cast<bool>(find_); }
  void operator()(const VectorResult& q, std::vector<ContactPoint>& found, double reach = 0) const { find_(q, reach, found); }
  bool looksAhead() const { return static_cast<bool>(look_); }
  Approach approach(const VectorResult& q, const MatrixResult& velocities, double seconds) const { return look_(q, velocities, seconds); }

 private:
  Find find_;
  Look look_;
};

/// The finder that tells what either of two tells.
DYN_API ContactFinder together(const ContactFinder& a, const ContactFinder& b);

/// Origins of these frames above the plane normal . x = height of the world [m]. Throws Error(argument) for a frame that is not there, a
/// normal without direction, a height that is not finite, a friction that is negative or not finite.
DYN_API ContactFinder pointsOnPlane(const CompactModel& model, const std::vector<std::string>& frames, const Vec3<double>& normal = {0, 0, 1},
                                    double height = 0, double friction = 0);

}  // namespace dyn
