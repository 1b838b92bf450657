// How far the kinematics of a Data have come.
#pragma once

namespace dyn {

/// Each stage has what those before it have.
enum class KinematicsStage { nothing, poses, velocities, accelerations, derivatives };

}  // namespace dyn
