// Scratch of recursions with memory of their own: a struct at the start of a block, and behind it the arrays that its carve() hands out.
#pragma once

#include "kernels/workspace.hpp"

#include <new>

namespace dyn::kernels {

template <class Scratch>
inline constexpr std::size_t scratch_head = (sizeof(Scratch) + Arena::alignment - 1) / Arena::alignment * Arena::alignment;

/// `how`: what Scratch::carve asks for beside the model.
template <class Scratch, class... How>
std::size_t scratchBytes(const CompactImpl& m, How... how) {
  Scratch counted;
  return scratch_head<Scratch> + Scratch::carve(counted, m, how..., nullptr);
}

/// In so many bytes of zeros, aligned as Arena says.
template <class Scratch, class... How>
Scratch& makeScratch(char* memory, const CompactImpl& m, How... how) {
  auto* s = new (memory) Scratch;
  Scratch::carve(*s, m, how..., memory + scratch_head<Scratch>);
  return *s;
}

}  // namespace dyn::kernels
