// SPDX-License-Identifier: BSD-2-Clause
// Types without a motion of their own: the joint type composite, which the compiler expands, and the coupling type mimic.
#pragma once

#include "one_axis.hpp"

#include <algorithm>

namespace dyn::standard {

struct Composite : sdk::Joint<Composite, 0> {
  static constexpr const char* name = "composite";
  static constexpr const char* summary = "any list of other joints, one after the other; q and v are theirs in order";
  static constexpr Shape shape = Shape::translation;
  static constexpr Structure structure = Structure::series;
  static constexpr std::array parameters{ParameterSpec{"parts", ParameterKind::joints, true, "", "the joints, from the parent to the child"}};
  template <class S>
  static void coordinates(const S*, const sdk::Constants&, S* p) {
    p[0] = p[1] = p[2] = S(0);
  }
};

struct Mimic {
  static constexpr const char* name = "mimic";
  static constexpr const char* summary = "polynomial in the master's coordinate: c0 + c1 q + c2 q^2 + ...";
  static constexpr std::array parameters{
      ParameterSpec{"coefficients", ParameterKind::numbers, true, "", "constant term first: offset, multiplier, ..."}};
  static bool check(const ParameterArgument* a, const sdk::Refusal& refuse) { return a[0].count > 0 || refuse("coefficients must not be empty"); }
  /// Horner's rule, with its first three derivatives.
  static void derivatives(double x, const sdk::Constants& c, double* f) {
    std::fill_n(f, 4, 0.0);
    for (int k = c.size() - 1; k >= 0; --k) {
      for (int order = 3; order > 0; --order) f[order] = f[order] * x + order * f[order - 1];
      f[0] = f[0] * x + c[k];
    }
  }
};

}  // namespace dyn::standard
