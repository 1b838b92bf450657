// SPDX-License-Identifier: BSD-2-Clause
// Compiled volumes, collision and distance.
#include "arrays.hpp"
#include "description.hpp"
#include "objects.hpp"

#include <dyn/geometry/collision.hpp>
#include <dyn/geometry/distance.hpp>
#include <dyn/geometry/embed.hpp>
#include <dyn/near_names.hpp>
#include <dyn/spatial/eigen.hpp>

#include <pybind11/eigen.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <atomic>

namespace dyn::python {

namespace {

using Vector = Eigen::Ref<const Eigen::VectorXd>;
using Pairs = std::vector<std::pair<std::string, std::string>>;

std::vector<PairName> pairsOf(const Pairs& pairs) {
  std::vector<PairName> out;
  for (const auto& [a, b] : pairs) out.push_back({a, b});
  return out;
}

/// Memory for many states, and whether a call is using it. Calls release the interpreter's lock, so a second thread may come.
struct Volumes {
  Volumes(const CompactModel& model, const GeometryModel& geometry, int capacity, int threads) : batch(model, geometry, capacity, threads) {}
  GeometryBatch batch;
  std::atomic<bool> busy = false;
};

py::array_t<bool> collisionsOf(const CompactModel& model, Volumes& volumes, const py::object& q) {
  StatesInput<double> states;
  if (!states.read(q.ptr(), "compute_collisions", "q")) throw py::error_already_set();
  py::array_t<bool> out(static_cast<py::ssize_t>(states.view().cols));
  const InUse use(volumes.busy, "compute_collisions");
  const unsigned char* flags = nullptr;
  {
    const py::gil_scoped_release unlocked;
    flags = detail::batchCollisions(model, volumes.batch, states.view());
  }
  std::copy_n(flags, out.size(), out.mutable_data());
  return out;
}

int geometryOf(const GeometryModel& geometry, const std::variant<int, std::string>& volume) {
  if (std::holds_alternative<int>(volume)) return std::get<int>(volume);
  const std::string& name = std::get<std::string>(volume);
  const int id = geometry.geometryId(name);
  if (id < 0) throw Error(ErrorCode::argument, "the geometry has no volume '" + name + "'" + nearNames(name, namesOf(geometry.geometries())));
  return id;
}

}  // namespace

void addGeometry(py::module_& m) {
  py::class_<GeometryRecord>(m, "GeometryRecord", "A volume that belongs to a pair.")
      .def_readonly("name", &GeometryRecord::name, "The name of the volume.")
      .def_readonly("body", &GeometryRecord::body, "The name of the described body that it is on.")
      .def_readonly("joint", &GeometryRecord::joint, "The index of its joint; 0 if it does not move.")
      .def_readonly("placement", &GeometryRecord::placement, "In the joint's frame.")
      .def("__repr__", [](const GeometryRecord& g) { return "<volume '" + g.name + "'>"; });
  py::class_<GeometryModel>(m, "GeometryModel", "Compiled volumes and the pairs to check.")
      .def_property_readonly("geometries", &GeometryModel::geometries, "A GeometryRecord for each volume.")
      .def("geometry_id", &GeometryModel::geometryId, py::arg("name"), "Returns the index of a volume; -1 if there is none.")
      .def("pair_id", &GeometryModel::pairId, py::arg("a"), py::arg("b"), "Returns the index of a pair of volumes; -1 if there is none.")
      .def_property_readonly(
          "names", [](const GeometryModel& g) { return namesOf(g.geometries()); }, "The names of the volumes, in the order of their indices.")
      .def_property_readonly(
          "pairs",
          [](const GeometryModel& g) {
            std::vector<std::pair<int, int>> pairs;
            for (const CollisionPair& x : g.pairs()) pairs.emplace_back(x.a, x.b);
            return pairs;
          },
          "The pairs to check, as indices of volumes.")
      .def_property_readonly(
          "report", [](const GeometryModel& g) { return g.report().lines; }, "What was kept and left out, and why.");
  m.def(
      "compile_geometry",
      [](const CompactModel& model, const Model& description, const std::vector<std::string>& packages, bool all_pairs, const Pairs& add,
         const Pairs& remove, bool skip_missing, bool fcl, double fcl_tolerance) {
        GeometryOptions options;
        options.pairs = all_pairs ? GeometryOptions::Pairs::all : GeometryOptions::Pairs::none;
        options.add = pairsOf(add);
        options.remove = pairsOf(remove);
        options.packages = packages;
        options.missing = skip_missing ? GeometryOptions::Missing::skip : GeometryOptions::Missing::refuse;
        options.narrow = fcl ? GeometryOptions::Narrow::fcl : GeometryOptions::Narrow::own;
        options.fcl_tolerance = fcl_tolerance;
        return compileGeometry(model, description, options);
      },
      py::arg("model"), py::arg("description"), py::kw_only(), py::arg("packages") = std::vector<std::string>(), py::arg("all_pairs") = true,
      py::arg("add") = Pairs(), py::arg("remove") = Pairs(), py::arg("skip_missing") = false, py::arg("fcl") = false,
      py::arg("fcl_tolerance") = GeometryOptions().fcl_tolerance,
      "Collects the collision volumes of the description from which `model` was compiled, and the pairs to check.\n\n"
      "packages: folders for package://. all_pairs: begin with all pairs but neighbours, rigid and disabled ones. add, remove: pairs of names.\n"
      "skip_missing: leave out volumes whose files do not exist. fcl: compare two volumes by FCL's functions, with the tolerance\n"
      "fcl_tolerance [m].");

  py::class_<GeometryData>(m, "GeometryData", "Placements of volumes and results, for one thread.")
      .def(py::init<const GeometryModel&, int>(), py::arg("geometry"), py::arg("contacts") = 256);
  const py::arg model("model"), data("data"), geometry("geometry"), geometry_data("geometry_data"), pair("pair");
  m.def(
      "update_geometry_placements",
      [](const CompactModel& x, Data& d, const GeometryModel& g, GeometryData& gd, const std::optional<Vector>& q) {
        q ? updateGeometryPlacements(x, d, g, gd, *q) : updateGeometryPlacements(x, d, g, gd);
      },
      model, data, geometry, geometry_data, py::arg("q") = py::none(),
      "Places all volumes by the poses of the last forward_kinematics; with q, runs that first.");
  m.def(
      "geometry_placement",
      [](const GeometryModel& g, const GeometryData& gd, const std::variant<int, std::string>& volume) {
        return geometryPlacement(g, gd, geometryOf(g, volume));
      },
      geometry, geometry_data, py::arg("volume"), "Returns the pose of a volume (its name or index) in the world.");
  py::class_<Distance>(m, "Distance", "The distance of a pair a, b: nearest_b - nearest_a = distance * normal, in the world.")
      .def_readonly("pair", &Distance::pair, "The index in GeometryModel.pairs; -1: there is no pair.")
      .def_readonly("distance", &Distance::distance, "The distance [m]; negative if the two overlap.")
      .def_property_readonly(
          "normal", [](const Distance& x) { return toEigen(x.normal); }, "The unit vector from a towards b (3,).")
      .def_property_readonly(
          "nearest_a", [](const Distance& x) { return toEigen(x.nearest_a); }, "The nearest point of a (3,) [m].")
      .def_property_readonly(
          "nearest_b", [](const Distance& x) { return toEigen(x.nearest_b); }, "The nearest point of b (3,) [m].");
  py::class_<Contact>(m, "Contact", "A contact of a pair a, b, in the world.")
      .def_readonly("pair", &Contact::pair, "The index in GeometryModel.pairs.")
      .def_property_readonly(
          "position", [](const Contact& x) { return toEigen(x.position); }, "The midpoint between the two surfaces (3,) [m].")
      .def_property_readonly(
          "normal", [](const Contact& x) { return toEigen(x.normal); }, "The unit vector from a towards b (3,).")
      .def_readonly("depth", &Contact::depth, "The depth [m] by which they overlap.");
  m.def(
      "embed_files",
      [](Model& described, const std::vector<std::string>& packages, std::uintmax_t largest_file) {
        return embedFiles(described, {packages, largest_file}).left;
      },
      py::arg("model"), py::arg("packages") = std::vector<std::string>{}, py::arg("largest_file") = EmbedOptions{}.largest_file,
      "Replaces meshes and octrees in files of up to `largest_file` bytes by their contents, so that save() writes a model that needs no files. "
      "Collisions and distances stay the same to the bit. Returns the volumes that still need their file, each with the reason.");
  m.def("compute_distance", &computeDistance, geometry, geometry_data, pair, "Returns the distance of one pair.");
  m.def("compute_distances", &computeDistances, geometry, geometry_data, "Returns the distances of all pairs.");
  m.def("compute_minimum_distance", &computeMinimumDistance, geometry, geometry_data, "Returns the smallest distance of all pairs.");
  m.def("compute_collision", &computeCollision, geometry, geometry_data, pair, "Returns whether one pair collides.");
  m.def("any_collision", &anyCollision, geometry, geometry_data, "Returns whether any pair collides.");
  m.def("first_collision", &firstCollision, geometry_data, "Returns the index of the pair that the last any_collision() found; -1 if it found none.");
  py::class_<Volumes>(m, "GeometryBatch", "Memory for compute_collisions() of up to `capacity` states at once, in threads.")
      .def(py::init<const CompactModel&, const GeometryModel&, int, int>(), model, geometry, py::arg("capacity"), py::arg("threads") = 1)
      .def_property_readonly(
          "capacity", [](const Volumes& v) { return v.batch.capacity(); }, "The largest number of states.");
  m.def("compute_collisions", &collisionsOf, model, py::arg("batch"), py::arg("q"),
        "Returns for each state (a row of q) of a GeometryBatch whether any pair collides (states,).");
  m.def("compute_collisions", static_cast<const std::vector<int>& (*)(const GeometryModel&, GeometryData&)>(&computeCollisions), geometry,
        geometry_data, "Returns the indices of the pairs that collide.");
  m.def("compute_contacts", &computeContacts, geometry, geometry_data, "Returns the contacts of all pairs that collide.");
  m.def(
      "compute_distance_derivative",
      [](const CompactModel& x, Data& d, const GeometryModel& g, GeometryData& gd, const Distance& distance) {
        Eigen::VectorXd out(x.nv());
        computeDistanceDerivative(x, d, g, gd, distance, out);
        return out;
      },
      model, data, geometry, geometry_data, py::arg("distance"), "Returns the derivative of a distance by q (nv,), in the tangent space.");
}

}  // namespace dyn::python
