// SPDX-License-Identifier: BSD-2-Clause
// The parts of the module libdyn._core. Each function adds the names of one source.
#pragma once

#include <dyn/error.hpp>

#include <pybind11/pybind11.h>

#include <string>

namespace dyn::python {

namespace py = pybind11;

void addErrors(py::module_& m);
void addSpatial(py::module_& m);
void addLie(py::module_& m);
void addRegistry(py::module_& m);
void addSubclasses(py::module_& m);
void addInertialParameters(py::module_& m);
void addDescription(py::module_& m);
void addFiles(py::module_& m);
void addJointTypes(py::module_& m);
void addConformance(py::module_& m);
void addCompactModel(py::module_& m);
void addData(py::module_& m);
void addNamedAccess(py::module_& m);
void addConfiguration(py::module_& m);
void addKinematics(py::module_& m);
void addBatchKinematics(py::module_& m);
void addFunctions(py::module_& m);
void addConstraints(py::module_& m);
void addFriction(py::module_& m);
void addDelassus(py::module_& m);
void addGroups(py::module_& m);
void addShapes(py::module_& m);
void addFrameConstraint(py::module_& m);
void addGeometry(py::module_& m);
void addContactFinders(py::module_& m);
void addDerivatives(py::module_& m);
void addCompute(py::module_& m);
void addSimulation(py::module_& m);
void addIslands(py::module_& m);
void addRollout(py::module_& m);
void addGraphs(py::module_& m);
void addCodegen(py::module_& m);
/// Lets the functions that the module has by now name the argument that does not fit.
void addArgumentErrors(py::module_& m);

/// Returns a libdyn.Error with the attributes code, file, line, joint, place and remedy.
py::object errorOf(const Error& e);
/// Returns a text of the library with the names that Python has for what it names: Need.MASS_MATRIX for Need::mass_matrix.
std::string inPython(const std::string& text);
/// Gives a libdyn.ModelWarning to Python's warnings. Throws if these make it an error.
void warn(const std::string& text);
/// Sets Python's error from the C++ exception that is being handled; returns null.
PyObject* fail();

}  // namespace dyn::python
