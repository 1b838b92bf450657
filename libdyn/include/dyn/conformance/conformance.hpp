// SPDX-License-Identifier: BSD-2-Clause
// Checks that a joint type satisfies the assumptions of the recursions. Each check compares two results of the plugin that must agree, at random
// configurations: for example its subspace with differences of poses, or a Jacobian with differences of integrate.
#pragma once

#include <dyn/joint/registry.hpp>
#include <dyn/model/model.hpp>

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace dyn {

/// The outcome of one check.
struct ConformanceFinding {
  std::string check;   ///< what was checked
  bool passed;         ///< true if the error is within the bound
  double error;        ///< largest error found, relative to max(1, size of the quantity); infinite if a result was not finite
  double bound;        ///< largest error allowed
  std::string detail;  ///< where the largest error occurred, or what was found
};

/// Returns the number of heap allocations of the calling thread so far. Only the program can count them, not a library.
using AllocationCount = std::function<long()>;

/// Makes plausible parameters from a type's schema. A parameter with an author's example gets that example; an empty example leaves it out. Otherwise
/// a vector without a unit gets a random direction (no two of the first three are nearly parallel), numbers are positive, and a list of joints gets
/// two joints. Optional parameters without an example are given for even seeds only. Throws Error(parameter) if an example does not fit its kind.
DYN_API Parameters exampleParameters(const JointTypeInfo& info, std::uint64_t seed);

/// Runs every check on the joint with these parameters. `registry` provides the other joints of the model in the dynamics checks, and the parts of a
/// joint made of joints; it need not contain the type itself. Allocations are checked only if `allocations` is given. `progress` is called with the
/// name of each group of checks before the group runs, so that a program can say where a type crashed or hangs.
/// Does not throw: every failure becomes a finding.
DYN_API std::vector<ConformanceFinding> checkJointType(const JointType& type, const Parameters& example, const JointRegistry& registry,
                                                       std::uint64_t seed, const AllocationCount& allocations = {},
                                                       const std::function<void(const char*)>& progress = {});
/// The same for a coupling: compares its three derivatives with differences.
DYN_API std::vector<ConformanceFinding> checkCouplingType(const CouplingType& type, const Parameters& example, std::uint64_t seed,
                                                          const AllocationCount& allocations = {});

}  // namespace dyn
