// Where sweeps along paths to the root enter what they find of two degrees of freedom: in matrices, or in pairs.
#pragma once

#include "kernels/derivatives.hpp"
#include "kernels/subtree.hpp"

namespace dyn::kernels {

/// Where a sweep enters what it finds.
template <class S, bool pairs = in_pairs<S>>
class PathEntries {
 public:
  explicit PathEntries(const DerivativeWorkspace<S>& d) : by_a_(d.by_a), by_q_(d.by_q), by_v_(d.by_v) {}
  /// Of some neighbouring degrees of freedom, and a joint on their way whose first one is iv; k counts from there.
  template <class Part>
  struct At {
    using Wide = typename Part::Number;
    const PathEntries& entries;
    const Part& part;
    int iv;
    void inertia(int k, const Wide& x) const { entries.by_a_.enterBelow(part, iv + k, x); }
    void below(int k, const Below<Wide>& x) const {
      entries.by_q_.enterBelow(part, iv + k, x.q);
      entries.by_v_.enterBelow(part, iv + k, x.v);
    }
    /// Zeros outside the subtree.
    void rightByQ(int k, const Wide& x) const { part.store(x, entries.by_q_.right[iv + k]); }
    void rightByV(int k, const Wide& x) const { part.store(x, entries.by_v_.right[iv + k]); }
    /// The same for products, which scale it by 1 / D.
    void shareByQ(int k, const Wide& x) const { rightByQ(k, x); }
    void shareByV(int k, const Wide& x) const { rightByV(k, x); }
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
  explicit PathEntries(const DerivativeWorkspace<S>& d) : pairs_(d.pairs), shares_(d.shares), inverse_(d.factors.inverse) {}
  struct At {
    using Pairs = PathPairs<S>;
    using Shares = ColumnShares<S>;
    S *row, *shares;
    std::ptrdiff_t stride;
    const S* inverse;  ///< 1 / D
    void inertia(int k, const S& x) const { row[Pairs::numbers * k + Pairs::by_a] = x; }
    void below(int k, const Below<S>& x) const {
      row[Pairs::numbers * k + Pairs::q_below] = x.q;
      belowByV(k, x.v);
    }
    void belowByV(int k, const S& x) const { row[Pairs::numbers * k + Pairs::v_below] = x; }
    void rightByQ(int k, const S& x) const { row[Pairs::numbers * k + Pairs::q_right] = x; }
    void rightByV(int k, const S& x) const { row[Pairs::numbers * k + Pairs::v_right] = x; }
    void shareByQ(int k, const S& x) const { shares[stride * k + Shares::by_q] = inverse[k] * x; }
    void shareByV(int k, const S& x) const { shares[stride * k + Shares::by_v] = inverse[k] * x; }
  };
  template <class Part>
  At at(const CompactImpl& m, const Part& part, int iv) const {
    const int depth = m.dof_depth[static_cast<std::size_t>(iv)];
    const auto& column = shares_[part.first()];
    return {pairs_.row(part.first(), depth), column.at(depth), column.stride, inverse_ + iv};
  }

 private:
  const PathPairs<S> pairs_;
  const ColumnShares<S> shares_;
  const S* inverse_;
};

}  // namespace dyn::kernels
