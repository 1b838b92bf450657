// The arena behind Data: one block, carved into arrays. Each field: meaning, frame, writer.
#pragma once

#include "compile/compact_impl.hpp"

#include <dyn/data/data.hpp>

#include <memory>
#include <vector>

namespace dyn {

/// What a differentiated call of a batch with varying subspaces needs.
struct DualMemory {
  Dual<double>* q = nullptr;
  Dual<double>* pose = nullptr;
  Dual<double>* subspace = nullptr;
};

/// Joint results of one batch as its plugin wrote them, component c of joint k at [c * stride + k].
struct BatchMemory {
  double* pose = nullptr;
  double* subspace = nullptr;
  double* bias = nullptr;
  double* q = nullptr;  ///< gathered coordinates, null when the batch reads q in place
  double* v = nullptr;
  std::ptrdiff_t stride = 0;
  DualMemory dual;
};

/// One degree of freedom in ABA, when its turn of elimination has come: W = IA S, pivot d = S^T W, y = its share of tau.
struct DofFactor {
  Motion<double> S;  ///< aligned axes, at the joint's origin
  Force<double> W;
  double d = 0, y = 0;
};

struct DataImpl {
  const CompactImpl* model = nullptr;
  std::shared_ptr<const void> keep;  ///< the model lives as long as its data
  Need needs = Need::state;
  std::unique_ptr<double[]> block;
  std::size_t size = 0;

  std::vector<BatchMemory> batches;

  // Per body (universe included), written by the stage in brackets.
  SE3<double>* rel = nullptr;                ///< pose in the parent body's frame [placements]
  SE3<double>* oM = nullptr;                 ///< pose in the world [world placements]
  Motion<double>* v = nullptr;               ///< spatial velocity, body axes at its origin [velocities]
  Motion<double>* a = nullptr;               ///< spatial acceleration, same [accelerations]; in rnea: classical acceleration, body axes
  Vec3<double>* w = nullptr;                 ///< angular velocity: body axes in rnea, aligned axes in aba
  Force<double>* f = nullptr;                ///< force through the joint [rnea]
  Mat3<double>* R = nullptr;                 ///< body axes in aligned axes [aligned]
  Vec3<double>* r = nullptr;                 ///< from the parent's origin to the joint's, aligned axes [aligned]
  Motion<double>* beta = nullptr;            ///< velocity-dependent acceleration, aligned [aba]
  ArticulatedInertia<double>* IA = nullptr;  ///< [aba]
  Force<double>* pA = nullptr;               ///< [aba]
  Motion<double>* acc = nullptr;             ///< classical acceleration, aligned [aba]
  double* mass = nullptr;                    ///< of the subtree [crba, com]
  Vec3<double>* h = nullptr;                 ///< first moment of the subtree about the joint's origin, aligned [crba]
  Sym3<double>* Io = nullptr;                ///< rotational inertia of the subtree about the joint's origin, aligned [crba]
  Force<double>* fext = nullptr;             ///< external forces in core frames

  DofFactor* dof = nullptr;  ///< nvx

  // Expanded inputs and results of models with couplings; without, they are the user's vectors.
  double *qx = nullptr, *vx = nullptr, *ax = nullptr, *taux = nullptr;
  double *G = nullptr, *gamma = nullptr;  ///< v_x = G v_master, and its rate, an entry a coupling

  // Results in the user's numbering.
  double *tau = nullptr, *nle = nullptr, *g = nullptr, *ddq = nullptr;
  double *M = nullptr, *Mx = nullptr, *Jcom = nullptr;
  double* columns = nullptr;  ///< 6 x nvx, twice: Jacobians before couplings are folded
  double* zero = nullptr;     ///< max(nvx, 1) zeros
  Vec3<double> com, vcom, acom;
  double kinetic = 0, potential = 0;
};

}  // namespace dyn
