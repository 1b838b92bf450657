// Parameters of a description against the schema that a plugin declares.
#pragma once

#include "compile/draft.hpp"

#include <utility>

namespace dyn {

/// Throws Error(parameter) that names the joint and each parameter that is unknown, missing or ill-typed.
CheckedParameters checkParameters(const Parameters& parameters, const JointTypeInfo& schema, const Where& where);

/// The type of a coupling and its constants. Throws as checkParameters, and Error(joint_type) for a type that is not there.
std::pair<const CouplingType*, std::vector<double>> prepareCoupling(const Coupling& coupling, const JointRegistry& registry, const Where& where);

}  // namespace dyn
