// SPDX-License-Identifier: BSD-2-Clause
// Constraints between two frames with all their choices. constraints.cpp has the usual ones under shorter names.
#include "module.hpp"

#include <dyn/error.hpp>
#include <dyn/model/constraint.hpp>
#include <dyn/spatial/reference_frame.hpp>

#include <pybind11/stl.h>

namespace dyn::python {

namespace {

ConstraintAxes axesOf(ReferenceFrame reference) {
  if (reference == ReferenceFrame::LOCAL) return ConstraintAxes::LOCAL;
  if (reference == ReferenceFrame::LOCAL_WORLD_ALIGNED) return ConstraintAxes::LOCAL_WORLD_ALIGNED;
  throw Error(ErrorCode::argument, "frame_constraint: axes must be LOCAL or LOCAL_WORLD_ALIGNED");
}

}  // namespace

void addFrameConstraint(py::module_& m) {
  m.def(
      "frame_constraint",
      [](const std::string& name, const std::string& frame, const std::string& other, const SE3<double>& placement,
         const SE3<double>& other_placement, const std::array<bool, 6>& free, ReferenceFrame axes, bool target) {
        return ConstraintDescription{name, FrameConstraint{frame, other, placement, other_placement, free, axesOf(axes), target}};
      },
      py::arg("name"), py::arg("frame"), py::arg("other") = "universe", py::arg("placement") = SE3<double>(),
      py::arg("other_placement") = SE3<double>(), py::kw_only(), py::arg("free") = std::array<bool, 6>{},
      py::arg_v("axes", ReferenceFrame::LOCAL, "LOCAL"), py::arg("target") = false,
      "Describes a constraint between a frame at `placement` in `frame` and one at `other_placement` in `other`.\n\n"
      "free: the directions, translations then rotations, that it leaves free. axes: those of the rows, of its own frame (LOCAL) or of the world\n"
      "(LOCAL_WORLD_ALIGNED). target: the two frames shall coincide; without it, the constraint holds them wherever they are.");
}

}  // namespace dyn::python
