// SPDX-License-Identifier: BSD-2-Clause
// Visits the bodies with vectors in registers.
#pragma once

#include "kernels/pack/vectored.hpp"
// Specialisations come before the templates that use them.
#include "kernels/order/register_cached.hpp"

namespace dyn::kernels {

/// Constants are the right factors of products with vectors. They stay single numbers in memory, and a load copies them to all lanes at no cost.
struct VectoredBodies : CachedBodies<Vectored> {
  static constexpr bool latency_bound = true, shared_constants = false;
  const BodyConstants<double>& constants(int i) const { return m.constants[static_cast<std::size_t>(i)]; }
};

}  // namespace dyn::kernels
