// What a table is put together from. Each source of a table is compiled once for every instruction set, in the library itself for what every
// processor has; the flags it is compiled with say how wide packs are.
#pragma once

#include "kernels/table.hpp"

#include <dyn_sdk/pack.hpp>

#include <type_traits>

namespace dyn::kernels {

#if DYN_HAS_PACKS && !defined(DYN_SCALAR_TABLE)
using Doubles = Pack<double>;
using Floats = Pack<float>;
#else
using Doubles = double;
using Floats = float;
#endif
/// A single state's degrees of freedom, or columns, are worked on side by side: in Panel where all of them are, in Wide where subtrees are, most of
/// them short, and joints: limbs come in twos and fours, so four is enough.
using Panel = Doubles;
#if defined(__AVX2__) && defined(__FMA__) && DYN_HAS_PACKS && !defined(DYN_SCALAR_TABLE)
using Wide = Pack<double, xsimd::fma3<xsimd::avx2>>;
constexpr bool joints_in_lanes = true;
#else
using Wide = Panel;
constexpr bool joints_in_lanes = false;
#endif

// Each in the source of its name.
SingleKernels singleKernels();
void addDerivatives(SingleKernels& k);        ///< single_derivatives.cpp
void addFactors(SingleKernels& k);            ///< single_factors.cpp
const ConstraintKernels& tableConstraints();  ///< constraints.cpp
PackedKernels jointsInLanes();                ///< strips.cpp; all null where packs are too narrow
PackedKernels vectored();
BlockKernels<double> batchesOfDoubles();
BlockKernels<float> batchesOfFloats();

}  // namespace dyn::kernels
