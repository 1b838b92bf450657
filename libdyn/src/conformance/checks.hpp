// The groups of checks, one source file each. Every function appends its findings.
#pragma once

#include "conformance/joint_probe.hpp"
#include "conformance/support.hpp"

namespace dyn::conformance {

/// Pose in SE(3), S and bias against the pose map, behaviour far out and at singular configurations.
void checkMotion(const JointProbe& joint, std::uint64_t seed, Findings& findings);
/// neutral, integrate, difference, normalize and their Jacobians.
void checkConfiguration(const JointProbe& joint, std::uint64_t seed, Findings& findings);
/// How the type answers calls: batches as single joints, nothing written outside, the same bits from two threads, no allocation.
void checkCalls(const JointProbe& joint, std::uint64_t seed, const AllocationCount& allocations, Findings& findings);
/// The joint between two revolutes: inverse against forward dynamics, mass matrix, energy balance.
void checkDynamics(const JointType& type, const Parameters& parameters, const JointRegistry& registry, std::uint64_t seed, Findings& findings);

/// A configuration reached from neutral by a random tangent vector.
Eigen::VectorXd randomConfiguration(const JointProbe& joint, Random& random);

constexpr int sample_count = 8;

}  // namespace dyn::conformance
