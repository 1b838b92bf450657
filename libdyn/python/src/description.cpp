// SPDX-License-Identifier: BSD-2-Clause
// The description of a robot, its reader, and functions that make new descriptions.
#include "description.hpp"

#include "choices.hpp"

#include <dyn/compile/edit.hpp>
#include <dyn/near_names.hpp>
#include <dyn/parsers/load.hpp>

#include <pybind11/stl.h>

namespace dyn::python {

namespace {

/// A limit, a damping and the like may be one number or one for each degree of freedom.
std::vector<double> numbers(const std::variant<double, std::vector<double>>& x) {
  return std::holds_alternative<double>(x) ? std::vector<double>{std::get<double>(x)} : std::get<std::vector<double>>(x);
}

/// A member of doubles that also takes one number.
template <class Class, class Get>
void numbersProperty(Class& c, const char* name, Get get, const char* doc) {
  using T = typename Class::type;
  c.def_property(
      name, [get](T& x) { return get(x); }, [get](T& x, const std::variant<double, std::vector<double>>& value) { get(x) = numbers(value); }, doc);
}

LoadOptions optionsOf(const std::string& root, const std::string& mimic, const std::string& order, const std::string& continuous,
                      const std::string& inertias, const std::string& files = "beside", const std::string& versions = "known") {
  return {root,
          chosen<Mimic>("mimic", mimic, {{"coupled", Mimic::coupled}, {"independent", Mimic::independent}}),
          chosen<Order>("order", order, {{"name", Order::name}, {"file", Order::file}}),
          chosen<Continuous>("continuous", continuous, {{"unit_circle", Continuous::unit_circle}, {"angle", Continuous::angle}}),
          chosen<Inertias>("inertias", inertias, {{"physical", Inertias::physical}, {"any", Inertias::any}}),
          chosen<Files>("files", files, {{"beside", Files::beside}, {"anywhere", Files::anywhere}}),
          chosen<Versions>("versions", versions, {{"known", Versions::known}, {"any", Versions::any}})};
}

/// Adds the class of a list whose elements are parts of the model.
template <class T>
void addList(py::module_& m, const char* name, const char* doc) {
  using List = std::vector<T>;
  const auto element = [](const py::object& self, py::ssize_t k) {
    auto& list = py::cast<List&>(self);
    const auto size = static_cast<py::ssize_t>(list.size());
    if (k < 0) k += size;
    if (k < 0 || k >= size) throw py::index_error("the list has " + std::to_string(size) + " elements");
    return py::cast(&list[static_cast<std::size_t>(k)], py::return_value_policy::reference_internal, self);
  };
  py::class_<List>(m, name, doc)
      .def("__len__", &List::size, "Returns the number of elements.")
      .def("__getitem__", element, py::arg("index"), "Returns an element.")
      .def(
          "__getitem__",
          [element](const py::object& self, const py::slice& range) {
            py::ssize_t start = 0, stop = 0, step = 0, count = 0;
            if (!range.compute(static_cast<py::ssize_t>(py::cast<List&>(self).size()), &start, &stop, &step, &count)) throw py::error_already_set();
            py::list out;
            for (py::ssize_t k = 0; k < count; ++k) out.append(element(self, start + k * step));
            return out;
          },
          py::arg("range"), "Returns a list of elements.")
      .def(
          "__iter__", [](List& list) { return py::make_iterator(list.begin(), list.end()); }, py::keep_alive<0, 1>(), "Iterates over the elements.")
      .def("__repr__", [](const py::object& self) { return py::repr(py::list(self)); });
}

/// Makes room for one more element. If the elements move, those that the program holds stay where they are, as long as the model lives.
template <class T>
void makeRoom(const py::object& model, std::vector<T>& list) {
  if (list.size() < list.capacity()) return;
  std::vector<T> larger;
  larger.reserve(2 * list.size() + 16);
  larger.insert(larger.end(), list.begin(), list.end());  // assignment might give up the room
  list.swap(larger);
  const py::capsule earlier(new std::vector<T>(std::move(larger)), [](void* x) { delete static_cast<std::vector<T>*>(x); });
  py::detail::keep_alive_impl(model, earlier);
}

}  // namespace

Parameters parametersOf(const GivenParameters& given) {
  Parameters out;
  for (const auto& [name, value] : given)
    std::visit(
        [&out, &name = name](const auto& x) {
          if constexpr (std::is_same_v<std::decay_t<decltype(x)>, double>) {
            out[name] = std::vector<double>{x};
          } else {
            out[name] = x;
          }
        },
        value);
  return out;
}

std::vector<LockedJoint> lockedJoints(const Locks& lock) {
  std::vector<LockedJoint> out;
  for (const auto& [joint, q] : lock) out.push_back({joint, q ? numbers(*q) : std::vector<double>()});
  return out;
}

int bodyOf(const Model& model, const std::variant<int, std::string>& body) {
  if (std::holds_alternative<int>(body)) return std::get<int>(body);
  const std::string& name = std::get<std::string>(body);
  const int found = model.findBody(name);
  if (found < 0) throw Error(ErrorCode::argument, "the model has no body '" + name + "'" + nearNames(name, namesOf(model.bodies)));
  return found;
}

/// Returns the index of the body that a joint carries.
int carriedBy(const Model& model, const std::string& joint) {
  const int found = model.findJoint(joint);
  if (found >= 0) return found;
  std::vector<std::string> names;
  for (const BodyDescription& b : model.bodies) names.push_back(b.joint.name);
  throw Error(ErrorCode::argument, "the model has no joint '" + joint + "'" + nearNames(joint, names));
}

void addDescription(py::module_& m) {
  py::class_<JointDescription> joint(m, "JointDescription",
                                     "A joint by type name and parameters.\n\n"
                                     "parameters: numbers, lists of numbers, texts or lists of joints, by name, as the type defines them.\n"
                                     "placement: the pose of the joint at its zero in the parent body's frame.");
  joint
      .def(py::init([](const std::string& name, const std::string& type, const GivenParameters& parameters, const SE3<double>& placement) {
             JointDescription j;
             j.name = name;
             j.type = type;
             j.parameters = parametersOf(parameters);
             j.placement = placement;
             return j;
           }),
           py::arg("name") = "", py::arg("type") = "fixed", py::arg("parameters") = GivenParameters(), py::arg("placement") = SE3<double>())
      .def_readwrite("name", &JointDescription::name, "Unique among the model's joints.")
      .def_readwrite("type", &JointDescription::type, "The name of a joint type.")
      .def_property(
          "parameters", [](const JointDescription& j) { return j.parameters; },
          [](JointDescription& j, const GivenParameters& given) { j.parameters = parametersOf(given); }, "By name, as the type defines them.")
      .def_readwrite("placement", &JointDescription::placement, "The pose of the joint at its zero in the parent body's frame.")
      .def("__repr__", [](const JointDescription& j) { return "<joint '" + j.name + "' of type " + j.type + ">"; });
  numbersProperty(
      joint, "damping", [](JointDescription& j) -> auto& { return j.damping; },
      "Viscous damping [N m s/rad or N s/m], one number for each degree of freedom; one number stands for a list of one.");
  numbersProperty(
      joint, "friction", [](JointDescription& j) -> auto& { return j.friction; },
      "Coulomb friction [N m or N], one number for each degree of freedom.");
  numbersProperty(
      joint, "armature", [](JointDescription& j) -> auto& { return j.armature; },
      "Rotor inertia [kg m^2 or kg], one number for each degree of freedom.");
  numbersProperty(
      joint, "lower", [](JointDescription& j) -> auto& { return j.limits.lower; }, "The lowest position [rad or m]; empty: none.");
  numbersProperty(
      joint, "upper", [](JointDescription& j) -> auto& { return j.limits.upper; }, "The highest position [rad or m]; empty: none.");
  numbersProperty(
      joint, "velocity_limit", [](JointDescription& j) -> auto& { return j.limits.velocity; }, "The largest speed [rad/s or m/s].");
  numbersProperty(
      joint, "effort_limit", [](JointDescription& j) -> auto& { return j.limits.effort; }, "The largest force [N m or N].");
  numbersProperty(
      joint, "acceleration_limit", [](JointDescription& j) -> auto& { return j.limits.acceleration; },
      "The largest acceleration [rad/s^2 or m/s^2], for planners.");
  numbersProperty(
      joint, "deceleration_limit", [](JointDescription& j) -> auto& { return j.limits.deceleration; },
      "The largest deceleration [rad/s^2 or m/s^2], if it differs.");
  numbersProperty(
      joint, "jerk_limit", [](JointDescription& j) -> auto& { return j.limits.jerk; }, "The largest jerk [rad/s^3 or m/s^3], for planners.");
  joint.def(
      "couple",
      [](JointDescription& j, const std::string& master, const std::string& type, const GivenParameters& parameters) {
        j.coupling = {type, master, parametersOf(parameters)};
      },
      py::arg("master"), py::arg("type") = "mimic", py::arg("parameters") = GivenParameters(),
      "Makes the joint depend on another: its coordinate becomes a function of the master's.");
  joint.def_property_readonly(
      "coupling",
      [](const JointDescription& j) -> py::object {
        if (j.coupling.type.empty()) return py::none();
        return py::make_tuple(j.coupling.type, j.coupling.master, j.coupling.parameters);
      },
      "A tuple (type, master, parameters) if the joint depends on another; else None.");

  py::class_<BodyDescription>(m, "BodyDescription", "A body and the joint that carries it.")
      .def_readwrite("name", &BodyDescription::name, "Unique among the model's bodies.")
      .def_readwrite("parent", &BodyDescription::parent, "The index of the parent body; 0 is the world.")
      .def_readwrite("joint", &BodyDescription::joint, "The joint between the parent body and this one.")
      .def_readwrite("inertia", &BodyDescription::inertia, "The inertia in the body's frame.")
      .def("__repr__", [](const BodyDescription& b) { return "<body '" + b.name + "'>"; });
  py::class_<FrameDescription>(m, "FrameDescription", "A named frame that is fixed to a body.")
      .def_readwrite("name", &FrameDescription::name, "Unique among the model's frames.")
      .def_readwrite("body", &FrameDescription::body, "The index of the body to which the frame is fixed; 0 is the world.")
      .def_readwrite("placement", &FrameDescription::placement, "The pose in the body's frame.")
      .def("__repr__", [](const FrameDescription& f) { return "<frame '" + f.name + "'>"; });
  addList<BodyDescription>(m, "BodyList", "The bodies of a model. An element is a part of the model, not a copy. Take it again after add_body().");
  addList<FrameDescription>(m, "FrameList", "The frames of a model. An element is a part of the model, not a copy. Take it again after add_frame().");

  py::class_<Model>(m, "Model", "The description of a robot, which compile() turns into a CompactModel. Body 0 is the world.")
      .def(py::init<>())
      .def_readwrite("name", &Model::name, "The name of the robot.")
      .def_property(
          "gravity",
          [](const Model& x) {
            return std::array<double, 3>{x.gravity.x, x.gravity.y, x.gravity.z};
          },
          [](Model& x, const std::array<double, 3>& g) {
            x.gravity = {g[0], g[1], g[2]};
          },
          "The acceleration of free fall (3,) [m/s^2], in the world.")
      .def_readonly("bodies", &Model::bodies, "The world and all bodies.")
      .def_readonly("frames", &Model::frames, "Frames in addition to that of each body.")
      .def_readonly("notes", &Model::notes, "What a parser ignored or found odd.")
      .def(
          "body", [](Model& x, const std::string& name) -> BodyDescription& { return x.bodies[static_cast<std::size_t>(bodyOf(x, name))]; },
          py::arg("name"), py::return_value_policy::reference_internal, "Returns a body, as a part of the model. Take it again after add_body().")
      .def(
          "joint",
          [](Model& x, const std::string& name) -> JointDescription& { return x.bodies[static_cast<std::size_t>(carriedBy(x, name))].joint; },
          py::arg("name"), py::return_value_policy::reference_internal, "Returns a joint, as a part of the model. Take it again after add_body().")
      .def("find_body", &Model::findBody, py::arg("name"), "Returns the index of a body; -1 if there is none.")
      .def("find_joint", &Model::findJoint, py::arg("name"), "Returns the index of the body that a joint carries; -1 if there is none.")
      .def(
          "add_body",
          [](const py::object& self, const std::string& name, const std::variant<int, std::string>& parent, const JointDescription& j,
             const Inertia<double>& inertia) {
            auto& model = py::cast<Model&>(self);
            makeRoom(self, model.bodies);
            return model.addBody(name, bodyOf(model, parent), j, inertia);
          },
          py::arg("name"), py::arg("parent"), py::arg("joint"), py::arg("inertia") = Inertia<double>(),
          "Adds a body that `joint` connects to the parent (a name or an index); returns its index.")
      .def(
          "add_frame",
          [](const py::object& self, const std::string& name, const std::variant<int, std::string>& body, const SE3<double>& placement) {
            auto& model = py::cast<Model&>(self);
            makeRoom(self, model.frames);
            return model.addFrame(name, bodyOf(model, body), placement);
          },
          py::arg("name"), py::arg("body"), py::arg("placement") = SE3<double>(), "Adds a frame at `placement` in the body's frame.")
      .def("__copy__", [](const Model& x) { return x; })
      .def(
          "__deepcopy__", [](const Model& x, const py::dict&) { return x; }, py::arg("memo"))
      .def("__repr__", [](const Model& x) { return "<libdyn.Model '" + x.name + "': " + std::to_string(x.bodies.size() - 1) + " bodies>"; });

  const py::arg_v root("root", "fixed"), mimic("mimic", "coupled"), order("order", "name"), continuous("continuous", "unit_circle"),
      inertias("inertias", "physical"), files("files", "beside"), versions("versions", "known"), named("format", "");
  m.def(
      "_load",
      [](const std::string& path, const std::string& r, const std::string& mi, const std::string& o, const std::string& c, const std::string& i,
         const std::string& f, const std::string& ve, const std::string& format) { return load(path, optionsOf(r, mi, o, c, i, f, ve), format); },
      py::arg("path"), root, mimic, order, continuous, inertias, files, versions, named);
  m.def(
      "parse",
      [](const std::string& text, const std::string& name, const std::string& r, const std::string& mi, const std::string& o, const std::string& c,
         const std::string& i, const std::string& ve) { return urdf::parse(text, name, optionsOf(r, mi, o, c, i, "beside", ve)); },
      py::arg("text"), py::arg("name") = "<text>", root, mimic, order, continuous, inertias, versions,
      "Reads a robot from the text of a URDF file. Messages call the text `name`. The options are those of load().");
  m.def(
      "_check",
      [](const std::string& path, const std::string& r, const std::string& mi, const std::string& o, const std::string& c, const std::string& i,
         const std::string& f, const std::string& ve, const std::string& format) {
        py::list errors;
        for (const Error& e : check(path, optionsOf(r, mi, o, c, i, f, ve), format)) errors.append(errorOf(e));
        return errors;
      },
      py::arg("path"), root, mimic, order, continuous, inertias, files, versions, named);
  const py::arg_v types("registry", py::none());
  m.def(
      "reduce",
      [](const Model& model, const Locks& lock, const JointRegistry* known) { return reduce(model, registryOr(known), lockedJoints(lock)); },
      py::arg("model"), py::arg("lock"), types,
      "Returns the model with joints held. `lock` maps names of joints to their coordinates, or to None for neutral.");
  m.def(
      "keep_only",
      [](const Model& model, const std::vector<std::string>& keep, const JointRegistry* known) { return keepOnly(model, registryOr(known), keep); },
      py::arg("model"), py::arg("keep"), types,
      "Returns the model with all joints held at neutral but those named in `keep` and those on which these depend.");
  m.def(
      "append",
      [](const Model& model, const Model& other, const std::string& at, const SE3<double>& placement, const std::string& prefix) {
        return append(model, other, at, placement, prefix);
      },
      py::arg("model"), py::arg("other"), py::arg("at"), py::arg("placement") = SE3<double>(), py::arg("prefix") = "",
      "Returns `model` with a copy of `other` that its body or frame `at` carries. Names of the copy get the prefix.");
}

}  // namespace dyn::python
