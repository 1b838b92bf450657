#include "algorithm/dense_factors.hpp"

#include "algorithm/inputs.hpp"

#include <cmath>
#include <limits>

namespace dyn {

void factorDense(const char* algorithm, const CompactImpl& m, double* M, double* diagonal) {
  const std::ptrdiff_t n = m.nv;
  for (std::ptrdiff_t k = 0; k < n; ++k) diagonal[k] = M[k * n + k];
  for (std::ptrdiff_t k = n - 1; k >= 0; --k) {
    const double pivot = M[k * n + k];
    // NaN and infinity are those of q, and spread.
    if (pivot <= 8 * std::numeric_limits<double>::epsilon() * diagonal[k] && std::isfinite(diagonal[k])) {
      std::size_t joint = m.joints.size() - 1;
      while (m.joints[joint].idx_v > k || m.joints[joint].nv == 0) --joint;
      refuseSingular(algorithm, m.joints[joint].name);
    }
    for (std::ptrdiff_t i = 0; i < k; ++i) {
      const double l = M[k * n + i] / pivot;
      if (l == 0) continue;
      for (std::ptrdiff_t j = 0; j <= i; ++j) M[i * n + j] -= l * M[k * n + j];
    }
  }
}

void solveDense(const CompactImpl& m, const double* factors, double* x) {
  const std::ptrdiff_t n = m.nv;
  for (std::ptrdiff_t k = n - 1; k >= 0; --k)
    for (std::ptrdiff_t i = 0; i < k; ++i) x[i] -= factors[k * n + i] / factors[k * n + k] * x[k];
  for (std::ptrdiff_t k = 0; k < n; ++k) {
    double sum = x[k];
    for (std::ptrdiff_t i = 0; i < k; ++i) sum -= factors[k * n + i] * x[i];
    x[k] = sum / factors[k * n + k];
  }
}

}  // namespace dyn
