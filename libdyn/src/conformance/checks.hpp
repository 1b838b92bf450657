// SPDX-License-Identifier: BSD-2-Clause
// The groups of checks, one source file each. Every function appends its findings.
#pragma once

#include "conformance/joint_probe.hpp"
#include "conformance/support.hpp"

namespace dyn::conformance {

/// Checks that poses are in SE(3), S and bias against the pose map, large q, NaN, jumps of S and singular configurations.
void checkMotion(const JointProbe& joint, std::uint64_t seed, Findings& findings);
/// Checks neutral, integrate, difference, normalize and their Jacobians.
void checkConfiguration(const JointProbe& joint, std::uint64_t seed, Findings& findings);
/// Checks the calls: batches agree with single joints, nothing is written outside a batch, two threads get the same bits, and nothing is allocated.
void checkCalls(const JointProbe& joint, std::uint64_t seed, const AllocationCount& allocations, Findings& findings);
/// Puts the joint between two revolute joints and checks inverse against forward dynamics, mass matrix, derivatives and energy balance.
void checkDynamics(const JointType& type, const Parameters& parameters, const JointRegistry& registry, std::uint64_t seed, Findings& findings);

/// Returns a configuration that a random tangent vector reaches from neutral.
Eigen::VectorXd randomConfiguration(const JointProbe& joint, Random& random);

constexpr int sample_count = 8;

}  // namespace dyn::conformance
