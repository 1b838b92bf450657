// SPDX-License-Identifier: BSD-2-Clause
// The solver for forces in Coulomb cones: 0 in G x + g + friction |tangential velocity| normal + normal cone of the cones at x.
#pragma once

#include "kernels/constraint/constraint_workspace.hpp"

#include <dyn/constraint/friction.hpp>

namespace dyn {

/// A cone and its rows: three of a contact, or one of a limit or of a joint's own friction. Rows in no cone are free.
struct PackedCone {
  int row;
  double friction;
  double gap;
  int rows = 3;
  double sign = 1;         ///< of the normal force and velocity
  bool both_ways = false;  ///< a joint's own friction: `friction` then is the largest force, or impulse

  int normal() const { return row + rows - 1; }
};

struct ConeProblem {
  int rows;
  const PackedCone* cones;
  std::size_t count;
  const double* g;
  bool dissipative;  ///< for contacts: slip adds to the normal velocity (de Saxce). Otherwise the nearest force in the cones is the solution
};

struct ConeSolution {
  bool converged;
  int iterations;
};

/// The solver, with memory for one set of constraints.
class ConeSolver {
 public:
  void layOut(int rows, Arena& arena);
  /// Writes the forces to x, each in its cone. G is w.delassus; w.delassus and w.inverse are overwritten. x and w's vectors have room for a pack.
  ConeSolution solve(kernels::ConstraintWorkspace& w, const ConeProblem& problem, const ContactSettings& settings, double* x);
  /// G x + g of the last solution.
  const double* velocity() const { return velocity_; }

 private:
  /// Writes a power of two for each row to scale_, the same for all rows of a cone, which brings the matrix' diagonal near to its mean. Then forces
  /// and moments of heavy and light bodies converge together.
  void chooseScales(const kernels::ConstraintWorkspace& w, const ConeProblem& problem, double mean);
  void project(const ConeProblem& problem, double* x) const;

  double *scale_ = nullptr, *force_ = nullptr, *dual_ = nullptr, *right_ = nullptr, *velocity_ = nullptr, *sum_ = nullptr;
};

/// Replaces the cone's rows of x by the nearest point of the cone.
void projectOntoCone(const PackedCone& cone, double* x);

}  // namespace dyn
