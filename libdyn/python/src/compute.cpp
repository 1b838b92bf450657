// SPDX-License-Identifier: BSD-2-Clause
// Several quantities of one state at once, and states in the layouts of other libraries.
#include "choices.hpp"
#include "module.hpp"

#include <dyn/algorithm/compute.hpp>
#include <dyn/algorithm/layout.hpp>
#include <dyn/near_names.hpp>

#include <pybind11/eigen.h>
#include <pybind11/stl.h>

namespace dyn::python {

namespace {

using Vector = Eigen::Ref<const Eigen::VectorXd>;

/// The quantities by the names of their C++ enumerators.
const std::vector<std::pair<const char*, Algorithm>> quantities = {
    {"placements", Algorithm::placements},
    {"velocities", Algorithm::velocities},
    {"accelerations", Algorithm::accelerations},
    {"joint_jacobians", Algorithm::joint_jacobians},
    {"center_of_mass", Algorithm::center_of_mass},
    {"energies", Algorithm::energies},
    {"rnea", Algorithm::rnea},
    {"nle", Algorithm::nle},
    {"gravity", Algorithm::gravity},
    {"mass_matrix", Algorithm::mass_matrix},
    {"minverse", Algorithm::minverse},
    {"rnea_derivatives", Algorithm::rnea_derivatives},
    {"coriolis", Algorithm::coriolis},
    {"centroidal_map", Algorithm::centroidal_map},
    {"centroidal_rate", Algorithm::centroidal_rate},
};

Algorithms setOf(const std::vector<std::string>& names) {
  Algorithms out;
  for (const std::string& name : names) {
    const auto found = std::find_if(quantities.begin(), quantities.end(), [&](const auto& x) { return name == x.first; });
    if (found == quantities.end()) {
      std::vector<std::string> all;
      for (const auto& x : quantities) all.emplace_back(x.first);
      throw Error(ErrorCode::argument, "compute: there is no quantity '" + name + "'" + nearNames(name, all));
    }
    out = out | found->second;
  }
  return out;
}

py::dict computed(const CompactModel& model, Data& data, const std::vector<std::string>& names, const Vector& q, const std::optional<Vector>& v,
                  const std::optional<Vector>& a) {
  const Algorithms what = setOf(names);
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(model.nv());
  const Computed x = compute(model, data, what, q, v ? *v : Vector(zero), a ? *a : Vector(zero));
  using namespace py::literals;
  py::dict out("passes"_a = py::dict("joints"_a = x.passes.joints, "subspaces"_a = x.passes.subspaces, "kinematics"_a = x.passes.kinematics,
                                     "dynamics"_a = x.passes.dynamics, "inertias"_a = x.passes.inertias, "derivatives"_a = x.passes.derivatives));
  if (has(what, Algorithm::center_of_mass)) out["center_of_mass"] = x.center_of_mass;
  if (has(what, Algorithm::energies)) {
    out["kinetic_energy"] = x.kinetic_energy;
    out["potential_energy"] = x.potential_energy;
  }
  const auto add = [&out](const char* name, const auto& numbers) {
    if (numbers.data() != nullptr) out[name] = numbers.eval();
  };
  add("tau", x.tau);
  add("nle", x.nle);
  add("gravity", x.gravity);
  add("hg", x.hg);
  add("dhg", x.dhg);
  add("J", x.J);
  add("M", x.M);
  add("Minv", x.Minv);
  add("C", x.C);
  add("Ag", x.Ag);
  add("dAg", x.dAg);
  add("dtau_dq", x.dtau_dq);
  add("dtau_dv", x.dtau_dv);
  return out;
}

Layout layoutOf(const std::string& name) {
  return chosen<Layout>("layout", name,
                        {{"pinocchio", Layout::pinocchio}, {"rbdl", Layout::rbdl}, {"mujoco", Layout::mujoco}, {"drake", Layout::drake}});
}

}  // namespace

void addCompute(py::module_& m) {
  const py::arg model("model"), layout("layout"), q("q"), v("v");
  m.def(
      "compute", &computed, model, py::arg("data"), py::arg("what"), q, py::arg("v") = py::none(), py::arg("a") = py::none(),
      "Computes several quantities of one state at once; returns a dictionary of the results by name. Passes that they share run only once.\n\n"
      "what: names out of placements, velocities, accelerations, joint_jacobians (J), center_of_mass, energies (kinetic_energy, potential_energy),\n"
      "rnea (tau), nle, gravity, mass_matrix (M), minverse (Minv), rnea_derivatives (dtau_dq, dtau_dv, M), coriolis (C), centroidal_map (hg, Ag) "
      "and\n"
      "centroidal_rate (hg, dhg, Ag, dAg). Read poses and motions by frame_placement() and the like. v and a count as zero unless they are given.\n"
      "passes has the number of passes over the model that the call made, by kind.");
  m.def(
      "layout_nq", [](const CompactModel& x, const std::string& name) { return layoutNq(x, layoutOf(name)); }, model, layout,
      "Returns the number of entries of q in the layout of another library: 'pinocchio', 'rbdl', 'mujoco' or 'drake'.");
  m.def(
      "to_layout",
      [](const CompactModel& x, const std::string& name, const Vector& at, const Vector& w) {
        const StateVectors out = toLayout(x, layoutOf(name), at, w);
        return py::make_tuple(out.q, out.v);
      },
      model, layout, q, v, "Returns q and v in the layout of another library: 'pinocchio', 'rbdl', 'mujoco' or 'drake'.");
  m.def(
      "from_layout",
      [](const CompactModel& x, const std::string& name, const Vector& at, const Vector& w) {
        const StateVectors out = fromLayout(x, layoutOf(name), at, w);
        return py::make_tuple(out.q, out.v);
      },
      model, layout, q, v, "Returns libdyn's q and v of a state in the layout of another library.");
}

}  // namespace dyn::python
