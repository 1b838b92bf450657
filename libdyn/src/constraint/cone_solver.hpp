// Forces in Coulomb cones: 0 in G x + g + friction |tangential velocity| normal + normal cone of the cones at x.
#pragma once

#include "kernels/constraint_workspace.hpp"

#include <dyn/constraint/friction.hpp>

namespace dyn {

/// Of which rows a cone is: three of a contact, or the one of a limit; rows that are in none are free.
struct PackedCone {
  int row;
  double friction;
  double gap;
  int rows = 3;
  double sign = 1;         ///< of the normal force and velocity
  bool both_ways = false;  ///< `friction` then is the largest force, or impulse

  int normal() const { return row + rows - 1; }
};

struct ConeProblem {
  int rows;
  const PackedCone* cones;
  std::size_t count;
  const double* g;
  bool dissipative;  ///< slip opens the normal velocity (de Saxce): contacts. Otherwise the nearest force in the cones is sought
};

struct ConeSolution {
  bool converged;
  int iterations;
};

/// Memory of one set of constraints.
class ConeSolver {
 public:
  void carve(int rows, Arena& arena);
  /// G is w.delassus; that and w.inverse are overwritten. x: forces in their cones; w's vectors have room for a pack.
  ConeSolution solve(kernels::ConstraintWorkspace& w, const ConeProblem& problem, const ContactSettings& settings, double* x);
  /// G x + g of the last solution.
  const double* velocity() const { return velocity_; }

 private:
  /// Into scale_: a power of two a row, the same for all of a cone, by which the matrix' diagonal comes near to its mean: forces and moments of
  /// heavy and light bodies converge together.
  void chooseScales(const kernels::ConstraintWorkspace& w, const ConeProblem& problem, double mean);
  void project(const ConeProblem& problem, double* x) const;

  double *scale_ = nullptr, *force_ = nullptr, *dual_ = nullptr, *right_ = nullptr, *velocity_ = nullptr, *sum_ = nullptr;
};

/// The cone's rows of x into it: nearest point.
void projectOntoCone(const PackedCone& cone, double* x);

}  // namespace dyn
