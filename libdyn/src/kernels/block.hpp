// Scratch of one thread that computes blocks of states.
#pragma once

#include "kernels/derivatives.hpp"
#include "kernels/followers.hpp"
#include "kernels/squares.hpp"
#include "kernels/state_products.hpp"
#include "kernels/table.hpp"

namespace dyn::kernels {

/// What models with couplings take beside.
template <class S>
struct CoupledScratch {
  S* couplings;      ///< G, dG and ddG of all
  S *forces, *tau;   ///< of the user's coordinates; expanded, with followers' shares
  S *M, *diagonal;   ///< the user's, and its factors
  S* expanded[3]{};  ///< derivatives of rnea

  void carve(const CompactImpl& m, Room room, Arena& arena) {
    const auto n = static_cast<std::size_t>(m.nvx);
    arena.take(couplings, 3 * m.couplings.size());
    for (S** vector : {&forces, &tau, &diagonal}) arena.take(*vector, n);
    arena.take(M, n * n);
    if (room.derivatives)
      for (S*& matrix : expanded) arena.take(matrix, n * n);
  }
  /// Kernels write matrices where paths lead, and count on zeros elsewhere: of what has been folded.
  static void clear(const CompactImpl& m, S* matrix) { std::fill_n(matrix, static_cast<std::ptrdiff_t>(m.nvx) * m.nvx, S(0)); }
  Followers<S> followers(const CompactImpl& m, const S* v, const S* a) const {
    const std::size_t n = m.couplings.size();
    return {m, couplings, couplings + n, couplings + 2 * n, v, a};
  }
};

/// Scratch of one thread for blocks of states.
template <class S>
struct BlockScratch {
  Workspace<S> w;
  S *q, *v, *a, *result, *M, *J;
  MatrixSquares<S> squares;
  DerivativeWorkspace<S> d;
  S* matrix;   ///< nvx * nvx
  S* columns;  ///< a product's in turn: nvx each
  ProductScratch<S> product;
  S* maps[5];  ///< 6 nvx each
  CoupledScratch<S> coupled;

  static std::size_t carve(BlockScratch& s, const CompactImpl& m, Room room, char* base) {
    Arena arena(base);
    dyn::carve(s.w, m, arena);
    const auto nq = static_cast<std::size_t>(m.nqx), nv = static_cast<std::size_t>(m.nvx);
    arena.take(s.q, nq);
    arena.take(s.v, nv);
    arena.take(s.a, nv);
    arena.take(s.result, nv);
    arena.take(s.M, room.mass_matrix ? nv * nv : 0);
    if (room.mass_matrix) s.squares.carve(m, room.derivatives, arena);
    arena.take(s.J, room.jacobian ? 6 * nv : 0);
    if (!m.couplings.empty()) s.coupled.carve(m, room, arena);
    if (room.derivatives) {
      dyn::kernels::carve(s.d, m, arena);
      arena.take(s.matrix, nv * nv);
      arena.take(s.columns, std::min<std::size_t>(columns_abreast<S>, nv) * nv);
      s.product.carve(m, arena);
      for (S*& map : s.maps) arena.take(map, 6 * nv);
    }
    return arena.used();
  }
};

/// What a block's tasks write, result by result; notes in the block whether all is finite.
template <class S>
class Results {
 public:
  explicit Results(Block<Real<S>>& b) : b_(b) { b.not_finite = false; }

  /// `count` numbers a state, if they are wanted.
  void put(int result, const S* numbers, std::ptrdiff_t count) const {
    if (b_.results[result] != nullptr) putPart(result, numbers, count, 0, count);
  }
  /// Of `size` numbers a state those from `begin` on.
  void putPart(int result, const S* numbers, std::ptrdiff_t count, std::ptrdiff_t begin, std::ptrdiff_t size) const {
    if (!storeColumns(numbers, count, b_.q.states, b_.results[result] + begin, size)) b_.not_finite = true;
  }
  /// Of a matrix of `size` numbers those in squares, of which there are some.
  void putSquares(int result, const Squares<S>& squares, const S* numbers, std::ptrdiff_t size) const {
    if (!squares.store(numbers, b_.q.states, b_.results[result], size)) b_.not_finite = true;
  }
  void putFailures(const int* failed) const { std::copy_n(failed, b_.q.states, b_.failed); }

 private:
  Block<Real<S>>& b_;
};

/// The tasks of derivatives, joints asked.
template <class S>
void runDerivatives(const CompactImpl& m, BlockScratch<S>& s, Block<Real<S>>& b);

}  // namespace dyn::kernels
