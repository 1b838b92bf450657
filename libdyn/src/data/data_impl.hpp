// The arena behind Data: one block, carved into arrays. Each field: meaning, frame, writer.
#pragma once

#include "data/kinematics_stage.hpp"
#include "kernels/derivatives.hpp"

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

struct DataImpl : Workspace<double> {
  KinematicsStage stage = KinematicsStage::nothing;

  const CompactImpl* model = nullptr;
  std::shared_ptr<const void> keep;  ///< the model lives as long as its data
  Need needs = Need::state;
  PackMemory block;
  PackMemory kept;               ///< what no result is written to: zeros, and arguments that are results
  PackMemory packed[2];          ///< scratch of the kernels that kernels::packed() names: [over_strips]
  PackMemory strip_derivatives;  ///< where derivatives' recursions are over strips

  std::vector<DualMemory> dual;  ///< a batch each

  Force<double>* fext = nullptr;  ///< external forces in core frames

  // Expanded inputs and results of models with couplings; without, they are the user's vectors.
  double *qx = nullptr, *vx = nullptr, *ax = nullptr, *taux = nullptr;
  double *G = nullptr, *dG = nullptr, *ddG = nullptr;  ///< derivatives of couplings by their masters' coordinates

  // Results in the user's numbering.
  double *tau = nullptr, *nle = nullptr, *g = nullptr, *ddq = nullptr;
  double *M = nullptr, *Mx = nullptr, *Jcom = nullptr, *J = nullptr;
  double* columns = nullptr;                                                            ///< 6 x nvx, twice: Jacobians before couplings are folded
  double* zero = nullptr;                                                               ///< max(nvx, 1) zeros
  double *kept_q = nullptr, *kept_v = nullptr, *kept_a = nullptr, *kept_tau = nullptr;  ///< see keepArguments
  kernels::DerivativeWorkspace<double> derivatives;
  double *dtau_dq = nullptr, *dtau_dv = nullptr, *ddq_dq = nullptr, *ddq_dv = nullptr, *Minv = nullptr, *C = nullptr;
  double* column = nullptr;                                                                          ///< nvx, with room for a pack
  double *Ag = nullptr, *dAg = nullptr, *dh_dq = nullptr, *dhdot_dq = nullptr, *dhdot_dv = nullptr;  ///< 6 x nvx; scratch of others that need columns
  double *kinematics_v = nullptr, *kinematics_a = nullptr;  ///< of the last computeForwardKinematicsDerivatives, expanded
  double* regressor = nullptr;                              ///< nv x 10 (njoints - 1)
  double hg[6] = {}, dhg[6] = {};
  Mat3<double> locked_inertia;
  double* expanded[3] = {};  ///< derivatives of rnea by q, v, a before couplings are folded
  Vec3<double> com, vcom, acom;
  double kinetic = 0, potential = 0;
};

}  // namespace dyn
