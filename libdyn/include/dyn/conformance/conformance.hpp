// Does a joint type keep the promises that the recursions rely on? Every check compares what a plugin says in one way with what it
// says in another (a subspace with differences of poses, a Jacobian with differences of integrate, ...), at random configurations.
#pragma once

#include <dyn/joint/registry.hpp>
#include <dyn/model/model.hpp>

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace dyn {

struct ConformanceFinding {
  std::string check;
  bool passed;
  double error;        ///< the worst met; infinite where a result was not finite. Relative to the larger of 1 and the quantity's size
  double bound;        ///< what it may be
  std::string detail;  ///< where the worst was met, or what was found
};

/// Heap allocations of the calling thread so far; a library cannot count them, the program can.
using AllocationCount = std::function<long()>;

/// Plausible parameters made up from a type's schema: the author's example where there is one; else for a vector without unit any
/// direction, no two nearly parallel; positive numbers otherwise; two joints for a list of joints. Optional parameters without an example
/// are given for every other seed. Throws Error(parameter) for an example that is not what its kind says.
DYN_API Parameters exampleParameters(const JointTypeInfo& info, std::uint64_t seed);

/// Runs every check on the joint of these parameters. `registry` provides the joints around it in the model of the dynamics checks (and
/// the parts of a joint made of joints); the type itself need not be in it. Without `allocations` allocation is not checked.
/// `progress` is called with the name of each group of checks before it is run, so that a program can say where a type crashed or hangs.
/// Throws nothing: what goes wrong is a finding.
DYN_API std::vector<ConformanceFinding> checkJointType(const JointType& type, const Parameters& example, const JointRegistry& registry,
                                                       std::uint64_t seed, const AllocationCount& allocations = {},
                                                       const std::function<void(const char*)>& progress = {});
/// The same for a coupling: both derivatives against differences.
DYN_API std::vector<ConformanceFinding> checkCouplingType(const CouplingType& type, const Parameters& example, std::uint64_t seed,
                                                          const AllocationCount& allocations = {});

}  // namespace dyn
