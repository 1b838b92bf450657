// SPDX-License-Identifier: BSD-2-Clause
// The memory of Data: arrays that are laid out in one block, and copies of arguments in another.
#pragma once

#include "data/kinematics_stage.hpp"
#include "kernels/body/regressor_memory.hpp"
#include "kernels/derivative/derivatives.hpp"

#include <dyn/data/data.hpp>

#include <memory>
#include <vector>

namespace dyn {

/// Memory for a differentiated call of a batch with varying subspaces.
struct DualMemory {
  Dual<double>* q = nullptr;
  Dual<double>* pose = nullptr;
  Dual<double>* subspace = nullptr;
};

struct DataImpl : Workspace<double> {
  KinematicsStage stage = KinematicsStage::nothing;

  const CompactImpl* model = nullptr;
  std::shared_ptr<const void> keep;  ///< keeps the model alive as long as its data
  Need needs = Need::state;
  PackMemory block;
  PackMemory copies;             ///< memory that no result overwrites: zeros, and copies of arguments that were results
  PackMemory packed[2];          ///< scratch of the kernels that kernels::packed() names: [over_lane_groups]
  PackMemory group_derivatives;  ///< scratch of derivatives whose recursions are over lane groups

  std::vector<DualMemory> dual;  ///< one per batch

  Force<double>* fext = nullptr;  ///< external forces by body, core frames

  // Inputs and results in expanded coordinates, for models with couplings. Null for other models, which use the user's vectors.
  double *qx = nullptr, *vx = nullptr, *ax = nullptr, *taux = nullptr;
  double *G = nullptr, *dG = nullptr, *ddG = nullptr;  ///< first, second and third derivative of each coupling by its master's coordinate

  // Results in the user's coordinates.
  double *tau = nullptr, *nle = nullptr, *g = nullptr, *ddq = nullptr;
  double *M = nullptr, *Mx = nullptr, *Jcom = nullptr, *J = nullptr;
  double* columns = nullptr;  ///< 6 x nvx, twice: Jacobians before couplings are folded; scratch
  double* zero = nullptr;     ///< max(nvx, 1) zeros
  double *copied_q = nullptr, *copied_v = nullptr, *copied_a = nullptr, *copied_tau = nullptr;  ///< see copyAliasedArguments()
  kernels::DerivativeWorkspace<double> derivatives;
  double *dtau_dq = nullptr, *dtau_dv = nullptr, *ddq_dq = nullptr, *ddq_dv = nullptr, *Minv = nullptr, *C = nullptr;
  double* column = nullptr;                                                                          ///< nvx numbers, with room for a pack at the end
  double *Ag = nullptr, *dAg = nullptr, *dh_dq = nullptr, *dhdot_dq = nullptr, *dhdot_dv = nullptr;  ///< 6 x nvx; also scratch of other algorithms
  double *kinematics_v = nullptr, *kinematics_a = nullptr;  ///< v and a of the last computeForwardKinematicsDerivatives, expanded
  kernels::TorqueRegressorMemory torque_regressor;
  double* regressor = nullptr;           ///< nv x 10 (njoints - 1)
  double* expanded_regressor = nullptr;  ///< nvx rows; zero beside root paths, and `regressor` itself for models without couplings
  double* energy_regressor = nullptr;    ///< 10 (njoints - 1), of joints without bodies always zero
  double hg[6] = {}, dhg[6] = {};
  Mat3<double> locked_inertia;
  double* expanded[3] = {};  ///< nvx x nvx: derivatives of rnea by q, v, a before couplings are folded; zeros between calls
  Vec3<double> com, vcom, acom;
  double kinetic = 0, potential = 0;
};

}  // namespace dyn
