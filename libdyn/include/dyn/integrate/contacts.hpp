// SPDX-License-Identifier: BSD-2-Clause
// Possible contacts in a simulation: points of bodies near surfaces of other bodies, found anew for every configuration.
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
  std::int64_t id = 0;    ///< not negative; in every call the same for the same place on the two bodies' surfaces, and different from all others
  int frame = 0;          ///< frame of the point, its number in CompactModel::frames()
  Vec3<double> point{};   ///< in that frame [m]
  int other = 0;          ///< frame of the surface; 0: the world
  Vec3<double> normal{};  ///< of the surface, pointing away from it, in the axes of `other`; any length but zero
  double gap = 0;         ///< [m] between point and surface; negative inside
  double friction = 0;    ///< coefficient
};

/// An Approach says what may come into contact during a step of a simulation.
struct DYN_API Approach {
  /// [s] Nothing that is apart now touches before this time, except for things that `soonest` covers.
  double clear = std::numeric_limits<double>::infinity();
  /// [s] The earliest contact of things that are so near that they must be checked at the step's end; infinity if there are none.
  double soonest = std::numeric_limits<double>::infinity();
  double reach = 0;  ///< [m] During the step no two things approach each other by more than this.

  /// Adds two things that are `gap` [m] apart and approach each other at no more than `speed` [m/s] during the next `seconds`. One may be `room` [m]
  /// deep inside the other before it appears on the far side.
  void add(double gap, double speed, double seconds, double room);
};

/// Tells a simulation what touches; it is called several times a step. Any function of q that appends all points near enough to matter can be a
/// finder. The library's own finders also look ahead: they learn within which distance things may matter, and say for how long nothing can touch.
/// Then no body passes through another unseen, whatever its speed. Copies of these finders share scratch memory, so each thread needs its own finder.
class DYN_API ContactFinder {
 public:
  /// Appends points to `found`. It need not report points farther away than `reach` [m].
  using Find = std::function<void(VectorResult q, double reach, std::vector<ContactPoint>& found)>;
  /// The columns of `velocities`, nv rows, occur during the next `seconds`; the function bounds the motion by them.
  using Look = std::function<Approach(VectorResult q, MatrixResult velocities, double seconds)>;

  /// Makes an empty finder, which finds nothing.
  ContactFinder() = default;
  /// Makes a finder of a function that ignores the reach: find(q, found) appends to `found`. The finder does not look ahead.
  template <class F>
    requires std::is_invocable_v<F&, VectorResult, std::vector<ContactPoint>&>
  ContactFinder(F find)  // NOLINT: a function is one
      : find_([find = std::move(find)](const VectorResult& q, double, std::vector<ContactPoint>& found) mutable { find(q, found); }) {}
  /// Makes a finder that looks ahead, unless `look` is empty.
  ContactFinder(Find find, Look look) : find_(std::move(find)), look_(std::move(look)) {}

  /// Returns whether there is a function to call.
  explicit operator bool() const { return static_cast<bool>(find_); }
  /// Appends the contact points at q (nq) to `found`. Points farther away than `reach` [m] may be missing.
  void operator()(const VectorResult& q, std::vector<ContactPoint>& found, double reach = 0) const {
    if (find_) find_(q, reach, found);
  }
  /// Returns whether approach() may be called.
  bool looksAhead() const { return static_cast<bool>(look_); }
  /// Calls the Look with these arguments.
  Approach approach(const VectorResult& q, const MatrixResult& velocities, double seconds) const { return look_(q, velocities, seconds); }

 private:
  Find find_;
  Look look_;
};

/// Makes a finder that reports the contacts of both finders. It looks ahead if both do. If one finder is empty, returns the other.
DYN_API ContactFinder together(const ContactFinder& a, const ContactFinder& b);

/// Makes a finder of contacts between the origins of these frames and the plane normal . x = height [m], in world axes. Throws Error(argument) for an
/// unknown frame, a normal without direction, a height that is not finite, and a friction that is negative or not finite.
DYN_API ContactFinder pointsOnPlane(const CompactModel& model, const std::vector<std::string>& frames, const Vec3<double>& normal = {0, 0, 1},
                                    double height = 0, double friction = 0);

}  // namespace dyn
