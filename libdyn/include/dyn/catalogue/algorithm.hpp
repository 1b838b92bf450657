// SPDX-License-Identifier: BSD-2-Clause
// The catalogue of algorithms: their names, arguments, results, and the memory that they need.
//
// Batches, compute(), traces, `dyn compute` and `dyn bench` loop over this list, and take names, arguments, results and checks from it.
// libdyn/doc/adding_an_algorithm.md walks through adding one.
#pragma once

#include <dyn/catalogue/need.hpp>

#include <array>
#include <cstdint>

namespace dyn {

/// The algorithms of the catalogue. Each is the function that info() names.
enum class Algorithm : std::uint8_t {
  placements,               ///< forwardKinematics() of q
  velocities,               ///< forwardKinematics() of q and v, with placements
  accelerations,            ///< forwardKinematics() of q, v and a, with velocities
  joint_jacobians,          ///< computeJointJacobians()
  frame_jacobian,           ///< computeFrameJacobian()
  center_of_mass,           ///< centerOfMass(); in compute(), with its velocity and acceleration where those of bodies are asked for
  energies,                 ///< computeKineticEnergy() and computePotentialEnergy()
  rnea,                     ///< rnea()
  nle,                      ///< nonLinearEffects()
  gravity,                  ///< generalizedGravity()
  static_torque,            ///< computeStaticTorque()
  mass_matrix,              ///< crba()
  aba,                      ///< aba()
  minverse,                 ///< computeMinverse()
  rnea_derivatives,         ///< computeRNEADerivatives()
  aba_derivatives,          ///< computeABADerivatives()
  coriolis,                 ///< computeCoriolisMatrix()
  centroidal_map,           ///< ccrba()
  centroidal_rate,          ///< computeCentroidalMomentumTimeVariation()
  centroidal_derivatives,   ///< computeCentroidalDynamicsDerivatives()
  center_of_mass_jacobian,  ///< jacobianCenterOfMass()
};
inline constexpr int algorithm_count = 21;  ///< number of algorithms

/// A set of algorithms, for example Algorithm::rnea | Algorithm::mass_matrix.
class Algorithms {
 public:
  using enum Algorithm;
  /// Makes an empty set, or a set of one.
  /// @{
  constexpr Algorithms() = default;
  constexpr Algorithms(Algorithm one) : bits_(1U << static_cast<unsigned>(one)) {}  // NOLINT: meant to convert
  /// @}
  /// Returns the union.
  friend constexpr Algorithms operator|(Algorithms a, Algorithms b) {
    a.bits_ |= b.bits_;
    return a;
  }
  /// Returns whether any of the wanted ones is in the set.
  friend constexpr bool has(Algorithms set, Algorithms wanted) { return (set.bits_ & wanted.bits_) != 0; }
  constexpr bool empty() const { return bits_ == 0; }  ///< whether it has no algorithm
  /// Calls use(algorithm) for each, in the order of the catalogue.
  template <class Use>
  constexpr void each(Use&& use) const {
    for (unsigned k = 0; k < algorithm_count; ++k)
      if (bits_ >> k & 1U) use(static_cast<Algorithm>(k));
  }

 private:
  std::uint32_t bits_ = 0;
};
/// Returns the set of both.
constexpr Algorithms operator|(Algorithm a, Algorithm b) { return Algorithms(a) | Algorithms(b); }

/// A number of rows or columns: a constant, or one of the model's sizes.
enum class Extent : std::uint8_t { one, six, twelve, nv, joints, frames, three };

/// Sizes of a model.
struct ModelSizes {
  int nv,      ///< degrees of freedom
      joints,  ///< joints that can move, and the world
      frames;  ///< frames of bodies and extra frames

  /// Returns the number for which `extent` stands.
  constexpr int of(Extent extent) const {
    switch (extent) {
      case Extent::one:
        return 1;
      case Extent::six:
        return 6;
      case Extent::twelve:
        return 12;
      case Extent::nv:
        return nv;
      case Extent::joints:
        return joints;
      case Extent::frames:
        return frames;
      case Extent::three:
        return 3;
    }
    return 0;
  }
};

/// One result of an algorithm.
struct AlgorithmOutput {
  const char* symbol = nullptr;  ///< the name of the result in formulas; null: there is none
  const char* key = nullptr;     ///< its name in `dyn compute`; null: not printed there
  Extent rows = Extent::one,     ///< number of rows
      columns = Extent::one;     ///< number of columns
};

/// The kind of pass over the model under which compute() counts an algorithm.
enum class Pass : std::uint8_t { kinematics, dynamics, inertias, derivatives };

/// One entry of the catalogue.
struct AlgorithmInfo {
  Algorithm algorithm;                          ///< which one it is
  const char* function;                         ///< its C++ name, which errors begin with
  const char* name;                             ///< its name in `dyn bench`; null: not measured there
  const char* traced;                           ///< its name in trace(); null: not traced
  std::array<const char*, 3> inputs;            ///< "q" first; "v"; "a" or "tau", or what single calls alone take ("frame", "fext"); null: no more
  Pass pass;                                    ///< where compute() counts it
  Need need;                                    ///< what a Data needs for it
  Need batch_need;                              ///< what a BatchData needs for it
  bool batched;                                 ///< whether a BatchData can run it
  bool varies = false;                          ///< whether it reads how subspaces vary with q
  std::array<AlgorithmOutput, 4> outputs = {};  ///< its results, then entries without a symbol

  /// Returns whether the name of one of its inputs begins with that letter.
  constexpr bool reads(char first_letter) const {
    for (const char* input : inputs)
      if (input != nullptr && input[0] == first_letter) return true;
    return false;
  }
};

namespace detail {
inline constexpr std::array<AlgorithmInfo, algorithm_count> algorithm_table = [] {
  using A = Algorithm;
  using E = Extent;
  constexpr Need state = Need::state, mass = Need::mass_matrix, matrices = Need::derivatives, bodies = Need::kinematics, maps = Need::jacobians;
  return std::array<AlgorithmInfo, algorithm_count>{{
      {A::placements,
       "forwardKinematics",
       "forward_kinematics",
       "forwardKinematics",
       {"q"},
       Pass::kinematics,
       state,
       bodies,
       true,
       false,
       {{{"oMi", nullptr, E::twelve, E::joints}}}},
      {A::velocities, "forwardKinematics", "forward_kinematics_1", nullptr, {"q", "v"}, Pass::kinematics, state, bodies, true},
      {A::accelerations, "forwardKinematics", "forward_kinematics_2", nullptr, {"q", "v", "a"}, Pass::kinematics, state, bodies, true},
      {A::joint_jacobians,
       "computeJointJacobians",
       "joint_jacobians",
       "jacobians",
       {"q"},
       Pass::kinematics,
       state,
       maps,
       true,
       false,
       {{{"J", nullptr, E::six, E::nv}}}},
      {A::frame_jacobian,
       "computeFrameJacobian",
       nullptr,
       nullptr,
       {"q", "frame"},
       Pass::kinematics,
       state,
       maps,
       true,
       false,
       {{{"J", nullptr, E::six, E::nv}}}},
      {A::center_of_mass,
       "centerOfMass",
       "center_of_mass",
       nullptr,
       {"q", "v", "a"},
       Pass::kinematics,
       state,
       state,
       true,
       false,
       {{{"com", nullptr, E::three}, {"vcom", nullptr, E::three}, {"acom", nullptr, E::three}}}},
      {A::energies,
       "computeKineticEnergy",
       "energies",
       nullptr,
       {"q", "v"},
       Pass::kinematics,
       state,
       state,
       true,
       false,
       {{{"kinetic_energy", nullptr}, {"potential_energy", nullptr}}}},
      {A::rnea, "rnea", "rnea", "rnea", {"q", "v", "a"}, Pass::dynamics, state, state, true, false, {{{"tau", "rnea", E::nv}}}},
      {A::nle, "nonLinearEffects", "nle", "nonLinearEffects", {"q", "v"}, Pass::dynamics, state, state, true, false, {{{"nle", "nle", E::nv}}}},
      {A::gravity, "generalizedGravity", "gravity", "gravity", {"q"}, Pass::dynamics, state, state, true, false, {{{"g", "gravity_torque", E::nv}}}},
      {A::static_torque,
       "computeStaticTorque",
       nullptr,
       nullptr,
       {"q", "fext"},
       Pass::dynamics,
       state,
       state,
       false,
       false,
       {{{"tau", nullptr, E::nv}}}},
      {A::mass_matrix, "crba", "crba", "crba", {"q"}, Pass::inertias, mass, mass, true, false, {{{"M", "M", E::nv, E::nv}}}},
      {A::aba, "aba", "aba", "aba", {"q", "v", "tau"}, Pass::inertias, state, state, true, false, {{{"ddq", "aba", E::nv}}}},
      {A::minverse,
       "computeMinverse",
       "minverse",
       "minverse",
       {"q"},
       Pass::inertias,
       matrices,
       matrices,
       true,
       false,
       {{{"Minv", "Minv", E::nv, E::nv}}}},
      {A::rnea_derivatives,
       "computeRNEADerivatives",
       "rnea_derivatives",
       "rnea_derivatives",
       {"q", "v", "a"},
       Pass::derivatives,
       matrices,
       matrices,
       true,
       true,
       {{{"dtau_dq", "dtau_dq", E::nv, E::nv}, {"dtau_dv", "dtau_dv", E::nv, E::nv}, {"M", nullptr, E::nv, E::nv}}}},
      {A::aba_derivatives,
       "computeABADerivatives",
       "aba_derivatives",
       "aba_derivatives",
       {"q", "v", "tau"},
       Pass::derivatives,
       matrices,
       matrices,
       true,
       true,
       {{{"ddq_dq", "ddq_dq", E::nv, E::nv}, {"ddq_dv", "ddq_dv", E::nv, E::nv}, {"Minv", nullptr, E::nv, E::nv}, {"ddq", nullptr, E::nv}}}},
      {A::coriolis,
       "computeCoriolisMatrix",
       "coriolis",
       nullptr,
       {"q", "v"},
       Pass::derivatives,
       matrices,
       matrices,
       true,
       true,
       {{{"C", "coriolis_matrix", E::nv, E::nv}}}},
      {A::centroidal_map,
       "ccrba",
       "ccrba",
       "centroidal_map",
       {"q", "v"},
       Pass::inertias,
       matrices,
       matrices,
       true,
       false,
       {{{"hg", "hg", E::six}, {"Ag", "Ag", E::six, E::nv}}}},
      {A::centroidal_rate,
       "computeCentroidalMomentumTimeVariation",
       nullptr,
       nullptr,
       {"q", "v", "a"},
       Pass::derivatives,
       matrices,
       matrices,
       true,
       true,
       {{{"hg", nullptr, E::six}, {"dhg", "dhg", E::six}, {"Ag", nullptr, E::six, E::nv}, {"dAg", "dAg", E::six, E::nv}}}},
      {A::centroidal_derivatives,
       "computeCentroidalDynamicsDerivatives",
       "centroidal_derivatives",
       nullptr,
       {"q", "v", "a"},
       Pass::derivatives,
       matrices,
       matrices,
       true,
       true,
       {{{"dhg_dq", "dhg_dq", E::six, E::nv},
         {"dhgdot_dq", "dhgdot_dq", E::six, E::nv},
         {"dhgdot_dv", "dhgdot_dv", E::six, E::nv},
         {"dhgdot_da", "dhgdot_da", E::six, E::nv}}}},
      {A::center_of_mass_jacobian,
       "jacobianCenterOfMass",
       "center_of_mass_jacobian",
       nullptr,
       {"q"},
       Pass::kinematics,
       state,
       matrices,
       true,
       false,
       {{{"Jcom", nullptr, E::three, E::nv}}}},
  }};
}();
consteval bool algorithmsAreInOrder() {
  for (std::size_t k = 0; k < algorithm_table.size(); ++k)
    if (algorithm_table[k].algorithm != static_cast<Algorithm>(k)) return false;
  return true;
}
static_assert(algorithmsAreInOrder());
}  // namespace detail

/// Returns all entries, by Algorithm.
constexpr const std::array<AlgorithmInfo, algorithm_count>& algorithms() { return detail::algorithm_table; }
/// Returns the entry of an algorithm.
constexpr const AlgorithmInfo& info(Algorithm algorithm) { return detail::algorithm_table[static_cast<std::size_t>(algorithm)]; }

/// Returns whether it is about the centre of mass, which a model without mass does not have. Then the algorithm throws Error(singular).
constexpr bool isCentroidal(Algorithm a) {
  return a == Algorithm::centroidal_map || a == Algorithm::centroidal_rate || a == Algorithm::centroidal_derivatives;
}

}  // namespace dyn
