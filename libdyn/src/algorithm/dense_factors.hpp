// Factors of the mass matrix of models with couplings, which connect distant joints: M is taken as dense.
#pragma once

#include "compile/compact_impl.hpp"

namespace dyn {

/// In place, square-root-free from the leaves to the root (Featherstone 2008, ch. 8). `diagonal`: scratch of nv numbers.
/// Throws Error(singular) naming the joint whose pivot is of the rounding of its diagonal's size. NaN and infinity just spread.
void factorDense(const char* algorithm, const CompactImpl& m, double* M, double* diagonal);
/// x = M^-1 x by these factors.
void solveDense(const CompactImpl& m, const double* factors, double* x);

}  // namespace dyn
