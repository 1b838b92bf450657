// SPDX-License-Identifier: BSD-2-Clause
// Joints and frames by name: data.frame("tool").placement, model.q_index["elbow"], with completion in interactive shells.
#include "names.hpp"
#include "objects.hpp"

#include <dyn/algorithm/jacobians.hpp>
#include <dyn/near_names.hpp>

#include <pybind11/eigen.h>

#include <memory>

namespace dyn::python {

namespace {

/// The functions of joints, and those of frames.
struct Kind {
  const char* name;
  int (CompactModel::*find)(const std::string&) const;
  SE3<double> (*placement)(const CompactModel&, const Data&, int);
  Motion<double> (*velocity)(const CompactModel&, const Data&, int, ReferenceFrame);
  Motion<double> (*acceleration)(const CompactModel&, const Data&, int, ReferenceFrame);
  void (*jacobian)(const CompactModel&, Data&, int, ReferenceFrame, const MatrixOut&);
};
const Kind joints = {"joint", &CompactModel::jointId, &jointPlacement, &jointVelocity, &jointAcceleration, &getJointJacobian};
const Kind frames = {"frame", &CompactModel::frameId, &framePlacement, &frameVelocity, &frameAcceleration, &getFrameJacobian};

std::vector<std::string> namesOf(const CompactModel& model, const Kind& kind) {
  return &kind == &joints ? dyn::namesOf(model.joints()) : dyn::namesOf(model.frames());
}

/// A joint or frame of a Data, which it keeps alive.
struct Place {
  std::shared_ptr<Data> data;
  const Kind* kind;
  int id;

  const CompactModel& model() const { return modelOf(*data); }
  std::string name() const { return python::namesOf(model(), *kind)[static_cast<std::size_t>(id)]; }
};

/// All joints or frames of a Data.
struct Places {
  std::shared_ptr<Data> data;
  const Kind* kind;

  Place at(const std::string& name) const { return {data, kind, (modelOf(*data).*kind->find)(name)}; }
  std::vector<std::string> names() const { return python::namesOf(modelOf(*data), *kind); }
};

void addPlaces(py::module_& m) {
  py::class_<Place>(m, "Place", "A joint or frame, as the last forward_kinematics() of a Data found it. Motions are in LOCAL axes.")
      .def_property_readonly("name", &Place::name, "The name of the joint or frame.")
      .def_readonly("id", &Place::id, "Its index in the model.")
      .def_property_readonly(
          "placement", [](const Place& x) { return x.kind->placement(x.model(), *x.data, x.id); }, "The pose in the world.")
      .def_property_readonly(
          "velocity", [](const Place& x) { return x.kind->velocity(x.model(), *x.data, x.id, ReferenceFrame::LOCAL); },
          "The spatial velocity [m/s, rad/s].")
      .def_property_readonly(
          "acceleration", [](const Place& x) { return x.kind->acceleration(x.model(), *x.data, x.id, ReferenceFrame::LOCAL); },
          "The spatial acceleration [m/s^2, rad/s^2], without gravity.")
      .def_property_readonly(
          "jacobian",
          [](const Place& x) {
            Eigen::MatrixXd J(6, x.model().nv());
            x.kind->jacobian(x.model(), *x.data, x.id, ReferenceFrame::LOCAL, J);
            return J;
          },
          "The Jacobian (6, nv), linear part first.")
      .def("__repr__", [](const Place& x) { return std::string("<") + x.kind->name + " '" + x.name() + "'>"; });
  py::class_<Places>(m, "Places", "The joints or frames of a Data by name: places[\"tool\"], or places.tool.")
      .def("__getitem__", &Places::at, py::arg("name"))
      .def("__getattr__",
           [](const Places& x, const std::string& name) {
             try {
               return x.at(name);
             } catch (const Error& e) {
               throw py::attribute_error(e.what());
             }
           })
      .def("__dir__", &Places::names)
      .def("_ipython_key_completions_", &Places::names)
      .def("__len__", [](const Places& x) { return x.names().size(); })
      .def("__iter__", [](const Places& x) { return py::iter(py::cast(x.names())); })
      .def("__contains__", [](const Places& x, const std::string& name) {
        const std::vector<std::string> all = x.names();
        return std::find(all.begin(), all.end(), name) != all.end();
      });
  auto data = py::reinterpret_borrow<py::class_<Data, std::shared_ptr<Data>>>(m.attr("Data"));
  for (const Kind* kind : {&joints, &frames}) {
    data.def(
        kind->name,
        [kind](const std::shared_ptr<Data>& x, const std::string& name) {
          return Places{x, kind}.at(name);
        },
        py::arg("name"), "Returns the Place of this name. Raises Error, which lists similar names, if there is none.");
    data.def_property_readonly((std::string(kind->name) + "s").c_str(),
                               [kind](const std::shared_ptr<Data>& x) {
                                 return Places{x, kind};
                               },
                               "All of them by name.");
  }
}

/// The slices that joints have in q or v.
struct SliceIndex {
  CompactModel model;
  int JointRecord::*first;
  int JointRecord::*count;

  std::vector<std::string> names() const {
    std::vector<std::string> out;
    for (const JointRecord& joint : model.joints())
      if (joint.*count > 0) out.push_back(joint.name);
    return out;
  }
  bool contains(const std::string& name) const {
    const int joint = model.findJoint(name);
    return joint >= 0 && model.joints()[static_cast<std::size_t>(joint)].*count > 0;
  }
  py::slice at(const std::string& name) const {
    const JointRecord& joint = model.joints()[static_cast<std::size_t>(model.jointId(name))];
    return {joint.*first, joint.*first + joint.*count, 1};
  }
};

void addSliceIndex(py::module_& m) {
  py::class_<SliceIndex>(m, "SliceIndex", "The slices that joints have in q or v, by the joints' names.")
      .def("__getitem__", &SliceIndex::at, py::arg("name"))
      .def("keys", &SliceIndex::names, "Returns the names of the joints.")
      .def("_ipython_key_completions_", &SliceIndex::names)
      .def(
          "items",
          [](const SliceIndex& x) {
            std::vector<std::pair<std::string, py::slice>> out;
            for (const std::string& name : x.names()) out.emplace_back(name, x.at(name));
            return out;
          },
          "Returns pairs of a name and its slice.")
      .def(
          "values",
          [](const SliceIndex& x) {
            std::vector<py::slice> out;
            for (const std::string& name : x.names()) out.push_back(x.at(name));
            return out;
          },
          "Returns the slices.")
      .def(
          "get",
          [](const SliceIndex& x, const std::string& name, const py::object& otherwise) {
            return x.contains(name) ? py::object(x.at(name)) : otherwise;
          },
          py::arg("name"), py::arg("default") = py::none(), "Returns the slice of a joint, or `default` if there is none.")
      .def("__len__", [](const SliceIndex& x) { return x.names().size(); })
      .def("__iter__", [](const SliceIndex& x) { return py::iter(py::cast(x.names())); })
      .def("__contains__", &SliceIndex::contains)
      .def("__repr__", [](const SliceIndex& x) {
        py::dict all;
        for (const std::string& name : x.names()) all[py::str(name)] = x.at(name);
        return py::repr(all);
      });
  py::reinterpret_borrow<py::class_<CompactModel>>(m.attr("CompactModel"))
      .def_property_readonly(
          "q_index",
          [](const CompactModel& x) {
            return SliceIndex{x, &JointRecord::idx_q, &JointRecord::nq};
          },
          "The slice of q with the coordinates of each joint, by name.")
      .def_property_readonly(
          "v_index",
          [](const CompactModel& x) {
            return SliceIndex{x, &JointRecord::idx_v, &JointRecord::nv};
          },
          "The slice of v with the velocities of each joint, by name.");
}

}  // namespace

void addNamedAccess(py::module_& m) {
  addPlaces(m);
  addSliceIndex(m);
}

}  // namespace dyn::python
