// SPDX-License-Identifier: BSD-2-Clause
// Lane groups: joints of one type that advance together, one in each lane of a pack.
#pragma once

#include "compile/shared_vector.hpp"

#include <dyn/joint/shape.hpp>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace dyn {

struct CompactImpl;

constexpr int group_lanes = 4;

/// Memory aligned for packs of every width.
class PackMemory {
 public:
  static constexpr std::size_t alignment = 64;
  PackMemory() : PackMemory(0) {}
  explicit PackMemory(std::size_t bytes);
  PackMemory(const PackMemory& other);
  PackMemory(PackMemory&&) noexcept = default;
  PackMemory& operator=(const PackMemory&) = delete;
  PackMemory& operator=(PackMemory&&) noexcept = default;
  char* data() const { return data_; }
  std::size_t bytes() const { return bytes_; }

 private:
  std::size_t bytes_;
  std::unique_ptr<char[]> block_;
  char* data_;
};

/// A body's place in the lanes. The world is in all lanes.
struct LaneSlot {
  int group = 0, lane = 0;
  unsigned lanes = 0;  ///< the lanes with this body or its mirror image, one bit each
  int group_dof = 0;   ///< the lane group's first degree of freedom
};

/// Some lanes of a lane group, and the lane group with their parents.
struct LaneGroupParents {
  int group = 0;
  int lane = -1;       ///< lane of the one parent of all these lanes; -1: each has its parent in its own lane
  unsigned lanes = 0;  ///< one bit each
  unsigned given = 0;  ///< the lanes whose bodies add something to their parents
  bool first = false;  ///< these lanes are the first to hand anything to that lane group, when children come before parents
};
/// Where one lane finds its parent.
struct LaneParent {
  int group = 0, lane = 0;
  bool given = false;  ///< whether its body adds something to the parent
};

/// Up to four bodies. A lane without a body of its own may mirror the body of another lane. Limbs on that body then find their parent in their own
/// lane, and the mirrored body moves as the original does. Where limbs branch, one lane has the body's inertia, and each of the lanes takes the sum
/// of all. Above, along a trunk that is mirrored as a whole, every lane has the whole inertia. Lanes without a body or mirrored body have some other
/// body's pose, and their results are not used.
struct LaneGroup {
  int body[group_lanes] = {-1, -1, -1, -1};
  int shows[group_lanes] = {-1, -1, -1, -1};  ///< the body, or the mirrored body
  unsigned united[2] = {0, 0};                ///< lanes with the same body, on which limbs of several lanes hang; one bit each
  LaneGroupParents parents[group_lanes];      ///< of lanes with a body and of those that mirror one
  int parents_count = 0;
  bool same_lanes = true;  ///< there is one entry in `parents`, and each lane has its parent in the same lane, or the world
  bool gives_all = true;   ///< the same, and every lane hands something over
  bool apart = false;      ///< there are many parents, so lanes are read and written one by one
  LaneParent lane_parents[group_lanes];
  unsigned bodies = 0;                    ///< lanes with a body of their own
  unsigned root_paths[group_lanes] = {};  ///< these by root path: lanes that go through the same lane groups until they meet
  int depth = 0;
  bool leaf = true;  ///< it is no lane group's parent
  int batch = 0, slot = 0;
  int dof = 0;  ///< index of its first degree of freedom; each has four numbers
  Shape shape = Shape::dense;
  int nv = 0;
};

/// Consecutive lane groups of one shape.
struct LaneGroupRun {
  int first = 0, end = 0;
  Shape shape = Shape::dense;
  int nv = 0;
};

struct LaneGroupBatch {
  int slots = 0;                               ///< number of lane groups
  std::vector<int> bodies;                     ///< four per slot: the bodies whose poses the lanes have
  std::vector<double> constants;               ///< of the joint type, component-major, stride 4 * slots
  std::vector<std::int64_t> q_index, v_index;  ///< of each of these bodies
  std::vector<std::int64_t> pose_index;        ///< each body's place in the type batch
};

/// Algorithms for single states that use lane groups, because the compiler judged them faster than one body after the other.
struct LaneGroupUses {
  bool rnea = false;  ///< if false, all others are false as well
  bool aba = false;
  bool mass_matrix = false;
  bool derivatives = false;  ///< and the factors of M^-1
  bool centroidal_map = false;
};

struct LaneGroupPlan {
  LaneGroupUses uses;
  int count = 0;                        ///< number of lane groups without the world; only this is set if no algorithm uses them
  SharedVector<LaneGroup> lane_groups;  ///< [0] is the world; parents first
  SharedVector<LaneSlot> lane_slots;    ///< by body
  SharedVector<LaneGroupRun> runs;
  SharedVector<LaneGroupBatch> batches;
  int dofs = 0;
  int shared_dofs = 0;                   ///< the first ones, which are the same in all lanes: the root's
  SharedVector<std::int64_t> dof_index;  ///< four per degree of freedom: where its lanes are in v and tau
  SharedVector<std::int64_t> dof_row;    ///< the same times nvx: where their rows and columns begin
  SharedVector<std::int64_t> dof_place;  ///< the inverse: where entries of v and tau are among the lanes of all degrees of freedom
  PackMemory constants;                  ///< BodyConstants of packs, one per lane group
  std::vector<double> armature;          ///< four per degree of freedom; 1 in lanes without a body, so that their pivots do not vanish
};

/// Finds only which bodies share a lane group, for any model and on any machine: LaneGroup::body and lane_slots.
LaneGroupPlan assignLanes(const CompactImpl& m);
/// Groups the bodies of a packed model for processors with this instruction set. There are no lane groups for models with couplings or with joints
/// of constant dense subspaces, nor for instruction sets other than "avx2" and "avx512".
LaneGroupPlan planLaneGroups(const CompactImpl& m, const std::string& instruction_set);
/// Writes the plan's numbers, lane by lane: constants and armature. The plan has lane groups.
void writeLaneNumbers(LaneGroupPlan& plan, const CompactImpl& m);

}  // namespace dyn
