// SPDX-License-Identifier: BSD-2-Clause
// Volumes, collision and distance.
#include "description.hpp"

#include <dyn/geometry/collision.hpp>
#include <dyn/geometry/contact_finder.hpp>
#include <dyn/geometry/distance.hpp>
#include <dyn/near_names.hpp>
#include <dyn/spatial/eigen.hpp>

#include <pybind11/eigen.h>
#include <pybind11/stl.h>

namespace dyn::python {

namespace {

using Vector = Eigen::Ref<const Eigen::VectorXd>;
using Vector3 = Eigen::Vector3d;
using Points = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
using Pairs = std::vector<std::pair<std::string, std::string>>;

std::vector<Vec3<double>> pointsOf(const Points& rows) {
  std::vector<Vec3<double>> out;
  for (Eigen::Index k = 0; k < rows.rows(); ++k) out.push_back({rows(k, 0), rows(k, 1), rows(k, 2)});
  return out;
}
std::vector<PairName> pairsOf(const Pairs& pairs) {
  std::vector<PairName> out;
  for (const auto& [a, b] : pairs) out.push_back({a, b});
  return out;
}

void addShapes(py::module_& m) {
  using namespace geometry;
  const py::arg radius("radius"), length("length");
  py::class_<Sphere>(m, "Sphere", "A ball [m].").def(py::init([](double r) { return Sphere{r}; }), radius);
  py::class_<Box>(m, "Box", "A cuboid, by its whole side lengths along x, y, z [m].")
      .def(py::init([](double x, double y, double z) {
             return Box{{x, y, z}};
           }),
           py::arg("x"), py::arg("y"), py::arg("z"));
  py::class_<Capsule>(m, "Capsule", "A cylinder with round ends along z; `length` is between the centres of the ends [m].")
      .def(py::init([](double r, double l) {
             return Capsule{r, l};
           }),
           radius, length);
  py::class_<Cylinder>(m, "Cylinder", "A circular cylinder along z [m].")
      .def(py::init([](double r, double l) {
             return Cylinder{r, l};
           }),
           radius, length);
  py::class_<Cone>(m, "Cone", "A circular cone along z, with the tip at +length / 2 [m].")
      .def(py::init([](double r, double l) {
             return Cone{r, l};
           }),
           radius, length);
  py::class_<HalfSpace>(m, "HalfSpace", "All points x with normal . x <= offset [m].")
      .def(py::init([](const Vector3& normal, double offset) {
             return HalfSpace{fromEigen3(normal), offset};
           }),
           py::arg("normal") = Vector3::UnitZ().eval(), py::arg("offset") = 0.0);
  py::class_<ConvexHull>(m, "ConvexHull", "The convex hull of points, one a row [m].")
      .def(py::init([](const Points& points) { return ConvexHull{pointsOf(points)}; }), py::arg("points"));
  py::class_<TriangleMesh>(m, "TriangleMesh", "A surface of triangles: vertices, one a row [m], and three indices of them a triangle.")
      .def(py::init([](const Points& vertices, const std::vector<std::array<int, 3>>& triangles) {
             return TriangleMesh{pointsOf(vertices), triangles};
           }),
           py::arg("vertices"), py::arg("triangles"));
  py::class_<MeshFile>(m, "MeshFile", "A mesh in a file, scaled along x, y, z. `convex` makes it its convex hull.")
      .def(py::init([](const std::string& uri, const Vector3& scale, bool convex) {
             return MeshFile{uri, fromEigen3(scale), convex};
           }),
           py::arg("uri"), py::arg("scale") = Vector3::Ones().eval(), py::arg("convex") = false);
  py::class_<Voxels>(m, "Voxels", "Cubes along the axes of the frame: centres, one a row [m], and their sides [m].")
      .def(py::init([](const Points& centers, const std::vector<double>& sizes) {
             if (centers.rows() != static_cast<Eigen::Index>(sizes.size()))
               throw Error(ErrorCode::size, "Voxels: " + std::to_string(centers.rows()) + " centers and " + std::to_string(sizes.size()) + " sizes");
             Voxels out;
             for (const Vec3<double>& center : pointsOf(centers)) out.cubes.push_back({center, sizes[out.cubes.size()]});
             return out;
           }),
           py::arg("centers"), py::arg("sizes"));
  py::class_<OctreeFile>(m, "OctreeFile", "The occupied leaves of an octomap file (.bt or .ot).")
      .def(py::init([](const std::string& uri) { return OctreeFile{uri}; }), py::arg("uri"));
}

}  // namespace

void addGeometry(py::module_& m) {
  addShapes(m);
  py::reinterpret_borrow<py::class_<Model>>(m.attr("Model"))
      .def(
          "add_geometry",
          [](Model& model, const std::string& name, const std::variant<int, std::string>& body, const GeometryShape& shape,
             const SE3<double>& placement) { return model.addGeometry(name, bodyOf(model, body), placement, shape); },
          py::arg("name"), py::arg("body"), py::arg("shape"), py::arg("placement") = SE3<double>(),
          "Adds a volume for collision at `placement` in the body's frame.");

  py::class_<GeometryModel>(m, "GeometryModel", "Compiled volumes and the pairs to check.")
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
         const Pairs& remove, bool skip_missing, bool fcl) {
        GeometryOptions options;
        options.pairs = all_pairs ? GeometryOptions::Pairs::all : GeometryOptions::Pairs::none;
        options.add = pairsOf(add);
        options.remove = pairsOf(remove);
        options.packages = packages;
        options.missing = skip_missing ? GeometryOptions::Missing::skip : GeometryOptions::Missing::refuse;
        options.narrow = fcl ? GeometryOptions::Narrow::fcl : GeometryOptions::Narrow::own;
        return compileGeometry(model, description, options);
      },
      py::arg("model"), py::arg("description"), py::kw_only(), py::arg("packages") = std::vector<std::string>(), py::arg("all_pairs") = true,
      py::arg("add") = Pairs(), py::arg("remove") = Pairs(), py::arg("skip_missing") = false, py::arg("fcl") = false,
      "Collects the collision volumes of the description from which `model` was compiled, and the pairs to check.\n\n"
      "packages: folders for package://. all_pairs: begin with all pairs but neighbours, rigid and disabled ones. add, remove: pairs of names.\n"
      "skip_missing: leave out volumes whose files do not exist. fcl: compare two volumes by FCL's functions.");

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
  m.def("compute_distance", &computeDistance, geometry, geometry_data, pair, "Returns the distance of one pair.");
  m.def("compute_distances", &computeDistances, geometry, geometry_data, "Returns the distances of all pairs.");
  m.def("compute_minimum_distance", &computeMinimumDistance, geometry, geometry_data, "Returns the smallest distance of all pairs.");
  m.def("compute_collision", &computeCollision, geometry, geometry_data, pair, "Returns whether one pair collides.");
  m.def("any_collision", &anyCollision, geometry, geometry_data, "Returns whether any pair collides.");
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

  py::class_<ContactFinder>(m, "ContactFinder", "Tells a simulation what touches.");
  m.def(
      "geometry_contacts",
      [](const CompactModel& x, const GeometryModel& g, double friction, double margin) {
        return geometryContacts(x, g, {.friction = friction, .pairs = {}, .margin = margin});
      },
      model, geometry, py::arg("friction") = 0.8, py::arg("margin") = 0.01, "Makes a finder of the contacts of all pairs.");
  m.def(
      "points_on_plane",
      [](const CompactModel& x, const std::vector<std::string>& frames, const Vector3& normal, double height, double friction) {
        return pointsOnPlane(x, frames, fromEigen3(normal), height, friction);
      },
      model, py::arg("frames"), py::arg("normal") = Vector3::UnitZ().eval(), py::arg("height") = 0.0, py::arg("friction") = 0.0,
      "Makes a finder of contacts between origins of frames and the plane normal . x = height.");
}

}  // namespace dyn::python
