// What the recursions of constraints leave for the algorithms, and the other way.
#pragma once

#include "compile/constraints.hpp"
#include "kernels/workspace.hpp"

namespace dyn::kernels {

/// Of the first body of a chain, the only one that rows act on. In the aligned axes of its tree.
struct ChainState {
  Mat3<double> R = Mat3<double>::identity();  ///< the body's axes
  Vec3<double> w;                             ///< its angular velocity
  Vec3<double> lever;                         ///< its origin, from that of the body that the chain hangs on
  Motion<double> velocity;                    ///< of its origin, as far as the chain's own joints move it
  SE3<double> tree;                           ///< the aligned axes in the world, and where they are
  Motion<double> acceleration;                ///< classical, of its origin
};

/// Arrays of one number a row of the constraints, `stride` numbers long: a multiple of the widest pack's.
struct ConstraintWorkspace {
  std::ptrdiff_t stride = 0;
  ChainState* chains = nullptr;
  ChainState world;
  double* force = nullptr;     ///< see forceOf
  double* share = nullptr;     ///< one a degree of freedom of these bodies
  double* free = nullptr;      ///< acceleration of each row without constraint forces, from the sweep
  double* bound = nullptr;     ///< what the diagonal of the Delassus matrix could be if nothing cancelled and no lever lay along its force
  double* delassus = nullptr;  ///< rows of the matrix
  double* scaled = nullptr;    ///< the shares over the degrees of freedom's pivots
  double* inverse = nullptr;   ///< rows of its inverse
  double* column = nullptr;    ///< scratch of two rows
  double* motion = nullptr;    ///< one number a degree of freedom of these bodies: acceleration

  /// Of a force on the first body of a chain: about its joint's origin, aligned axes; last its reach, the square of the moment that it would have
  /// if all levers on its way stood square to it. Numbers of `widest` rows lie together, a component after the other.
  static constexpr int components = 7, reach = 6, widest = 8;
  double* forceOf(int chain, int row) const { return force + (chain * stride + row / widest * widest) * components + row % widest; }
  const ChainState& stateOf(const PackedConstraints& c, int body) const { return body > 0 ? chains[c.chainOf(body)] : world; }
  double* shareOf(int dof) const { return share + dof * stride; }
  double* scaledOf(int dof) const { return scaled + dof * stride; }
};

inline void carve(ConstraintWorkspace& x, const PackedConstraints& c, Arena& arena) {
  constexpr int widest = ConstraintWorkspace::widest;
  x.stride = (c.rows + widest - 1) / widest * widest;
  const auto stride = static_cast<std::size_t>(x.stride);
  arena.take(x.chains, c.chains.size());
  arena.take(x.force, ConstraintWorkspace::components * stride * c.chains.size());
  arena.take(x.share, stride * c.dofs.size());
  arena.take(x.free, stride);
  arena.take(x.bound, stride);
  arena.take(x.delassus, stride * static_cast<std::size_t>(c.rows));
  arena.take(x.scaled, stride * c.dofs.size());
  arena.take(x.inverse, stride * static_cast<std::size_t>(c.rows));
  arena.take(x.column, 2 * stride);
  arena.take(x.motion, c.dofs.size());
}

}  // namespace dyn::kernels
