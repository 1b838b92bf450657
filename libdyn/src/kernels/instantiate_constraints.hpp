// The kernels of constraints of one table.
#pragma once

#include "kernels/constraints.hpp"
#include "kernels/table.hpp"

namespace dyn::kernels {

/// Panel: what rows are worked on in, side by side.
template <class Panel>
void addConstraints(SingleKernels& k) {
  k.constraintSweep = [](const CompactImpl& m, const Workspace<double>& w, const PackedConstraints& c, bool eliminated, ConstraintWorkspace& x) {
    kernels::constraintSweep<Panel>(m, w, c, eliminated, x);
  };
  k.delassusMatrix = [](const Workspace<double>& w, const PackedConstraints& c, ConstraintWorkspace& x) { kernels::delassusMatrix<Panel>(w, c, x); };
  k.constraint_layout = constraintLayoutStamp();
}

}  // namespace dyn::kernels
