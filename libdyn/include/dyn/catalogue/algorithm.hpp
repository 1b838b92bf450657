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

enum class Algorithm : std::uint8_t {
  placements,
  velocities,     ///< with placements
  accelerations,  ///< with velocities
  joint_jacobians,
  frame_jacobian,
  center_of_mass,  ///< in compute(), with its velocity and acceleration where those of bodies are asked for
  energies,
  rnea,
  nle,
  gravity,
  static_torque,
  mass_matrix,
  aba,
  minverse,
  rnea_derivatives,
  aba_derivatives,
  coriolis,
  centroidal_map,
  centroidal_rate,
  centroidal_derivatives,
};
inline constexpr int algorithm_count = 20;

/// A set of algorithms, as a bit each: Algorithm::rnea | Algorithm::mass_matrix.
class Algorithms {
 public:
  using enum Algorithm;
  constexpr Algorithms() = default;
  constexpr Algorithms(Algorithm one) : bits_(1U << static_cast<unsigned>(one)) {}  // NOLINT: meant to convert
  friend constexpr Algorithms operator|(Algorithms a, Algorithms b) {
    a.bits_ |= b.bits_;
    return a;
  }
  /// Whether any of the wanted ones is in the set.
  friend constexpr bool has(Algorithms set, Algorithms wanted) { return (set.bits_ & wanted.bits_) != 0; }
  constexpr bool empty() const { return bits_ == 0; }
  /// Calls use(algorithm) for each, in the order of the catalogue.
  template <class Use>
  constexpr void each(Use&& use) const {
    for (unsigned k = 0; k < algorithm_count; ++k)
      if (bits_ >> k & 1U) use(static_cast<Algorithm>(k));
  }

 private:
  std::uint32_t bits_ = 0;
};
constexpr Algorithms operator|(Algorithm a, Algorithm b) { return Algorithms(a) | Algorithms(b); }

/// A number of rows or columns: a constant, or one of the model's sizes.
enum class Extent : std::uint8_t { one, six, twelve, nv, joints, frames };

/// Sizes of a model; `joints` and `frames` count the world's, too.
struct ModelSizes {
  int nv, joints, frames;

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
    }
    return 0;
  }
};

/// One result.
struct AlgorithmOutput {
  const char* symbol = nullptr;  ///< null: there is none
  const char* key = nullptr;     ///< of `dyn compute`; null: not printed there
  Extent rows = Extent::one, columns = Extent::one;
};

/// The kind of pass over the model under which compute() counts an algorithm.
enum class Pass : std::uint8_t { kinematics, dynamics, inertias, derivatives };

/// One entry of the catalogue.
struct AlgorithmInfo {
  Algorithm algorithm;
  const char* function;               ///< its C++ name, which errors begin with
  const char* name;                   ///< of `dyn bench`; null: not measured there
  const char* traced;                 ///< of trace(); null: not traced
  std::array<const char*, 3> inputs;  ///< "q" first; "v"; "a" or "tau", or what single calls alone take ("frame", "fext"); null: no more
  Pass pass;
  Need need;            ///< of Data
  Need batch_need;      ///< of BatchData
  bool batched;         ///< a BatchData can run it
  bool varies = false;  ///< it reads how subspaces vary with q
  std::array<AlgorithmOutput, 4> outputs = {};

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
      {A::center_of_mass, "centerOfMass", nullptr, nullptr, {"q", "v", "a"}, Pass::kinematics, state, state, false},
      {A::energies, "computeKineticEnergy", nullptr, nullptr, {"q", "v"}, Pass::kinematics, state, state, false},
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
  }};
}();
consteval bool algorithmsAreInOrder() {
  for (std::size_t k = 0; k < algorithm_table.size(); ++k)
    if (algorithm_table[k].algorithm != static_cast<Algorithm>(k)) return false;
  return true;
}
static_assert(algorithmsAreInOrder());
}  // namespace detail

/// All entries, by Algorithm.
constexpr const std::array<AlgorithmInfo, algorithm_count>& algorithms() { return detail::algorithm_table; }
constexpr const AlgorithmInfo& info(Algorithm algorithm) { return detail::algorithm_table[static_cast<std::size_t>(algorithm)]; }

/// Whether it is about the centre of mass, which a model without mass does not have.
constexpr bool isCentroidal(Algorithm a) {
  return a == Algorithm::centroidal_map || a == Algorithm::centroidal_rate || a == Algorithm::centroidal_derivatives;
}

}  // namespace dyn
