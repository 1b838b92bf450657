// SPDX-License-Identifier: BSD-2-Clause
// The recursions of derivatives on dual numbers: how their results change along one degree of freedom.
#pragma once

#include "kernels/derivative/derivatives.hpp"

namespace dyn::kernels {

/// Memory of one pass.
struct DualState {
  Workspace<Dual<double>> w;
  DerivativeWorkspace<Dual<double>> d;
  Dual<double>*v = nullptr, *a = nullptr;
  Dual<double>* matrix = nullptr;       ///< nvx x nvx, zero off the root paths
  Dual<Dual<double>>* twice = nullptr;  ///< q, v, pose, subspace, bias of one joint
};
void layOut(DualState& s, const CompactImpl& m, Arena& arena);

/// Loads the state of evaluated joints, with the derivatives of their subspaces, and no change.
void loadState(const CompactImpl& m, const Workspace<double>& w, const DerivativeWorkspace<double>& d, const double* v, const double* a,
               DualState& s);

/// moveAlong writes how poses and subspaces change when body i's joint moves along its k-th degree of freedom. standStill sets this change to zero.
void moveAlong(const CompactImpl& m, const Workspace<double>& w, const DerivativeWorkspace<double>& d, const double* q, const double* v, int i, int k,
               DualState& s);
void standStill(const CompactImpl& m, const Workspace<double>& w, const DerivativeWorkspace<double>& d, int i, int k, DualState& s);

/// How the derivatives of rnea change when q moves along degree of freedom k of body i: n x n each.
void derivativesAlong(const CompactImpl& m, const Workspace<double>& w, const DerivativeWorkspace<double>& d, const double* q, const double* v, int i,
                      int k, DualState& s, double* by_q, double* by_v, double* by_a);

}  // namespace dyn::kernels
