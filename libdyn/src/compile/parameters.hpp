// SPDX-License-Identifier: BSD-2-Clause
// Checks the parameters of a description against the schema that a plugin declares.
#pragma once

#include "compile/draft.hpp"

#include <utility>

namespace dyn {

/// Checks parameters. Throws Error(parameter) that names the joint and each parameter that is unknown, missing or ill-typed.
CheckedParameters checkParameters(const Parameters& parameters, const JointTypeInfo& schema, const Where& where);

/// Returns a coupling's type and constants. Throws like checkParameters(), and Error(joint_type) if the registry has no such type.
std::pair<const CouplingType*, std::vector<double>> prepareCoupling(const Coupling& coupling, const JointRegistry& registry, const Where& where);

}  // namespace dyn
