// SPDX-License-Identifier: BSD-2-Clause
// The compact model: frequently read constants by body, batches by type, and runs in depth-first order. pack() writes it once; then it is constant.
// Models that withNumbers() makes have the same structure, and share its memory.
#pragma once

#include "compile/described.hpp"
#include "compile/lane_groups.hpp"
#include "joint/coordinate.hpp"

#include <dyn/compile/compact_model.hpp>
#include <dyn/joint/joint_type.hpp>

#include <cstdint>
#include <type_traits>
#include <vector>

namespace dyn {

/// The numbers of a body that the sweeps read, 31 side by side.
template <class T>
struct BodyConstants {
  SE3<T> placement;  ///< joint frame before its motion, in the parent body's frame
  T mass{};
  Vec3<T> com;
  Sym3<T> rotational;  ///< about the centre of mass
  Vec3<T> h;           ///< mass * com
  Sym3<T> origin;      ///< about the joint's origin
};

template <class To, class From>
BodyConstants<To> broadcast(const BodyConstants<From>& c) {
  return {cast<To>(c.placement), To(c.mass), cast<To>(c.com), cast<To>(c.rotational), cast<To>(c.h), cast<To>(c.origin)};
}

/// The numbers of BodyConstants that say how a body's mass is distributed. A batch has some for each state if its states are of different models.
template <class T>
struct InertiaConstants {
  T mass{};
  Vec3<T> com;
  Sym3<T> rotational;
  Vec3<T> h;
  Sym3<T> origin;
};

/// A rotation that only exchanges axes. The placement of a joint about or along an axis of its parent is one, because canonicalise() turns the
/// joint's own frame that way. Column k is the unit vector (k + shift) mod 3. If it `flips`, the last two columns are negative.
struct AxisExchange {
  std::int8_t shift = -1;  ///< -1 for any other rotation
  bool flips = false;
  bool changesNothing() const { return shift == 0 && !flips; }
};

/// Bookkeeping of a body, in one cache line. idx_q and idx_v count all coordinates, those of dependent joints included ("expanded").
struct alignas(64) BodyIndex {
  int parent = 0;
  int idx_q = 0, idx_v = 0, nq = 0, nv = 0;
  int user_q = -1, user_v = -1;  ///< indices in the user's vectors; -1 for a dependent joint
  int batch = 0, slot = 0;
  int joint = 0;                 ///< the user's joint
  int depth = 0;                 ///< number of moving bodies from this one up to the world
  int contiguous_from = 0;       ///< first body of the contiguous run of revolute joints up to this one; this body + 1 if its own is not revolute
  bool leaf = false;             ///< it has no children
  bool last_child = false;       ///< it is the last child of its parent, by number
  bool branches = false;         ///< it has several children
  bool follows = false;          ///< the body before is its parent, and in the same run
  bool turns_only = false;       ///< the joint's motion subspace has no linear part
  std::uint8_t offset_axes = 0;  ///< bit k: the joint offset has a component along the parent's axis k, or the joint moves the origin
  AxisExchange exchange;         ///< the placement's rotation, if it only exchanges axes
  bool floating_base = false;    ///< it is a free body on the world; its subspace is the identity in aligned axes
};

/// All joints of one type and shape. One virtual call evaluates them.
struct TypeBatch {
  const JointType* type = nullptr;
  const JointType* fast = nullptr;  ///< the same type built for this processor, or `type`; evaluates poses, subspaces and biases
  Shape shape = Shape::dense;
  bool adds = false;    ///< coordinates are numbers to which velocities are added, and zeros at neutral
  bool curved = false;  ///< v is not dq/dt; only for dense shapes
  int nq = 0, nv = 0, count = 0;
  std::vector<int> bodies;
  std::vector<int> q_index, v_index;  ///< of each joint's first coordinates
  bool contiguous = false;            ///< coordinates lie in q as the type reads them, so they need no gathering
  int constant_count = 0;
  std::vector<double> constants;  ///< component-major, stride = count; at least one row, so that each joint has a place

  JointPlace placeOf(int slot) const { return {type, constants.data() + slot, constant_count, count}; }
};

/// Consecutive bodies, depth first, that belong to one batch. A pass makes one kernel call for them.
struct Run {
  Shape shape = Shape::dense;
  int nv = 0, first = 0, count = 0, batch = 0, slot = 0;
};

/// The coupling of a dependent joint to its master. Couplings are ordered so that a master's value is known before those of its dependent joints.
struct PackedCoupling {
  const CouplingType* type = nullptr;
  int body = 0, master = 0;
  std::vector<double> constants;
};

struct PackedConstraints;

/// Consecutive degrees of freedom on one root path, between two places where the tree branches.
struct DofChain {
  int begin = 0, end = 0;
  int depth = 0;              ///< of `begin`
  int first_fresh_depth = 0;  ///< from this depth on, the subtrees of its path's degrees of freedom end with this chain
  bool leaf = true;           ///< it carries no other body
};

struct CompactImpl {
  std::string name;
  Vec3<double> gravity;
  int nq = 0, nv = 0;    ///< the user's
  int nqx = 0, nvx = 0;  ///< expanded; equal to the user's without couplings

  // The numbers that withNumbers() changes.
  double mass = 0;
  std::vector<BodyConstants<double>> constants;
  std::vector<BodyConstants<float>> constants_float;
  std::vector<double> damping, friction, armature;  ///< nvx each, or empty when the model has none
  bool roots_have_armature = false;                 ///< whether some floating base has armature
  DescribedNumbers described;                       ///< those of the description, from which all others are made again

  SharedVector<BodyIndex> index;   ///< [0] is the world
  SharedVector<double> subspaces;  ///< of dense_constant shapes: 6 nv numbers per body
  SharedVector<float> subspaces_float;
  SharedVector<int> subspace_offset;  ///< by body: index into subspaces, or -1
  SharedVector<TypeBatch> batches;
  SharedVector<Run> runs;
  SharedVector<int> tree_end;  ///< one past the last body of each body's subtree
  // By degree of freedom. Its path to the root goes through those degrees of freedom of its joint that have lower numbers.
  SharedVector<int> dof_body;     ///< the body that it moves
  SharedVector<int> dof_end;      ///< one past the last one of its joint's subtree
  SharedVector<int> dof_parent;   ///< the next one on its path; -1 at the end
  SharedVector<int> dof_segment;  ///< the lowest number that its path reaches without a gap in the numbers
  SharedVector<int> dof_depth;    ///< the number of others on its path
  SharedVector<DofChain> chains;
  int path_room = 0;  ///< the number of degrees of freedom on the longest path

  LaneGroupPlan lane_groups;

  SharedVector<PackedCoupling> couplings;
  SharedVector<int> q_of_user, v_of_user;  ///< user's index -> expanded index; empty without couplings

  SharedVector<JointRecord> joints;
  SharedVector<SE3<double>> user_frame;  ///< user's joint frame in its body's core frame
  SharedVector<int> body_of_joint;
  SharedVector<FrameRecord> frames;  ///< placements in the user's joint frame
  SharedVector<int> frame_body;
  SharedVector<SE3<double>> frame_placement;  ///< in the body's core frame
  ModelLimits limits;
  CompileReport report;
  std::shared_ptr<const PackedConstraints> constraints;  ///< those of the description itself

  template <class T>
  const auto& constantsIn() const {
    if constexpr (std::is_same_v<T, float>) {
      return constants_float;
    } else {
      return constants;
    }
  }
  template <class T>
  const auto& subspacesIn() const {
    if constexpr (std::is_same_v<T, float>) {
      return subspaces_float;
    } else {
      return subspaces;
    }
  }
  int bodies() const { return static_cast<int>(index.size()); }
};

}  // namespace dyn
