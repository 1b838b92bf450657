// The compact model: hot constants by body, batches by type, runs in depth-first order. Written once by pack(), then constant.
#pragma once

#include <dyn/compile/compact_model.hpp>
#include <dyn/joint/joint_type.hpp>

#include <vector>

namespace dyn {

/// What the sweeps read of a body, 30 doubles side by side.
struct BodyConstants {
  SE3<double> placement;  ///< joint frame before its motion, in the parent body's frame
  double mass = 0;
  Vec3<double> com;
  Sym3<double> rotational;  ///< about the centre of mass
  Vec3<double> h;           ///< mass * com
  Sym3<double> origin;      ///< about the joint's origin
};

/// Bookkeeping of a body. idx_q and idx_v count all coordinates, coupled ones included ("expanded").
struct BodyIndex {
  int parent = 0;
  int idx_q = 0, idx_v = 0, nq = 0, nv = 0;
  int user_q = -1, user_v = -1;  ///< in the user's vectors; -1 for a coupled joint
  int batch = 0, slot = 0;
  int joint = 0;  ///< user's joint
  int depth = 0;  ///< moving bodies up to the world
};

/// All joints of one type and shape: one virtual call.
struct TypeBatch {
  const JointType* type = nullptr;
  Shape shape = Shape::dense;
  int nq = 0, nv = 0, count = 0;
  std::vector<int> bodies;
  bool contiguous = false;  ///< nq = 1 and coordinates follow one another, so q needs no gathering
  int constant_count = 0;
  std::vector<double> constants;  ///< component-major, stride = count
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

struct CompactImpl {
  std::string name;
  Vec3<double> gravity;
  int nq = 0, nv = 0;    ///< the user's
  int nqx = 0, nvx = 0;  ///< expanded; equal to the user's without couplings
  double mass = 0;

  std::vector<BodyIndex> index;  ///< [0] is the universe
  std::vector<BodyConstants> constants;
  std::vector<double> subspaces;     ///< dense_constant: 36 doubles a body that needs them
  std::vector<int> subspace_offset;  ///< into subspaces, -1 without
  std::vector<TypeBatch> batches;
  std::vector<Run> runs;
  std::vector<int> tree_end;  ///< one past the last body of each body's subtree

  std::vector<PackedCoupling> couplings;
  std::vector<int> q_of_user, v_of_user;  ///< user's index -> expanded index; empty without couplings

  std::vector<double> damping, friction, armature;  ///< nvx each, or empty when the model has none

  std::vector<JointRecord> joints;
  std::vector<SE3<double>> user_frame;  ///< user's joint frame in its body's core frame
  std::vector<int> body_of_joint;
  std::vector<FrameRecord> frames;  ///< placements in the user's joint frame
  std::vector<int> frame_body;
  std::vector<SE3<double>> frame_placement;  ///< in the body's core frame
  ModelLimits limits;
  CompileReport report;

  int bodies() const { return static_cast<int>(index.size()); }
};

}  // namespace dyn
