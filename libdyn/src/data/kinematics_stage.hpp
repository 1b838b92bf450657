// SPDX-License-Identifier: BSD-2-Clause
// The stage that the kinematics of a Data have reached.
#pragma once

namespace dyn {

/// Each stage includes the results of the stages before it.
enum class KinematicsStage { nothing, poses, velocities, accelerations, derivatives };

}  // namespace dyn
