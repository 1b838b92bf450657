// SPDX-License-Identifier: BSD-2-Clause
// Where the sweeps along root paths enter their results for two degrees of freedom: in matrices, or in pairs.
#pragma once

#include "kernels/derivative/derivatives.hpp"
#include "kernels/order/subtree.hpp"

namespace dyn::kernels {

/// The results in matrices. The specialisation below has them in pairs and column projections, for states in packs.
template <class S, bool pairs = in_pairs<S>>
class PathEntries {
 public:
  explicit PathEntries(const DerivativeWorkspace<S>& d) : by_a_(d.by_a), by_q_(d.by_q), by_v_(d.by_v) {}
  /// The entries of some neighbouring degrees of freedom (`part`) with a joint on their root path. iv: that joint's first degree of freedom, from
  /// which k counts.
  template <class Part>
  struct At {
    using Wide = typename Part::Number;
    const PathEntries& entries;
    const Part& part;
    int iv;
    void inertia(int k, const Wide& x) const { entries.by_a_.enterLower(part, iv + k, x); }
    void below(int k, const LowerEntries<Wide>& x) const {
      entries.by_q_.enterLower(part, iv + k, x.q);
      entries.by_v_.enterLower(part, iv + k, x.v);
    }
    /// x must be zero outside the subtree.
    void upperByQ(int k, const Wide& x) const { part.store(x, entries.by_q_.right[iv + k]); }
    void upperByV(int k, const Wide& x) const { part.store(x, entries.by_v_.right[iv + k]); }
    /// The same for products, which scale x by 1 / D themselves.
    void projectionByQ(int k, const Wide& x) const { upperByQ(k, x); }
    void projectionByV(int k, const Wide& x) const { upperByV(k, x); }
  };
  template <class Part>
  At<Part> at(const CompactImpl&, const Part& part, int iv) const {
    return {*this, part, iv};
  }

 private:
  const PathMatrix<S> by_a_, by_q_, by_v_;
};
template <class S>
class PathEntries<S, true> {
 public:
  explicit PathEntries(const DerivativeWorkspace<S>& d) : pairs_(d.pairs), projections_(d.projections), inverse_(d.factors.inverse) {}
  struct At {
    using Pairs = PathPairs<S>;
    using Projections = ColumnProjections<S>;
    S *row, *projections;
    std::ptrdiff_t stride;
    const S* inverse;  ///< 1 / D
    void inertia(int k, const S& x) const { row[Pairs::numbers * k + Pairs::by_a] = x; }
    void below(int k, const LowerEntries<S>& x) const {
      row[Pairs::numbers * k + Pairs::q_lower] = x.q;
      lowerByV(k, x.v);
    }
    void lowerByV(int k, const S& x) const { row[Pairs::numbers * k + Pairs::v_lower] = x; }
    void upperByQ(int k, const S& x) const { row[Pairs::numbers * k + Pairs::q_upper] = x; }
    void upperByV(int k, const S& x) const { row[Pairs::numbers * k + Pairs::v_upper] = x; }
    void projectionByQ(int k, const S& x) const { projections[stride * k + Projections::by_q] = inverse[k] * x; }
    void projectionByV(int k, const S& x) const { projections[stride * k + Projections::by_v] = inverse[k] * x; }
  };
  template <class Part>
  At at(const CompactImpl& m, const Part& part, int iv) const {
    const int depth = m.dof_depth[static_cast<std::size_t>(iv)];
    const auto& column = projections_[part.first()];
    return {pairs_.row(part.first(), depth), column.at(depth), column.stride, inverse_ + iv};
  }

 private:
  const PathPairs<S> pairs_;
  const ColumnProjections<S> projections_;
  const S* inverse_;
};

}  // namespace dyn::kernels
