// The compact model: hot constants by body, batches by type, runs in depth-first order. Written once by pack(), then constant.
#pragma once

#include "compile/strips.hpp"
#include "joint/coordinate.hpp"

#include <dyn/compile/compact_model.hpp>
#include <dyn/joint/joint_type.hpp>

#include <cstdint>
#include <type_traits>
#include <vector>

namespace dyn {

/// What the sweeps read of a body, 31 numbers side by side.
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

/// A rotation that only exchanges axes, as placements are of joints about or along an axis of their parent's (canonicalise() turns joints' own
/// frames so): its column k is unit vector (k + shift) mod 3, the last two of them its negative where it `flips`.
struct AxisExchange {
  std::int8_t shift = -1;  ///< -1: it is another rotation
  bool flips = false;
  bool changesNothing() const { return shift == 0 && !flips; }
};

/// Bookkeeping of a body, in a line of cache. idx_q and idx_v count all coordinates, coupled ones included ("expanded").
struct alignas(64) BodyIndex {
  int parent = 0;
  int idx_q = 0, idx_v = 0, nq = 0, nv = 0;
  int user_q = -1, user_v = -1;  ///< in the user's vectors; -1 for a coupled joint
  int batch = 0, slot = 0;
  int joint = 0;             ///< user's joint
  int depth = 0;             ///< moving bodies up to the world
  int piece = 0;             ///< first of the bodies with one axis to turn about that lead here, numbers without a gap; past this one if it has not
  bool leaf = false;         ///< no body hangs on it
  bool last_child = false;   ///< of its parent's, in their numbers
  bool branches = false;     ///< more than one body hangs on it
  bool follows = false;      ///< the body before is its parent, and of the same run
  bool turns_only = false;   ///< the joint's motion subspace has no linear part
  std::uint8_t lever = 0;    ///< bit k: its origin is elsewhere than its parent's along its axis k, or moves
  AxisExchange exchange;     ///< what the placement's rotation is, if it is one
  bool flying_root = false;  ///< a free body on the world: its subspace is the identity in aligned axes
};

/// All joints of one type and shape: one virtual call.
struct TypeBatch {
  const JointType* type = nullptr;
  const JointType* fast = nullptr;  ///< the same type built for this processor, or `type`; for poses, subspaces and biases
  Shape shape = Shape::dense;
  bool adds = false;    ///< coordinates are numbers that velocities are added to, zeros where it is neutral
  bool curved = false;  ///< of a dense shape: v is not dq/dt
  int nq = 0, nv = 0, count = 0;
  std::vector<int> bodies;
  std::vector<int> q_index, v_index;  ///< of each one's first coordinates
  bool contiguous = false;            ///< coordinates are in q as the type reads them, so that they need no gathering
  int constant_count = 0;
  std::vector<double> constants;  ///< component-major, stride = count; one row at least, so that each joint has a place

  JointPlace placeOf(int slot) const { return {type, constants.data() + slot, constant_count, count}; }
};

/// Bodies that follow one another depth first and belong to one batch: one kernel call a pass.
struct Run {
  Shape shape = Shape::dense;
  int nv = 0, first = 0, count = 0, batch = 0, slot = 0;
};

/// A coordinate that follows another one. Ordered so that a master's value is known before its followers'.
struct PackedCoupling {
  const CouplingType* type = nullptr;
  int body = 0, master = 0;
  std::vector<double> constants;
};

struct PackedConstraints;

/// Degrees of freedom that follow one another on one path to the root, between two places where the tree branches.
struct DofChain {
  int begin = 0, end = 0;
  int depth = 0;     ///< of `begin`
  int fresh = 0;     ///< its path from this depth on has no dofs of higher numbers but these
  bool leaf = true;  ///< no body hangs on it
};

struct CompactImpl {
  std::string name;
  Vec3<double> gravity;
  int nq = 0, nv = 0;    ///< the user's
  int nqx = 0, nvx = 0;  ///< expanded; equal to the user's without couplings
  double mass = 0;

  std::vector<BodyIndex> index;  ///< [0] is the universe
  std::vector<BodyConstants<double>> constants;
  std::vector<BodyConstants<float>> constants_float;
  std::vector<double> subspaces;  ///< dense_constant: 6 nv numbers a body that needs them
  std::vector<float> subspaces_float;
  std::vector<int> subspace_offset;  ///< into subspaces, -1 without
  std::vector<TypeBatch> batches;
  std::vector<Run> runs;
  std::vector<int> tree_end;  ///< one past the last body of each body's subtree
  // By degree of freedom. Its path leads to the root through the joint's other degrees of freedom of lower number.
  std::vector<int> dof_body;     ///< the body that it moves
  std::vector<int> dof_end;      ///< one past the last one of its joint's subtree
  std::vector<int> dof_parent;   ///< the next one on its path; -1 at the end
  std::vector<int> dof_segment;  ///< how far down its path goes without a gap in the numbers
  std::vector<int> dof_depth;    ///< how many others its path has
  std::vector<DofChain> chains;
  int path_room = 0;  ///< degrees of freedom of the longest path

  StripPlan strips;

  std::vector<PackedCoupling> couplings;
  std::vector<int> q_of_user, v_of_user;  ///< user's index -> expanded index; empty without couplings

  std::vector<double> damping, friction, armature;  ///< nvx each, or empty when the model has none
  bool roots_have_armature = false;                 ///< some of those that fly

  std::vector<JointRecord> joints;
  std::vector<SE3<double>> user_frame;  ///< user's joint frame in its body's core frame
  std::vector<int> body_of_joint;
  std::vector<FrameRecord> frames;  ///< placements in the user's joint frame
  std::vector<int> frame_body;
  std::vector<SE3<double>> frame_placement;  ///< in the body's core frame
  ModelLimits limits;
  CompileReport report;
  std::shared_ptr<const PackedConstraints> constraints;  ///< of the description itself

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
