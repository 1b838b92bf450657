#include "constraint/cone_solver.hpp"

#include "kernels/constraint_table.hpp"

#include <algorithm>
#include <cmath>

namespace dyn {

void ConeSolver::carve(int rows, Arena& arena) {
  for (double** vector : {&force_, &dual_, &right_, &velocity_, &sum_}) arena.take(*vector, static_cast<std::size_t>(rows) + most_lanes);
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

/// Boyd et al. 2011, sec. 3; the penalty follows the ratio of the two residuals (sec. 3.4.1).
ConeSolution ConeSolver::solve(kernels::ConstraintWorkspace& w, const ConeProblem& problem, const ContactSettings& settings, double* x) {
  const kernels::ConstraintKernels& k = kernels::constraintKernels();
  const int n = problem.rows;
  double largest = 0, mean = 0;  // what the matrix makes of entries of 1 at most; its mean diagonal
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
  if (!(largest > 0)) return {largest == 0, 0};
  // Of the order of the matrix between its largest and its smallest entries; a trace of it keeps what is not determined from wandering.
  double penalty = 0.1 * mean;
  const double proximal = 1e-6 * mean;
  k.invertDelassus(n, w, penalty + proximal, 0);
  int since = 0, wait = 10;
  int iteration = 0;
  for (; iteration < settings.max_iterations; ++iteration) {
    for (int i = 0; i < n; ++i) right_[i] = penalty * x[i] + proximal * force_[i] - problem.g[i] - dual_[i];
    if (problem.dissipative)
      for (std::size_t c = 0; c < problem.count; ++c) {
        if (problem.cones[c].rows == 1 || problem.cones[c].friction == 0) continue;
        const double* y = dual_ + problem.cones[c].row;
        right_[problem.cones[c].normal()] -= problem.cones[c].friction * std::sqrt(y[0] * y[0] + y[1] * y[1]);
      }
    k.timesRows(n, w.stride, w.inverse, right_, force_);
    double moved = 0;
    for (int i = 0; i < n; ++i) sum_[i] = force_[i] + dual_[i] / penalty;
    for (std::size_t c = 0; c < problem.count; ++c) projectOntoCone(problem.cones[c], sum_);
    // Free rows have no cone: their dual stays zero.
    double apart = 0;
    for (int i = 0; i < n; ++i) {
      moved = std::max(moved, std::abs(sum_[i] - x[i]));
      x[i] = sum_[i];
      apart = std::max(apart, std::abs(force_[i] - x[i]));
      dual_[i] += penalty * (force_[i] - x[i]);
    }
    // Both in velocities: forces that differ, and forces that still move, by what they do.
    const double primal = largest * apart, change = penalty * moved;
    if (std::max(primal, change) <= settings.tolerance) {
      ++iteration;
      break;
    }
    if (!(primal < HUGE_VAL) || !(change < HUGE_VAL)) break;
    if (++since >= wait) {
      const double ratio = mean * apart / std::max(change, 1e-300);
      if (ratio > 5 || ratio < 0.2) {
        penalty = std::clamp(penalty * std::clamp(std::sqrt(ratio), 0.01, 100.0), 1e-8 * largest, 1e4 * largest);
        k.invertDelassus(n, w, penalty + proximal, 0);
        // Ever later: iterations converge with a penalty that stays.
        wait += wait / 4;
      }
      since = 0;
    }
  }
  k.timesRows(n, w.stride, w.delassus, x, velocity_);
  for (int i = 0; i < n; ++i) velocity_[i] += problem.g[i];
  return {iteration < settings.max_iterations, iteration};
}

}  // namespace dyn
