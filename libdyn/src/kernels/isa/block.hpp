// SPDX-License-Identifier: BSD-2-Clause
// Scratch of one thread that computes blocks of states.
#pragma once

#include "kernels/body/dependent_joints.hpp"
#include "kernels/derivative/derivatives.hpp"
#include "kernels/derivative/squares.hpp"
#include "kernels/derivative/state_products.hpp"
#include "kernels/derivative/tree_factors.hpp"
#include "kernels/isa/table.hpp"

namespace dyn::kernels {

/// Additional scratch for models with couplings.
template <class S>
struct CoupledScratch {
  S* couplings;      ///< G, dG and ddG of all couplings
  S *forces, *tau;   ///< tau of aba, user's coordinates; expanded forces, those of dependent joints added to their masters'
  S *M, *diagonal;   ///< mass matrix in the user's coordinates, later its factors; scratch of factorDense()
  S* expanded[3]{};  ///< derivatives of rnea by q, v and a

  void layOut(const CompactImpl& m, Room room, Arena& arena) {
    const auto n = static_cast<std::size_t>(m.nvx);
    arena.take(couplings, 3 * m.couplings.size());
    for (S** vector : {&forces, &tau, &diagonal}) arena.take(*vector, n);
    arena.take(M, n * n);
    if (room.derivatives)
      for (S*& matrix : expanded) arena.take(matrix, n * n);
  }
  /// Sets a folded matrix to zero. Kernels write only entries on root paths and rely on zeros elsewhere, but folding writes there, too.
  static void clear(const CompactImpl& m, S* matrix) { std::fill_n(matrix, static_cast<std::ptrdiff_t>(m.nvx) * m.nvx, S(0)); }
  DependentJoints<S> dependents(const CompactImpl& m, const S* v, const S* a) const {
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
  S* columns;  ///< some columns of a product at a time: nvx numbers each
  ProductScratch<S> product;
  S* maps[5];  ///< centroidal maps: 6 nvx numbers each
  CoupledScratch<S> coupled;

  static std::size_t layOut(BlockScratch& s, const CompactImpl& m, Room room, char* base) {
    Arena arena(base);
    dyn::layOut(s.w, m, arena);
    const auto nq = static_cast<std::size_t>(m.nqx), nv = static_cast<std::size_t>(m.nvx);
    arena.take(s.q, nq);
    arena.take(s.v, nv);
    arena.take(s.a, nv);
    arena.take(s.result, nv);
    arena.take(s.M, room.mass_matrix ? nv * nv : 0);
    if (room.mass_matrix) s.squares.layOut(m, room.derivatives, arena);
    arena.take(s.J, room.jacobian ? 6 * nv : 0);
    if (!m.couplings.empty()) s.coupled.layOut(m, room, arena);
    if (room.derivatives) {
      dyn::kernels::layOut(s.d, m, arena);
      arena.take(s.matrix, nv * nv);
      arena.take(s.columns, std::min<std::size_t>(columns_together<S>, nv) * nv);
      s.product.layOut(m, arena);
      for (S*& map : s.maps) arena.take(map, 6 * nv);
    }
    return arena.used();
  }
};

/// Writes the results of a block's algorithm, and notes in the block if a number is not finite.
template <class S>
class Results {
 public:
  explicit Results(Block<Real<S>>& b) : b_(b) { b.not_finite = false; }

  /// Writes `count` numbers per state if the result is wanted.
  void put(int result, const S* numbers, std::ptrdiff_t count) const {
    if (b_.results[result] != nullptr) putPart(result, numbers, count, 0, count);
  }
  /// Writes `count` of the `size` numbers per state, from number `begin` on.
  void putPart(int result, const S* numbers, std::ptrdiff_t count, std::ptrdiff_t begin, std::ptrdiff_t size) const {
    if (!storeColumns(numbers, count, b_.q.states, b_.results[result] + begin, size)) b_.not_finite = true;
  }
  /// Writes the numbers of a matrix of `size` numbers that are in `squares`, which must not be empty.
  void putSquares(int result, const Squares<S>& squares, const S* numbers, std::ptrdiff_t size) const {
    if (!squares.store(numbers, b_.q.states, b_.results[result], size)) b_.not_finite = true;
  }
  /// Writes the factors to the block's own memory.
  void keep(const CompactImpl& m, const TreeFactors<S>& factors, const int* failed) const {
    auto* const out = static_cast<S*>(b_.factors);
    keepFactors(m, factors, out);
    if (!allFinite(out, static_cast<std::ptrdiff_t>(keptNumbers(m)))) b_.not_finite = true;
    putFailures(failed);
  }
  void putFailures(const int* failed) const { std::copy_n(failed, b_.q.states, b_.failed); }

 private:
  Block<Real<S>>& b_;
};

/// The articulated-body recursion for the block's q, v and tau, without its last pass. Leaves the factors of the degrees of freedom in the bodies'
/// own axes, and the bodies' axes and columns in aligned axes. For models without dependent joints.
template <class S>
void articulateStates(const CompactImpl& m, BlockScratch<S>& s, Block<Real<S>>& b);
/// The last pass: writes the accelerations under this gravity to the block's first result.
template <class S>
void accelerateStates(const CompactImpl& m, BlockScratch<S>& s, const Vec3<double>& gravity, Block<Real<S>>& b);

/// Runs algorithms that are derivatives, factors or centroidal quantities. The joints must have been evaluated before.
template <class S>
void runDerivatives(const CompactImpl& m, BlockScratch<S>& s, Block<Real<S>>& b);

}  // namespace dyn::kernels
