// SPDX-License-Identifier: BSD-2-Clause
// Shared by the writer and the interpreter of traced joint types.
#pragma once

#include <dyn/codegen/joint_source.hpp>

namespace dyn {

/// Throws Error(argument) unless the name of a type is an identifier of C++.
void checkTypeName(const std::string& name);
/// Throws Error(argument) if names, sizes or graphs do not fit.
void checkJoint(const TracedJoint& joint);
/// Returns how many numbers all parameters have together.
int constantCount(const TracedJoint& joint);
/// Returns a value that the parameter accepts: its usual value, or some numbers.
std::string exampleOf(const TracedParameter& parameter);
/// Returns the graph (q, v, c) -> dq/dt of a type with its own configuration space.
Graph ratesOf(const TracedJoint& joint);

}  // namespace dyn
