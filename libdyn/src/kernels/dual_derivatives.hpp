// The recursions of derivatives on dual numbers: the change of their results along one degree of freedom.
#pragma once

#include "kernels/derivatives.hpp"

namespace dyn::kernels {

/// Memory of one pass.
struct DualState {
  Workspace<Dual<double>> w;
  DerivativeWorkspace<Dual<double>> d;
  Dual<double>*v = nullptr, *a = nullptr;
  Dual<double>* matrix = nullptr;       ///< nvx x nvx, zero off the paths
  Dual<Dual<double>>* twice = nullptr;  ///< q, v, pose, subspace, bias of one joint
};
void carve(DualState& s, const CompactImpl& m, Arena& arena);

/// The state of joints that have been evaluated, subspaces' derivatives too, without any change.
void loadState(const CompactImpl& m, const Workspace<double>& w, const DerivativeWorkspace<double>& d, const double* v, const double* a,
               DualState& s);

/// How poses and subspaces change when body i's joint moves along its k-th degree of freedom; back to none.
void moveAlong(const CompactImpl& m, const Workspace<double>& w, const DerivativeWorkspace<double>& d, const double* q, const double* v, int i, int k,
               DualState& s);
void standStill(const CompactImpl& m, const Workspace<double>& w, const DerivativeWorkspace<double>& d, int i, int k, DualState& s);

/// The derivatives of rnea at q moved along degree of freedom k of body i: their changes, n x n each.
void derivativesAlong(const CompactImpl& m, const Workspace<double>& w, const DerivativeWorkspace<double>& d, const double* q, const double* v, int i,
                      int k, DualState& s, double* by_q, double* by_v, double* by_a);

}  // namespace dyn::kernels
