// The parts of a table of kernels. Each source of a table is compiled in the library, for every processor of this architecture, and again in a
// module for each instruction set. The flags decide how wide packs are.
#pragma once

#include "kernels/table.hpp"

#include <dyn_sdk/pack.hpp>

namespace dyn::kernels {

#if DYN_HAS_PACKS && !defined(DYN_SCALAR_TABLE)
using Doubles = Pack<double>;
using Floats = Pack<float>;
#else
using Doubles = double;
using Floats = float;
#endif
/// A single state's degrees of freedom, or columns, are worked on side by side. Panel takes all of them. Wide takes those of subtrees, most of which
/// are short, and joints: four lanes are enough, because limbs come in twos and fours.
using Panel = Doubles;
#if defined(__AVX2__) && defined(__FMA__) && DYN_HAS_PACKS && !defined(DYN_SCALAR_TABLE)
using Wide = Pack<double, xsimd::fma3<xsimd::avx2>>;
#define DYN_JOINTS_IN_LANES 1
#else
using Wide = Panel;
#define DYN_JOINTS_IN_LANES 0
#endif

// Each part is in the source of its name, or in the one named beside it.
SingleKernels singleKernels();
void addDerivatives(SingleKernels& k);        ///< single_derivatives.cpp
void addFactors(SingleKernels& k);            ///< single_factors.cpp
const ConstraintKernels& tableConstraints();  ///< constraints.cpp
PackedKernels jointsInLanes();                ///< strips.cpp; all null without DYN_JOINTS_IN_LANES, as those of vectored()
PackedKernels vectored();
BlockKernels<double> batchesOfDoubles();
BlockKernels<float> batchesOfFloats();

}  // namespace dyn::kernels
