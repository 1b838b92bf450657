// SPDX-License-Identifier: BSD-2-Clause
#include <dyn/error.hpp>
#include <dyn/integrate/integrator.hpp>

namespace dyn {

const std::vector<IntegratorInfo>& integrators() {
  static const std::vector<IntegratorInfo> all{
      {Integrator::explicit_euler, "explicit_euler", 1, false, false},
      {Integrator::semi_implicit_euler, "semi_implicit_euler", 1, false, false},
      {Integrator::rk4, "rk4", 4, false, false},
      {Integrator::dormand_prince, "dormand_prince", 5, true, false},
      {Integrator::implicit_midpoint, "implicit_midpoint", 2, false, true},
      {Integrator::gauss6, "gauss6", 6, false, true},
      {Integrator::radau5, "radau5", 5, false, true},
      {Integrator::variational, "variational", 2, false, true},
  };
  return all;
}

Integrator integratorByName(const std::string& name) {
  std::string known;
  for (const IntegratorInfo& info : integrators()) {
    if (name == info.name) return info.integrator;
    known += (known.empty() ? "" : ", ") + std::string(info.name);
  }
  throw Error(ErrorCode::argument, "no integrator is called '" + name + "'; there are " + known);
}

}  // namespace dyn
