// SPDX-License-Identifier: BSD-2-Clause
// The parts of a table of kernels. The sources of a table are compiled once for each instruction set, into the module of that set, and not into the
// library. The compiler flags decide how wide packs are.
#pragma once

#include "kernels/isa/table.hpp"

#include <dyn_sdk/pack.hpp>

namespace dyn::kernels {

#if DYN_HAS_PACKS && !defined(DYN_SCALAR_TABLE)
using Doubles = Pack<double>;
using Floats = Pack<float>;
#else
using Doubles = double;
using Floats = float;
#endif
/// Packs hold degrees of freedom or columns of a single state side by side. WidestPack is for all of them. Wide is for joints and for subtrees, most
/// of which are short; its four lanes are enough, because limbs come in twos and fours.
using WidestPack = Doubles;
#if defined(__AVX2__) && defined(__FMA__) && DYN_HAS_PACKS && !defined(DYN_SCALAR_TABLE)
using Wide = Pack<double, xsimd::fma3<xsimd::avx2>>;
#define DYN_JOINTS_IN_LANES 1
#else
using Wide = WidestPack;
#define DYN_JOINTS_IN_LANES 0
#endif

// Each part is defined in the source file of its name, or in the file named next to it.
SingleKernels singleKernels();
void addDerivatives(SingleKernels& k);        ///< single_derivatives.cpp
void addFactors(SingleKernels& k);            ///< single_factors.cpp
const ConstraintKernels& tableConstraints();  ///< constraints.cpp
PackedKernels jointsInLanes();                ///< lane_groups.cpp; like those of vectored(), all null without DYN_JOINTS_IN_LANES
PackedKernels vectored();
BlockKernels<double> batchesOfDoubles();
BlockKernels<float> batchesOfFloats();

}  // namespace dyn::kernels
