// SPDX-License-Identifier: BSD-2-Clause
// Checks the parameters of a description against the schema that a plugin declares, and its numbers.
#pragma once

#include "compile/draft.hpp"

#include <string>
#include <utility>
#include <vector>

namespace dyn {

/// Checks parameters. Throws Error(parameter) that names the joint and each parameter that is unknown, missing or ill-typed.
CheckedParameters checkParameters(const Parameters& parameters, const JointTypeInfo& schema, const Where& where);

/// Returns a coupling's type and constants. Throws like checkParameters(), and Error(joint_type) if the registry has no such type.
std::pair<const CouplingType*, std::vector<double>> prepareCoupling(const Coupling& coupling, const JointRegistry& registry, const Where& where);

// Checks of described numbers. All throw Error(model), and the last two also Error(size).

void checkGravity(const Vec3<double>& gravity);
/// Refuses what is not a pose. A rotation may have the error of numbers written with two digits. Reflections, scalings and matrices that were never
/// filled in are refused.
void checkPlacement(const SE3<double>& X, const std::string& what, const Where& where);
void checkInertia(const Inertia<double>& inertia, const std::string& body, const Where& where);
/// Refuses damping, friction or armature of a joint with nv degrees of freedom. An empty list is right.
void checkDissipation(const char* name, const std::vector<double>& values, std::size_t nv, const Where& where);
/// The same for any list of numbers. `otherwise` says what entries are that do not fit.
template <class Fits>
void checkEntries(const char* name, const std::vector<double>& values, std::size_t size, const Fits& fits, const char* otherwise,
                  const Where& where) {
  if (!values.empty() && values.size() != size)
    throw Error(ErrorCode::size,
                std::string(name) + " has " + std::to_string(values.size()) + " entries, the joint wants " + std::to_string(size) + " or none",
                where);
  for (const double x : values)
    if (!fits(x)) throw Error(ErrorCode::model, std::string(name) + " has an entry that " + otherwise, where);
}

}  // namespace dyn
