// The methods by which a simulation moves through time, and what is known of each.
#pragma once

#include <dyn/export.hpp>

#include <string>
#include <vector>

namespace dyn {

/// Configurations are moved along the group: steps are taken in the chart u -> q (+) u about the step's first configuration, in which
/// du/dt is the velocity through the inverse of the exponential's derivative (Munthe-Kaas 1999). Rotations of a step should stay below pi.
enum class Integrator {
  explicit_euler,       ///< q (+) h v, v + h a. For comparison only
  semi_implicit_euler,  ///< v + h a, then q (+) h v of the new v. Not symplectic where M depends on q: its energy drifts
  rk4,                  ///< Runge and Kutta's, on the group
  dormand_prince,       ///< 5(4), steps chosen by its error estimate (Dormand and Prince 1980)
  implicit_midpoint,    ///< Gauss' method of one stage: symmetric, energy errors stay bounded
  gauss6,               ///< Gauss' method of three stages
  radau5,               ///< Radau IIA of three stages: damps what is stiff (Hairer and Wanner 1996, sec. IV.8)
  variational,          ///< discrete Lagrangian of the midpoint: symplectic, keeps momentum maps (Marsden and West 2001)
};

struct IntegratorInfo {
  Integrator integrator;
  const char* name;
  int order;
  bool adaptive;  ///< steps follow a tolerance
  bool implicit;  ///< solves equations in every step: by Newton's method with analytic derivatives, the variational one by iteration
};

/// All of them, in the order of the enumeration.
DYN_API const std::vector<IntegratorInfo>& integrators();
inline const IntegratorInfo& infoOf(Integrator integrator) { return integrators()[static_cast<std::size_t>(integrator)]; }
/// Throws Error(argument) that lists the names there are.
DYN_API Integrator integratorByName(const std::string& name);

}  // namespace dyn
