// Parameters of a description against the schema that a plugin declares.
#pragma once

#include "compile/draft.hpp"

namespace dyn {

/// Throws Error(parameter) that names the joint and each parameter that is unknown, missing or ill-typed.
CheckedParameters checkParameters(const Parameters& parameters, const JointTypeInfo& schema, const Where& where);

}  // namespace dyn
