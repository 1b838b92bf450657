// SPDX-License-Identifier: BSD-2-Clause
// Several quantities of one state at once. Each pass that they need runs only once.
#pragma once

#include <dyn/algorithm/center_of_mass.hpp>
#include <dyn/catalogue/algorithm.hpp>
#include <dyn/data/data.hpp>

#include <array>

namespace dyn {

/// A set of algorithms whose results compute() returns, for example Quantity::rnea | Quantity::mass_matrix.
using Quantity = Algorithms;

/// How many passes over the model a call made, by kind.
struct Passes {
  int joints = 0;       ///< poses, subspaces and biases of all joints
  int subspaces = 0;    ///< derivatives of subspaces that vary with q
  int kinematics = 0;   ///< placements, velocities, accelerations, Jacobians
  int dynamics = 0;     ///< Newton-Euler recursions, outward and inward
  int inertias = 0;     ///< composite or articulated inertias, with the sweeps that use them
  int derivatives = 0;  ///< the recursions of derivatives
};

/// The quantities that were asked for; views of the others are empty. Vectors and matrices are views of memory that the Data owns. Read poses and
/// motions with framePlacement, frameVelocity and the like.
struct Computed {
  Passes passes;                  ///< passes over the model that the call made
  CenterOfMass center_of_mass;    ///< its velocity and acceleration too, where those of bodies were asked for
  double kinetic_energy = 0,      ///< [J], if energies were asked for
      potential_energy = 0;       ///< likewise
  VectorResult tau{nullptr, 0},   ///< of rnea, nv [N m, N]
      nle{nullptr, 0},            ///< of nle, nv [N m, N]
      gravity{nullptr, 0},        ///< of gravity, nv [N m, N]
      hg{nullptr, 0},             ///< momentum, of centroidal_map or centroidal_rate, 6 [kg m/s, kg m^2/s]
      dhg{nullptr, 0};            ///< its rate, of centroidal_rate, 6 [N, N m]
  MatrixResult J{nullptr, 0, 0},  ///< of joint_jacobians, 6 x nv
      M{nullptr, 0, 0},           ///< of mass_matrix or rnea_derivatives, nv x nv
      Minv{nullptr, 0, 0},        ///< of minverse, nv x nv
      C{nullptr, 0, 0},           ///< of coriolis, nv x nv
      Ag{nullptr, 0, 0},          ///< of centroidal_map or centroidal_rate, 6 x nv
      dAg{nullptr, 0, 0},         ///< of centroidal_rate, 6 x nv
      dtau_dq{nullptr, 0, 0},     ///< of rnea_derivatives, nv x nv
      dtau_dv{nullptr, 0, 0};     ///< of rnea_derivatives, nv x nv
};

namespace detail {
/// Pointers to the first number of each result of an algorithm, in the order of the catalogue; null where there is no result.
struct AlgorithmViews {
  const double* results[4] = {};
  AlgorithmViews(const double* first = nullptr, const double* second = nullptr, const double* third = nullptr, const double* fourth = nullptr)
      : results{first, second, third, fourth} {}
};
struct ComputedViews {
  Passes passes;
  CenterOfMass center_of_mass;
  double kinetic_energy = 0, potential_energy = 0;
  std::array<AlgorithmViews, algorithm_count> results;

  AlgorithmViews& operator[](Algorithm algorithm) { return results[static_cast<std::size_t>(algorithm)]; }
};
DYN_API ComputedViews compute(const CompactModel&, Data&, Algorithms, VectorView q, VectorView v, VectorView a);
/// `a` is tau for forward dynamics. Throws Error(argument) for algorithms that read anything else.
DYN_API AlgorithmViews runAlgorithm(const CompactModel&, Data&, Algorithm, VectorView q, VectorView v, VectorView a);
}  // namespace detail

/// The results of runAlgorithm(). results(k) is output k of info(algorithm), a view of memory that the Data owns.
class AlgorithmResults {
 public:
  /// Wraps the views that `algorithm` has written; runAlgorithm() calls it.
  AlgorithmResults(const CompactModel& model, Algorithm algorithm, const detail::AlgorithmViews& views)
      : algorithm_(algorithm), model_(&model), views_(views) {}
  /// Returns output k with the rows and columns of info(algorithm).outputs[k]. Poses and motions are read by framePlacement and the like: empty here.
  MatrixResult operator()(std::size_t k) const {
    const AlgorithmOutput& output = info(algorithm_).outputs[k];
    const double* const first = views_.results[k];
    if (first == nullptr) return {nullptr, 0, 0};
    const ModelSizes sizes{model_->nv(), model_->njoints(), static_cast<int>(model_->frames().size())};
    return {first, sizes.of(output.rows), sizes.of(output.columns)};
  }

 private:
  Algorithm algorithm_;
  const CompactModel* model_;
  detail::AlgorithmViews views_;
};
/// Runs one algorithm of the catalogue, for programs that loop over the catalogue. For aba and its derivatives, `a` is tau. Vectors that the
/// algorithm does not read are ignored. Throws what the algorithm's own function throws. Throws Error(argument) for
/// algorithms that read more than q, v and a or tau.
inline AlgorithmResults runAlgorithm(const CompactModel& model, Data& data, Algorithm algorithm, const VectorArg& q, const VectorArg& v,
                                     const VectorArg& a) {
  return {model, algorithm, detail::runAlgorithm(model, data, algorithm, q, v, a)};
}

/// Computes each quantity in `what` as its own function does. Data must have been made with the need of each, info(algorithm).need. Throws
/// Error(size | argument | singular); Error(argument) also for algorithms that read more than q, v and a. With dependent joints the quantities share
/// no passes, and joint_jacobians throws Error(argument).
inline Computed compute(const CompactModel& model, Data& data, Algorithms what, const VectorArg& q, const VectorArg& v, const VectorArg& a) {
  detail::ComputedViews x = detail::compute(model, data, what, q, v, a);
  const int n = model.nv();
  const auto vector = [&](Algorithm algorithm, std::size_t k, int size) {
    const double* const p = x[algorithm].results[k];
    return VectorResult(p, p ? size : 0);
  };
  const auto matrix = [&](Algorithm algorithm, std::size_t k, int rows) {
    const double* const p = x[algorithm].results[k];
    return MatrixResult(p, p ? rows : 0, p ? n : 0);
  };
  // Some results come with those of another algorithm.
  const bool rate = has(what, Quantity::centroidal_rate), derived = has(what, Quantity::rnea_derivatives);
  const Algorithm momentum = rate ? Quantity::centroidal_rate : Quantity::centroidal_map;
  return {x.passes,
          x.center_of_mass,
          x.kinetic_energy,
          x.potential_energy,
          vector(Quantity::rnea, 0, n),
          vector(Quantity::nle, 0, n),
          vector(Quantity::gravity, 0, n),
          vector(momentum, 0, 6),
          vector(Quantity::centroidal_rate, 1, 6),
          matrix(Quantity::joint_jacobians, 0, 6),
          derived ? matrix(Quantity::rnea_derivatives, 2, n) : matrix(Quantity::mass_matrix, 0, n),
          matrix(Quantity::minverse, 0, n),
          matrix(Quantity::coriolis, 0, n),
          matrix(momentum, rate ? 2 : 1, 6),
          matrix(Quantity::centroidal_rate, 3, 6),
          matrix(Quantity::rnea_derivatives, 0, n),
          matrix(Quantity::rnea_derivatives, 1, n)};
}

}  // namespace dyn
