// SPDX-License-Identifier: BSD-2-Clause
// Scratch memory of recursions. A struct stands at the start of a block, and the arrays that its layOut() lays out follow.
#pragma once

#include "kernels/body/workspace.hpp"

#include <new>

namespace dyn::kernels {

template <class Scratch>
inline constexpr std::size_t scratch_head = (sizeof(Scratch) + Arena::alignment - 1) / Arena::alignment * Arena::alignment;

/// The bytes of such a block. `how` are the arguments that Scratch::layOut takes in addition to the model.
template <class Scratch, class... How>
std::size_t scratchBytes(const CompactImpl& m, How... how) {
  Scratch counted;
  return scratch_head<Scratch> + Scratch::layOut(counted, m, how..., nullptr);
}

/// Makes a Scratch in `memory`, which has scratchBytes() bytes of zeros and is aligned to Arena::alignment.
template <class Scratch, class... How>
Scratch& makeScratch(char* memory, const CompactImpl& m, How... how) {
  auto* s = new (memory) Scratch;
  Scratch::layOut(*s, m, how..., memory + scratch_head<Scratch>);
  return *s;
}

}  // namespace dyn::kernels
