// SPDX-License-Identifier: BSD-2-Clause
#include "constraint/cone_solver.hpp"

#include "kernels/isa/constraint_table.hpp"

#include <algorithm>
#include <cmath>

namespace dyn {

void ConeSolver::layOut(int rows, Arena& arena) {
  for (double** vector : {&scale_, &force_, &dual_, &right_, &velocity_, &sum_}) arena.take(*vector, static_cast<std::size_t>(rows) + most_lanes);
}

void projectOntoCone(const PackedCone& cone, double* all) {
  double* x = all + cone.row;
  if (cone.both_ways) {
    x[0] = std::clamp(x[0], -cone.friction, cone.friction);
    return;
  }
  if (cone.rows == 1) {
    x[0] = cone.sign * std::max(0.0, cone.sign * x[0]);
    return;
  }
  const double friction = cone.friction;
  const double slip = std::sqrt(x[0] * x[0] + x[1] * x[1]), normal = x[2];
  if (slip <= friction * normal) return;
  if (friction * slip <= -normal) {
    x[0] = x[1] = x[2] = 0;
    return;
  }
  const double along = (normal + friction * slip) / (1 + friction * friction), share = slip > 0 ? friction * along / slip : 0;
  x[0] *= share;
  x[1] *= share;
  x[2] = along;
}

void ConeSolver::chooseScales(const kernels::ConstraintWorkspace& w, const ConeProblem& problem, double mean) {
  const auto scaleOf = [&](int row, int rows) {
    double diagonal = 0;
    for (int i = row; i < row + rows; ++i) diagonal += w.delassus[i * w.stride + i] / rows;
    const double scale = diagonal > 0 ? std::exp2(-std::round(0.5 * std::log2(diagonal / mean))) : 1;
    std::fill_n(scale_ + row, rows, scale);
  };
  for (int i = 0; i < problem.rows; ++i) scaleOf(i, 1);
  for (std::size_t c = 0; c < problem.count; ++c) scaleOf(problem.cones[c].row, problem.cones[c].rows);
}

void ConeSolver::project(const ConeProblem& problem, double* x) const {
  for (std::size_t c = 0; c < problem.count; ++c) {
    PackedCone cone = problem.cones[c];
    if (cone.both_ways) cone.friction /= scale_[cone.row];
    projectOntoCone(cone, x);
  }
}

/// The alternating direction method of multipliers (Boyd et al. 2011, sec. 3). The penalty follows the ratio of the two residuals (sec. 3.4.1). The
/// problem is scaled: with x = S y it becomes S G S y + S g, with the same cones except for the bounds of both_ways.
ConeSolution ConeSolver::solve(kernels::ConstraintWorkspace& w, const ConeProblem& problem, const ContactSettings& settings, double* x) {
  const kernels::ConstraintKernels& k = kernels::constraintKernels();
  const int n = problem.rows;
  double largest = 0, mean = 0;  // the matrix' largest sum of absolute values in a row, and its mean diagonal entry
  for (int i = 0; i < n; ++i) {
    const double* row = w.delassus + i * w.stride;
    double sum = 0;
    for (int j = 0; j < n; ++j) sum += std::abs(row[j]);
    largest = std::max(largest, sum);
    mean += row[i] / n;
  }
  std::fill_n(x, n, 0.0);
  std::fill_n(dual_, n, 0.0);
  std::fill_n(force_, n, 0.0);
  std::copy_n(problem.g, n, velocity_);
  if (!std::isfinite(mean)) return {false, 0};
  if (!(largest > 0)) return {largest == 0, 0};
  chooseScales(w, problem, mean);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) w.delassus[i * w.stride + j] *= scale_[i] * scale_[j];
  // The penalty lies between the matrix' largest and smallest entries. A small proximal term keeps undetermined forces from drifting.
  double penalty = 0.1 * mean;
  const double proximal = 1e-6 * mean;
  k.invertDelassus(n, w, penalty + proximal, 0);
  int since = 0, wait = 10;
  int iteration = 0;
  bool converged = false;
  for (; iteration < settings.max_iterations; ++iteration) {
    for (int i = 0; i < n; ++i) right_[i] = penalty * x[i] + proximal * force_[i] - scale_[i] * problem.g[i] - dual_[i];
    if (problem.dissipative)
      for (std::size_t c = 0; c < problem.count; ++c) {
        if (problem.cones[c].rows == 1 || problem.cones[c].friction == 0) continue;
        const double* y = dual_ + problem.cones[c].row;
        right_[problem.cones[c].normal()] -= problem.cones[c].friction * std::sqrt(y[0] * y[0] + y[1] * y[1]);
      }
    k.timesRows(n, w.stride, w.inverse, right_, force_);
    if (!std::all_of(force_, force_ + n, [](double f) { return std::isfinite(f); })) break;  // comparisons with NaN below would look like success
    // Both residuals are velocities: the effects of the difference between the two copies of the forces, and of their last step.
    double primal = 0, change = 0, moved = 0;
    for (int i = 0; i < n; ++i) sum_[i] = force_[i] + dual_[i] / penalty;
    project(problem, sum_);
    // Free rows have no cone: their dual stays zero.
    double apart = 0;
    for (int i = 0; i < n; ++i) {
      const double step = std::abs(sum_[i] - x[i]);
      moved = std::max(moved, step);
      change = std::max(change, penalty * step / scale_[i]);
      x[i] = sum_[i];
      const double split = std::abs(force_[i] - x[i]);
      apart = std::max(apart, split);
      primal = std::max(primal, largest * split * scale_[i]);
      dual_[i] += penalty * (force_[i] - x[i]);
    }
    if (std::max(primal, change) <= settings.tolerance) {
      ++iteration;
      converged = true;
      break;
    }
    if (++since >= wait) {
      const double ratio = mean * apart / std::max(penalty * moved, 1e-300);
      if (ratio > 5 || ratio < 0.2) {
        penalty = std::clamp(penalty * std::clamp(std::sqrt(ratio), 0.01, 100.0), 1e-8 * largest, 1e4 * largest);
        k.invertDelassus(n, w, penalty + proximal, 0);
        // Changes become ever rarer, because the iteration converges with a constant penalty.
        wait += wait / 4;
      }
      since = 0;
    }
  }
  k.timesRows(n, w.stride, w.delassus, x, velocity_);
  for (int i = 0; i < n; ++i) {
    velocity_[i] = velocity_[i] / scale_[i] + problem.g[i];
    x[i] *= scale_[i];
  }
  return {converged, iteration};
}

}  // namespace dyn
