// SPDX-License-Identifier: BSD-2-Clause
// Kernels of one table for single states, without derivatives.
#include "kernels/body/dissipation.hpp"
#include "kernels/body/evaluate.hpp"
#include "kernels/isa/table_parts.hpp"
#include "kernels/recursion/aba.hpp"
#include "kernels/recursion/crba.hpp"
#include "kernels/recursion/kinematics.hpp"
#include "kernels/recursion/rnea.hpp"

namespace dyn::kernels {

SingleKernels singleKernels() {
  using W = Workspace<double>;
  SingleKernels k;
  k.evaluate = [](const CompactImpl& m, W& w, const double* q, const double* v) { evaluateJoints(m, w, q, v); };
  k.forwardKinematics = [](const CompactImpl& m, W& w, const double* v, const double* a) {
    kernels::forwardKinematics(Bodies<double>{m, w}, w, v, a);
  };
  k.jointJacobians = [](const CompactImpl& m, W& w, double* J) { kernels::jointJacobians(Bodies<double>{m, w}, w, J); };
  k.rnea = [](const CompactImpl& m, W& w, const double* v, const double* a, const Force<double>* fext, double* tau) {
    const Bodies<double> bodies{m, w};
    rneaOutward(bodies, w, v, a);
    rneaInward(bodies, w, tau, fext);
    addJointForces(m, v, a, tau);
  };
  k.massMatrix = [](const CompactImpl& m, W& w, double* M) { kernels::massMatrix(Bodies<double>{m, w}, w, M); };
  k.articulate = [](const CompactImpl& m, W& w, const double* v, const double* tau, const Force<double>* fext) {
    const Bodies<double> bodies{m, w};
    abaOutward(bodies, w, v);
    abaInward(bodies, w, tau, fext);
  };
  k.accelerate = [](const CompactImpl& m, W& w, const Vec3<double>& gravity, double* ddq) { abaSolve(Bodies<double>{m, w}, w, gravity, ddq); };
  k.placeOutward = [](const CompactImpl& m, W& w, const double* v) { abaOutward(Bodies<double>{m, w}, w, v); };
  addDerivatives(k);
  addFactors(k);
  return k;
}

}  // namespace dyn::kernels
