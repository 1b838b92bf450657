// SPDX-License-Identifier: BSD-2-Clause
// Meshes and octrees from files. Valid files give the shapes that they describe; broken files give an error within seconds and bounded memory.
#include "geometry/scene.hpp"
#include "support/folder.hpp"

#include <dyn/geometry/embed.hpp>
#include <dyn/parsers/json.hpp>
#include <dyn/parsers/urdf.hpp>

#include <sys/resource.h>

#include <chrono>
#include <cstring>
#include <filesystem>
#include <fstream>

using namespace dyn;
using namespace dyn::test;
namespace g = dyn::geometry;

namespace {

/// A box with sides 2 x 2 x 2, with its lid, or without it and therefore not convex.
g::TriangleMesh openBox(bool lid) {
  g::TriangleMesh m;
  for (int i = 0; i < 8; ++i) m.vertices.push_back({i & 1 ? 1. : -1., i & 2 ? 1. : -1., i & 4 ? 1. : -1.});
  const int quads[6][4] = {{0, 2, 3, 1}, {0, 1, 5, 4}, {1, 3, 7, 5}, {3, 2, 6, 7}, {2, 0, 4, 6}, {4, 5, 7, 6}};
  for (int i = 0; i < (lid ? 6 : 5); ++i) {
    m.triangles.push_back({quads[i][0], quads[i][1], quads[i][2]});
    m.triangles.push_back({quads[i][0], quads[i][2], quads[i][3]});
  }
  return m;
}

std::string binaryStl(const g::TriangleMesh& m, std::uint32_t claimed) {
  std::string bytes(80, ' ');
  const auto put = [&](const auto& x) { bytes.append(reinterpret_cast<const char*>(&x), sizeof x); };
  put(claimed);
  for (const auto& t : m.triangles) {
    for (int i = 0; i < 3; ++i) put(0.0f);
    for (const int corner : t)
      for (int i = 0; i < 3; ++i) put(static_cast<float>(m.vertices[static_cast<std::size_t>(corner)][i]));
    put(std::uint16_t{0});
  }
  return bytes;
}
std::string binaryStl(const g::TriangleMesh& m) { return binaryStl(m, static_cast<std::uint32_t>(m.triangles.size())); }

std::string obj(const g::TriangleMesh& m) {
  std::string text;
  for (const auto& v : m.vertices) text += "v " + std::to_string(v.x) + " " + std::to_string(v.y) + " " + std::to_string(v.z) + "\n";
  for (const auto& t : m.triangles) text += "f " + std::to_string(t[0] + 1) + " " + std::to_string(t[1] + 1) + " " + std::to_string(t[2] + 1) + "\n";
  return text;
}

std::string dae(const g::TriangleMesh& m) {
  std::string positions, indices;
  for (const auto& v : m.vertices) positions += std::to_string(v.x) + " " + std::to_string(v.y) + " " + std::to_string(v.z) + " ";
  for (const auto& t : m.triangles)
    for (const int corner : t) indices += std::to_string(corner) + " ";
  const std::string n = std::to_string(m.vertices.size());
  return R"(<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset><unit meter="1"/><up_axis>Y_UP</up_axis></asset>
<library_geometries><geometry id="m"><mesh><source id="p"><float_array id="pa" count=")" +
         std::to_string(3 * m.vertices.size()) + "\">" + positions + R"(</float_array><technique_common><accessor source="#pa" count=")" + n +
         R"(" stride="3"><param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices><triangles count=")" +
         std::to_string(m.triangles.size()) + R"("><input semantic="VERTEX" source="#v" offset="0"/><p>)" + indices +
         R"(</p></triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n"><instance_geometry url="#m"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>)";
}

/// Distance of a ball of radius 0.1 at `at` from a shape in the world.
double distanceFrom(const GeometryShape& shape, const Vec3<double>& at) {
  TwoSolids scene(shape, {}, g::Sphere{0.1});
  return scene.distance({Mat3<double>::identity(), at}).distance;
}

}  // namespace

TEST_CASE("meshes of every format are the surface that they say, wherever the file is found", "[geometry]") {
  const Folder folder;
  const g::TriangleMesh open = openBox(false), closed = openBox(true);
  const auto [name, text] =
      GENERATE_COPY(std::pair<std::string, std::string>{"a.stl", binaryStl(open)}, std::pair<std::string, std::string>{"a.obj", obj(open)},
                    std::pair<std::string, std::string>{"a.dae", dae(open)});
  folder.write("robot_description/meshes/" + name, text);
  const std::string file = (folder.path / "robot_description/meshes" / name).string();
  INFO(name);
  // The open mesh is a surface, seen from outside, through the open top and from inside.
  for (const std::string& uri : {file, "file://" + file}) {
    CHECK(distanceFrom(g::MeshFile{uri}, {2, 0, 0}) == approx(0.9).epsilon(1e-12));
    CHECK(distanceFrom(g::MeshFile{uri}, {0, 0, 2}) == approx(std::sqrt(2.0) - 0.1).epsilon(1e-12));
    CHECK(distanceFrom(g::MeshFile{uri}, {0, 0, 0}) == approx(0.9).epsilon(1e-12));
    CHECK(distanceFrom(g::MeshFile{uri}, {0, 0, -0.95}) == approx(-0.05).epsilon(1e-9));
    CHECK(distanceFrom(g::MeshFile{uri, {2, 1, 1}}, {4, 0, 0}) == approx(1.9).epsilon(1e-12));
    CHECK(distanceFrom(g::MeshFile{uri, {-1, 1, 3}}, {0, 0, -4}) == approx(0.9).epsilon(1e-12));
    CHECK(distanceFrom(g::MeshFile{uri, {1, 1, 1}, true}, {0, 0, 0.5}) == approx(-0.6).epsilon(1e-12));
  }
  // A closed convex mesh is a solid.
  CHECK(distanceFrom(closed, {0, 0, 0.5}) == approx(-0.6).epsilon(1e-12));

  // A package is found by the folder of packages, by its own folder, by the environment, or beside the URDF.
  Model m = TwoSolids::describe(g::MeshFile{"package://robot_description/meshes/" + name}, {}, g::Sphere{0.1});
  const CompactModel model = compile(m, registry());
  GeometryOptions options;
  CHECK_THROWS_WITH(compileGeometry(model, m, options), containing("package://robot_description/meshes/" + name) && containing("'a'"));
  for (const std::string& given :
       {folder.path.string(), (folder.path / "robot_description").string(), (folder.path / "robot_description/").string()}) {
    options.packages = {"/nowhere", given};
    CHECK(compileGeometry(model, m, options).report().files_read == 1);
  }
  options.packages.clear();
  setenv("ROS_PACKAGE_PATH", ("/nowhere:" + folder.path.string()).c_str(), 1);
  CHECK(compileGeometry(model, m, options).report().files_read == 1);
  unsetenv("ROS_PACKAGE_PATH");
  folder.write("share/robot_description/meshes/" + name, text);
  setenv("AMENT_PREFIX_PATH", folder.path.c_str(), 1);
  CHECK(compileGeometry(model, m, options).report().files_read == 1);
  unsetenv("AMENT_PREFIX_PATH");
  const std::string robot = folder.write("robot_description/r.urdf", "<robot name='r'><link name='l'><collision><geometry><mesh filename='meshes/" +
                                                                         name + "'/></geometry></collision></link></robot>");
  Model beside = urdf::load(robot, {.root = "free_flyer"});
  beside.addGeometry("ball", 0, {}, g::Sphere{0.1});
  CHECK(compileGeometry(compile(beside, registry()), beside).report().files_read == 1);
}

TEST_CASE("files are read once each, and only those that a pair needs", "[geometry]") {
  const Folder folder;
  const std::string used = folder.write("used.stl", binaryStl(openBox(false)));
  Model m;
  for (int i = 0; i < 5; ++i) {
    m.addBody("b" + std::to_string(i), 0, jointOf("j" + std::to_string(i), "free_flyer"), {1, {}, {1, 0, 0, 1, 0, 1}});
    m.addGeometry("g" + std::to_string(i), i + 1, {}, g::MeshFile{used});
  }
  m.addGeometry("scaled", 5, {}, g::MeshFile{used, {2, 2, 2}});
  // Broken and missing files that no pair needs are not an error.
  GeometryDescription seen;
  seen.name = "seen";
  seen.body = 1;
  seen.shape = g::MeshFile{"package://none/visual.dae"};
  seen.role = GeometryDescription::Role::visual;
  m.geometries.push_back(seen);
  m.addGeometry("alone", 0, {}, g::MeshFile{folder.write("broken.stl", "solid")});
  GeometryOptions options;
  for (int i = 0; i < 5; ++i) options.remove.push_back({"alone", "g" + std::to_string(i)});
  options.remove.push_back({"alone", "scaled"});
  const GeometryModel geometry = compileGeometry(compile(m, registry()), m, options);
  CHECK(geometry.report().files_read == 1);
  CHECK(geometry.report().files_not_needed == 2);
  CHECK(geometry.report().kept == 6);
  CHECK(geometry.report().described == 8);
  CHECK(geometry.report().removed == 6);
}

TEST_CASE("an embedded file gives the same distances to the bit, after saving and without the file", "[geometry]") {
  const Folder folder;
  const auto& [description, closed] = GENERATE(table<g::MeshFile, bool>({{{"m.stl", {1, 1, 1}, false}, false},
                                                                         {{"m.stl", {0.1, -0.3, 1.0 / 3}, false}, false},
                                                                         {{"m.stl", {1, 2, 3}, true}, false},
                                                                         {{"m.stl", {-0.7, 1, 1}, false}, true}}));
  g::TriangleMesh box = openBox(closed);
  box.vertices[3].x = 1.1f;
  const std::string file = folder.write("m.stl", binaryStl(box));
  Model m = TwoSolids::describe(description, {}, g::Sphere{0.1});
  m.geometries[0].where.file = (folder.path / "robot.urdf").string();
  const auto distances = [](const Model& described) {
    const CompactModel model = compile(described, registry());
    const GeometryModel geometry = compileGeometry(model, described);
    Data data(model);
    GeometryData volumes(geometry);
    std::vector<double> out;
    for (unsigned seed = 0; seed < 20; ++seed) {
      updateGeometryPlacements(model, data, geometry, volumes, randomConfiguration(model, seed));
      for (const Distance& d : computeDistances(geometry, volumes)) out.insert(out.end(), {d.distance, d.nearest_a.x, d.nearest_b.y, d.normal.z});
    }
    return out;
  };
  const std::vector<double> expected = distances(m);
  REQUIRE(!expected.empty());
  const EmbedReport report = embedFiles(m);
  CHECK(report.volumes == 1);
  CHECK(report.files == 1);
  CHECK(report.left.empty());
  std::filesystem::remove(file);
  CHECK(distances(json::parse(json::write(m), "text")) == expected);
}

TEST_CASE("only small files that exist are embedded, each is read once, and pictures stay surfaces", "[geometry]") {
  const Folder folder;
  const std::string small = folder.write("small.stl", binaryStl(openBox(true)));
  const std::uintmax_t size = std::filesystem::file_size(small);
  const std::string large = folder.write("large.stl", binaryStl(openBox(true)) + " ");
  Model m;
  for (const std::string& uri : {small, large, std::string("package://none/a.stl"), small}) {
    m.addGeometry("g" + std::to_string(m.geometries.size()), 0, {}, g::MeshFile{uri, {1, 1, 1}, true});
  }
  m.geometries[3].role = GeometryDescription::Role::visual;
  m.addGeometry("ball", 0, {}, g::Sphere{1});
  const EmbedReport report = embedFiles(m, {.largest_file = size});
  CHECK(report.volumes == 2);
  CHECK(report.files == 1);
  REQUIRE(report.left.size() == 2);
  CHECK_THAT(report.left[0], containing("'g1'") && containing("large.stl") && containing("the limit is"));
  CHECK_THAT(report.left[1], containing("'g2' (package://none/a.stl): the file is not there"));
  CHECK(std::get<g::ConvexHull>(m.geometries[0].shape).points.size() == 8);
  CHECK(std::get<g::TriangleMesh>(m.geometries[3].shape).triangles.size() == 12);
  CHECK(std::holds_alternative<g::MeshFile>(m.geometries[1].shape));

  // A broken file is an error, and nothing is half done.
  Model broken;
  broken.addGeometry("a", 0, {}, g::MeshFile{small});
  broken.addGeometry("b", 0, {}, g::MeshFile{folder.write("broken.stl", "solid")});
  CHECK_THROWS_WITH(embedFiles(broken), containing("broken.stl"));
  CHECK(std::holds_alternative<g::MeshFile>(broken.geometries[0].shape));
}

TEST_CASE("missing meshes are named all at once, and skipped where the caller allows", "[geometry]") {
  Model m = TwoSolids::describe(g::MeshFile{"package://none/a.stl"}, {}, g::Sphere{0.1});
  m.addGeometry("c", 1, {}, g::MeshFile{"also/none.stl"});
  m.addGeometry("d", 0, {}, g::Sphere{1});
  const CompactModel model = compile(m, registry());
  CHECK_THROWS_WITH(compileGeometry(model, m), containing("'a': package://none/a.stl") && containing("'c': also/none.stl"));
  GeometryOptions options;
  options.missing = GeometryOptions::Missing::skip;
  const GeometryModel geometry = compileGeometry(model, m, options);
  CHECK(geometry.report().missing.size() == 2);
  CHECK(geometry.pairs().size() == 1);
  CHECK(geometry.geometryId("a") == -1);
}

namespace {
/// A COLLADA file with nodes nested `depth` deep, which assimp follows until its stack overflows.
std::string nestedDae(int depth) {
  std::string open, close;
  for (int i = 0; i < depth; ++i) {
    open += "<node id=\"n" + std::to_string(i) + "\">";
    close += "</node>";
  }
  return "<?xml version=\"1.0\"?><COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" version=\"1.4.1\"><library_visual_scenes>"
         "<visual_scene id=\"s\">" +
         open + close + "</visual_scene></library_visual_scenes><scene><instance_visual_scene url=\"#s\"/></scene></COLLADA>";
}
}  // namespace

TEST_CASE("broken files are an error that names them, soon and without eating memory", "[geometry]") {
  const Folder folder;
  const g::TriangleMesh box = openBox(true);
  g::TriangleMesh nan = box, infinite = box;
  nan.vertices[3].y = std::numeric_limits<double>::quiet_NaN();
  infinite.vertices[0].z = std::numeric_limits<double>::infinity();
  const std::string good = binaryStl(box), text = obj(box), scene = dae(box);
  const std::pair<std::string, std::string> files[] = {
      {"empty.stl", ""},
      {"short.stl", good.substr(0, 60)},
      {"header.stl", good.substr(0, 84)},
      {"truncated.stl", good.substr(0, good.size() / 2)},
      {"billion.stl", binaryStl(box, 1000000000)},
      {"most.stl", binaryStl(box, 0xffffffffu)},
      {"zero.stl", binaryStl({}, 0)},
      {"nan.stl", binaryStl(nan)},
      {"infinite.stl", binaryStl(infinite)},
      {"text.stl", "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0\n"},
      {"words.stl", "solid x\nfacet normal 0 0 1\nouter loop\nvertex a b c\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n"},
      {"noise.stl", std::string(5000, '\x81')},
      {"empty.obj", ""},
      {"truncated.obj", text.substr(0, 40)},
      {"vertices.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n"},
      {"names.obj", "v 0 0 0\nf 1 2 3\n"},
      {"negative.obj", "v 0 0 0\nv 1 0 0\nf -5 -6 -7\n"},
      {"huge.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 1000000000\n"},
      {"nan.obj", "v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"},
      {"truncated.dae", scene.substr(0, scene.size() / 2)},
      {"empty.dae", "<COLLADA/>"},
      {"nested.dae", nestedDae(10000)},
      {"other.dae", "<robot/>"},
      {"unknown.xyz", "what is this"},
      {"empty.bt", ""},
      {"text.bt", "no octree"},
      {"header.bt", "# Octomap OcTree binary file\nid OcTree\nsize 1000000000\nres 0.1\ndata\n"},
      {"zero.bt", "# Octomap OcTree binary file\nid OcTree\nsize 1\nres 0\ndata\n\x01\x02"},
      {"text.ot", "no octree"},
      {"header.ot", "# Octomap OcTree file\nid OcTree\nsize 1000000000\nres 0.1\ndata\n"},
      // Endlessly nested children, which octomap would follow until its stack overflows.
      {"deep.bt", "# Octomap OcTree binary file\nid OcTree\nsize 1000000000\nres 0.1\ndata\n" + std::string(4 << 20, '\xff')},
      {"deep.ot", "# Octomap OcTree file\nid OcTree\nsize 1000000000\nres 0.1\ndata\n" + std::string(4 << 20, '\x01')},
      {"more.bt", "# Octomap OcTree binary file\nid OcTree\nsize 20\nres 0.1\ndata\n" + std::string(4 << 20, '\xff')},
      {"more.ot", "# Octomap OcTree file\nid OcTree\nsize 2\nres 0.1\ndata\n" + std::string("\0\0\0\0\x03\0\0\0\0\0\0\0\0\0\0", 15)},
      {"type.ot", "# Octomap OcTree file\nid ColorOcTree\nsize 1\nres 0.1\ndata\n" + std::string(8, '\0')},
      {"size.bt", "# Octomap OcTree binary file\nid OcTree\nres 0.1\ndata\n"},
  };
  for (const auto& [name, bytes] : files) {
    INFO(name);
    const std::string path = folder.write(name, bytes);
    const bool octree = name.size() > 3 && (name.substr(name.size() - 3) == ".bt" || name.substr(name.size() - 3) == ".ot");
    const GeometryShape shape = octree ? GeometryShape(g::OctreeFile{path}) : GeometryShape(g::MeshFile{path});
    CHECK_THROWS_WITH(distanceFrom(shape, {}), containing(path));
  }
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  CHECK(usage.ru_maxrss < 1 << 20);  // kB
}

TEST_CASE("cubes of an octree are solid, and one without leaves is nowhere", "[geometry]") {
  const g::Voxels voxels{{{{0, 0, 0}, 1}, {{1, 0, 0}, 1}, {{4, 4, 4}, 0.5}}};
  CHECK(distanceFrom(voxels, {3, 0, 0}) == approx(1.4).epsilon(1e-12));
  CHECK(distanceFrom(voxels, {0, 0, 0}) == approx(-0.6).epsilon(1e-12));
  CHECK(distanceFrom(voxels, {4, 4, 5}) == approx(0.65).epsilon(1e-12));
  CHECK(distanceFrom(g::Voxels{{{{2, 0, 0}, 1}}}, {2, 0, 2}) == approx(1.4).epsilon(1e-12));
  CHECK(std::isinf(distanceFrom(g::Voxels{}, {})));
  // A file with one occupied leaf at depth 1 of 16, which is the unit cube in the first octant, and a file with none.
  const Folder folder;
  const std::string header = "# Octomap OcTree binary file\nid OcTree\nsize ", rest = "\nres 3.0517578125e-05\ndata\n";
  const std::string one = folder.write("one.bt", header + "2" + rest + std::string("\x00\x80", 2));
  CHECK(distanceFrom(g::OctreeFile{one}, {0.5, 0.5, 2}) == approx(0.9).epsilon(1e-12));
  CHECK(distanceFrom(g::OctreeFile{one}, {0.5, 0.5, 0.5}) == approx(-0.6).epsilon(1e-12));
  CHECK(std::isinf(distanceFrom(g::OctreeFile{folder.write("none.bt", header + "0" + rest)}, {})));
  CHECK_THROWS_WITH(distanceFrom(g::OctreeFile{folder.write("short.bt", header + "9" + rest + std::string("\x00\x80", 2))}, {}),
                    containing("ends early"));
  // The same cube in octomap's other format, in which a node has log odds and a bit for each child.
  const auto node = [](float log_odds, char children) {
    std::string bytes(5, children);
    std::memcpy(bytes.data(), &log_odds, sizeof log_odds);
    return bytes;
  };
  const std::string odds = folder.write("odds.ot", "# Octomap OcTree file\n# a comment\nid OcTree\nsize 2" + rest + node(1, '\x80') + node(1, 0));
  CHECK(distanceFrom(g::OctreeFile{odds}, {0.5, 0.5, 2}) == approx(0.9).epsilon(1e-12));
  CHECK(distanceFrom(g::OctreeFile{odds}, {0.5, 0.5, 0.5}) == approx(-0.6).epsilon(1e-12));
  // A branch down to the smallest cubes is allowed.
  std::string branch;
  for (int depth = 0; depth < 15; ++depth) branch += std::string("\x03\0", 2);
  const std::string deep = folder.write("smallest.bt", header + "17" + rest + branch + std::string("\x02\0", 2));
  CHECK(distanceFrom(g::OctreeFile{deep}, {-1, -1, 0}) == approx(0.9).epsilon(1e-4));
}
