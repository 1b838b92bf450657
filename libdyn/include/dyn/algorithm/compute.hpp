// Several quantities of one state at once: the union of the passes that they need, each once.
#pragma once

#include <dyn/algorithm/center_of_mass.hpp>
#include <dyn/data/data.hpp>

namespace dyn {

enum class Quantity : unsigned {
  placements = 1,
  velocities = 2,       ///< with placements
  accelerations = 4,    ///< with velocities
  joint_jacobians = 8,  ///< of all joints, WORLD; with placements
  center_of_mass = 16,  ///< with its velocity and acceleration where those of bodies are asked for
  energies = 32,
  rnea = 64,
  nle = 128,
  gravity = 256,
  mass_matrix = 512,
  minverse = 1024,
  coriolis = 2048,
  centroidal_map = 4096,
  centroidal_rate = 8192,
  rnea_derivatives = 16384,  ///< M comes with them
};
constexpr Quantity operator|(Quantity a, Quantity b) { return static_cast<Quantity>(static_cast<unsigned>(a) | static_cast<unsigned>(b)); }
/// Whether any of the wanted ones is in the set.
constexpr bool has(Quantity set, Quantity wanted) { return (static_cast<unsigned>(set) & static_cast<unsigned>(wanted)) != 0; }

/// Walks over the model that a call made.
struct Passes {
  int joints = 0;       ///< poses, subspaces and biases of all joints
  int subspaces = 0;    ///< derivatives of those that vary
  int kinematics = 0;   ///< placements, velocities, accelerations, Jacobians
  int dynamics = 0;     ///< Newton-Euler recursions, there and back
  int inertias = 0;     ///< composite or articulated inertias, there and back
  int derivatives = 0;  ///< the recursions of derivatives
};

/// What was asked for; views of the others are empty. Poses and motions are read by framePlacement, frameVelocity and their like.
struct Computed {
  Passes passes;
  CenterOfMass center_of_mass;
  double kinetic_energy = 0, potential_energy = 0;
  VectorResult tau{nullptr, 0}, nle{nullptr, 0}, gravity{nullptr, 0}, hg{nullptr, 0}, dhg{nullptr, 0};
  MatrixResult J{nullptr, 0, 0}, M{nullptr, 0, 0}, Minv{nullptr, 0, 0}, C{nullptr, 0, 0}, Ag{nullptr, 0, 0}, dAg{nullptr, 0, 0},
      dtau_dq{nullptr, 0, 0}, dtau_dv{nullptr, 0, 0};
};

namespace detail {
struct ComputedViews {
  Passes passes;
  CenterOfMass center_of_mass;
  double kinetic_energy = 0, potential_energy = 0;
  const double *tau = nullptr, *nle = nullptr, *gravity = nullptr, *hg = nullptr, *dhg = nullptr, *J = nullptr, *M = nullptr, *Minv = nullptr,
               *C = nullptr, *Ag = nullptr, *dAg = nullptr, *dtau_dq = nullptr, *dtau_dv = nullptr;
};
DYN_API ComputedViews compute(const CompactModel&, Data&, Quantity, VectorView q, VectorView v, VectorView a);
}  // namespace detail

/// Each as the function of its own gives it. Data must have what they need: Need::mass_matrix for M, Need::derivatives for minverse and
/// what follows it. Throws Error(size | argument | singular). Models with joints that follow others share no passes.
inline Computed compute(const CompactModel& model, Data& data, Quantity what, const VectorArg& q, const VectorArg& v, const VectorArg& a) {
  const detail::ComputedViews x = detail::compute(model, data, what, q, v, a);
  const int n = model.nv();
  const auto vector = [](const double* p, int size) { return VectorResult(p, p ? size : 0); };
  const auto matrix = [](const double* p, int rows, int cols) { return MatrixResult(p, p ? rows : 0, p ? cols : 0); };
  return {x.passes,
          x.center_of_mass,
          x.kinetic_energy,
          x.potential_energy,
          vector(x.tau, n),
          vector(x.nle, n),
          vector(x.gravity, n),
          vector(x.hg, 6),
          vector(x.dhg, 6),
          matrix(x.J, 6, n),
          matrix(x.M, n, n),
          matrix(x.Minv, n, n),
          matrix(x.C, n, n),
          matrix(x.Ag, 6, n),
          matrix(x.dAg, 6, n),
          matrix(x.dtau_dq, n, n),
          matrix(x.dtau_dv, n, n)};
}

}  // namespace dyn
