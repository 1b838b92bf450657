// SPDX-License-Identifier: BSD-2-Clause
// The compiled model.
#include "description.hpp"
#include "printing.hpp"
#include "typed.hpp"

#include <dyn/compile/compile.hpp>

#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <map>
#include <optional>

namespace dyn::python {

namespace {

Eigen::VectorXd arrayOf(const std::vector<double>& x) { return Eigen::Map<const Eigen::VectorXd>(x.data(), static_cast<Eigen::Index>(x.size())); }

/// Numbers of joints, by name; one number stands for a list of one.
using OfJoints = std::map<std::string, std::variant<double, std::vector<double>>>;

std::vector<JointNumbers> jointNumbers(const OfJoints& given) {
  std::vector<JointNumbers> out;
  for (const auto& [joint, values] : given) {
    const double* one = std::get_if<double>(&values);
    out.push_back({joint, one ? std::vector{*one} : std::get<std::vector<double>>(values)});
  }
  return out;
}

CompactModel withNumbers(const CompactModel& model, const std::optional<Eigen::Vector3d>& gravity,
                         const std::map<std::string, Inertia<double>>& inertias, const std::map<std::string, SE3<double>>& placements,
                         const OfJoints& damping, const OfJoints& friction, const OfJoints& armature) {
  ModelNumbers numbers;
  if (gravity) numbers.gravity = {gravity->x(), gravity->y(), gravity->z()};
  for (const auto& [body, inertia] : inertias) numbers.inertias.push_back({body, inertia});
  for (const auto& [joint, placement] : placements) numbers.placements.push_back({joint, placement});
  numbers.damping = jointNumbers(damping);
  numbers.friction = jointNumbers(friction);
  numbers.armature = jointNumbers(armature);
  return model.withNumbers(numbers);
}

Typed<py::dict, "dict[str, Any]"> numbersOf(const CompactModel& model) {
  const ModelNumbers numbers = model.numbers();
  py::dict inertias, placements, out;
  for (const BodyInertia& x : numbers.inertias) inertias[py::str(x.body)] = x.inertia;
  for (const JointPlacement& x : numbers.placements) placements[py::str(x.joint)] = x.placement;
  const auto ofJoints = [](const std::vector<JointNumbers>& list) {
    py::dict values;
    for (const JointNumbers& x : list) values[py::str(x.joint)] = x.values;
    return values;
  };
  out["gravity"] = Eigen::Vector3d(numbers.gravity->x, numbers.gravity->y, numbers.gravity->z);
  out["inertias"] = inertias;
  out["placements"] = placements;
  out["damping"] = ofJoints(numbers.damping);
  out["friction"] = ofJoints(numbers.friction);
  out["armature"] = ofJoints(numbers.armature);
  return out;
}

}  // namespace

void addCompactModel(py::module_& m) {
  py::class_<JointRecord>(m, "JointRecord", "A joint of a compiled model.")
      .def_readonly("name", &JointRecord::name, "The name in the description.")
      .def_readonly("type", &JointRecord::type, "The name of the joint type.")
      .def_readonly("parent", &JointRecord::parent, "The index of the joint that carries this one.")
      .def_readonly("idx_q", &JointRecord::idx_q, "The index of its first coordinate in q.")
      .def_readonly("idx_v", &JointRecord::idx_v, "The index of its first velocity in v.")
      .def_readonly("nq", &JointRecord::nq, "The number of its coordinates in q.")
      .def_readonly("nv", &JointRecord::nv, "The number of its velocities in v.")
      .def("__repr__", [](const JointRecord& j) { return "<joint '" + j.name + "' of type " + j.type + ">"; });
  py::class_<FrameRecord>(m, "FrameRecord", "A frame of a compiled model.")
      .def_readonly("name", &FrameRecord::name, "The name in the description.")
      .def_readonly("joint", &FrameRecord::joint, "The index of the joint whose body carries it.")
      .def_readonly("placement", &FrameRecord::placement, "The pose in the joint's frame.")
      .def("__repr__", [](const FrameRecord& f) { return "<frame '" + f.name + "'>"; });

  py::class_<CompactModel>(m, "CompactModel", "A compiled model: immutable, and shared freely between threads.")
      .def_property_readonly("name", &CompactModel::name, "The name of the robot.")
      .def_property_readonly("nq", &CompactModel::nq, "The number of coordinates.")
      .def_property_readonly("nv", &CompactModel::nv, "The number of degrees of freedom.")
      .def_property_readonly("njoints", &CompactModel::njoints, "The number of joints that can move, plus one for the world.")
      .def_property_readonly("mass", &CompactModel::mass, "The mass of all moving bodies [kg].")
      .def_property_readonly(
          "gravity", [](const CompactModel& x) { return Eigen::Vector3d(x.gravity().x, x.gravity().y, x.gravity().z); },
          "The acceleration of free fall (3,) [m/s^2], in the world.")
      .def_property_readonly("joints", &CompactModel::joints, "All joints; 0 is the world.")
      .def_property_readonly("frames", &CompactModel::frames, "All frames; 0 is the world.")
      .def(
          "joint", [](const CompactModel& x, const std::string& name) { return x.joints()[static_cast<std::size_t>(x.jointId(name))]; },
          py::arg("name"), "Returns the record of a joint.")
      .def(
          "frame", [](const CompactModel& x, const std::string& name) { return x.frames()[static_cast<std::size_t>(x.frameId(name))]; },
          py::arg("name"), "Returns the record of a frame.")
      .def("joint_id", &CompactModel::jointId, py::arg("name"), "Returns the index of a joint.")
      .def("frame_id", &CompactModel::frameId, py::arg("name"), "Returns the index of a frame.")
      .def("find_joint", &CompactModel::findJoint, py::arg("name"), "Returns the index of a joint; -1 if there is none.")
      .def("find_frame", &CompactModel::findFrame, py::arg("name"), "Returns the index of a frame; -1 if there is none.")
      .def_property_readonly("follows", &CompactModel::follows, "Whether the model has dependent joints, whose coordinates are not in q.")
      .def_property_readonly("nbytes", &CompactModel::bytes, "The approximate size in bytes.")
      .def_property_readonly(
          "lower", [](const CompactModel& x) { return arrayOf(x.limits().lower); }, "The lowest positions (nq,) [rad, m]; -inf: none.")
      .def_property_readonly(
          "upper", [](const CompactModel& x) { return arrayOf(x.limits().upper); }, "The highest positions (nq,) [rad, m]; inf: none.")
      .def_property_readonly(
          "velocity_limit", [](const CompactModel& x) { return arrayOf(x.limits().velocity); }, "The largest speeds (nv,) [rad/s, m/s]; inf: none.")
      .def_property_readonly(
          "effort_limit", [](const CompactModel& x) { return arrayOf(x.limits().effort); }, "The largest forces (nv,) [N m, N]; inf: none.")
      .def_property_readonly(
          "passes", [](const CompactModel& x) { return x.report().passes; }, "A line for each pass of the compiler.")
      .def_property_readonly(
          "warnings", [](const CompactModel& x) { return x.report().warnings; }, "What is legal and likely to be a mistake.")
      .def_property_readonly(
          "held", [](const CompactModel& x) { return x.report().held; }, "Bodies whose joint could move but is rigid because it is held.")
      .def("with_numbers", &withNumbers, py::kw_only(), py::arg("gravity") = py::none(),
           py::arg("inertias") = std::map<std::string, Inertia<double>>(), py::arg("placements") = std::map<std::string, SE3<double>>(),
           py::arg("damping") = OfJoints(), py::arg("friction") = OfJoints(), py::arg("armature") = OfJoints(),
           "Returns a model that differs in these numbers of its description only, as compile() would make it, at a small part of the cost.\n\n"
           "gravity: (3,) [m/s^2]. inertias: of bodies, by name, in the body's frame. placements: of joints, in the parent body's frame.\n"
           "damping, friction, armature: of joints that move; one number for each degree of freedom, or one number for a list of one.")
      .def("numbers", &numbersOf, "Returns all numbers that with_numbers() can change, as a dict of its arguments.")
      .def("__copy__", [](const CompactModel& x) { return x; })
      .def("__reduce__", &refusePickle<CompactModel>)
      .def(
          "__deepcopy__", [](const CompactModel& x, const py::dict&) { return x; }, py::arg("memo"))
      .def("__repr__", [](const CompactModel& x) {
        return "<libdyn.CompactModel '" + x.name() + "': nq = " + std::to_string(x.nq()) + ", nv = " + std::to_string(x.nv()) + ">";
      });

  m.def(
      "compile",
      [](const Model& model, const Locks& lock, bool dissipation, bool armature, const std::vector<std::string>& outputs, bool dynamics,
         const std::vector<std::string>& touching, bool lane_groups, const std::string& instruction_set, const JointRegistry* types) {
        CompileOptions options;
        options.lock = lockedJoints(lock);
        options.dissipation = dissipation;
        options.armature = armature;
        options.scene.outputs = outputs;
        options.scene.dynamics = dynamics;
        options.scene.touching = touching;
        options.lane_groups = lane_groups;
        options.instruction_set = instruction_set;
        CompactModel compiled = compile(model, registryOr(types), options);
        for (const std::string& warning : compiled.report().warnings) warn(warning);
        return compiled;
      },
      py::arg("model"), py::kw_only(), py::arg("lock") = Locks(), py::arg("dissipation") = true, py::arg("armature") = true,
      py::arg("outputs") = std::vector<std::string>(), py::arg("dynamics") = true, py::arg("touching") = std::vector<std::string>(),
      py::arg("lane_groups") = true, py::arg("instruction_set") = "", py::arg("registry") = py::none(),
      "Turns a description into a compiled model.\n\n"
      "lock: joints to hold, by name, with their coordinates or None. dissipation, armature: whether damping and friction, and rotor inertia, act.\n"
      "outputs: joints, bodies or frames whose motion is wanted; what cannot influence them is left out. dynamics: motion follows from forces.\n"
      "touching: bodies or frames that may touch each other; if one is wanted, all are kept. lane_groups: single states may advance joints of\n"
      "one type together. instruction_set: the one that these are chosen for; without it the one in use.\n"
      "registry: the joint types; without it those of registry().");
}

}  // namespace dyn::python
