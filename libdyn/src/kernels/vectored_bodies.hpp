// Walking the bodies with vectors in registers.
#pragma once

#include "kernels/vectored.hpp"
// Specialisations come before what is made of them.
#include "kernels/kept.hpp"

namespace dyn::kernels {

/// Where constants are what vectors are multiplied by, on the right: they stay single numbers in memory, from which they get into all lanes at
/// no cost.
struct AlignedBodies : KeepingBodies<Vectored> {
  static constexpr bool waits = true, alike = false;
  const BodyConstants<double>& constants(int i) const { return m.constants[static_cast<std::size_t>(i)]; }
};

}  // namespace dyn::kernels
