// SPDX-License-Identifier: BSD-2-Clause
// RBDL's Lua models mean what RBDL documents. The references are models that are built here, by the rules that the messages of each test state.
#include "support/difference.hpp"
#include "support/random_model.hpp"
#include "support/registry.hpp"

#include <dyn/dyn.hpp>
#include <dyn/parsers/lua.hpp>

#include <algorithm>
#include <clocale>
#include <string>

using namespace dyn;
using namespace dyn::test;

namespace {

const std::string body = "body = { mass = 2, com = { 0.1, 0.2, 0.3 }, inertia = { { 3, 0.1, 0.2 }, { 0.1, 4, 0.3 }, { 0.2, 0.3, 5 } } }";

Model read(const std::string& text, const LoadOptions& options = {}) { return lua::parse(text, "robot.lua", options); }
Model withJoint(const std::string& joint, const std::string& more = "") {
  return read("return { gravity = { 1, 2, -9 }, frames = { { name = 'a', parent = 'ROOT', joint = " + joint + ", " + body + more + " } } }");
}

JointDescription joint(const std::string& type, const std::vector<double>& axis = {}) {
  JointDescription out;
  out.name = "j";
  out.type = type;
  if (!axis.empty()) out.parameters["axis"] = axis;
  return out;
}

/// Checks that a model moves as one body on these joints, one after the other.
void checkMoves(const Model& description, const std::vector<JointDescription>& parts) {
  Model expected;
  expected.gravity = {1, 2, -9};
  for (std::size_t k = 0; k < parts.size(); ++k) {
    JointDescription part = parts[k];
    part.name += std::to_string(k);
    const bool last = k + 1 == parts.size();
    expected.addBody("b" + std::to_string(k), static_cast<int>(k), part,
                     last ? Inertia<double>{2, {0.1, 0.2, 0.3}, {3, 0.1, 0.2, 4, 0.3, 5}} : Inertia<double>{});
  }
  const CompactModel model = compile(description, registry()), reference = compile(expected, registry());
  REQUIRE(model.nq() == reference.nq());
  REQUIRE(model.nv() == reference.nv());
  Data data(model), other(reference);
  Random random(3);
  const Eigen::VectorXd q = integrate(reference, neutral(reference), random.vector(model.nv(), 1)), v = random.vector(model.nv(), 1),
                        a = random.vector(model.nv(), 1);
  CHECK(off(rnea(model, data, q, v, a), rnea(reference, other, q, v, a)) < 1e-13);
}

bool noted(const Model& model, const std::string& text) {
  return std::any_of(model.notes.begin(), model.notes.end(), [&](const std::string& note) { return note.find(text) != std::string::npos; });
}

}  // namespace

TEST_CASE("an axis lists its rotation before its translation", "[parser]") {
  checkMoves(withJoint("{ { 0, 0.6, 0.8, 0, 0, 0 } }"), {joint("revolute", {0, 0.6, 0.8})});
  checkMoves(withJoint("{ { 0, 0, 0, 0.6, 0, 0.8 } }"), {joint("prismatic", {0.6, 0, 0.8})});
  JointDescription screw = joint("helical", {0, 1, 0});
  screw.parameters["pitch"] = std::vector<double>{-0.3};
  checkMoves(withJoint("{ { 0, 1, 0, 0, -0.3, 0 } }"), {screw});
}

TEST_CASE("a joint of several axes moves about one after the other", "[parser]") {
  checkMoves(withJoint("{ { 0, 0, 1, 0, 0, 0 }, { 0, 1, 0, 0, 0, 0 }, { 1, 0, 0, 0, 0, 0 } }"),
             {joint("revolute", {0, 0, 1}), joint("revolute", {0, 1, 0}), joint("revolute", {1, 0, 0})});
  checkMoves(withJoint("{ { 0,0,0,1,0,0 }, { 0,0,0,0,1,0 }, { 0,0,0,0,0,1 }, { 0,0,1,0,0,0 }, { 0,1,0,0,0,0 }, { 1,0,0,0,0,0 } }"),
             {joint("prismatic", {1, 0, 0}), joint("prismatic", {0, 1, 0}), joint("prismatic", {0, 0, 1}), joint("revolute", {0, 0, 1}),
              joint("revolute", {0, 1, 0}), joint("revolute", {1, 0, 0})});
}

TEST_CASE("joints with RBDL's names move as RBDL documents", "[parser]") {
  const JointDescription x = joint("revolute", {1, 0, 0}), y = joint("revolute", {0, 1, 0}), z = joint("revolute", {0, 0, 1});
  checkMoves(withJoint("{ 'JointTypeEulerZYX' }"), {z, y, x});
  checkMoves(withJoint("{ 'JointTypeEulerXYZ' }"), {x, y, z});
  checkMoves(withJoint("{ 'JointTypeEulerYXZ' }"), {y, x, z});
  checkMoves(withJoint("{ 'JointTypeSpherical' }"), {joint("spherical")});
  checkMoves(withJoint("{ 'JointTypeTranslationXYZ' }"), {joint("translation")});
  checkMoves(withJoint("{ 'JointTypeFloatingBase' }"), {joint("translation"), joint("spherical")});
}

TEST_CASE("E of a joint_frame turns coordinates of the parent into those of the joint", "[parser]") {
  // A joint that is turned by +90 degrees about z sees the parent's y as its x.
  const Model model = withJoint("{}", ", joint_frame = { r = { 1, 2, 3 }, E = { { 0, 1, 0 }, { -1, 0, 0 }, { 0, 0, 1 } } }");
  const SE3<double>& placement = model.bodies[1].joint.placement;
  const Vec3<double> x = placement.R * Vec3<double>{1, 0, 0};
  CHECK(x.x == 0);
  CHECK(x.y == 1);
  CHECK(placement.p.z == 3);
}

TEST_CASE("missing values are those that RBDL documents, and are noted", "[parser]") {
  const Model model = read("return { frames = { { name = 'a', parent = 'ROOT', body = { } }, { name = 'b', parent = 'a' } } }");
  CHECK(model.gravity.y == -9.81);
  CHECK(model.bodies[1].inertia.mass == 1);
  CHECK(model.bodies[1].inertia.rotational.zz == 1);
  CHECK(model.bodies[2].inertia.mass == 0);
  for (const char* text : {"no gravity", "no mass", "no inertia"}) CHECK(noted(model, text));
}

TEST_CASE("points, local frames and markers become frames", "[parser]") {
  const Model model = read(
      "return { gravity = { 0, 0, 0 }, frames = { { name = 'a', parent = 'ROOT', joint = { { 0, 0, 1, 0, 0, 0 } }, markers = { M = { 1, 0, 0 } } } "
      "},\n"
      "points = { { name = 'P', body = 'a', point = { 0, 2, 0 } } },\n"
      "local_frames = { { name = 'L', body = 'a', r = { 0, 0, 3 }, E = { { 0, 1, 0 }, { -1, 0, 0 }, { 0, 0, 1 } } } } }");
  REQUIRE(model.frames.size() == 3);
  CHECK(model.frames[0].name == "M");
  CHECK(model.frames[0].placement.p.x == 1);
  CHECK(model.frames[1].placement.p.y == 2);
  CHECK(model.frames[2].placement.p.z == 3);
  CHECK(model.frames[2].placement.R(1, 0) == 1);
  CHECK(model.notes.empty());
}

TEST_CASE("loops of the only constraint set belong to the model; sets are read by name", "[parser]") {
  const std::string frames =
      "frames = { { name = 'a', parent = 'ROOT', joint = { { 0, 0, 1, 0, 0, 0 } } }, { name = 'b', parent = 'ROOT', joint = { { 0, 0, 1, 0, 0, 0 "
      "} } } }, gravity = { 0, 0, 0 }, ";
  const std::string loop =
      "{ constraint_type = 'loop', name = 'L', predecessor_body = 'a', successor_body = 'b', axis_sets = { { 0, 0, 0, 0, 1, 0 }, { 0, 0, 0, 1, "
      "0, 0 } }, enable_stabilization = true, stabilization_coefficient = 0.5 }";
  const std::string contact = "{ constraint_type = 'contact', name = 'C', body = 'a', point = { 1, 0, 0 }, normal = { 0, 0, 1 } }";
  const std::string one = "return { " + frames + "constraint_sets = { s = { " + loop + ", " + contact + " } } }";
  const Model model = read(one);
  REQUIRE(model.constraints.size() == 1);
  const auto& relation = std::get<FrameConstraint>(model.constraints[0].relation);
  CHECK(relation.frame == "b");
  CHECK(relation.other == "a");
  CHECK(relation.free == std::array<bool, 6>{false, false, true, true, true, true});
  CHECK(relation.has_target);
  CHECK(model.constraints[0].baumgarte.position == 4);
  CHECK(model.constraints[0].baumgarte.velocity == 4);
  CHECK(noted(model, "1 contacts"));
  const auto sets = lua::parseConstraintSets(one, "robot.lua");
  REQUIRE(sets.size() == 1);
  REQUIRE(sets[0].constraints.size() == 2);
  const auto& held = std::get<FrameConstraint>(sets[0].constraints[1].relation);
  CHECK(held.free == std::array<bool, 6>{true, true, false, true, true, true});
  CHECK(held.axes == ConstraintAxes::LOCAL_WORLD_ALIGNED);
  CHECK(held.placement.p.x == 1);
  const CompactModel compiled = compile(model, registry());
  CHECK(ConstraintSet(compiled, sets[0].constraints).rows() == 3);
  const std::string two = "return { " + frames + "constraint_sets = { s = { " + loop + " }, t = { " + contact + " } } }";
  CHECK(read(two).constraints.empty());
  CHECK(noted(read(two), "2 constraint sets"));
  CHECK(lua::parseConstraintSets(two, "robot.lua").size() == 2);
}

TEST_CASE("visuals become volumes, and those that need a mesh's size are noted", "[parser]") {
  const Model model =
      withJoint("{}",
                ", visuals = { { src = 'a.obj', scale = 0.1, translate = { 1, 2, 3 } }, { geometry = { box = { dimensions = { 1, 2, 3 } } }, "
                "rotate = { axis = { 0, 0, 2 }, angle = 90 } }, { src = 'b.obj', dimensions = { 1, 1, 1 } } }");
  REQUIRE(model.geometries.size() == 2);
  CHECK(std::get<geometry::MeshFile>(model.geometries[0].shape).scale.x == 0.1);
  CHECK(model.geometries[0].placement.p.y == 2);
  CHECK(model.geometries[0].role == GeometryDescription::Role::visual);
  CHECK(std::fabs(model.geometries[1].placement.R(1, 0) - 1) < 1e-15);
  CHECK(noted(model, "stretched to the size of its mesh"));
}

TEST_CASE("every entry that nobody reads is noted once", "[parser]") {
  const Model model = read(
      "return { gravity = { 0, 0, 0 }, configuration = {}, frames = {\n{ name = 'a', parent = 'ROOT', colour = 1 },\n{ name = 'b', parent = 'a', "
      "colour = 2 } } }");
  REQUIRE(model.notes.size() == 2);
  CHECK(noted(model, "configuration of a model"));
  CHECK(noted(model, "colour of a frame, 2 times, first at line 2"));
}

TEST_CASE("an inertia that is not symmetric is read from its lower triangle, as in RBDL", "[parser]") {
  const Model model =
      read("return { frames = { { name = 'a', parent = 'ROOT', body = { mass = 1, inertia = { { 3, 9, 9 }, { 0.1, 4, 9 }, { 0.2, 0.3, 5 } } } } } }");
  const Sym3<double>& I = model.bodies[1].inertia.rotational;
  CHECK(I.xy == 0.1);
  CHECK(I.xz == 0.2);
  CHECK(I.yz == 0.3);
  CHECK(noted(model, "lower triangle"));
}

TEST_CASE("siblings are sorted by joint name, or stay as in the file", "[parser]") {
  const std::string text = "return { frames = { { name = 'a', parent = 'ROOT' }, { name = 'z', parent = 'a' }, { name = 'b', parent = 'a' } } }";
  CHECK(read(text).bodies[2].name == "b");
  CHECK(read(text, {.order = Order::file}).bodies[2].name == "z");
}

TEST_CASE("numbers of a script are the same under a locale with decimal commas", "[parser]") {
  const std::string before = std::setlocale(LC_ALL, nullptr);
  const bool set = std::setlocale(LC_ALL, "de_DE.UTF-8") != nullptr;
  const Model model = read("return { gravity = { 0, 0, -9.81 }, frames = { { name = 'a', parent = 'ROOT' } } }");
  std::setlocale(LC_ALL, before.c_str());
  CHECK(model.gravity.z == -9.81);
  (void)set;
}
