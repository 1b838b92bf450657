// SPDX-License-Identifier: BSD-2-Clause
// Results of the library's algorithms at one state, from their definitions, with fifty digits. Keys are those of a truth file.
#pragma once

#include "exact_bodies.hpp"
#include "states.hpp"

#include <map>
#include <string>

namespace dyn::tool {

using Quantities = std::map<std::string, MatrixR>;

/// rnea, nle, gravity, M, Minv, aba and the scales; with `derivatives` those of rnea and aba.
Quantities dynamicsOf(const ExactBodies& x, const State& state, bool derivatives);
/// Poses and Jacobians of joints, torques that balance external forces, the Coriolis matrix.
Quantities jointsOf(const ExactBodies& x, const State& state);
/// Energies, the centre of mass and centroidal quantities, with derivatives.
Quantities centroidalOf(const ExactBodies& x, const State& state);
/// Jacobians, motions, and derivatives of motions of the frame of one body. Keys are those of an entry of "frames" in a truth file.
Quantities frameOf(const ExactBodies& x, const State& state, std::size_t body);
/// Joint torques, kinetic and potential energy as linear functions of the inertial parameters.
Quantities regressorsOf(const ExactBodies& x, const State& state);
/// Second derivatives of rnea: for each direction one matrix below the other. Costs nv^2 evaluations of rnea for each.
Quantities secondDerivativesOf(const ExactBodies& x, const State& state);
/// J, bias, accelerations and forces of the description's closed loops, with derivatives. Empty if it has none, or has constraints of another kind.
Quantities loopsOf(const ExactBodies& x, const Model& description, const State& state);

}  // namespace dyn::tool
