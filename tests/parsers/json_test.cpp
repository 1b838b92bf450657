// SPDX-License-Identifier: BSD-2-Clause
// libdyn's own format: nothing is lost, and what is wrong is said with its place.
#include "support/catch.hpp"
#include "support/random_model.hpp"
#include "support/registry.hpp"
#include "support/shared.hpp"
#include "support/skip.hpp"

#include <dyn/dyn.hpp>
#include <dyn/parsers/load.hpp>

#include <clocale>
#include <filesystem>
#include <limits>

using namespace dyn;
using namespace dyn::test;

namespace {

Model everything() {
  Model model;
  model.name = "all \"of\" it";
  model.gravity = {0.1, -0.0, -9.81};
  JointDescription part{.name = "part", .type = "revolute", .parameters = {{"axis", std::vector<double>{0, 0.6, 0.8}}}};
  JointDescription series{.name = "series", .type = "composite", .parameters = {{"parts", std::vector<JointDescription>{part, part}}}};
  series.placement = {{{0, -1, 0, 1, 0, 0, 0, 0, 1}}, {0.1, 1.0 / 3, 1e-300}};
  series.limits.lower = {-std::numeric_limits<double>::infinity(), -1};
  series.limits.upper = {1, std::numeric_limits<double>::infinity()};
  series.damping = {0.1, 0.2};
  series.where = {"robot.urdf", 12, "series"};
  model.addBody("a", 0, series, {1.0 / 3, {1e-17, -0.0, 5e-324}, {1, 0.1, 0.2, 1, 0.3, 1}});
  JointDescription slave{.name = "slave", .type = "revolute", .parameters = {{"axis", std::vector<double>{0, 0, 1}}, {"mode", "a text"}}};
  slave.coupling = {"mimic", "series", {{"multiplier", std::vector<double>{2}}}};
  slave.held = true;
  model.addBody("b", 1, slave);
  model.addBody("b", 2, {.name = "twice", .type = "fixed"});
  model.addBody("c", 3, {.name = "last", .type = "fixed"});
  model.addFrame("tool", 3, {Mat3<double>::identity(), {0, 0, 1}});
  model.constraints = {pointContact("tool"), closeLoop("loop", "tool", "a", {true, false, false, false, false, true}), lockJoint("series", {1, 2}),
                       coupleJoint("slave", slave.coupling)};
  model.constraints[1].baumgarte = {10, 2};
  using namespace geometry;
  const Vec3<double> x{1, 2, 3}, y{4, 5, 6}, z{7, 8, 10};
  for (const GeometryShape& shape :
       {GeometryShape(Sphere{0.1}), GeometryShape(Box{x}), GeometryShape(Capsule{1, 2}), GeometryShape(Cylinder{1, 2}), GeometryShape(Cone{1, 2}),
        GeometryShape(HalfSpace{x, 0.5}), GeometryShape(ConvexHull{{x, y, z}}), GeometryShape(TriangleMesh{{x, y, z}, {{0, 1, 2}}}),
        GeometryShape(MeshFile{"package://a/b.stl", x, true}), GeometryShape(Voxels{{{x, 1}, {y, 2}}}), GeometryShape(OctreeFile{"c.bt"})})
    model.addGeometry("volume" + std::to_string(model.geometries.size()), 3, {Mat3<double>::identity(), x}, shape);
  model.geometries[0].role = GeometryDescription::Role::visual;
  model.geometries[1].where = {"robot.urdf", 7, ""};
  model.disabled_collisions = {{"a", "b", "adjacent"}, {"a", "c", ""}};
  model.groups = {{"arm", {"b"}, {"series"}, {{"a", "c"}}, {"hand"}, {"robot.srdf", 3, ""}}, {.name = "hand"}};
  model.end_effectors = {{"gripper", "hand", "c", "arm", {}}};
  model.virtual_joints = {{"world", "free_flyer", "odom", "a", {"robot.srdf", 9, ""}}};
  model.passive_joints = {"slave"};
  model.configurations = {{"home", "arm", {{"series", {0.1, 1.0 / 3}, {1, 2}}, {"slave", {}, {}}}, {}}, {.name = "zero"}};
  model.devices = {{DeviceDescription::Kind::sensor, "jointpos", "", "<jointpos joint=\"b\"/>", {"robot.xml", 12, ""}},
                   {DeviceDescription::Kind::actuator, "motor", "m", "<motor name=\"m\" joint=\"b\"/>", {}}};
  model.notes = {"odd"};
  return model;
}

void checkRefused(const std::string& text, const std::string& message) {
  INFO(text);
  try {
    json::parse(text, "text");
    FAIL("was accepted");
  } catch (const Error& e) {
    CHECK(std::string(e.what()).find(message) != std::string::npos);
    INFO(e.what());
    CHECK(std::string(e.what()).find("text") == 0);
  }
}

/// A model's text with the body's joint replaced.
std::string withJoint(const std::string& joint) {
  return R"({"format": "libdyn model", "version": 1, "name": "m", "bodies": [{"name": "a", "parent": "universe", "joint": )" + joint + "}]}";
}

}  // namespace

TEST_CASE("a model of every kind of member is written, read and written to the same text", "[json]") {
  const std::string text = json::write(everything());
  const Model read = json::parse(text, "text");
  CHECK(json::write(read) == text);
  CHECK(read.bodies[1].inertia.com.z == 5e-324);
  CHECK(std::signbit(read.gravity.y));
  CHECK(read.bodies[3].parent == 2);
  CHECK(read.frames[0].body == 3);
  CHECK(read.geometries.size() == 11);
  CHECK(read.groups.at(0).chains.at(0).tip == "c");
  CHECK(read.groups.at(0).where.line == 3);
  CHECK(read.configurations.at(0).joints.at(0).v == std::vector<double>{1, 2});
  CHECK(std::get<std::vector<JointDescription>>(read.bodies[1].joint.parameters.at("parts")).size() == 2);
}

TEST_CASE("random models compute the same numbers after a round trip", "[json]") {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const Model model = randomTree(registry(), 12, seed);
    const CompactModel before = compile(model, registry()), after = compile(json::parse(json::write(model), "text"), registry());
    Data a(before, Need::mass_matrix), b(after, Need::mass_matrix);
    const Eigen::VectorXd q = randomConfiguration(before, seed);
    CHECK(Eigen::MatrixXd(crba(before, a, q)) == Eigen::MatrixXd(crba(after, b, q)));
  }
}

TEST_CASE("real robots have the same bits after a round trip through a file", "[json]") {
  DYN_NEEDS_SHARED();
  const std::filesystem::path folder = std::filesystem::temp_directory_path() / ("libdyn-json-" + std::to_string(getpid()));
  std::filesystem::create_directory(folder);
  for (const auto& entry : std::filesystem::directory_iterator(sharedFolder() + "/models")) {
    if (entry.path().extension() != ".urdf") continue;
    INFO(entry.path());
    const Model model = load(entry.path().string(), {.inertias = Inertias::any});
    const std::string path = (folder / "robot.dyn.json").string();
    json::save(model, path);
    CHECK(json::write(load(path)) == json::write(model));
  }
  std::filesystem::remove_all(folder);
}

TEST_CASE("what is wrong in a file of libdyn's own format is said with its place", "[json]") {
  checkRefused("{\n \"format\": \"libdyn model\",\n oops", "text:3");
  checkRefused("[]", "\"format\": \"libdyn model\"");
  checkRefused(R"({"format": "libdyn model", "version": 2, "name": "m", "bodies": []})", "use a newer libdyn");
  checkRefused(R"({"format": "libdyn model", "version": 1, "name": "m"})", "has no member 'bodies'");
  checkRefused(R"({"format": "libdyn model", "version": 1, "name": "m", "bodys": []})", "did you mean 'bodies'");
  checkRefused(withJoint(R"({"name": "j", "typo": "fixed"})"), "bodies[0].joint: has an unknown member 'typo'");
  checkRefused(withJoint(R"({"name": "j", "type": 1})"), "bodies[0].joint.type: must be a text");
  checkRefused(withJoint(R"({"name": "j", "type": "fixed", "lower": [true]})"), "bodies[0].joint.lower[0]: must be a number");
  checkRefused(withJoint(R"({"name": "j", "type": "fixed", "placement": {"position": [1, 2]}})"), "must have 3 numbers, not 2");
  checkRefused(withJoint(R"({"name": "j", "type": "fixed", "placement": {"rotation": [2, 0, 0, 0, 1, 0, 0, 0, 1]}})"), "no rotation matrix");
  checkRefused(R"({"format": "libdyn model", "version": 1, "name": "m", "bodies": [{"name": "a", "parent": "universes", "joint": {}}]})",
               "did you mean 'universe'");
  checkRefused(R"({"format": "libdyn model", "version": 1, "name": "m", "bodies": [{"name": "a", "parent": 1, "joint": {}}]})",
               "there is no body 1 before this place");
  checkRefused(R"({"format": "libdyn model", "version": 1, "name": "m", "bodies": [], "groups": [{"name": "g", "links": []}]})",
               "groups[0]: has an unknown member 'links'");
  std::string nested = R"({"name": "j", "type": "fixed"})";
  for (int k = 0; k < 100; ++k) nested = R"({"name": "j", "type": "composite", "parameters": {"parts": {"joints": [)" + nested + "]}}}";
  checkRefused(withJoint(nested), "nested too deep");
}

TEST_CASE("members that are there twice, characters that a terminal would obey and text without end of nesting are refused", "[json]") {
  checkRefused(withJoint(R"({"name": "j", "type": "fixed", "type": "revolute"})"), "two members of one object are called 'type'");
  CHECK_NOTHROW(json::parse(withJoint(R"({"name": "j", "type": "fixed", "parameters": {"type": [1], "name": "n"}})"), "text"));
  checkRefused(withJoint(R"({"name": "j\u001b[31m", "type": "fixed"})"), "bodies[0].joint.name: has control characters");
  checkRefused(withJoint(R"({"name": "j", "type": "fixed", "parameters": {"a\u0007": [1]}})"), "'a?'");
  checkRefused(withJoint(R"({"name": "j", "\u001b": "fixed"})"), "unknown member '?'");
  checkRefused(withJoint("{\"name\": \"j\xff\", \"type\": \"fixed\"}"), "malformed JSON");
  checkRefused(std::string(100000, '['), "malformed JSON");
  checkRefused(std::string(100000, '[') + std::string(100000, ']'), "no model of libdyn");
  for (const char* name : {"a\x1b[31m", "a\xff"}) {
    Model model;
    model.addBody(name, 0, {.name = "j", .type = "fixed"});
    CHECK_THROWS_WITH(json::write(model), containing("the text 'a?"));
  }
}

TEST_CASE("numbers of libdyn's own format are the same under a locale with decimal commas", "[json]") {
  const std::string before = std::setlocale(LC_ALL, nullptr), text = json::write(everything());
  if (std::setlocale(LC_ALL, "de_DE.UTF-8") == nullptr) DYN_SKIP("the locale de_DE is not installed");
  const std::string written = json::write(everything()), again = json::write(json::parse(text, "text"));
  std::setlocale(LC_ALL, before.c_str());
  CHECK(written == text);
  CHECK(again == text);
}

TEST_CASE("one hundred thousand bodies are read in linear time and memory", "[json]") {
  Model model;
  model.name = "chain";
  for (int i = 0; i < 100000; ++i) model.addBody("b" + std::to_string(i), i, {.name = "j" + std::to_string(i), .type = "fixed"});
  CHECK(json::parse(json::write(model), "text").bodies.size() == 100001);
}

TEST_CASE("load() decides by the file's ending, and says what does not apply", "[json]") {
  const auto message = [](const std::string& path, const LoadOptions& options = {}) {
    try {
      load(path, options);
    } catch (const Error& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  CHECK(message("/tmp/robot.urdf.xacro").find("xacro /tmp/robot.urdf.xacro > robot.urdf") != std::string::npos);
  CHECK(message("/nowhere/a.dyn.json").find("/nowhere/a.dyn.json") == 0);
  CHECK(message("/nowhere/a.dyn.json", {.root = "free_flyer"}).find("does not apply") != std::string::npos);
}
