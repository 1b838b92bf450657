// SPDX-License-Identifier: BSD-2-Clause
// The chart u -> q0 (+) u of a model's configuration space, and its action on velocities, momenta and forces.
#pragma once

#include "compile/compact_impl.hpp"

#include <dyn/data/views.hpp>

#include <vector>

namespace dyn {

/// Coordinates that simply add are added, contiguous runs at once. The other joints are few and have blocks of at most 6 x 6.
class Chart {
 public:
  explicit Chart(const CompactModel& model);

  /// q = q0 (+) u.
  void point(const double* q0, const double* u, double* q) const;
  /// du/dt of a motion that passes q = q0 (+) u with velocity v.
  void rate(const double* q0, const double* q, const double* v, double* du) const;

  /// Moves q0 by u with held axes. For free and planar joints u is a straight translation and a rotation [m, rad], both in the axes at q0. A step
  /// with components in rotating axes would leave the straight path and increase the speed. On entry v of these joints is in the axes at q0, on
  /// return in the axes at q.
  void pointInHeldAxes(const double* q0, const double* u, double* v, double* q) const;

  /// Applies the maps of the midpoint's discrete Lagrangian to the momentum and force at the midpoint, where u is the step:
  /// momentum <- X^T momentum, at_start <- Y0^T force, at_end <- Y1^T force, with X = A T, Y1 = J T and Y0 = A Y1. Here A = exp(-ad(u/2)), T is the
  /// inverse of exp's derivative at u, and J is that derivative at u/2. All of them commute.
  void midpointMaps(const double* u, double* momentum, const double* force, double* at_start, double* at_end) const;

 private:
  struct Joint {
    JointPlace place;
    int q, v, nv, linear;  ///< the first `linear` velocities are in axes that the other velocities rotate
  };
  struct Run {
    int q, v, count;
  };
  struct Blocks;
  static ConfigurationBatch<double> callOf(const Joint& joint, Blocks& blocks);
  /// The same as point(), for one joint's coordinates.
  static void pointOf(const Joint& joint, const double* q0, const double* u, double* q);
  void add(const double* q0, const double* u, double* q) const;

  CompactModel model_;
  std::vector<Run> added_;
  std::vector<Joint> turned_;  ///< all other joints
  std::vector<Joint> curved_;  ///< joints of turned_ whose velocity is not the rate of the chart
};

}  // namespace dyn
