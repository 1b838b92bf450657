// SPDX-License-Identifier: BSD-2-Clause
// The pairs that a geometry model checks, and the geometries that it loads for them.
#include "geometry/scene.hpp"

#include <dyn/compile/edit.hpp>
#include <dyn/geometry/contact_finder.hpp>
#include <dyn/parsers/srdf.hpp>
#include <dyn/parsers/urdf.hpp>

#include <set>

using namespace dyn;
using namespace dyn::test;
namespace g = dyn::geometry;

namespace {

/// The chain base - upper - lower - tool, with a ball on each body. The tool is fixed to lower, the base to the world.
Model arm() {
  Model m;
  const auto joint = [](const char* name, const char* type) {
    JointDescription j = jointOf(name, type, {Mat3<double>::identity(), {0, 0, 0.5}});
    if (std::string(type) == "revolute") j.parameters["axis"] = std::vector<double>{0, 1, 0};
    return j;
  };
  const Inertia<double> Y{1, {}, {1, 0, 0, 1, 0, 1}};
  m.addBody("base", 0, joint("root", "fixed"), Y);
  m.addBody("upper", 1, joint("shoulder", "revolute"), Y);
  m.addBody("lower", 2, joint("elbow", "revolute"), Y);
  m.addBody("tool", 3, joint("flange", "fixed"), Y);
  for (int i = 1; i <= 4; ++i) m.addGeometry(m.bodies[static_cast<std::size_t>(i)].name + "_ball", i, {}, g::Sphere{0.2});
  m.addGeometry("table", 0, {Mat3<double>::identity(), {1, 0, 0}}, g::Box{{1, 1, 0.1}});
  return m;
}

std::set<std::string> pairsOf(const GeometryModel& geometry) {
  std::set<std::string> names;
  const auto& records = geometry.geometries();
  for (const CollisionPair& p : geometry.pairs())
    names.insert(records[static_cast<std::size_t>(p.a)].name + " " + records[static_cast<std::size_t>(p.b)].name);
  return names;
}

}  // namespace

TEST_CASE("pairs of one rigid body and of neighbours are left out, those with the world are not", "[geometry]") {
  const Model description = arm();
  const CompactModel model = compile(description, registry());
  const GeometryModel geometry = compileGeometry(model, description);
  // The base and the table are both fixed to the world. The first moving body is a neighbour of the base but not of the table.
  CHECK(pairsOf(geometry) ==
        std::set<std::string>{"base_ball lower_ball", "base_ball tool_ball", "upper_ball table", "lower_ball table", "tool_ball table"});
  CHECK(geometry.report().rigid == 2);
  CHECK(geometry.report().adjacent == 3);
  CHECK(geometry.pairId("table", "tool_ball") >= 0);
  CHECK(geometry.pairId("table", "tool_ball") == geometry.pairId("tool_ball", "table"));
  CHECK(geometry.pairId("table", "base_ball") == -1);
  CHECK(geometry.pairId("table", "nobody") == -1);
  // A link of another model that is fixed to the world is not its neighbour, either.
  Model scene;
  scene.addBody("shelf", 0, jointOf("stand", "fixed"), {1, {}, {1, 0, 0, 1, 0, 1}});
  scene.addGeometry("board", 1, {}, g::Box{{1, 1, 1}});
  const Model both = append(description, scene, "universe", {}, "scene/");
  CHECK(compileGeometry(compile(both, registry()), both).pairId("upper_ball", "scene/board") >= 0);
}

TEST_CASE("which pairs are asked does not depend on the joints that are held", "[geometry]") {
  const Model description = arm();
  const std::set<std::string> all = pairsOf(compileGeometry(compile(description, registry()), description));
  CompileOptions options;
  for (const auto& joints : {std::vector<std::string>{"elbow"}, {"shoulder"}, {"flange"}, {"shoulder", "elbow"}, {"root", "shoulder", "flange"}}) {
    options.lock.clear();
    for (const std::string& joint : joints) options.lock.push_back({joint, {}});
    CHECK(pairsOf(compileGeometry(compile(description, registry(), options), description)) == all);
    const Model reduced = reduce(description, registry(), options.lock);
    CHECK(pairsOf(compileGeometry(compile(reduced, registry()), reduced)) == all);
  }
}

TEST_CASE("what an appended model disables with its world is still asked of what carries it", "[geometry]") {
  Model tool = arm();
  tool.disabled_collisions = {{"universe", "lower", "Adjacent"}};
  const Model both = append(arm(), tool, "tool", {}, "x_");
  const GeometryModel geometry = compileGeometry(compile(both, registry()), both);
  CHECK(geometry.pairId("x_table", "x_lower_ball") == -1);
  CHECK(geometry.pairId("tool_ball", "x_lower_ball") >= 0);
  CHECK(geometry.pairId("table", "x_lower_ball") >= 0);
}

TEST_CASE("what held joints make collide is found, and makes no contact forces", "[geometry]") {
  // The elbow is bent so far that the tool overlaps the base. Then all joints are held there.
  const Model description = arm();
  const CompactModel free = compile(description, registry());
  const std::vector<double> bent{2 * M_PI / 3, 2 * M_PI / 3};
  CompileOptions options;
  options.lock = {{"shoulder", {bent[0]}}, {"elbow", {bent[1]}}};
  const CompactModel held = compile(description, registry(), options);
  const GeometryModel of_free = compileGeometry(free, description), of_held = compileGeometry(held, description);
  Data free_data(free), held_data(held);
  GeometryData free_geometry(of_free), held_geometry(of_held);
  updateGeometryPlacements(free, free_data, of_free, free_geometry, Eigen::Map<const Eigen::VectorXd>(bent.data(), 2));
  updateGeometryPlacements(held, held_data, of_held, held_geometry, Eigen::VectorXd(0));
  const std::vector<int> found = computeCollisions(of_free, free_geometry);
  CHECK(found == std::vector<int>{of_free.pairId("base_ball", "tool_ball")});
  CHECK(computeCollisions(of_held, held_geometry) == found);
  std::vector<ContactPoint> points;
  geometryContacts(held, of_held)(VectorResult(nullptr, 0), points);
  CHECK(points.empty());
}

TEST_CASE("what stands in the world beside a base is no neighbour of its first link", "[geometry]") {
  // The description has a link for the world, as many URDFs do. This link carries a table and a pedestal; the base is on the pedestal.
  Model m;
  const auto fixed = [](const char* name) { return jointOf(name, "fixed"); };
  JointDescription shoulder = jointOf("shoulder", "revolute");
  shoulder.parameters["axis"] = std::vector<double>{1, 0, 0};
  m.addBody("world_link", 0, fixed("w"));
  m.addBody("table", 1, fixed("t"));
  m.addBody("pedestal", 1, fixed("p"));
  m.addBody("base", 3, fixed("b"));
  m.addBody("arm", 4, shoulder, {1, {}, {1, 0, 0, 1, 0, 1}});
  m.addBody("cover", 5, fixed("c"));
  for (int i = 1; i <= 6; ++i) m.addGeometry("of_" + m.bodies[static_cast<std::size_t>(i)].name, i, {}, g::Sphere{0.1});
  const CompactModel model = compile(m, registry());
  CHECK(pairsOf(compileGeometry(model, m)) == std::set<std::string>{"of_world_link of_arm", "of_world_link of_cover", "of_table of_arm",
                                                                    "of_table of_cover", "of_pedestal of_arm", "of_pedestal of_cover"});
}

TEST_CASE("pairs are added and removed by the names of geometries and bodies", "[geometry]") {
  const Model description = arm();
  const CompactModel model = compile(description, registry());
  GeometryOptions options;
  options.remove = {{"table", "upper_ball"}, {"base", "tool"}};
  options.add = {{"upper", "lower"}};
  CHECK(pairsOf(compileGeometry(model, description, options)) ==
        std::set<std::string>{"base_ball lower_ball", "lower_ball table", "tool_ball table", "upper_ball lower_ball"});
  options = {};
  options.pairs = GeometryOptions::Pairs::none;
  CHECK(compileGeometry(model, description, options).geometries().empty());
  options.add = {{"tool", "table"}};
  const GeometryModel one = compileGeometry(model, description, options);
  CHECK(pairsOf(one) == std::set<std::string>{"tool_ball table"});
  CHECK(one.geometries().size() == 2);
  options.add = {{"tool", "chair"}};
  CHECK_THROWS_WITH(compileGeometry(model, description, options), containing("no collision geometry and no body 'chair'"));
}

TEST_CASE("an SRDF disables pairs of links, and what is written is read back", "[geometry]") {
  Model description = arm();
  srdf::parse(R"(<robot name="arm"><group name="all"/><disable_collisions link1="base" link2="lower" reason="Never"/>
    <disable_collisions link1="base" link2="chair" reason="User"/></robot>)",
              "arm.srdf", description);
  REQUIRE(description.disabled_collisions.size() == 2);
  CHECK(description.disabled_collisions[0].reason == "Never");
  CHECK_THAT(description.notes.back(), containing("no link 'chair'"));
  const CompactModel model = compile(description, registry());
  const GeometryModel geometry = compileGeometry(model, description);
  CHECK(geometry.pairId("base_ball", "lower_ball") == -1);
  CHECK(geometry.pairId("base_ball", "tool_ball") >= 0);
  CHECK(geometry.report().disabled == 1);
  Model again = arm();
  srdf::parse(srdf::text("arm", {{"a&b", "tool", "<Always>"}}), "again.srdf", again);
  CHECK(again.disabled_collisions.at(0).body == "a&b");
  CHECK(again.disabled_collisions.at(0).reason == "<Always>");
  CHECK_THROWS_WITH(srdf::parse("<robot><disable_collisions link1='a'/></robot>", "bad.srdf", again), containing("bad.srdf:1"));
  CHECK(again.disabled_collisions.size() == 1);
  CHECK_THROWS_AS(srdf::write("/nowhere/arm.srdf", "arm", {}), Error);
}

TEST_CASE("volumes without size and names used twice are refused, and say which", "[geometry]") {
  const auto compiled = [](const GeometryShape& shape) {
    Model m = arm();
    m.addGeometry("odd", 0, {}, shape);
    return compileGeometry(compile(m, registry()), m);
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const GeometryShape bad[] = {g::Sphere{-1},
                               g::Sphere{nan},
                               g::Box{{1, 0, 1}},
                               g::Cylinder{0, 1},
                               g::Cone{1, -1},
                               g::Capsule{1, nan},
                               g::ConvexHull{},
                               g::HalfSpace{{0, 0, 0}, 1},
                               g::TriangleMesh{},
                               g::TriangleMesh{{{0, 0, 0}}, {{0, 0, 1}}},
                               g::TriangleMesh{{{nan, 0, 0}}, {{0, 0, 0}}},
                               g::Voxels{{{{0, 0, 0}, -1}}},
                               g::MeshFile{"none.stl", {1, 1, 1}, false}};
  for (const GeometryShape& shape : bad) {
    INFO(shape.index());
    CHECK_THROWS_WITH(compiled(shape), containing("'odd'"));
  }
  CHECK_NOTHROW(compiled(g::Voxels{}));
  Model twice = arm();
  twice.addGeometry("table", 0, {}, g::Sphere{1});
  CHECK_THROWS_WITH(compileGeometry(compile(twice, registry()), twice), containing("two geometries are called 'table'"));
  CHECK_THROWS_AS(twice.addGeometry("far", 9, {}, g::Sphere{1}), Error);
}

TEST_CASE("an empty scene has no collisions and no least distance", "[geometry]") {
  Model m;
  m.addBody("body", 0, jointOf("joint", "free_flyer"), {1, {}, {1, 0, 0, 1, 0, 1}});
  m.addGeometry("voxels", 0, {}, g::Voxels{});
  m.addGeometry("ball", 1, {}, g::Sphere{1});
  const bool with_pair = GENERATE(false, true);
  if (!with_pair) m.geometries.clear();
  const CompactModel model = compile(m, registry());
  const GeometryModel geometry = compileGeometry(model, m);
  Data data(model);
  GeometryData geometry_data(geometry);
  updateGeometryPlacements(model, data, geometry, geometry_data, neutral(model));
  CHECK_FALSE(anyCollision(geometry, geometry_data));
  CHECK(computeCollisions(geometry, geometry_data).empty());
  CHECK(computeContacts(geometry, geometry_data).empty());
  CHECK(std::isinf(computeMinimumDistance(geometry, geometry_data).distance));
  CHECK_THROWS_AS(computeDistance(geometry, geometry_data, 1), Error);
  const GeometryModel other = compileGeometry(model, m);
  CHECK_THROWS_WITH(anyCollision(other, geometry_data), containing("another GeometryModel"));
  if (with_pair) CHECK_THROWS_WITH(geometryPlacement(other, geometry_data, 0), containing("another GeometryModel"));
  const CompactModel again = compile(m, registry());
  Data its_data(again);
  CHECK_THROWS_WITH(updateGeometryPlacements(again, its_data, geometry, geometry_data), containing("another model"));
  if (with_pair) CHECK_THROWS_WITH(updateGeometryPlacements(model, its_data, geometry, geometry_data), containing("another model"));
}

TEST_CASE("URDF's collisions and visuals become geometries of their links", "[geometry]") {
  const Model m = urdf::parse(R"(<robot name="r"><link name="a">
      <collision><origin xyz="1 2 3"/><geometry><box size="1 2 3"/></geometry></collision>
      <collision name="rod"><geometry><cylinder radius="0.5" length="2"/></geometry></collision>
      <collision/>
      <collision><geometry><mesh filename="package://p/m.stl" scale="2 2 2"/></geometry></collision>
      <collision_checking><capsule name="rod"/></collision_checking>
      <visual><geometry><sphere radius="1"/></geometry></visual>
      <visual><geometry><torus/></geometry></visual></link></robot>)",
                              "r.urdf");
  REQUIRE(m.geometries.size() == 4);
  CHECK(m.geometries[0].name == "a_0");
  CHECK(m.geometries[0].placement.p.z == 3);
  CHECK(std::get<g::Box>(m.geometries[0].shape).size.y == 2);
  CHECK(std::get<g::Capsule>(m.geometries[1].shape).length == 2);
  CHECK(std::get<g::MeshFile>(m.geometries[2].shape).scale.x == 2);
  CHECK(m.geometries[3].role == GeometryDescription::Role::visual);
  CHECK(m.geometries[3].where.line == 7);
  CHECK(m.notes.size() == 2);
  CHECK_THROWS_WITH(
      urdf::parse(R"(<robot><link name="a"><collision><geometry><sphere radius="1m"/></geometry></collision></link></robot>)", "x.urdf"),
      containing("'1m'"));
}

TEST_CASE("a model that is appended brings its geometries", "[geometry]") {
  Model scene;
  scene.addGeometry("shelf", 0, {}, g::Box{{1, 1, 1}});
  const Model both = append(append(arm(), arm(), "tool", {Mat3<double>::identity(), {0, 0, 1}}, "second/"), scene, "universe", {}, "scene/");
  CHECK(both.geometries.size() == 11);
  CHECK(both.geometries[5].name == "second/base_ball");
  CHECK(both.bodies[static_cast<std::size_t>(both.geometries[5].body)].name == "second/base");
  // Geometries of the second model's world move to the body that carries the second model.
  CHECK(both.geometries[9].name == "second/table");
  CHECK(both.bodies[static_cast<std::size_t>(both.geometries[9].body)].name == "tool");
  CHECK(both.geometries[9].placement.p.z == 1);
  CHECK(both.geometries[10].body == 0);
  CHECK_THROWS_WITH(append(both, scene, "universe", {}, "scene/"), containing("'scene/shelf'"));
}
