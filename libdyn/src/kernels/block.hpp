// Scratch of one thread that computes blocks of states.
#pragma once

#include "kernels/derivatives.hpp"
#include "kernels/state_products.hpp"
#include "kernels/table.hpp"

namespace dyn::kernels {

/// Scratch of one thread for blocks of states.
template <class S>
struct BlockScratch {
  Workspace<S> w;
  S *q, *v, *a, *result, *M, *J;
  DerivativeWorkspace<S> d;
  S* matrix;   ///< nvx * nvx
  S* columns;  ///< a product's in turn: nvx each
  ProductScratch<S> product;
  S* maps[5];  ///< 6 nvx each

  static std::size_t carve(BlockScratch& s, const CompactImpl& m, Room room, char* base) {
    Arena arena(base);
    dyn::carve(s.w, m, arena);
    const auto nq = static_cast<std::size_t>(m.nqx), nv = static_cast<std::size_t>(m.nvx);
    arena.take(s.q, nq);
    arena.take(s.v, nv);
    arena.take(s.a, nv);
    arena.take(s.result, nv);
    arena.take(s.M, room.mass_matrix ? nv * nv : 0);
    arena.take(s.J, room.jacobian ? 6 * nv : 0);
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

/// A result of nv x nv numbers a state. Whether all are finite.
template <class S>
[[nodiscard]] bool storeMatrix(const CompactImpl& m, const S* packs, const Block<Real<S>>& b, int result) {
  const std::ptrdiff_t square = static_cast<std::ptrdiff_t>(m.nvx) * m.nvx;
  if (b.squares.empty()) return storeColumns(packs, square, b.q.states, b.results[result], square);
  return storeSquares(packs, b.squares, b.q.states, b.results[result], square);
}

}  // namespace dyn::kernels
