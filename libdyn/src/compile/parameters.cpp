// SPDX-License-Identifier: BSD-2-Clause
#include "compile/parameters.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace dyn {

namespace {

const char* describe(ParameterKind kind) {
  switch (kind) {
    case ParameterKind::number:
      return "one number";
    case ParameterKind::vector3:
      return "three numbers";
    case ParameterKind::numbers:
      return "numbers";
    case ParameterKind::text:
      return "a text";
    case ParameterKind::joints:
      return "a list of joints";
  }
  return "nothing";
}

bool fits(const ParameterValue& value, ParameterKind kind) {
  if (const auto* numbers = std::get_if<std::vector<double>>(&value)) {
    for (const double x : *numbers)
      if (!std::isfinite(x)) return false;
    return kind == ParameterKind::numbers || (kind == ParameterKind::number && numbers->size() == 1) ||
           (kind == ParameterKind::vector3 && numbers->size() == 3);
  }
  if (std::holds_alternative<std::string>(value)) return kind == ParameterKind::text;
  return kind == ParameterKind::joints;
}

}  // namespace

std::vector<ParameterArgument> CheckedParameters::arguments() const {
  std::vector<ParameterArgument> result;
  for (std::size_t i = 0; i < given.size(); ++i)
    result.push_back({numbers[i].data(), static_cast<int>(numbers[i].size()), texts[i].c_str(), given[i]});
  return result;
}

CheckedParameters checkParameters(const Parameters& parameters, const JointTypeInfo& schema, const Where& where) {
  CheckedParameters checked;
  std::string problems;
  std::size_t used = 0;
  for (int i = 0; i < schema.parameter_count; ++i) {
    const ParameterSpec& spec = schema.parameters[i];
    checked.numbers.emplace_back();
    checked.texts.emplace_back();
    const auto found = parameters.find(spec.name);
    checked.given.push_back(found != parameters.end());
    if (found == parameters.end()) {
      if (spec.required) problems += std::string("; parameter '") + spec.name + "' is missing (" + describe(spec.kind) + ": " + spec.help + ")";
      continue;
    }
    ++used;
    if (!fits(found->second, spec.kind)) {
      problems += std::string("; parameter '") + spec.name + "' must be " + describe(spec.kind) + ", all finite (" + spec.help + ")";
      continue;
    }
    if (const auto* numbers = std::get_if<std::vector<double>>(&found->second)) checked.numbers.back() = *numbers;
    if (const auto* text = std::get_if<std::string>(&found->second)) checked.texts.back() = *text;
  }
  if (used < parameters.size()) {
    for (const auto& [name, value] : parameters) {
      bool known = false;
      for (int i = 0; i < schema.parameter_count; ++i) known = known || name == schema.parameters[i].name;
      if (!known) problems += "; parameter '" + name + "' is unknown";
    }
    problems += schema.parameter_count == 0 ? "; the type takes none" : "; it takes";
    for (int i = 0; i < schema.parameter_count; ++i) problems += std::string(i ? ", " : " ") + schema.parameters[i].name;
  }
  if (!problems.empty()) throw Error(ErrorCode::parameter, std::string("type '") + schema.name + "'" + problems, where);
  return checked;
}

std::pair<const CouplingType*, std::vector<double>> prepareCoupling(const Coupling& coupling, const JointRegistry& registry, const Where& where) {
  const CouplingType& type = registry.couplingType(coupling.type, where);
  const CheckedParameters checked = checkParameters(coupling.parameters, type.info(), where);
  const std::vector<ParameterArgument> arguments = checked.arguments();
  char message[256] = "";
  int count = 0;
  if (!type.prepare(arguments.data(), count, message, sizeof message))
    throw Error(ErrorCode::parameter, "coupling '" + coupling.type + "': " + message, where);
  std::vector<double> constants(static_cast<std::size_t>(count));
  type.constants(arguments.data(), constants.data());
  return {&type, std::move(constants)};
}

void checkGravity(const Vec3<double>& gravity) {
  for (const double g : {gravity.x, gravity.y, gravity.z})
    if (!std::isfinite(g)) throw Error(ErrorCode::model, "gravity has an entry that is not finite");
}

void checkPlacement(const SE3<double>& X, const std::string& what, const Where& where) {
  for (const double x : {X.p.x, X.p.y, X.p.z})
    if (!std::isfinite(x)) throw Error(ErrorCode::model, what + " has an entry that is not finite", where);
  const Vec3<double> x = X.R.col(0), y = X.R.col(1), z = X.R.col(2);
  const double off[] = {dot(x, x) - 1, dot(y, y) - 1, dot(z, z) - 1, dot(x, y), dot(x, z), dot(y, z)};
  const bool orthonormal = std::all_of(std::begin(off), std::end(off), [](double e) { return std::fabs(e) < 0.02; });
  if (!orthonormal || !(dot(cross(x, y), z) > 0)) throw Error(ErrorCode::model, what + " has a matrix that is no rotation", where);
}

void checkInertia(const Inertia<double>& Y, const std::string& body, const Where& where) {
  const Sym3<double>& I = Y.rotational;
  for (const double x : {Y.mass, Y.com.x, Y.com.y, Y.com.z, I.xx, I.xy, I.xz, I.yy, I.yz, I.zz})
    if (!std::isfinite(x)) throw Error(ErrorCode::model, "body '" + body + "': its inertia has an entry that is not finite", where);
  if (Y.mass < 0) throw Error(ErrorCode::model, "body '" + body + "': its mass is negative", where);
}

void checkDissipation(const char* name, const std::vector<double>& values, std::size_t nv, const Where& where) {
  checkEntries(
      name, values, nv, [](double x) { return std::isfinite(x) && x >= 0; }, "is negative or not finite", where);
}

}  // namespace dyn
