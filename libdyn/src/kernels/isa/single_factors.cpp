// SPDX-License-Identifier: BSD-2-Clause
// Kernels of one table for factors of the mass matrix, centroidal quantities and the torque regressor of single states.
#include "kernels/derivative/centroidal.hpp"
#include "kernels/derivative/factor_products.hpp"
#include "kernels/derivative/minverse.hpp"
#include "kernels/derivative/torque_regressor.hpp"
#include "kernels/isa/table_parts.hpp"

namespace dyn::kernels {

void addFactors(SingleKernels& k) {
  using W = Workspace<double>;
  using D = DerivativeWorkspace<double>;
  k.factorTimes = [](const CompactImpl& m, D& d, FactorProduct product, double* first, std::ptrdiff_t count, std::ptrdiff_t stride) {
    factorTimesColumns<Wide, WidestPack>(m, d.cholesky, product, first, count, stride);
  };
  k.centroidal = [](const CompactImpl& m, W& w, D& d, const double* v, const double* a, const CentroidalMaps<double>& out) {
    return kernels::centroidal(m, w, d, v, a, out);
  };
  k.choleskyDecompose = [](const CompactImpl& m, D& d, const double* M) {
    int failed = 0;
    kernels::choleskyDecompose<WidestPack>(m, M, d.cholesky, &failed);
    return failed;
  };
  k.treeFactors = [](const CompactImpl& m, W& w, D& d) {
    kernels::treeFactors<WidestPack, Wide>(m, w, d);
    return w.failed[0];
  };
  k.inverseOfMassMatrix = [](const CompactImpl& m, D& d, double* out) {
    kernels::inverseOfMassMatrix<WidestPack>(m, d.factors, Rows<double>{out, m.nvx});
  };
  k.torqueRegressor = [](const CompactImpl& m, W& w, const TorqueRegressorMemory& x, double* out) {
    regressorMotions(Bodies<double>{m, w}, w, x);
    kernels::torqueRegressor<WidestPack>(m, w, x, out);
  };
}

}  // namespace dyn::kernels
