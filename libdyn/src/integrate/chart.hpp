// The chart u -> q0 (+) u of a model's configuration space, and what it does to velocities.
#pragma once

#include "compile/compact_impl.hpp"

#include <dyn/data/views.hpp>

#include <vector>

namespace dyn {

/// Coordinates that simply add are added, neighbours in one go; the other joints are few and have blocks of at most 6 x 6.
class Chart {
 public:
  explicit Chart(const CompactModel& model);

  /// q0 (+) u.
  void point(const double* q0, const double* u, double* q) const;
  /// du/dt of a motion that passes q = q0 (+) u with velocity v.
  void rate(const double* q0, const double* q, const double* v, double* du) const;

  /// q0 moved by u, which of joints that fly, or slide and turn, is a way straight on and a turn [m, rad] in axes held as they are at q0: steps of
  /// velocities as components in turning axes lead off their way and make them longer. Such joints' v, in the same axes, is then in those at q.
  void pointInHeldAxes(const double* q0, const double* u, double* v, double* q) const;

  /// What the discrete Lagrangian of the midpoint does to momenta and forces there, u being the step and A = exp(-ad(u/2)):
  /// X = A T and Y1 = J T, Y0 = A Y1, with T the inverse of exp's derivative at u and J that derivative at u/2. All commute.
  /// momentum <- X^T momentum, at_start <- Y0^T force, at_end <- Y1^T force.
  void midpointMaps(const double* u, double* momentum, const double* force, double* at_start, double* at_end) const;

 private:
  struct Joint {
    JointPlace place;
    int q, v, nv, linear;  ///< the first `linear` velocities are in axes that the others turn
  };
  struct Run {
    int q, v, count;
  };
  struct Blocks;
  static ConfigurationBatch<double> callOf(const Joint& joint, Blocks& blocks);
  /// Of one joint's coordinates.
  static void pointOf(const Joint& joint, const double* q0, const double* u, double* q);
  void add(const double* q0, const double* u, double* q) const;

  CompactModel model_;
  std::vector<Run> added_;
  std::vector<Joint> turned_;  ///< all others
  std::vector<Joint> curved_;  ///< those of them whose velocity is not the rate of their chart
};

}  // namespace dyn
