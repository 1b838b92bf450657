// The recursions compiled for one instruction set. There is a table for each; dispatch.cpp chooses one when the library is first used.
//
// Everything behind a table is compiled with its own flags and kept in a shared object of its own, so that no inline function made for a
// newer processor is picked by the linker for an older one.
#pragma once

#include "kernels/columns.hpp"
#include "kernels/derivatives.hpp"
#include "kernels/jacobians.hpp"

#include <initializer_list>

namespace dyn::kernels {

struct ConstraintKernels;  // kernels/constraint_table.hpp

/// One state. Joints are asked first; vectors are in expanded coordinates.
struct SingleKernels {
  void (*evaluate)(const CompactImpl&, Workspace<double>&, const double* q, const double* v);
  void (*forwardKinematics)(const CompactImpl&, Workspace<double>&, const double* v, const double* a);
  void (*jointJacobians)(const CompactImpl&, Workspace<double>&, double* J);  ///< as forwardKinematics; J: 6 numbers a degree of freedom
  void (*rnea)(const CompactImpl&, Workspace<double>&, const double* v, const double* a, const Force<double>* fext, double* tau);
  void (*massMatrix)(const CompactImpl&, Workspace<double>&, double* M);
  void (*aba)(const CompactImpl&, Workspace<double>&, const double* v, const double* tau, const Force<double>* fext,
              double* ddq);  /// aba, in two parts: everything but the accelerations, and these, under the gravity given. Between them forces of
                             /// constraints are found.
  void (*articulate)(const CompactImpl&, Workspace<double>&, const double* v, const double* tau, const Force<double>* fext);
  void (*accelerate)(const CompactImpl&, Workspace<double>&, const Vec3<double>& gravity, double* ddq);
  /// The outward half of `articulate`: poses, columns, velocity-dependent accelerations.
  void (*placeOutward)(const CompactImpl&, Workspace<double>&, const double* v);

  using Derivatives = DerivativeWorkspace<double>;
  /// Memory for the Derivatives of models whose recursions are over strips; null where packs are too narrow.
  std::size_t (*stripBytes)(const CompactImpl&) = nullptr;
  void (*prepareStrips)(const CompactImpl&, char* memory, Derivatives&) = nullptr;
  /// How subspaces vary, which all derivatives take.
  void (*evaluateSubspaces)(const CompactImpl&, Derivatives&, const double* q, const double* v);
  void (*rneaDerivatives)(const CompactImpl&, Workspace<double>&, Derivatives&, const double* v, const double* a, const Force<double>* fext,
                          const PathDerivatives& out);
  /// aba without losses, its derivatives, and M^-1; n x n each. Returns the body whose pivot vanished, or 0.
  int (*abaDerivatives)(const CompactImpl&, Workspace<double>&, Derivatives&, const double* v, const double* tau, const Force<double>* fext,
                        double* ddq, double* by_q, double* by_v, double* inverse);
  /// C into by_v. zeros: accelerations.
  void (*coriolis)(const CompactImpl&, Workspace<double>&, Derivatives&, const double* v, const double* zeros);
  /// One of these, n x n.
  void (*assemble)(const CompactImpl&, const PathMatrix<double>&, double* out);
  /// Joints asked first. Without out.rates, a is not read.
  CentroidalState<double> (*centroidal)(const CompactImpl&, Workspace<double>&, Derivatives&, const double* v, const double* a,
                                        const CentroidalMaps<double>& out);
  /// The Derivatives' factors: of M, where the degree of freedom, plus one, whose pivot vanished is returned, or 0; or from articulated
  /// inertias, where the body is. Joints asked first.
  int (*choleskyDecompose)(const CompactImpl&, Derivatives&, const double* M);
  int (*treeFactors)(const CompactImpl&, Workspace<double>&, Derivatives&);
  /// By the Derivatives' factors, in place of n numbers with room for a pack: M^-1 x, M x, L^T x or L x.
  void (*factorTimes)(const CompactImpl&, Derivatives&, FactorProduct product, double* x);
  void (*inverseOfMassMatrix)(const CompactImpl&, Derivatives&, double* out);
};

/// One state, of which packs take several numbers at once; all null where they are too narrow. Vectors are in expanded coordinates. False: a
/// joint's pose is not finite, perhaps because q is no configuration.
struct PackedKernels {
  bool over_strips = false;
  std::size_t (*bytes)(const CompactImpl&) = nullptr;
  void (*prepare)(const CompactImpl&, char* scratch) = nullptr;
  bool (*rnea)(const CompactImpl&, char* scratch, const double* q, const double* v, const double* a, double* tau) = nullptr;
  bool (*massMatrix)(const CompactImpl&, char* scratch, const double* q, double* M) = nullptr;
  /// As SingleKernels'. failed: the body whose pivot vanished, or 0.
  bool (*articulate)(const CompactImpl&, char* scratch, const double* q, const double* v, const double* tau, int& failed) = nullptr;
  void (*accelerate)(const CompactImpl&, char* scratch, const Vec3<double>& gravity, double* ddq) = nullptr;
  /// Ag, 6 numbers a degree of freedom, and of `out` all but the rate.
  bool (*centroidalMap)(const CompactImpl&, char* scratch, const double* q, const double* v, double* Ag, CentroidalState<double>& out) = nullptr;
};

enum class Task {
  kinematics,
  joint_jacobians,
  frame_jacobian,
  rnea,
  mass_matrix,
  aba,
  rnea_derivatives,        ///< by q, by v, M
  aba_derivatives,         ///< by q, by v, M^-1, ddq
  minverse,                ///< M^-1
  coriolis,                ///< C
  centroidal_map,          ///< hg (6), Ag
  centroidal_rate,         ///< hg (6), dhg (6), Ag, dAg
  centroidal_derivatives,  ///< of hg by q, of dhg by q and v, Ag
};

/// As many states as a pack has lanes, from columns of the caller's matrices. Null inputs count as zero.
template <class T>
struct Block {
  Task task = Task::rnea;
  ColumnsIn<T> q, v, a;            ///< a: tau for aba
  ColumnsIn<T> forces, couplings;  ///< of models that have some, where q, v and a are expanded: tau for aba; and G, dG and ddG of all
  T* results[4] = {};              ///< first columns: tau, ddq, M (nv x nv), J (6 x nv), or see Task; the others follow each
  FramePoint<double> frame;        ///< frame_jacobian
  ReferenceFrame reference = ReferenceFrame::LOCAL;
  void* poses = nullptr;       ///< kinematics: where this block's poses go, 12 numbers a body, lanes innermost
  void* velocities = nullptr;  ///< 6 numbers a body; null: not wanted
  void* accelerations = nullptr;
  int failed[64] = {};      ///< by state: the body whose pivot vanished, or 0
  bool not_finite = false;  ///< some result or pose is NaN or infinite
};

/// What a block's scratch has room for beside what is of size O(n).
struct Room {
  bool mass_matrix = false, jacobian = false, derivatives = false;
};

template <class T>
struct BlockKernels {
  int lanes;
  std::size_t (*bytes)(const CompactImpl&, Room room);            ///< of scratch for one thread
  void (*prepare)(const CompactImpl&, Room room, char* scratch);  ///< aligned as Arena says
  void (*run)(const CompactImpl&, char* scratch, Block<T>&);
};

struct Kernels {
  std::size_t layout;
  SingleKernels single;
  BlockKernels<double> doubles;
  BlockKernels<float> floats;
  const ConstraintKernels* constraints;
  PackedKernels strips = {};    ///< joints in lanes
  PackedKernels vectored = {};  ///< coordinates of three-vectors in lanes
};

/// Changes with the layout of what tables and library share, so that a table of another build is not used.
constexpr std::size_t layoutStamp() {
  std::size_t stamp = 1;
  for (const std::size_t size :
       {sizeof(CompactImpl), sizeof(BodyIndex), sizeof(BodyConstants<double>), sizeof(TypeBatch), sizeof(Run), sizeof(Strip), sizeof(Seat),
        sizeof(StripRun), sizeof(StripPlan), sizeof(Workspace<double>), sizeof(JointMemory<double>), sizeof(DerivativeWorkspace<double>),
        sizeof(Block<double>), sizeof(Block<float>), sizeof(JointBatch<double>), sizeof(Kernels)})
    stamp = stamp * 1000003 + size;
  return stamp;
}

/// The one in use: the best that the processor has, or what DYN_SIMD asks for. Throws Error(argument) where that was not built, Error(file) where its
/// module cannot be opened.
const Kernels& active();

/// Whether there are algorithms that take this model's joints in lanes.
bool useStrips(const CompactImpl& m);

/// The same of derivatives and factors.
bool useStripsForDerivatives(const CompactImpl& m);

/// What takes several numbers of one state of this model at once, for one of StripUses' algorithms, or null.
const PackedKernels* packed(const CompactImpl& m, bool StripUses::*algorithm);

}  // namespace dyn::kernels
