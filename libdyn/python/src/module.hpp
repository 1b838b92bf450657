// SPDX-License-Identifier: BSD-2-Clause
// The parts of the module libdyn._core. Each function adds the names of one source.
#pragma once

#include <pybind11/pybind11.h>

namespace dyn::python {

namespace py = pybind11;

void addErrors(py::module_& m);
void addSpatial(py::module_& m);
void addSubclasses(py::module_& m);
void addLie(py::module_& m);
void addInertialParameters(py::module_& m);
void addDescription(py::module_& m);
void addFiles(py::module_& m);
void addJointTypes(py::module_& m);
void addCompactModel(py::module_& m);
void addData(py::module_& m);
void addConfiguration(py::module_& m);
void addKinematics(py::module_& m);
void addFunctions(py::module_& m);
void addConstraints(py::module_& m);
void addFrameConstraint(py::module_& m);
void addGeometry(py::module_& m);
void addDerivatives(py::module_& m);
void addSimulation(py::module_& m);

/// Sets Python's error from the C++ exception that is being handled; returns null.
PyObject* fail();

}  // namespace dyn::python
