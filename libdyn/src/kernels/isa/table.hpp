// SPDX-License-Identifier: BSD-2-Clause
// The recursions compiled for one instruction set. Each instruction set has a table; dispatch.cpp chooses one when the library is first used.
//
// The code of a table is compiled with its own flags into a shared object of its own. Otherwise the linker could choose, for all processors, an
// inline function that was compiled for a newer one.
#pragma once

#include "kernels/body/regressor_memory.hpp"
#include "kernels/derivative/derivatives.hpp"
#include "kernels/pack/columns.hpp"
#include "kernels/recursion/jacobians.hpp"

#include <dyn/catalogue/algorithm.hpp>

#include <initializer_list>

namespace dyn::kernels {

struct ConstraintKernels;  // kernels/isa/constraint_table.hpp

/// Kernels of one state. Those that take a Workspace, except `evaluate`, need evaluated joints. Vectors are in expanded coordinates.
struct SingleKernels {
  void (*evaluate)(const CompactImpl&, Workspace<double>&, const double* q, const double* v);
  void (*forwardKinematics)(const CompactImpl&, Workspace<double>&, const double* v, const double* a);
  void (*jointJacobians)(const CompactImpl&, Workspace<double>&, double* J);  ///< writes placements as well; J: 6 numbers per degree of freedom
  void (*rnea)(const CompactImpl&, Workspace<double>&, const double* v, const double* a, const Force<double>* fext, double* tau);
  void (*massMatrix)(const CompactImpl&, Workspace<double>&, double* M);
  /// ABA in two parts: `articulate` does everything but the accelerations, and `accelerate` computes these under the given gravity. Constraint forces
  /// are found between the two.
  void (*articulate)(const CompactImpl&, Workspace<double>&, const double* v, const double* tau, const Force<double>* fext);
  void (*accelerate)(const CompactImpl&, Workspace<double>&, const Vec3<double>& gravity, double* ddq);
  /// The outward pass of `articulate`: poses, columns, velocity-dependent accelerations.
  void (*placeOutward)(const CompactImpl&, Workspace<double>&, const double* v);

  using Derivatives = DerivativeWorkspace<double>;
  /// The memory that Derivatives need for recursions over lane groups. Null if packs are too narrow.
  std::size_t (*laneGroupBytes)(const CompactImpl&) = nullptr;
  void (*prepareLaneGroups)(const CompactImpl&, char* memory, Derivatives&) = nullptr;
  /// Computes the derivatives of subspaces, which all other derivatives read.
  void (*evaluateSubspaces)(const CompactImpl&, Derivatives&, const double* q, const double* v);
  void (*rneaDerivatives)(const CompactImpl&, Workspace<double>&, Derivatives&, const double* v, const double* a, const Force<double>* fext,
                          const PathDerivatives& out);
  /// ABA without dissipation, its derivatives and M^-1; n x n each. Returns the body whose pivot vanished, or 0.
  int (*abaDerivatives)(const CompactImpl&, Workspace<double>&, Derivatives&, const double* v, const double* tau, const Force<double>* fext,
                        double* ddq, double* by_q, double* by_v, double* inverse);
  /// Writes the Coriolis matrix C to Derivatives::by_v. `zeros` are the accelerations.
  void (*coriolis)(const CompactImpl&, Workspace<double>&, Derivatives&, const double* v, const double* zeros);
  /// Assembles one PathMatrix of the Derivatives to n x n numbers.
  void (*assemble)(const CompactImpl&, const PathMatrix<double>&, double* out);
  /// Reads `a` only if out.rates().
  CentroidalState<double> (*centroidal)(const CompactImpl&, Workspace<double>&, Derivatives&, const double* v, const double* a,
                                        const CentroidalMaps<double>& out);
  /// Compute the factors of the Derivatives. choleskyDecompose factors M and returns one plus the degree of freedom whose pivot vanished, or 0.
  /// treeFactors starts from articulated inertias and returns the body whose pivot vanished, or 0.
  int (*choleskyDecompose)(const CompactImpl&, Derivatives&, const double* M);
  int (*treeFactors)(const CompactImpl&, Workspace<double>&, Derivatives&);
  /// Replaces x, each of `count` columns, by M^-1 x, M x, L^T x or L x, using the factors of the Derivatives.
  void (*factorTimes)(const CompactImpl&, Derivatives&, FactorProduct product, double* first, std::ptrdiff_t count, std::ptrdiff_t stride);
  void (*inverseOfMassMatrix)(const CompactImpl&, Derivatives&, double* out);
  /// Reads placements, velocities and accelerations. Writes entries on root paths only, see derivative/torque_regressor.hpp.
  void (*torqueRegressor)(const CompactImpl&, Workspace<double>&, const TorqueRegressorMemory&, double* out);
};

/// Kernels of one state in which a pack holds several numbers of the state. All are null if packs are too narrow. Vectors are in expanded
/// coordinates. Kernels return false if a joint's pose is not finite, for example because q is not a configuration.
struct PackedKernels {
  bool over_lane_groups = false;
  std::size_t (*bytes)(const CompactImpl&) = nullptr;
  void (*prepare)(const CompactImpl&, char* scratch) = nullptr;
  bool (*rnea)(const CompactImpl&, char* scratch, const double* q, const double* v, const double* a, double* tau) = nullptr;
  bool (*massMatrix)(const CompactImpl&, char* scratch, const double* q, double* M) = nullptr;
  /// Like those of SingleKernels. `failed` becomes the body whose pivot vanished, or 0.
  bool (*articulate)(const CompactImpl&, char* scratch, const double* q, const double* v, const double* tau, int& failed) = nullptr;
  void (*accelerate)(const CompactImpl&, char* scratch, const Vec3<double>& gravity, double* ddq) = nullptr;
  /// Writes Ag, 6 numbers per degree of freedom, and all of `out` but the rate.
  bool (*centroidalMap)(const CompactImpl&, char* scratch, const double* q, const double* v, double* Ag, CentroidalState<double>& out) = nullptr;
};

/// At most as many states as a pack has lanes, in columns of the caller's matrices. Null inputs count as zero.
template <class T>
struct Block {
  Algorithm algorithm = Algorithm::rnea;  ///< its results come in the order of its entry in the catalogue
  ColumnsIn<T> q, v, a;                   ///< a: tau for aba
  ColumnsIn<T> forces, couplings;         ///< models with couplings, where q, v and a are expanded: tau for aba; G, dG and ddG
  T* results[4] = {};                     ///< first state's column of each; the other states' columns follow; null: not wanted
  FramePoint<double> frame;               ///< frame_jacobian
  ReferenceFrame reference = ReferenceFrame::LOCAL;
  void* poses = nullptr;       ///< kinematics: receives this block's poses, 12 numbers per body, lanes innermost
  void* velocities = nullptr;  ///< 6 numbers per body; null: not wanted
  void* accelerations = nullptr;
  void* factors = nullptr;         ///< minverse: receives this block's factors of M^-1 in place of its results (derivative/tree_factors.hpp)
  const void* inertias = nullptr;  ///< states of different models: InertiaConstants of this block's packs by body; otherwise null
  int failed[64] = {};             ///< by state: the body whose pivot vanished, or 0
  bool not_finite = false;         ///< a result or pose is NaN or infinite
};

/// The parts of a block's scratch that are needed in addition to those of size O(n).
struct Room {
  bool mass_matrix = false, jacobian = false, derivatives = false;
};

template <class T>
struct BlockKernels {
  int lanes;
  std::size_t (*bytes)(const CompactImpl&, Room room);            ///< size of the scratch of one thread
  void (*prepare)(const CompactImpl&, Room room, char* scratch);  ///< scratch: zeros, aligned to Arena::alignment
  void (*run)(const CompactImpl&, char* scratch, Block<T>&);
  /// Replaces tau, in the block's `a`, by M^-1 tau in its first result. `factors` are what run() has written for this block.
  void (*solve)(const CompactImpl&, char* scratch, const void* factors, Block<T>&);
};

struct Kernels {
  std::size_t layout;
  SingleKernels single;
  BlockKernels<double> doubles;
  BlockKernels<float> floats;
  const ConstraintKernels* constraints;
  PackedKernels lane_groups = {};  ///< joints in lanes
  PackedKernels vectored = {};     ///< coordinates of three-vectors in lanes
};

/// A number that changes with the layout of the data that tables and library share. It keeps a table of another build from being used.
constexpr std::size_t layoutStamp() {
  std::size_t stamp = 1;
  for (const std::size_t size :
       {sizeof(CompactImpl), sizeof(BodyIndex), sizeof(BodyConstants<double>), sizeof(TypeBatch), sizeof(Run), sizeof(LaneGroup), sizeof(LaneSlot),
        sizeof(LaneGroupRun), sizeof(LaneGroupPlan), sizeof(Workspace<double>), sizeof(JointMemory<double>), sizeof(DerivativeWorkspace<double>),
        sizeof(TorqueRegressorMemory), sizeof(Block<double>), sizeof(Block<float>), sizeof(JointBatch<double>), sizeof(Kernels)})
    stamp = stamp * 1000003 + size;
  // Blocks name their algorithm by its number.
  for (const AlgorithmInfo& algorithm : algorithms())
    for (const char* c = algorithm.function; *c != '\0'; ++c) stamp = stamp * 31 + static_cast<unsigned char>(*c);
  return stamp;
}

/// The table in use: the best one for this processor, or the one that DYN_SIMD names. Throws Error(argument) if that one was not built or the
/// processor does not have it, Error(file) if its module cannot be opened.
const Kernels& active();

/// Whether some algorithms use this model's lane groups.
bool useLaneGroups(const CompactImpl& m);

/// Whether derivatives and factors use this model's lane groups.
bool useLaneGroupsForDerivatives(const CompactImpl& m);

/// The kernels to use for one state of this model and one of the algorithms in LaneGroupUses. Null if packs are too narrow.
const PackedKernels* packed(const CompactImpl& m, bool LaneGroupUses::*algorithm);

}  // namespace dyn::kernels
