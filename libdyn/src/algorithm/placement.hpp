// Where joints and frames sit on bodies, and motions expressed where the user wants them.
#pragma once

#include "data/data_impl.hpp"

#include <dyn/algorithm/kinematics.hpp>

namespace dyn {

struct PointOnBody {
  int body;
  const SE3<double>& placement;  ///< in the body's core frame
};

/// Throw Error(argument) for a number out of range.
PointOnBody frameOnBody(const CompactModel& model, int frame);
PointOnBody jointOnBody(const CompactModel& model, int joint);

/// A motion given in the frame's axes at its origin, expressed as asked.
Motion<double> express(const Motion<double>& local, const SE3<double>& oMf, ReferenceFrame reference);

}  // namespace dyn
