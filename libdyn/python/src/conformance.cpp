// SPDX-License-Identifier: BSD-2-Clause
// The checks of a joint or coupling type.
#include "description.hpp"

#include <dyn/conformance/conformance.hpp>

#include <pybind11/stl.h>

namespace dyn::python {

namespace {

/// Runs checks with the given parameters, or with those that the seed chooses. The interpreter's lock is free while they run.
template <class Type, class Check>
std::vector<ConformanceFinding> checked(const Type& type, const std::optional<GivenParameters>& given, std::uint64_t seed, const Check& check) {
  const Parameters parameters = given ? parametersOf(*given) : exampleParameters(type.info(), seed);
  const py::gil_scoped_release unlocked;
  return check(type, parameters);
}

}  // namespace

void addConformance(py::module_& m) {
  py::class_<ConformanceFinding>(m, "ConformanceFinding", "The outcome of one check of a type.")
      .def_readonly("check", &ConformanceFinding::check, "What was checked.")
      .def_readonly("passed", &ConformanceFinding::passed, "Whether the error is within the bound.")
      .def_readonly("error", &ConformanceFinding::error, "The largest error, relative to max(1, size); infinite if a result was not finite.")
      .def_readonly("bound", &ConformanceFinding::bound, "The largest error allowed.")
      .def_readonly("detail", &ConformanceFinding::detail, "Where the largest error occurred, or what was found.")
      .def("__repr__", [](const ConformanceFinding& f) { return "<" + f.check + (f.passed ? ": passed>" : ": FAILED, " + f.detail + ">"); });
  const py::arg type("type");
  const py::arg_v seed("seed", 1), parameters("parameters", py::none()), reg("registry", py::none());
  m.def(
      "example_parameters", [](const TypeInfo& t, std::uint64_t s) { return exampleParameters(*t.info, s); }, type, seed,
      "Returns plausible parameters of a JointTypeInfo by name: the author's examples, else random ones. Optional ones without an example are given "
      "for even seeds only.");
  m.def(
      "check_joint_type",
      [](const std::string& name, const std::optional<GivenParameters>& given, const JointRegistry* r, std::uint64_t s) {
        // The copy stays as it is while another thread loads plugins.
        const JointRegistry types = registryOr(r);
        return checked(types.jointType(name), given, s, [&](const JointType& t, const Parameters& p) { return checkJointType(t, p, types, s); });
      },
      type, parameters, py::kw_only(), reg, seed,
      "Checks that a joint type (by name) satisfies the assumptions of the algorithms, at random configurations; returns the findings.\n\n"
      "It compares results of the type that must agree, such as its subspace and differences of poses. parameters: those of the joint; without them\n"
      "example_parameters() makes some. The checks run in this process: code of a plugin that crashes ends it (`dyn plugin check` does not end).");
  m.def(
      "check_coupling_type",
      [](const std::string& name, const std::optional<GivenParameters>& given, const JointRegistry* r, std::uint64_t s) {
        return checked(registryOr(r).couplingType(name), given, s,
                       [&](const CouplingType& t, const Parameters& p) { return checkCouplingType(t, p, s); });
      },
      type, parameters, py::kw_only(), reg, seed, "Compares the derivatives of a coupling type (by name) with differences; returns the findings.");
}

}  // namespace dyn::python
