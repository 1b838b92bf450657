// What the recursions of constraints leave for the algorithms, and the other way.
#pragma once

#include "compile/constraints.hpp"
#include "kernels/workspace.hpp"

#include <algorithm>

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

template <class S>
Motion<S> turnedBack(const Mat3<S>& R, const Motion<S>& x) {
  return {transposeTimes(R, x.linear), transposeTimes(R, x.angular)};
}

/// What of bodies' motion is wanted of rows: nothing, at rest; what their acceleration is made of, where they drift without velocities; all.
enum class RowRates { none, drift, velocities };

/// Of one constraint between frames, in the aligned axes of the first one's tree unless it says otherwise. Relative: as seen from the second
/// body, of the point of the first that is the constraint's origin.
struct FrameRows {
  Mat3<double> base;           ///< the axes that those of the constraint turn with
  Directions linear, angular;  ///< of its rows: the linear ones come first
  Vec3<double> lever[2];       ///< from each body's origin to the constraint's; of the second body in the axes of its own tree
  Mat3<double> turn;           ///< axes of the second body's tree from those of the first's; for the world, its axes
  Motion<double> relative;     ///< velocity
  Vec3<double> w[2];           ///< angular velocities
  Motion<double> error;        ///< zero for constraints without a target
};

/// Of each row, with room for a pack. Accelerations are beside what the sweep finds.
struct RowMotion {
  double* bias;   ///< acceleration that velocities make
  double* drift;  ///< the same with what is fed back of the velocity and of the error
  double* fall;   ///< acceleration that gravity makes where the sweep had the world fall up
  double* velocity;
  double* error;  ///< of position
};

/// Arrays of one number a row of the constraints. Packs begin at any row: after the last one there is room for the widest, with zeros in it.
struct ConstraintWorkspace {
  std::ptrdiff_t stride = 0;  ///< of matrices: a multiple of the widest pack's
  std::ptrdiff_t room = 0;    ///< that and a pack more
  ChainState* chains = nullptr;
  ChainState world;
  double* force = nullptr;     ///< see forceOf
  double* share = nullptr;     ///< one a degree of freedom of these bodies
  double* carried = nullptr;   ///< acceleration of each row, of velocities and of gravity, beside what degrees of freedom yield
  double* bound = nullptr;     ///< what the diagonal of the Delassus matrix could be if nothing cancelled and no lever lay along its force
  double* delassus = nullptr;  ///< rows of the matrix
  double* scaled = nullptr;    ///< the shares over the degrees of freedom's pivots
  double* yielded = nullptr;   ///< what each of these degrees of freedom yields, by itself and to forces of the rows
  double* inverse = nullptr;   ///< rows of its inverse
  double* column = nullptr;    ///< scratch of two rows

  static constexpr int widest = 8;
  static constexpr std::ptrdiff_t wholePacks(int rows) { return (rows + widest - 1) & -widest; }

  /// Of forces on the first body of a chain, about its joint's origin, aligned axes: `components` arrays of one number for each of the chain's
  /// rows, forceStep() apart. After the forces come their reach, the square of the moment that a force would have if all levers on its way
  /// stood square to it, and what chains below have added to `carried` and `bound`. The same numbers are written each time, but where a chain
  /// gathers, which begins with zeros; the others, and those behind the last row, which packs read, stay zero.
  static constexpr int components = 9, reach = 6, carried_below = 7, bound_below = 8;
  double* forceOf(int chain) const { return force + chain * components * room; }
  /// A pack of four that begins at a row of the chain is written to one component only.
  static std::ptrdiff_t forceStep(const ConstrainedChain& chain) { return wholePacks(chain.row_end - chain.row_begin + 3); }
  const ChainState& stateOf(const PackedConstraints& c, int body) const { return body > 0 ? chains[c.chainOf(body)] : world; }
  double* shareOf(int dof) const { return share + dof * room; }
  double* scaledOf(int dof) const { return scaled + dof * room; }
};

inline void carve(ConstraintWorkspace& x, const PackedConstraints& c, Arena& arena) {
  constexpr int widest = ConstraintWorkspace::widest;
  x.stride = ConstraintWorkspace::wholePacks(c.rows);
  x.room = x.stride + widest;
  const auto stride = static_cast<std::size_t>(x.stride), room = static_cast<std::size_t>(x.room);
  // Mirrored in squares, of which one is the least.
  const auto rows = static_cast<std::size_t>(std::max(c.rows, widest));
  arena.take(x.chains, c.chains.size());
  arena.take(x.force, ConstraintWorkspace::components * room * c.chains.size() + widest);
  arena.take(x.share, room * c.dofs.size());
  arena.take(x.carried, room);
  arena.take(x.bound, room);
  arena.take(x.delassus, stride * rows + widest);
  arena.take(x.scaled, room * c.dofs.size());
  arena.take(x.yielded, c.dofs.size());
  arena.take(x.inverse, stride * rows);
  arena.take(x.column, 2 * stride);
}

}  // namespace dyn::kernels
