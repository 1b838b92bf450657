// Constraints with their names looked up: what the kernels and algorithms of constrained dynamics read.
#pragma once

#include "compile/compact_impl.hpp"

#include <dyn/joint/registry.hpp>
#include <dyn/model/constraint.hpp>

#include <vector>

namespace dyn {

/// Component a of the k-th of at most three directions: [a][k]; 0 where there are fewer.
using Directions = double[3][4];

struct PackedFrameConstraint {
  int row = 0, rows = 0;
  int linear_rows = 0;  ///< the first of them
  int body[2] = {0, 0};
  int common = 0;            ///< the last body that moves both, or 0
  SE3<double> placement[2];  ///< of the constraint's frames, in the bodies' core frames
  std::array<bool, 6> free{};
  /// A degree of freedom that moves one of the frames, itself or what follows it.
  struct Slot {
    int dof, user;  ///< in the model; as the user counts, or -1 for followers
  };
  std::vector<Slot> slots;   ///< by dof
  std::vector<int> path[2];  ///< slots from each body to the world, joint by joint the first degree of freedom first
  ConstraintAxes axes = ConstraintAxes::LOCAL;
  Mat3<double> own_axes;                 ///< these, in the axes of the body that they turn with; of the world where they do not
  Directions linear = {}, angular = {};  ///< of the rows, likewise
  bool has_target = false;
  Baumgarte baumgarte;
  bool turnsFreely() const { return free[3] && free[4] && free[5]; }
  /// A point that cannot move at all is held by its own acceleration, whatever its axes do.
  bool holdsPoint() const { return turnsFreely() && rows == 3; }
  /// Whether the acceleration that is wanted of the rows depends on their velocities, and not only on how fast the bodies turn.
  bool driftsWithVelocity() const {
    return baumgarte.velocity != 0 || body[1] != 0 || axes == ConstraintAxes::OTHER || (axes == ConstraintAxes::LOCAL && !holdsPoint());
  }
  /// Against the first body, or against a second one that moves: not as external forces do, which derivatives of inverse dynamics carry.
  bool forceTurns() const { return axes != ConstraintAxes::LOCAL || body[1] != 0; }
};

/// The direction of each row of a constraint between frames, linear ones first, in its own axes: use(row, 0 to 5).
template <class Use>
void eachDirection(const PackedFrameConstraint& c, Use&& use) {
  int row = c.row;
  for (int k = 0; k < 6; ++k)
    if (!c.free[static_cast<std::size_t>(k)]) use(row++, k);
}

/// One row: v_follower - f'(q_master) v_master.
struct PackedJointCoupling {
  int row = 0;
  int body = 0, master = 0;
  const CouplingType* type = nullptr;
  std::vector<double> constants;
  Baumgarte baumgarte;
};

/// A row a degree of freedom of a body; joints made of joints are several of these.
struct PackedJointLock {
  int row = 0, rows = 0;
  int body = 0;
  std::vector<double> configuration;  ///< nq, or empty
  Baumgarte baumgarte;
};

/// A body between a constraint and the world, children before parents.
struct ConstrainedBody {
  int body = 0;
  int chain = 0;
  int dof = 0;  ///< place of its first degree of freedom among those of the list
  Seat seat;    ///< where the model has strips
};
/// A strip's degree of freedom that some of these bodies have in its lanes.
struct ConstrainedStripDof {
  int strip_dof = 0;
  unsigned lanes = 0;                   ///< theirs, a bit each
  std::int64_t dofs[strip_lanes] = {};  ///< places among the degrees of freedom of the list
};
/// Neighbours in that list, each the parent of the one before, of which no row acts on any but through the first.
struct ConstrainedChain {
  int begin = 0, end = 0;          ///< in the list of bodies
  int dof_begin = 0, dof_end = 0;  ///< in that of their degrees of freedom
  int row_begin = 0, row_end = 0;  ///< rows that act on them are among these
  int parent = -1;                 ///< the chain that the last one's parent begins; -1: the world
  bool alone = true;               ///< in these rows: no other chain that hangs on the same parent has any of them, nor has the parent's first body
  bool gathers = false;            ///< what chains that hang on it hand over adds up: some of these are not alone
};

struct PackedConstraints {
  std::vector<ConstraintDescription> descriptions;
  std::vector<int> first_row;  ///< by description, and the number of rows at the end
  std::vector<PackedFrameConstraint> frames;
  std::vector<PackedJointCoupling> couplings;
  std::vector<PackedJointLock> locks;
  std::vector<ConstrainedBody> bodies;
  std::vector<ConstrainedChain> chains;
  std::vector<ConstrainedStripDof> strip_dofs;
  std::vector<int> dofs;     ///< of these bodies: number in the model
  std::vector<int> body_at;  ///< by body: its place in `bodies`, or -1
  int rows = 0;
  /// -1: the world.
  int chainOf(int body) const { return body > 0 ? bodies[static_cast<std::size_t>(body_at[static_cast<std::size_t>(body)])].chain : -1; }
  bool actsOnJoints() const { return !couplings.empty() || !locks.empty(); }
  bool gathers = false;              ///< of chains that hang on the world, as ConstrainedChain::gathers
  bool drift_with_velocity = false;  ///< some of the frames
};

/// After those of `base`, which are of the same model and as they were looked up, if there are any. `registry` is needed for couplings only.
/// Throws Error(model | argument | joint_type | parameter), naming the constraint.
PackedConstraints packConstraints(const CompactModel& model, const std::vector<ConstraintDescription>& descriptions, const JointRegistry* registry,
                                  const PackedConstraints* base = nullptr);

/// 7. The description's own constraints, looked up in what became of it, with their line in the report.
void attachConstraints(const std::shared_ptr<CompactImpl>& compact, const std::vector<ConstraintDescription>& descriptions,
                       const JointRegistry& registry);

}  // namespace dyn
