// SPDX-License-Identifier: BSD-2-Clause
// SDF means what its specification says: frames, axes, screws, nested models, includes, loops.
#include "support/difference.hpp"
#include "support/folder.hpp"
#include "support/random_model.hpp"
#include "support/registry.hpp"

#include <dyn/dyn.hpp>
#include <dyn/parsers/sdf.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

using namespace dyn;
using namespace dyn::test;

namespace {

constexpr double pi = std::numbers::pi;
const std::string inertial = "<inertial><mass>1</mass><inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz></inertia></inertial>";

std::string linkText(const std::string& name, const std::string& more = "") { return "<link name='" + name + "'>" + inertial + more + "</link>\n"; }
std::string joint(const std::string& name, const std::string& type, const std::string& parent, const std::string& child, const std::string& more) {
  return "<joint name='" + name + "' type='" + type + "'><parent>" + parent + "</parent><child>" + child + "</child>" + more + "</joint>\n";
}
std::string axis(const std::string& xyz, const std::string& more = "") { return "<axis><xyz>" + xyz + "</xyz>" + more + "</axis>"; }
Model read(const std::string& model, const LoadOptions& options = {}) {
  return sdf::parse("<sdf version='1.9'><model name='m'>\n" + model + "</model></sdf>", "robot.sdf", options);
}

/// The pose of a frame at q, in the world.
SE3<double> poseAt(const Model& description, const std::string& frame, const std::vector<double>& q) {
  const CompactModel model = compile(description, registry());
  REQUIRE(model.nq() == static_cast<int>(q.size()));
  Data data(model);
  forwardKinematics(model, data, Eigen::Map<const Eigen::VectorXd>(q.data(), static_cast<Eigen::Index>(q.size())));
  return framePlacement(model, data, model.frameId(frame));
}

void checkPoint(const Vec3<double>& p, double x, double y, double z) {
  CHECK(std::fabs(p.x - x) < 1e-14);
  CHECK(std::fabs(p.y - y) < 1e-14);
  CHECK(std::fabs(p.z - z) < 1e-14);
}

bool noted(const Model& model, const std::string& text) {
  return std::any_of(model.notes.begin(), model.notes.end(), [&](const std::string& note) { return note.find(text) != std::string::npos; });
}

}  // namespace

TEST_CASE("an axis is in the joint's frame, which is in the child's, unless expressed_in says otherwise", "[parser]") {
  const std::string links = linkText("a") + linkText("b", "<pose>1 0 0 0 0 1.5707963267948966</pose>");
  // The child's frame is turned by 90 degrees about z: the joint's x is the world's y.
  const auto moved = [&](const std::string& text) { return poseAt(read(links + joint("j", "prismatic", "a", "b", text)), "b", {1}).p; };
  checkPoint(moved(axis("1 0 0")), 1, 1, 0);
  checkPoint(moved("<axis><xyz expressed_in='a'>1 0 0</xyz></axis>"), 2, 0, 0);
  checkPoint(moved("<axis><xyz expressed_in='__model__'>1 0 0</xyz></axis>"), 2, 0, 0);
  checkPoint(moved("<pose>0 0 0 0 0 1.5707963267948966</pose>" + axis("1 0 0")), 0, 0, 0);
  checkPoint(moved("<pose relative_to='a'>5 5 5 0 0 0</pose>" + axis("1 0 0")), 2, 0, 0);
}

TEST_CASE("axes of SDF 1.4 with use_parent_model_frame are in the model's frame", "[parser]") {
  const std::string text = "<sdf version='1.4'><model name='m'>" + linkText("a") + linkText("b", "<pose>1 0 0 0 0 1.5707963267948966</pose>") +
                           joint("j", "prismatic", "a", "b", axis("1 0 0")) + "</model></sdf>";
  checkPoint(poseAt(sdf::parse(text, "robot.sdf"), "b", {1}).p, 2, 0, 0);
}

TEST_CASE("a hinge that is elsewhere in its child turns the child about it", "[parser]") {
  const Model model =
      read(linkText("a") + linkText("b", "<pose>1 0 0 0 0 0</pose>") + joint("j", "revolute", "a", "b", "<pose>-1 0 0 0 0 0</pose>" + axis("0 0 1")));
  CHECK(model.findBody("j") > 0);  // joints are frames in SDF
  const SE3<double> pose = poseAt(model, "b", {pi / 2});
  checkPoint(pose.p, 0, 1, 0);
  CHECK(std::fabs(pose.R(1, 0) - 1) < 1e-14);
  checkPoint(poseAt(model, "j", {pi / 2}).p, 0, 0, 0);
}

TEST_CASE("a positive thread_pitch is left-handed, in radians per metre; screw_thread_pitch is right-handed, in metres per revolution", "[parser]") {
  const auto risen = [](const std::string& pitch) {
    return poseAt(read(linkText("a") + linkText("b") + joint("j", "screw", "a", "b", axis("0 0 1") + pitch)), "b", {2 * pi}).p.z;
  };
  CHECK(std::fabs(risen("<thread_pitch>10</thread_pitch>") - -2 * pi / 10) < 1e-14);
  CHECK(std::fabs(risen("<screw_thread_pitch>0.05</screw_thread_pitch>") - 0.05) < 1e-14);
  CHECK(std::fabs(risen("") - -2 * pi) < 1e-14);  // SDF 1.9's default of thread_pitch is 1
}

TEST_CASE("joints of two and three degrees of freedom", "[parser]") {
  const std::string two = axis("1 0 0") + "<axis2><xyz>0 1 0</xyz></axis2>";
  for (const char* type : {"universal", "revolute2"}) {
    INFO(type);
    const SE3<double> pose = poseAt(read(linkText("a") + linkText("b") + joint("j", type, "a", "b", two)), "b", {pi / 2, pi / 2});
    // Rx(90) Ry(90): x goes to -z by the second and to y by the first.
    CHECK(std::fabs(pose.R(1, 0) - 1) < 1e-14);
  }
  CHECK(compile(read(linkText("a") + linkText("b") + joint("j", "ball", "a", "b", "")), registry()).nv() == 3);
}

TEST_CASE("limits and dynamics are read; 1e16 and negative efforts are no limits", "[parser]") {
  const auto of = [](const std::string& type, const std::string& more, const LoadOptions& options = {}) {
    return read(linkText("a") + linkText("b") + joint("j", type, "a", "b", axis("0 0 1", more)), options).bodies[2].joint;
  };
  const JointDescription j = of("revolute",
                                "<limit><lower>-1</lower><upper>2</upper><effort>3</effort><velocity>4</velocity></limit>"
                                "<dynamics><damping>0.5</damping><friction>0.25</friction></dynamics>");
  CHECK(j.limits.lower == std::vector<double>{-1});
  CHECK(j.limits.upper == std::vector<double>{2});
  CHECK(j.limits.effort == std::vector<double>{3});
  CHECK(j.limits.velocity == std::vector<double>{4});
  CHECK(j.damping == std::vector<double>{0.5});
  CHECK(j.friction == std::vector<double>{0.25});
  const JointDescription free = of("prismatic", "<limit><lower>-1e16</lower><upper>inf</upper><effort>-1</effort></limit>");
  CHECK(free.limits.lower.empty());
  CHECK(free.limits.upper.empty());
  CHECK(free.limits.effort.empty());
  CHECK(of("continuous", "").type == "continuous");
  CHECK(of("continuous", "", {.continuous = Continuous::angle}).type == "revolute");
}

TEST_CASE("an inertia has its own pose", "[parser]") {
  const Model model = read(
      "<link name='a'><inertial><pose>1 2 3 0 0 1.5707963267948966</pose><mass>2</mass><inertia><ixx>3</ixx><iyy>4</iyy><izz>5</izz>"
      "</inertia></inertial></link>");
  const Inertia<double>& Y = model.bodies[1].inertia;
  CHECK(Y.mass == 2);
  checkPoint(Y.com, 1, 2, 3);
  CHECK(std::fabs(Y.rotational.xx - 4) < 1e-14);
  CHECK(std::fabs(Y.rotational.yy - 3) < 1e-14);
  CHECK(noted(read("<link name='a'/>"), "gets 1 kg"));
}

TEST_CASE("frames, nested models and their names", "[parser]") {
  const Model model = read(
      linkText("a") + "<frame name='f' attached_to='a'><pose>0 0 1 0 0 0</pose></frame><model name='n'><pose relative_to='f'>1 0 0 0 0 0</pose>" +
      linkText("a") + "</model>" + joint("j", "fixed", "a", "n::a", ""));
  CHECK(model.findBody("n::a") == 2);
  checkPoint(poseAt(model, "n::a", {}).p, 1, 0, 1);
  checkPoint(poseAt(model, "f", {}).p, 0, 0, 1);
}

TEST_CASE("a link without a joint hangs on the world by the root joint; a world holds several models", "[parser]") {
  const std::string world = "<sdf version='1.9'><world name='w'><gravity>0 0 -5</gravity><model name='floor'><static>true</static>" + linkText("a") +
                            "</model><model name='box'><pose>0 0 2 0 0 0</pose>" + linkText("a") + "</model></world></sdf>";
  const Model model = sdf::parse(world, "world.sdf", {.root = "free_flyer"});
  CHECK(model.gravity.z == -5);
  CHECK(model.bodies[static_cast<std::size_t>(model.findBody("floor::a"))].joint.type == "fixed");
  const BodyDescription& box = model.bodies[static_cast<std::size_t>(model.findBody("box::a"))];
  CHECK(box.joint.type == "free_flyer");
  CHECK(box.joint.name == "root_joint");
  CHECK(box.joint.placement.p.z == 2);
  CHECK(noted(read(linkText("a")), "SDF lets such a model move freely"));
  CHECK_THROWS_WITH(read(linkText("a") + joint("j", "fixed", "world", "a", ""), {.root = "free_flyer"}), containing("does not apply"));
}

TEST_CASE("joints that close a loop become constraints; must_be_loop_joint chooses them", "[parser]") {
  const std::string links = linkText("a") + linkText("b", "<pose>1 0 0 0 0 0</pose>") + linkText("c", "<pose>1 1 0 0 0 0</pose>");
  const std::string tree = joint("w", "fixed", "world", "a", "") + joint("p", "revolute", "a", "b", axis("0 0 1"));
  const std::string cut = "<physics><simbody><must_be_loop_joint>true</must_be_loop_joint></simbody></physics>";
  const Model model = read(links + tree + joint("q", "revolute", "b", "c", axis("0 0 1")) + joint("r", "revolute", "a", "c", axis("0 0 1")));
  REQUIRE(model.constraints.size() == 1);
  CHECK(model.constraints[0].name == "r");
  const auto& relation = std::get<FrameConstraint>(model.constraints[0].relation);
  CHECK(relation.free == std::array<bool, 6>{false, false, false, false, false, true});
  checkPoint(relation.other_placement.p, 1, 1, 0);
  const Model other = read(links + tree + joint("q", "revolute", "b", "c", axis("0 0 1") + cut) + joint("r", "revolute", "a", "c", axis("0 0 1")));
  REQUIRE(other.constraints.size() == 1);
  CHECK(other.constraints[0].name == "q");
}

TEST_CASE("a link with two parents of which one hangs on it is carried the other way round", "[parser]") {
  // a carries b, and c is said to carry b as well: c hangs on b by the opposite motion.
  const Model model =
      read(linkText("a") + linkText("b", "<pose>1 0 0 0 0 0</pose>") + linkText("c", "<pose>1 1 0 0 0 0</pose>") +
           joint("w", "fixed", "world", "a", "") + joint("p", "revolute", "a", "b", axis("0 0 1")) + joint("q", "revolute", "c", "b", axis("0 0 1")));
  CHECK(model.constraints.empty());
  // The hinge q is at the origin of b. Seen from b, c turns by -q.
  checkPoint(poseAt(model, "c", {0, pi / 2}).p, 2, 0, 0);
}

TEST_CASE("a gearbox couples two hinges of its reference body", "[parser]") {
  const std::string links = linkText("base") + linkText("b", "<pose>1 0 0 0 0 0</pose>") + linkText("c", "<pose>2 0 0 0 0 0</pose>");
  const std::string hinges = joint("w", "fixed", "world", "base", "") + joint("p", "revolute", "base", "b", axis("0 0 1")) +
                             joint("q", "revolute", "base", "c", axis("0 0 -1"));
  const std::string gear =
      axis("0 0 1") + "<axis2><xyz>0 0 1</xyz></axis2><gearbox_ratio>3</gearbox_ratio><gearbox_reference_body>base</gearbox_reference_body>";
  const Model model = read(links + hinges + joint("g", "gearbox", "b", "c", gear));
  REQUIRE(model.constraints.size() == 1);
  const auto& relation = std::get<JointCoupling>(model.constraints[0].relation);
  CHECK(relation.joint == "q");
  CHECK(relation.coupling.master == "p");
  // theta_2 = -3 theta_1; theta_2 is -q, because q's axis is opposite.
  CHECK(std::get<std::vector<double>>(relation.coupling.parameters.at("coefficients")) == std::vector<double>{0, 3});
  CHECK_THROWS_WITH(read(links + hinges + joint("g", "gearbox", "base", "c", gear)), containing("gearbox_reference_body"));
}

TEST_CASE("a mimic joint follows its master", "[parser]") {
  const std::string text = linkText("a") + linkText("b") + linkText("c") + joint("p", "revolute", "a", "b", axis("0 0 1")) +
                           joint("q", "revolute", "b", "c",
                                 axis("0 0 1", "<mimic joint='p'><multiplier>2</multiplier><offset>0.5</offset><reference>0.25</reference></mimic>"));
  const Model model = read(text);
  const Coupling& coupling = model.bodies[static_cast<std::size_t>(model.findJoint("q"))].joint.coupling;
  CHECK(coupling.master == "p");
  CHECK(std::get<std::vector<double>>(coupling.parameters.at("coefficients")) == std::vector<double>{0, 2});
  CHECK(compile(model, registry()).nv() == 1);
  CHECK(compile(read(text, {.mimic = Mimic::independent}), registry()).nv() == 2);
}

TEST_CASE("volumes keep their shapes, poses and names", "[parser]") {
  const Model model = read("<link name='a'>" + inertial +
                           "<collision name='c'><pose>0 0 1 0 0 0</pose><geometry><box><size>1 2 3</size></box></geometry></collision>"
                           "<collision name='d'><geometry><plane><normal>0 1 0</normal></plane></geometry></collision>"
                           "<collision name='e'><geometry><ellipsoid><radii>1 2 3</radii></ellipsoid></geometry></collision>"
                           "<visual name='v'><geometry><mesh><uri>a.stl</uri><scale>2 2 2</scale></mesh></geometry></visual></link>");
  REQUIRE(model.geometries.size() == 3);
  CHECK(model.geometries[0].name == "a::c");
  CHECK(model.geometries[0].placement.p.z == 1);
  CHECK(std::get<geometry::Box>(model.geometries[0].shape).size.z == 3);
  CHECK(std::get<geometry::HalfSpace>(model.geometries[1].shape).normal.y == 1);
  CHECK(std::get<geometry::MeshFile>(model.geometries[2].shape).scale.x == 2);
  CHECK(noted(model, "shape libdyn does not have"));
}

TEST_CASE("included models are read, merged and placed", "[parser]") {
  const Folder folder;
  folder.write("part.sdf", "<sdf version='1.9'><model name='part'>" + linkText("tip", "<pose>0 0 1 0 0 0</pose>") + linkText("end") +
                               joint("k", "fixed", "tip", "end", "") + "</model></sdf>");
  const auto with = [&](const std::string& include, const std::string& last) {
    const std::string path = folder.write("robot.sdf", "<sdf version='1.9'><model name='m'>\n<!-- <include><uri>no.sdf</uri></include> -->\n" +
                                                           linkText("a") + include + joint("j", "fixed", "a", last, "") + "</model></sdf>");
    return sdf::load(path);
  };
  const std::string uri = "<uri>part.sdf</uri>";
  checkPoint(poseAt(with("<include>" + uri + "<pose>1 0 0 0 0 0</pose></include>", "part::tip"), "part::tip", {}).p, 1, 0, 1);
  checkPoint(poseAt(with("<include>" + uri + "<name>n</name></include>", "n::tip"), "n::end", {}).p, 0, 0, 0);
  checkPoint(poseAt(with("<include merge='true'>" + uri + "<pose>1 0 0 0 0 0</pose></include>", "tip"), "tip", {}).p, 1, 0, 1);
  checkPoint(
      poseAt(with("<include>" + uri + "<placement_frame>tip</placement_frame><pose>1 0 0 0 0 0</pose></include>", "part::tip"), "part::tip", {}).p, 1,
      0, 0);
}

TEST_CASE("a folder with a model.config is included by its newest file", "[parser]") {
  const Folder folder;
  folder.write("part/model.config", "<model><name>part</name><sdf version='1.5'>old.sdf</sdf><sdf version='1.9'>new.sdf</sdf></model>");
  folder.write("part/new.sdf", "<sdf version='1.9'><model name='part'>" + linkText("tip") + "</model></sdf>");
  const std::string path = folder.write("robot.sdf", "<sdf version='1.9'><world name='w'><include><uri>model://part</uri></include></world></sdf>");
  CHECK(sdf::load(path).findBody("tip") == 1);
}

TEST_CASE("elements that nobody reads are noted once each", "[parser]") {
  const Model model =
      read("<link name='a'>" + inertial + "<sensor name='s' type='imu'/>\n<sensor name='t' type='imu'/></link><plugin name='p' filename='q'/>");
  CHECK(noted(model, "ignored: <sensor> in <link>, 2 times, first at line 2"));
  CHECK(noted(model, "ignored: <plugin> in <model>"));
}
