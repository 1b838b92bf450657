// SPDX-License-Identifier: BSD-2-Clause
// Integration methods of a simulation, and their properties.
#pragma once

#include <dyn/export.hpp>

#include <string>
#include <vector>

namespace dyn {

/// All methods integrate configurations on their group. A step uses the chart u -> q (+) u about its first configuration, where du/dt is the inverse
/// of the exponential's derivative times the velocity (Munthe-Kaas 1999). Rotations within one step should stay below pi.
enum class Integrator {
  explicit_euler,       ///< q (+) h v and v + h a; for comparison only
  semi_implicit_euler,  ///< v + h a, then q (+) h v with the new v; not symplectic where M depends on q, so that energy drifts
  rk4,                  ///< the classical method of Runge and Kutta, on the group
  dormand_prince,       ///< order 5(4), step size chosen by the error estimate (Dormand and Prince 1980)
  implicit_midpoint,    ///< Gauss' method of one stage: symmetric, energy errors stay bounded
  gauss6,               ///< Gauss' method of three stages
  radau5,               ///< Radau IIA of three stages: damps stiff motion (Hairer and Wanner 1996, sec. IV.8)
  variational,          ///< discrete Lagrangian of the midpoint: symplectic, conserves momentum maps (Marsden and West 2001)
};

/// Properties of an integrator.
struct IntegratorInfo {
  Integrator integrator;  ///< the method
  const char* name;       ///< as the enumerator is spelled
  int order;              ///< order of the global error in the step size
  bool adaptive;          ///< the step size follows a tolerance
  bool implicit;          ///< every step solves equations: by Newton's method with analytic derivatives, or by iteration in the variational method
};

/// Returns all integrators, in the order of the enumeration.
DYN_API const std::vector<IntegratorInfo>& integrators();
/// Returns the properties of one integrator.
inline const IntegratorInfo& infoOf(Integrator integrator) { return integrators()[static_cast<std::size_t>(integrator)]; }
/// Returns the integrator of this name. Throws Error(argument), which lists the known names, if there is none.
DYN_API Integrator integratorByName(const std::string& name);

}  // namespace dyn
