// SPDX-License-Identifier: BSD-2-Clause
// Constraints with their names looked up, as the kernels and algorithms of constrained dynamics read them.
#pragma once

#include "compile/compact_impl.hpp"

#include <dyn/joint/registry.hpp>
#include <dyn/model/constraint.hpp>

#include <vector>

namespace dyn {

/// At most three directions. Component a of the k-th is [a][k]; it is 0 where there are fewer directions.
using Directions = double[3][4];

struct PackedFrameConstraint {
  int row = 0, rows = 0;
  int linear_rows = 0;  ///< how many rows are linear; they come first
  int body[2] = {0, 0};
  int frame[2] = {0, 0};     ///< the model's frames to which the constraint's own frames are fixed
  int common = 0;            ///< the last body that moves both bodies, or 0
  SE3<double> placement[2];  ///< of the constraint's frames, in the bodies' core frames
  std::array<bool, 6> free{};
  /// A degree of freedom that moves one of the frames, directly or through a dependent joint.
  struct Slot {
    int dof, user;  ///< index in the model; index in the user's coordinates, or -1 for a dependent joint
  };
  std::vector<Slot> slots;   ///< by dof
  std::vector<int> path[2];  ///< slots from each body to the world; within a joint the first degree of freedom comes first
  ConstraintAxes axes = ConstraintAxes::LOCAL;
  Mat3<double> own_axes;                 ///< these axes, in those of the body with which they turn, or of the world
  Directions linear = {}, angular = {};  ///< directions of the rows, in the same axes
  bool has_target = false;
  Baumgarte baumgarte;
  bool turnsFreely() const { return free[3] && free[4] && free[5]; }
  /// Whether the constraint holds a point in all directions. The rows then need only the point's acceleration, whatever the axes do.
  bool holdsPoint() const { return turnsFreely() && rows == 3; }
  /// Whether the required acceleration of the rows depends on their velocities, and not only on how fast the bodies turn.
  bool driftsWithVelocity() const {
    return baumgarte.velocity != 0 || body[1] != 0 || axes == ConstraintAxes::OTHER || (axes == ConstraintAxes::LOCAL && !holdsPoint());
  }
  /// Whether the force turns relative to the first body, or relative to a second one that moves. Derivatives of inverse dynamics do not cover this:
  /// they take external forces as fixed in a body's axes.
  bool forceTurns() const { return axes != ConstraintAxes::LOCAL || body[1] != 0; }
};

/// Calls use(row, direction) for each row of a constraint between frames, linear ones first. direction is 0 to 5, in the constraint's own axes.
template <class Use>
void eachDirection(const PackedFrameConstraint& c, Use&& use) {
  int row = c.row;
  for (int k = 0; k < 6; ++k)
    if (!c.free[static_cast<std::size_t>(k)]) use(row++, k);
}

/// One row: v_dependent - f'(q_master) v_master.
struct PackedJointCoupling {
  int row = 0;
  int body = 0, master = 0;
  const CouplingType* type = nullptr;
  std::vector<double> constants;
  Baumgarte baumgarte;
};

/// One row per degree of freedom of a body. A joint made of joints becomes several of these.
struct PackedJointLock {
  int row = 0, rows = 0;
  int body = 0;
  std::vector<double> configuration;  ///< nq, or empty
  Baumgarte baumgarte;
};

/// A body between a constraint and the world. Children are listed before parents.
struct ConstrainedBody {
  int body = 0;
  int chain = 0;
  int dof = 0;         ///< place of its first degree of freedom in PackedConstraints::dofs
  LaneSlot lane_slot;  ///< set where the model has lane groups
};
/// A degree of freedom of a lane group that belongs, in some lanes, to such bodies.
struct ConstrainedLaneGroupDof {
  int group_dof = 0;
  unsigned lanes = 0;                   ///< these lanes, one bit each
  std::int64_t dofs[group_lanes] = {};  ///< places in PackedConstraints::dofs
};
/// Neighbours in the list of bodies, each the parent of the one before. Rows act on them only through the first one.
struct ConstrainedChain {
  int begin = 0, end = 0;          ///< in the list of bodies
  int dof_begin = 0, dof_end = 0;  ///< in the list of their degrees of freedom
  int row_begin = 0, row_end = 0;  ///< rows that act on them are in this range
  int parent = -1;                 ///< the chain that begins with the last body's parent; -1: the world
  bool alone = true;               ///< no other chain on the same parent has any of these rows, nor has the parent chain's first body
  bool gathers = false;            ///< contributions of the chains on it are added up, because some of these chains are not alone
};

struct PackedConstraints {
  std::vector<ConstraintDescription> descriptions;
  std::vector<int> first_row;  ///< by description; the last entry is the number of rows
  std::vector<PackedFrameConstraint> frames;
  std::vector<PackedJointCoupling> couplings;
  std::vector<PackedJointLock> locks;
  std::vector<ConstrainedBody> bodies;
  std::vector<ConstrainedChain> chains;
  std::vector<ConstrainedLaneGroupDof> group_dofs;
  std::vector<int> dofs;     ///< degrees of freedom of these bodies: their numbers in the model
  std::vector<int> body_at;  ///< by body: its place in `bodies`, or -1
  int rows = 0;
  /// The chain of a listed body; -1 for the world.
  int chainOf(int body) const { return body > 0 ? bodies[static_cast<std::size_t>(body_at[static_cast<std::size_t>(body)])].chain : -1; }
  bool actsOnJoints() const { return !couplings.empty() || !locks.empty(); }
  bool gathers = false;              ///< ConstrainedChain::gathers for the chains on the world
  bool drift_with_velocity = false;  ///< whether some of the frames drift with velocity
};

/// Looks up constraints and appends them to those of `base`, if given, which must belong to the same model. `registry` is needed for couplings only.
/// Throws Error(model | argument | size | joint_type | parameter) that names the constraint or its place.
PackedConstraints packConstraints(const CompactModel& model, const std::vector<ConstraintDescription>& descriptions, const JointRegistry* registry,
                                  const PackedConstraints* base = nullptr);

/// Returns the constraints of a model whose frames may have moved: `before` has their former placements. Without a move these are the same
/// constraints.
std::shared_ptr<const PackedConstraints> withPlacedFrames(const CompactImpl& m, const SharedVector<SE3<double>>& before);

/// 8. Looks up the description's own constraints in the compiled model, and adds their line to the report.
void attachConstraints(const std::shared_ptr<CompactImpl>& compact, const std::vector<ConstraintDescription>& descriptions,
                       const JointRegistry& registry);

}  // namespace dyn
