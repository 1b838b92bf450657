// SPDX-License-Identifier: BSD-2-Clause
// The memory that the recursions of constraints and the algorithms of constrained dynamics share.
#pragma once

#include "compile/constraints.hpp"
#include "kernels/body/workspace.hpp"

#include <algorithm>

namespace dyn::kernels {

/// The state of a chain's first body, the only one of the chain that rows act on, in the aligned axes of its tree.
struct ChainState {
  Mat3<double> R = Mat3<double>::identity();  ///< the body's axes
  Vec3<double> w;                             ///< its angular velocity
  Vec3<double> arm;                           ///< to its origin from that of the body that the chain hangs on
  Motion<double> velocity;                    ///< of its origin, due to the chain's own joints
  SE3<double> tree;                           ///< pose of the tree's aligned frame in the world
  Motion<double> acceleration;                ///< classical, of its origin
};

template <class S>
Motion<S> turnedBack(const Mat3<S>& R, const Motion<S>& x) {
  return {transposeTimes(R, x.linear), transposeTimes(R, x.angular)};
}

/// RowRates says which rates of the rows are wanted. none: the bodies are at rest. drift: the terms of the rows' accelerations, for
/// constraints where these do not depend on the rows' velocities. velocities: all.
enum class RowRates { none, drift, velocities };

/// The state of one constraint between frames, in the aligned axes of the first body's tree unless a member says otherwise.
struct FrameRows {
  Mat3<double> base;           ///< the axes with which the constraint's axes turn
  Directions linear, angular;  ///< of the rows; the linear rows come first
  Vec3<double> arm[2];         ///< from each body's origin to the constraint's; that of the second body is in the axes of its own tree
  Mat3<double> turn;           ///< from the axes of the first body's tree to those of the second's; to the world's axes if that is the world
  Motion<double> relative;     ///< velocity of the first body's point at the constraint's origin, as seen from the second body
  Vec3<double> w[2];           ///< angular velocities
  Motion<double> error;        ///< zero for constraints without a target
};

/// One number a row, with room for a pack. The accelerations come on top of those that the sweep finds.
struct RowMotion {
  double* bias;   ///< acceleration due to velocities
  double* drift;  ///< the same, plus the Baumgarte feedback of velocity and error
  double* fall;   ///< gravity, where one body is the world: the sweep accelerates the world by -gravity instead
  double* velocity;
  double* error;  ///< of position
};

/// Arrays of one number a row. Packs begin at any row: after the last row there is room for the widest pack, which holds zeros.
struct ConstraintWorkspace {
  std::ptrdiff_t stride = 0;  ///< of matrices: a multiple of the widest pack's
  std::ptrdiff_t room = 0;    ///< that and a pack more
  ChainState* chains = nullptr;
  ChainState world;
  double* force = nullptr;       ///< see forceOf
  double* projection = nullptr;  ///< y: an array for each degree of freedom of the constraints' bodies
  double* carried = nullptr;     ///< acceleration of each row due to velocities and gravity, without the response of degrees of freedom
  double* bound = nullptr;       ///< the diagonal of the Delassus matrix if nothing cancelled and each moment arm were perpendicular to its force
  double* delassus = nullptr;    ///< rows of the matrix
  double* scaled = nullptr;      ///< y / D, D the pivot of the degree of freedom
  double* response = nullptr;    ///< y of ABA of each of these degrees of freedom, plus the responses to the rows' forces
  double* inverse = nullptr;     ///< rows of the inverse
  double* column = nullptr;      ///< scratch of two rows

  static constexpr int widest = 8;
  static constexpr std::ptrdiff_t wholePacks(int rows) { return (rows + widest - 1) & -widest; }

  /// The rows' unit forces on the first body of a chain, about its joint's origin, in aligned axes: `components` arrays of one number for each of the
  /// chain's rows, forceStep() apart. After the six components of the force come its reach, which is the square of its moment if every moment arm on
  /// its path were perpendicular to it, and the parts of `carried` and `bound` from chains below. Each sweep writes the same places anew; a chain
  /// that gathers starts from zeros. All other places stay zero, also those behind the last row, which packs read.
  static constexpr int components = 9, reach = 6, carried_below = 7, bound_below = 8;
  double* forceOf(int chain) const { return force + chain * components * room; }
  /// A pack of four that begins at a row of the chain fits into one component.
  static std::ptrdiff_t forceStep(const ConstrainedChain& chain) { return wholePacks(chain.row_end - chain.row_begin + 3); }
  const ChainState& stateOf(const PackedConstraints& c, int body) const { return body > 0 ? chains[c.chainOf(body)] : world; }
  double* projectionOf(int dof) const { return projection + dof * room; }
  double* scaledOf(int dof) const { return scaled + dof * room; }
};

inline void layOut(ConstraintWorkspace& x, const PackedConstraints& c, Arena& arena) {
  constexpr int widest = ConstraintWorkspace::widest;
  x.stride = ConstraintWorkspace::wholePacks(c.rows);
  x.room = x.stride + widest;
  const auto stride = static_cast<std::size_t>(x.stride), room = static_cast<std::size_t>(x.room);
  // The matrix is completed by mirroring squares, so it has at least the rows of one square.
  const auto rows = static_cast<std::size_t>(std::max(c.rows, widest));
  arena.take(x.chains, c.chains.size());
  arena.take(x.force, ConstraintWorkspace::components * room * c.chains.size() + widest);
  arena.take(x.projection, room * c.dofs.size());
  arena.take(x.carried, room);
  arena.take(x.bound, room);
  arena.take(x.delassus, stride * rows + widest);
  arena.take(x.scaled, room * c.dofs.size());
  arena.take(x.response, c.dofs.size());
  arena.take(x.inverse, stride * rows);
  arena.take(x.column, 2 * stride);
}

}  // namespace dyn::kernels
