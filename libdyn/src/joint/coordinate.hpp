// The one-dimensional coordinate of a coupled joint: how far it is from neutral, whatever q looks like.
#pragma once

#include <dyn/joint/joint_type.hpp>

namespace dyn {

// All of one joint, whose constants lie `stride` apart.

void neutralOf(const JointType& type, const double* constants, std::ptrdiff_t stride, double* q);
double coordinateOf(const JointType& type, const double* constants, std::ptrdiff_t stride, const double* q);
void setCoordinate(const JointType& type, const double* constants, std::ptrdiff_t stride, double value, double* q);

}  // namespace dyn
