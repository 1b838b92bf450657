// Dynamics from their definitions with fifty digits: what results are judged by.
//
// No spatial vectors, no recursion over forces, no composite or articulated inertia, and no code of the library's: poses are products of
// transforms, carried along as power series of time to the second order; velocities and accelerations are their coefficients. M is the sum of
// m Jv^T Jv + Jw^T R I R^T Jw over bodies, torques follow from virtual work, aba from a dense solution with M, derivatives from central
// differences of step 1e-17, which are right to thirty digits.
#pragma once

#include "truth.hpp"

#include <dyn/compile/compact_model.hpp>
#include <dyn/model/model.hpp>

#include <memory>

namespace dyn::tool {

class Oracle {
 public:
  /// Of a model that was compiled from this description with no joint locked. Throws Error(joint_type) for joints that it has no definition
  /// of: it knows fixed, revolute, continuous, prismatic, spherical, free_flyer and translation, none that follows another.
  Oracle(const Model& description, const CompactModel& model);
  ~Oracle();
  Oracle(const Oracle&) = delete;
  Oracle& operator=(const Oracle&) = delete;

  /// rnea, nle, gravity, M, aba under the keys of a truth file, with the scales of rnea and aba (see hardcases: what the summands of a result
  /// could be before they cancel); and dtau_dq, dtau_dv, ddq_dq, ddq_dv, Minv if derivatives are asked for.
  TruthSample evaluate(const State& state, bool derivatives) const;

  /// Where the model is `time` later, moving freely: by Gragg's extrapolation of order 16 in so many steps, on the accelerations above, with the
  /// same fifty digits. Rounded at the end.
  State move(const State& start, double time, int steps) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace dyn::tool
