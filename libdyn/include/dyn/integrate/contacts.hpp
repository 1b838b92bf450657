// What may touch in a simulation: points of bodies and surfaces of others, told anew for every configuration.
#pragma once

#include <dyn/compile/compact_model.hpp>
#include <dyn/data/views.hpp>

#include <cstdint>
#include <functional>
#include <string>
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

/// Appends the points that are near enough to matter. Called several times a step; a function of q alone. The library's own keep scratch, which
/// copies of one share: a finder of its own for each thread.
using ContactFinder = std::function<void(VectorResult q, std::vector<ContactPoint>& found)>;

/// Origins of these frames above the plane normal . x = height of the world [m]. Throws Error(argument) for a frame that is not there, a
/// normal without direction, a height that is not finite, a friction that is negative or not finite.
DYN_API ContactFinder pointsOnPlane(const CompactModel& model, const std::vector<std::string>& frames, const Vec3<double>& normal = {0, 0, 1},
                                    double height = 0, double friction = 0);

}  // namespace dyn
