// SPDX-License-Identifier: BSD-2-Clause
// Reference dynamics from their definitions with fifty digits.
//
// The oracle uses no spatial vectors, no recursion over forces, no composite or articulated inertia, and none of the library's algorithms. Poses are
// products of transforms, as power series of time to the second order; velocities and accelerations are their coefficients. M is the sum of
// m Jv^T Jv + Jw^T R I R^T Jw over bodies. Torques follow from virtual work, aba from a dense solution with M, and derivatives from central
// differences with step 1e-17, which are right to thirty digits.
#pragma once

#include "truth.hpp"

#include <dyn/compile/compact_model.hpp>
#include <dyn/model/model.hpp>

#include <memory>

namespace dyn::tool {

class ExactBodies;

class Oracle {
 public:
  /// The model must have been compiled from this description with no joint locked, and without armature and dissipation. Throws Error(joint_type) for
  /// a type without definition: the oracle knows the standard joint types, those of plugins/examples, and mimic joints that depend on an independent
  /// joint of one coordinate.
  Oracle(const Model& description, const CompactModel& model);
  ~Oracle();
  Oracle(const Oracle&) = delete;
  Oracle& operator=(const Oracle&) = delete;

  /// Computes rnea, nle, gravity, M, Minv and aba under the keys of a truth file, with the scales of rnea and aba: upper bounds of a result's
  /// summands before they cancel. With `derivatives`, also dtau_dq, dtau_dv, ddq_dq and ddq_dv.
  TruthSample evaluate(const State& state, bool derivatives) const;

  /// The state of the freely moving model `time` later: Gragg's extrapolation of order 16 in `steps` steps on the accelerations above, with the same
  /// fifty digits. The result is rounded at the end.
  State move(const State& start, double time, int steps) const;

  const ExactBodies& bodies() const { return *bodies_; }

 private:
  std::unique_ptr<ExactBodies> bodies_;
};

}  // namespace dyn::tool
