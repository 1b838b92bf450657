// SPDX-License-Identifier: BSD-2-Clause
// The memory that the recursions of constraints and the algorithms of constrained dynamics share.
#pragma once

#include "compile/constraints.hpp"
#include "kernels/body/workspace.hpp"

#include <algorithm>

namespace dyn::kernels {

// The structs here hold the numbers of one state (T is double), or those of several states in packs T. `Basic...<double>` has a name of its own.

/// The state of a chain's first body, the only one of the chain that rows act on, in the aligned axes of its tree.
template <class T>
struct BasicChainState {
  Mat3<T> R = Mat3<T>::identity();  ///< the body's axes
  Vec3<T> w;                        ///< its angular velocity
  Vec3<T> arm;                      ///< to its origin from that of the body that the chain hangs on
  Motion<T> velocity;               ///< of its origin, due to the chain's own joints
  SE3<T> tree;                      ///< pose of the tree's aligned frame in the world
  Motion<T> acceleration;           ///< classical, of its origin
};
using ChainState = BasicChainState<double>;

template <class S>
Motion<S> turnedBack(const Mat3<S>& R, const Motion<S>& x) {
  return {transposeTimes(R, x.linear), transposeTimes(R, x.angular)};
}

/// RowRates says which rates of the rows are wanted. none: the bodies are at rest. drift: the terms of the rows' accelerations, for
/// constraints where these do not depend on the rows' velocities. velocities: all.
enum class RowRates { none, drift, velocities };

/// The state of one constraint between frames, in the aligned axes of the first body's tree unless a member says otherwise.
template <class T>
struct BasicFrameRows {
  Mat3<T> base;                   ///< the axes with which the constraint's axes turn
  T linear[3][4], angular[3][4];  ///< Directions of the rows; the linear rows come first
  Vec3<T> arm[2];                 ///< from each body's origin to the constraint's; that of the second body is in the axes of its own tree
  Mat3<T> turn;                   ///< from the axes of the first body's tree to those of the second's; to the world's axes if that is the world
  Motion<T> relative;             ///< velocity of the first body's point at the constraint's origin, as seen from the second body
  Vec3<T> w[2];                   ///< angular velocities
  Motion<T> error;                ///< zero for constraints without a target
};
using FrameRows = BasicFrameRows<double>;

/// One number a row, with room for a pack. The accelerations come on top of those that the sweep finds.
template <class T>
struct BasicRowMotion {
  T* bias;   ///< acceleration due to velocities
  T* drift;  ///< the same, plus the Baumgarte feedback of velocity and error
  T* fall;   ///< gravity, where one body is the world: the sweep accelerates the world by -gravity instead
  T* velocity;
  T* error;  ///< of position
};
using RowMotion = BasicRowMotion<double>;

/// Arrays of one number a row. Packs begin at any row: after the last row there is room for the widest pack, which holds zeros.
template <class T>
struct BasicConstraintWorkspace {
  using Number = T;
  std::ptrdiff_t stride = 0;  ///< of matrices: a multiple of the widest pack's
  std::ptrdiff_t room = 0;    ///< that and a pack more
  BasicChainState<T>* chains = nullptr;
  BasicChainState<T> world;
  T* force = nullptr;       ///< see forceOf
  T* projection = nullptr;  ///< y: an array for each degree of freedom of the constraints' bodies
  T* carried = nullptr;     ///< acceleration of each row due to velocities and gravity, without the response of degrees of freedom
  T* bound = nullptr;       ///< the diagonal of the Delassus matrix if nothing cancelled and each moment arm were perpendicular to its force
  T* delassus = nullptr;    ///< rows of the matrix
  T* scaled = nullptr;      ///< y / D, D the pivot of the degree of freedom
  T* response = nullptr;    ///< y of ABA of each of these degrees of freedom, plus the responses to the rows' forces
  T* inverse = nullptr;     ///< rows of the inverse
  T* column = nullptr;      ///< scratch of two rows

  static constexpr int widest = 8;
  static constexpr std::ptrdiff_t wholePacks(int rows) { return (rows + widest - 1) & -widest; }

  /// The rows' unit forces on the first body of a chain, about its joint's origin, in aligned axes: `components` arrays of one number for each of the
  /// chain's rows, forceStep() apart. After the six components of the force come its reach, which is the square of its moment if every moment arm on
  /// its path were perpendicular to it, and the parts of `carried` and `bound` from chains below. Each sweep writes the same places anew; a chain
  /// that gathers starts from zeros. All other places stay zero, also those behind the last row, which packs read.
  static constexpr int components = 9, reach = 6, carried_below = 7, bound_below = 8;
  T* forceOf(int chain) const { return force + chain * components * room; }
  /// A pack of four that begins at a row of the chain fits into one component.
  static std::ptrdiff_t forceStep(const ConstrainedChain& chain) { return wholePacks(chain.row_end - chain.row_begin + 3); }
  const BasicChainState<T>& stateOf(const PackedConstraints& c, int body) const { return body > 0 ? chains[c.chainOf(body)] : world; }
  T* projectionOf(int dof) const { return projection + dof * room; }
  T* scaledOf(int dof) const { return scaled + dof * room; }
};

using ConstraintWorkspace = BasicConstraintWorkspace<double>;

/// The Delassus matrix of so many rows and the bounds of its pivots.
template <class T>
void layOutDelassus(BasicConstraintWorkspace<T>& x, int count, Arena& arena) {
  constexpr int widest = BasicConstraintWorkspace<T>::widest;
  x.stride = x.wholePacks(count);
  x.room = x.stride + widest;
  const auto stride = static_cast<std::size_t>(x.stride);
  // The matrix is completed by mirroring squares, so it has at least the rows of one square.
  const auto rows = static_cast<std::size_t>(std::max(count, widest));
  arena.take(x.bound, static_cast<std::size_t>(x.room));
  arena.take(x.delassus, stride * rows + widest);
  arena.take(x.inverse, stride * rows);
  arena.take(x.column, 2 * stride);
}
template <class T>
void layOut(BasicConstraintWorkspace<T>& x, const PackedConstraints& c, Arena& arena) {
  layOutDelassus(x, c.rows, arena);
  const auto room = static_cast<std::size_t>(x.room);
  arena.take(x.chains, c.chains.size());
  arena.take(x.force, x.components * room * c.chains.size() + x.widest);
  arena.take(x.projection, room * c.dofs.size());
  arena.take(x.carried, room);
  arena.take(x.scaled, room * c.dofs.size());
  arena.take(x.response, c.dofs.size());
}

}  // namespace dyn::kernels
