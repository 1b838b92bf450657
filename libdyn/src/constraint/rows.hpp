// Where constraints are, how fast they are violated, and what their forces do: everything about rows that one pass from each constraint to
// the world finds.
#pragma once

#include "compile/constraints.hpp"
#include "data/data_impl.hpp"
#include "kernels/constraint_workspace.hpp"
#include "kernels/row_derivatives.hpp"

namespace dyn {

/// Of each row. Accelerations are beside what the kernel's sweep finds.
struct RowMotion {
  double* bias;   ///< acceleration that velocities make
  double* drift;  ///< the same with what is fed back of the velocity and of the error
  double* fall;   ///< acceleration that gravity makes where the sweep had the world fall up
  double* velocity;
  double* error;  ///< of position

  void put(int row, double v, double rate, double distance, const Baumgarte& b) const {
    velocity[row] = v;
    bias[row] = rate;
    error[row] = distance;
    drift[row] = rate + b.velocity * v + b.position * distance;
  }
};

/// Once the kernel has located chains. q and v in expanded coordinates; v may be null (at rest).
void locateRows(const CompactImpl& m, const PackedConstraints& c, const kernels::ConstraintWorkspace& x, const double* q, const double* v,
                FrameRows* frames, const RowMotion& rows);

/// Writes the rows' unit forces for the kernel's sweep.
void writeRowForces(const CompactImpl& m, const PackedConstraints& c, const FrameRows* frames, const double* q, kernels::ConstraintWorkspace& x);

/// The same with forces of the rows: one force a body of the constraints, and shares of their degrees of freedom.
void sumRowForces(const CompactImpl& m, const PackedConstraints& c, const FrameRows* frames, const double* q, const double* lambda,
                  Force<double>* bodies, double* shares);

/// Accelerations of the rows by those of chains and joints, without their bias.
void rowAccelerations(const CompactImpl& m, const PackedConstraints& c, const FrameRows* frames, const double* q,
                      const kernels::ConstraintWorkspace& x, double* out);

}  // namespace dyn
