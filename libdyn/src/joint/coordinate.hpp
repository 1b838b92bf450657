// One joint's configuration: neutral, normalised, and the one-dimensional coordinate of a coupled joint: how far it is from neutral,
// whatever q looks like.
#pragma once

#include <dyn/joint/joint_type.hpp>

namespace dyn {

// All of one joint, whose constants lie `stride` apart.

void neutralOf(const JointType& type, const double* constants, std::ptrdiff_t stride, double* q);
double coordinateOf(const JointType& type, const double* constants, std::ptrdiff_t stride, const double* q);
void setCoordinate(const JointType& type, const double* constants, std::ptrdiff_t stride, double value, double* q);

/// q brought onto the configuration space in `out` (may be null); returns its distance from there before.
double normalizeJoint(const JointType& type, const double* constants, std::ptrdiff_t stride, const double* q, double* out);

}  // namespace dyn
