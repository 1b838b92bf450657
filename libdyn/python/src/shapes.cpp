// SPDX-License-Identifier: BSD-2-Clause
// Volumes on bodies, as descriptions have them, and the pairs that are not checked for collision.
#include "choices.hpp"
#include "description.hpp"
#include "printing.hpp"

#include <dyn/parsers/srdf.hpp>
#include <dyn/spatial/eigen.hpp>

#include <pybind11/eigen.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <filesystem>

namespace dyn::python {

namespace {

using Vector3 = Eigen::Vector3d;
using Points = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
using Path = std::filesystem::path;

std::vector<Vec3<double>> pointsOf(const Points& rows) {
  std::vector<Vec3<double>> out;
  for (Eigen::Index k = 0; k < rows.rows(); ++k) out.push_back({rows(k, 0), rows(k, 1), rows(k, 2)});
  return out;
}
Points rowsOf(const std::vector<Vec3<double>>& points) {
  Points out(static_cast<Eigen::Index>(points.size()), 3);
  for (std::size_t k = 0; k < points.size(); ++k) out.row(static_cast<Eigen::Index>(k)) = toEigen(points[k]);
  return out;
}

geometry::Voxels voxelsOf(const Points& centers, const std::variant<double, Eigen::VectorXd>& sizes) {
  geometry::Voxels out;
  const auto* each = std::get_if<Eigen::VectorXd>(&sizes);
  if (each != nullptr && each->size() != centers.rows())
    throw Error(ErrorCode::size, "Voxels: there are " + std::to_string(centers.rows()) + " centres and " + std::to_string(each->size()) + " sizes");
  for (Eigen::Index k = 0; k < centers.rows(); ++k)
    out.cubes.push_back({{centers(k, 0), centers(k, 1), centers(k, 2)}, each ? (*each)[k] : std::get<double>(sizes)});
  return out;
}

void addSolids(py::module_& m) {
  using namespace geometry;
  const py::arg radius("radius"), length("length");
  py::class_<Sphere> sphere(m, "Sphere", "A ball [m].");
  sphere.def(py::init([](double r) { return Sphere{r}; }), radius).def_readwrite("radius", &Sphere::radius, "[m]; 0 makes a point.");
  printed(sphere, [](const Sphere& x) { return py::make_tuple(x.radius); });
  py::class_<Box> box(m, "Box", "A cuboid, by its whole side lengths along x, y, z [m].");
  box.def(py::init([](double x, double y, double z) {
            return Box{{x, y, z}};
          }),
          py::arg("x"), py::arg("y"), py::arg("z"))
      .def_property(
          "size", [](const Box& b) { return toEigen(b.size); }, [](Box& b, const Vector3& size) { b.size = fromEigen3(size); },
          "Whole side lengths along x, y, z (3,) [m].");
  printed(box, [](const Box& x) { return py::make_tuple(x.size.x, x.size.y, x.size.z); });
  // Shapes with a radius and a length.
  const auto turned = [&]<class Shape>(const Shape*, const char* name, const char* doc) {
    py::class_<Shape> shape(m, name, doc);
    shape.def(py::init([](double r, double l) {
                return Shape{r, l};
              }),
              radius, length)
        .def_readwrite("radius", &Shape::radius, "The radius [m].")
        .def_readwrite("length", &Shape::length, "The length along z [m].");
    printed(shape, [](const Shape& x) { return py::make_tuple(x.radius, x.length); });
  };
  turned(static_cast<const Capsule*>(nullptr), "Capsule", "A cylinder with round ends along z; `length` is between the centres of the ends [m].");
  turned(static_cast<const Cylinder*>(nullptr), "Cylinder", "A circular cylinder along z [m].");
  turned(static_cast<const Cone*>(nullptr), "Cone", "A circular cone along z, with the tip at +length / 2 [m].");
  py::class_<HalfSpace> half_space(m, "HalfSpace", "All points x with normal . x <= offset [m].");
  half_space
      .def(py::init([](const Vector3& normal, double offset) {
             return HalfSpace{fromEigen3(normal), offset};
           }),
           py::arg("normal") = Vector3::UnitZ().eval(), py::arg("offset") = 0.0)
      .def_property(
          "normal", [](const HalfSpace& h) { return toEigen(h.normal); }, [](HalfSpace& h, const Vector3& n) { h.normal = fromEigen3(n); },
          "Points outwards (3,); any length but zero.")
      .def_readwrite("offset", &HalfSpace::offset, "Distance of the plane from the origin along the normal, times its length [m].");
  printed(half_space, [](const HalfSpace& x) { return py::make_tuple(toEigen(x.normal), x.offset); });
}

void addMeshes(py::module_& m) {
  using namespace geometry;
  py::class_<ConvexHull>(m, "ConvexHull", "The convex hull of points, one a row [m].")
      .def(py::init([](const Points& points) { return ConvexHull{pointsOf(points)}; }), py::arg("points"))
      .def_property_readonly(
          "points", [](const ConvexHull& h) { return rowsOf(h.points); }, "The points, one a row (n, 3) [m].")
      .def("__repr__", [](const ConvexHull& h) { return "<libdyn.ConvexHull of " + std::to_string(h.points.size()) + " points>"; });
  py::class_<TriangleMesh>(m, "TriangleMesh", "A surface of triangles: vertices, one a row [m], and three indices of them a triangle.")
      .def(py::init([](const Points& vertices, const std::vector<std::array<int, 3>>& triangles) {
             return TriangleMesh{pointsOf(vertices), triangles};
           }),
           py::arg("vertices"), py::arg("triangles"))
      .def_property_readonly(
          "vertices", [](const TriangleMesh& t) { return rowsOf(t.vertices); }, "Corners, one a row (n, 3) [m].")
      .def_readonly("triangles", &TriangleMesh::triangles, "Three indices of vertices for each triangle.")
      .def("__repr__", [](const TriangleMesh& t) {
        return "<libdyn.TriangleMesh: " + std::to_string(t.vertices.size()) + " vertices, " + std::to_string(t.triangles.size()) + " triangles>";
      });
  py::class_<MeshFile>(m, "MeshFile", "A mesh in a file: a path, or file://, package:// or model:// and a path.")
      .def(py::init([](const std::string& uri, const Vector3& scale, bool convex) {
             return MeshFile{uri, fromEigen3(scale), convex};
           }),
           py::arg("uri"), py::arg("scale") = Vector3::Ones().eval(), py::arg("convex") = false)
      .def_readwrite("uri", &MeshFile::uri, "A path, file://, package:// or model://.")
      .def_property(
          "scale", [](const MeshFile& f) { return toEigen(f.scale); }, [](MeshFile& f, const Vector3& s) { f.scale = fromEigen3(s); },
          "Factors along x, y, z (3,).")
      .def_readwrite("convex", &MeshFile::convex, "Whether the convex hull of the mesh is meant.")
      .def("__repr__", [](const MeshFile& f) { return "<libdyn.MeshFile '" + f.uri + "'>"; });
  py::class_<Voxels>(m, "Voxels", "Cubes along the axes of the frame, such as the occupied leaves of an octree.")
      .def(py::init(&voxelsOf), py::arg("centers"), py::arg("sizes"), "centers: one a row [m]. sizes: one side length [m] for all, or one for each.")
      .def_property_readonly(
          "centers",
          [](const Voxels& v) {
            std::vector<Vec3<double>> centers;
            for (const Voxels::Cube& cube : v.cubes) centers.push_back(cube.center);
            return rowsOf(centers);
          },
          "The centres, one a row (n, 3) [m].")
      .def_property_readonly(
          "sizes",
          [](const Voxels& v) {
            Eigen::VectorXd sizes(static_cast<Eigen::Index>(v.cubes.size()));
            for (std::size_t k = 0; k < v.cubes.size(); ++k) sizes[static_cast<Eigen::Index>(k)] = v.cubes[k].size;
            return sizes;
          },
          "The sides [m].")
      .def("__repr__", [](const Voxels& v) { return "<libdyn.Voxels: " + std::to_string(v.cubes.size()) + " cubes>"; });
  py::class_<OctreeFile>(m, "OctreeFile", "The occupied leaves of an octomap file (.bt or .ot).")
      .def(py::init([](const std::string& uri) { return OctreeFile{uri}; }), py::arg("uri"))
      .def_readwrite("uri", &OctreeFile::uri, "A path, file://, package:// or model://.")
      .def("__repr__", [](const OctreeFile& f) { return "<libdyn.OctreeFile '" + f.uri + "'>"; });
  m.def(
      "height_field",
      [](const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>& heights, double x0, double y0, double dx, double dy) {
        return heightField(static_cast<int>(heights.rows()), static_cast<int>(heights.cols()),
                           std::vector<double>(heights.data(), heights.data() + heights.size()), x0, y0, dx, dy);
      },
      py::arg("heights"), py::arg("x0"), py::arg("y0"), py::arg("dx"), py::arg("dy"),
      "Makes a mesh of a height field: heights[i, j] is the height at (x0 + i dx, y0 + j dy) [m].");
}

void addToModel(py::module_& m) {
  using Role = GeometryDescription::Role;
  const auto role_of = [](const std::string& name) { return chosen<Role>("role", name, {{"collision", Role::collision}, {"visual", Role::visual}}); };
  py::class_<GeometryDescription>(m, "GeometryDescription", "A volume that is fixed to a body.")
      .def_readonly("name", &GeometryDescription::name, "Unique among volumes for collision.")
      .def_readonly("body", &GeometryDescription::body, "The index of the body; 0 is the world.")
      .def_readonly("placement", &GeometryDescription::placement, "The pose in the body's frame.")
      .def_readonly("shape", &GeometryDescription::shape, "The shape, such as a Sphere.")
      .def_property_readonly(
          "role", [](const GeometryDescription& g) { return g.role == Role::collision ? "collision" : "visual"; }, "'collision' or 'visual'.")
      .def("__repr__", [](const GeometryDescription& g) { return "<volume '" + g.name + "'>"; });
  py::class_<DisabledCollision>(m, "DisabledCollision", "Two bodies or volumes that are not checked against each other.")
      .def(py::init([](const std::string& body, const std::string& other, const std::string& reason) {
             return DisabledCollision{body, other, reason};
           }),
           py::arg("body"), py::arg("other"), py::arg("reason") = "")
      .def_readonly("body", &DisabledCollision::body, "The name of a body or volume.")
      .def_readonly("other", &DisabledCollision::other, "The name of another one.")
      .def_readonly("reason", &DisabledCollision::reason, "Why, for people.")
      .def("__repr__", [](const DisabledCollision& x) { return "<no collision of '" + x.body + "' with '" + x.other + "'>"; });
  py::reinterpret_borrow<py::class_<Model>>(m.attr("Model"))
      .def_property_readonly(
          "geometries", [](const Model& x) { return py::tuple(py::cast(x.geometries)); }, "Volumes on bodies and in the world.")
      .def_property(
          "disabled_collisions", [](const Model& x) { return py::tuple(py::cast(x.disabled_collisions)); },
          [](Model& x, const std::vector<DisabledCollision>& pairs) { x.disabled_collisions = pairs; },
          "Pairs that compile_geometry() leaves out. Assign a list to change them.")
      .def(
          "add_geometry",
          [role_of](Model& model, const std::string& name, const std::variant<int, std::string>& body, const GeometryShape& shape,
                    const SE3<double>& placement, const std::string& role) {
            const Role wanted = role_of(role);
            const int added = model.addGeometry(name, bodyOf(model, body), placement, shape);
            model.geometries.back().role = wanted;
            return added;
          },
          py::arg("name"), py::arg("body"), py::arg("shape"), py::arg("placement") = SE3<double>(), py::arg("role") = "collision",
          "Adds a volume at `placement` in the body's frame; returns its index. role: 'collision' or 'visual'.")
      .def(
          "disable_collision",
          [](Model& model, const std::string& body, const std::string& other, const std::string& reason) {
            model.disabled_collisions.push_back({body, other, reason});
          },
          py::arg("body"), py::arg("other"), py::arg("reason") = "", "Leaves out the pairs of two bodies or volumes.")
      .def("find_geometry", &Model::findGeometry, py::arg("name"), "Returns the index of a collision volume; -1 if there is none.");
}

void addSrdf(py::module_& m) {
  auto s = m.def_submodule("srdf",
                           "SRDF files (MoveIt's companions of URDFs): groups, named states, and pairs of links that are not checked for collision.");
  const py::arg path("path"), model("model"), robot("robot"), disabled("disabled");
  s.def(
      "load", [](const Path& file, Model& x) { srdf::load(file.string(), x); }, path, model,
      "Adds groups, end effectors, virtual and passive joints, named states and pairs without collision checks of a file to the model, and a note to "
      "model.notes for each name that the model does not have.");
  s.def("parse", &srdf::parse, py::arg("text"), py::arg("name"), model, "Does the same for a text, which messages call `name`.");
  s.def("text", &srdf::text, robot, disabled, "Returns the text of an SRDF with these pairs.");
  s.def(
      "write",
      [](const Path& file, const std::string& name, const std::vector<DisabledCollision>& pairs) { srdf::write(file.string(), name, pairs); }, path,
      robot, disabled, "Writes that text to a file.");
}

}  // namespace

void addShapes(py::module_& m) {
  addSolids(m);
  addMeshes(m);
  addToModel(m);
  addSrdf(m);
}

}  // namespace dyn::python
