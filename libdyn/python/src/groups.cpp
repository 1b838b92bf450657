// SPDX-License-Identifier: BSD-2-Clause
// Groups, end effectors and named states of a description.
#include "module.hpp"

#include <dyn/algorithm/named_configuration.hpp>

#include <pybind11/eigen.h>
#include <pybind11/stl.h>

namespace dyn::python {

namespace {

using Names = std::vector<std::string>;

template <class T>
std::string called(const char* what, const T& x) {
  return std::string("<") + what + " '" + x.name + "'>";
}

void addParts(py::module_& m) {
  py::class_<Chain>(m, "Chain", "The joints on the way from one body to another.")
      .def(py::init([](const std::string& base, const std::string& tip) {
             return Chain{base, tip};
           }),
           py::arg("base"), py::arg("tip"))
      .def_readonly("base", &Chain::base, "The name of a body that carries the other; its own joint does not belong to the chain.")
      .def_readonly("tip", &Chain::tip, "The name of the last body; its joint belongs to the chain.");
  py::class_<GroupDescription>(m, "GroupDescription", "A named part of a robot: joints, the joints of bodies, chains and other groups.")
      .def(py::init([](const std::string& name, const Names& bodies, const Names& joints, const std::vector<Chain>& chains, const Names& groups) {
             return GroupDescription{name, bodies, joints, chains, groups, {}};
           }),
           py::arg("name"), py::arg("bodies") = Names(), py::arg("joints") = Names(), py::arg("chains") = std::vector<Chain>(),
           py::arg("groups") = Names())
      .def_readonly("name", &GroupDescription::name, "Unique among the model's groups.")
      .def_readonly("bodies", &GroupDescription::bodies, "Names of bodies; their joints belong to the group.")
      .def_readonly("joints", &GroupDescription::joints, "Names of joints.")
      .def_readonly("chains", &GroupDescription::chains, "Chains, whose joints belong to the group.")
      .def_readonly("groups", &GroupDescription::groups, "Names of other groups, which belong to this one as a whole.")
      .def("__repr__", [](const GroupDescription& x) { return called("group", x); });
  py::class_<EndEffectorDescription>(m, "EndEffectorDescription", "A hand or a tool.")
      .def(py::init([](const std::string& name, const std::string& group, const std::string& body, const std::string& parent_group) {
             return EndEffectorDescription{name, group, body, parent_group, {}};
           }),
           py::arg("name"), py::arg("group"), py::arg("body"), py::arg("parent_group") = "")
      .def_readonly("name", &EndEffectorDescription::name, "Unique among the model's end effectors.")
      .def_readonly("group", &EndEffectorDescription::group, "The name of the group that is the end effector.")
      .def_readonly("body", &EndEffectorDescription::body, "The name of the body that carries it.")
      .def_readonly("parent_group", &EndEffectorDescription::parent_group, "The name of the group that moves it; empty: not said.")
      .def("__repr__", [](const EndEffectorDescription& x) { return called("end effector", x); });
  py::class_<VirtualJointDescription>(m, "VirtualJointDescription", "How a planner sees a root joint. It does not move the model.")
      .def(py::init([](const std::string& name, const std::string& type, const std::string& frame, const std::string& body) {
             return VirtualJointDescription{name, type, frame, body, {}};
           }),
           py::arg("name"), py::arg("type"), py::arg("frame"), py::arg("body"))
      .def_readonly("name", &VirtualJointDescription::name, "The planner's name of the joint.")
      .def_readonly("type", &VirtualJointDescription::type, "The type of root joint that the planner expects, such as 'free_flyer'.")
      .def_readonly("frame", &VirtualJointDescription::frame, "The name of a frame of the surroundings.")
      .def_readonly("body", &VirtualJointDescription::body, "The name of the body that the joint carries.")
      .def("__repr__", [](const VirtualJointDescription& x) { return called("virtual joint", x); });
}

void addDevices(py::module_& m) {
  using Device = DeviceDescription;
  py::enum_<Device::Kind>(m, "DeviceKind", "What a device is.")
      .value("ACTUATOR", Device::Kind::actuator)
      .value("TENDON", Device::Kind::tendon)
      .value("SENSOR", Device::Kind::sensor);
  py::class_<Device> c(m, "DeviceDescription", "An actuator, tendon or sensor, which is kept and not used.");
  c.def(py::init([](Device::Kind kind, const std::string& type, const std::string& text, const std::string& name) {
          return Device{kind, type, name, text, {}};
        }),
        py::arg("kind"), py::arg("type"), py::arg("text"), py::arg("name") = "")
      .def_readonly("kind", &Device::kind, "Actuator, tendon or sensor.")
      .def_readonly("type", &Device::type, "The format's word for it, such as 'motor'.")
      .def_readonly("name", &Device::name, "May be empty.")
      .def_readonly("text", &Device::text, "The element of the file, completed by its default class.")
      .def("__repr__", [](const Device& x) { return called(x.type.c_str(), x); });
}

void addStates(py::module_& m) {
  py::class_<JointState>(m, "JointState", "Coordinates of one joint in a named state.")
      .def(py::init([](const std::string& joint, const std::vector<double>& q, const std::vector<double>& v) {
             return JointState{joint, q, v};
           }),
           py::arg("joint"), py::arg("q") = std::vector<double>(), py::arg("v") = std::vector<double>())
      .def_readonly("joint", &JointState::joint, "The name of the joint.")
      .def_readonly("q", &JointState::q, "Its coordinates; empty: neutral.")
      .def_readonly("v", &JointState::v, "Its velocities; empty: at rest.");
  py::class_<ConfigurationDescription>(m, "ConfigurationDescription", "A named state. Joints that it does not name are neutral and at rest.")
      .def(py::init([](const std::string& name, const std::vector<JointState>& joints, const std::string& group) {
             return ConfigurationDescription{name, group, joints, {}};
           }),
           py::arg("name"), py::arg("joints"), py::arg("group") = "")
      .def_readonly("name", &ConfigurationDescription::name, "Such as 'home'.")
      .def_readonly("group", &ConfigurationDescription::group, "The name of the group that the state belongs to; empty: the whole robot.")
      .def_readonly("joints", &ConfigurationDescription::joints, "The joints that it sets.")
      .def("__repr__", [](const ConfigurationDescription& x) { return called("state", x); });
  const py::arg model("model"), description("description"), name("name");
  m.def(
      "named_configuration", [](const CompactModel& x, const Model& d, const std::string& n) { return namedConfiguration(x, d, n); }, model,
      description, name,
      "Returns the configuration (nq,) of a named state: 'home', or 'arm/home' of the group 'arm'. A name that several groups use stands for the "
      "states of all of them. Several names are separated by commas.");
  m.def(
      "named_velocity", [](const CompactModel& x, const Model& d, const std::string& n) { return namedVelocity(x, d, n); }, model, description, name,
      "Returns the velocity (nv,) of a named state; 0 where the state has none.");
}

/// Adds a member of the model that is a list. Python sees a tuple of copies, and assigns lists.
template <auto member, class List>
void addMember(py::class_<Model>& c, const char* name, List, const char* doc) {
  c.def_property(
      name, [](const Model& x) { return py::tuple(py::cast(x.*member)); }, [](Model& x, const List& list) { x.*member = list; }, doc);
}

}  // namespace

void addGroups(py::module_& m) {
  addParts(m);
  addStates(m);
  addDevices(m);
  auto c = py::reinterpret_borrow<py::class_<Model>>(m.attr("Model"));
  addMember<&Model::groups>(c, "groups", std::vector<GroupDescription>(), "Named parts. Assign a list to change them.");
  addMember<&Model::end_effectors>(c, "end_effectors", std::vector<EndEffectorDescription>(), "Hands and tools. Assign a list to change them.");
  addMember<&Model::virtual_joints>(c, "virtual_joints", std::vector<VirtualJointDescription>(), "How planners see the root joints.");
  addMember<&Model::passive_joints>(c, "passive_joints", std::vector<std::string>(), "The names of joints that no motor moves.");
  addMember<&Model::configurations>(c, "configurations", std::vector<ConfigurationDescription>(),
                                    "Named states; named_configuration() returns their q. Assign a list to change them.");
  addMember<&Model::devices>(c, "devices", std::vector<DeviceDescription>(), "Actuators, tendons and sensors, which are kept and not used.");
  c.def("joints_of", &Model::jointsOf, py::arg("group"), "Returns the names of the joints of a group, of its chains and of its subgroups.");
}

}  // namespace dyn::python
