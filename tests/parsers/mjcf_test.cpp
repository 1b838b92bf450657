// SPDX-License-Identifier: BSD-2-Clause
// Single elements of MJCF, and the traps that readers of MJCF fall into.
#include "support/difference.hpp"
#include "support/folder.hpp"
#include "support/registry.hpp"

#include <dyn/dyn.hpp>
#include <dyn/lie/so3.hpp>
#include <dyn/parsers/load.hpp>
#include <dyn/parsers/mjcf.hpp>
#include <dyn/spatial/eigen.hpp>

#include <Eigen/Geometry>

using namespace dyn;
using namespace dyn::test;

namespace {

constexpr double pi = 3.14159265358979323846;

std::string mujoco(const std::string& world, const std::string& before = "") {
  return "<mujoco model=\"m\">\n" + before + "<worldbody>\n" + world + "</worldbody>\n</mujoco>\n";
}
Model read(const std::string& world, const std::string& before = "") { return mjcf::parse(mujoco(world, before), "robot.xml"); }

const BodyDescription& bodyOf(const Model& model, const std::string& name) {
  const int i = model.findBody(name);
  REQUIRE(i >= 0);
  return model.bodies[static_cast<std::size_t>(i)];
}
const JointDescription& jointOf(const Model& model, const std::string& name) {
  const int i = model.findJoint(name);
  REQUIRE(i >= 0);
  return model.bodies[static_cast<std::size_t>(i)].joint;
}

Eigen::Matrix3d about(int axis, double angle) { return Eigen::AngleAxisd(angle, Eigen::Vector3d::Unit(axis)).toRotationMatrix(); }
double away(const SE3<double>& X, const Eigen::Matrix3d& R) { return (toEigen(X).topLeftCorner<3, 3>() - R).cwiseAbs().maxCoeff(); }

/// The pose of the only body, which the attributes turn.
SE3<double> turned(const std::string& attributes, const std::string& before = "") {
  return read("<body name=\"a\" " + attributes + "/>", before).bodies.back().joint.placement;
}

bool noted(const Model& model, const std::string& what) {
  return std::any_of(model.notes.begin(), model.notes.end(), [&](const std::string& note) { return note.find(what) != std::string::npos; });
}

const std::string mass = "<geom type=\"sphere\" size=\"0.1\"/>";

}  // namespace

TEST_CASE("eulerseq is xyz about moving axes unless the compiler says otherwise", "[mjcf]") {
  const double a = 0.3, b = 0.5, c = -0.7;
  const std::string euler = "euler=\"0.3 0.5 -0.7\"", radian = "<compiler angle=\"radian\"/>";
  CHECK(away(turned(euler, radian), about(0, a) * about(1, b) * about(2, c)) < 1e-15);
  CHECK(away(turned(euler, radian + "<compiler eulerseq=\"XYZ\"/>"), about(2, c) * about(1, b) * about(0, a)) < 1e-15);
  CHECK(away(turned(euler, radian + "<compiler eulerseq=\"zyx\"/>"), about(2, a) * about(1, b) * about(0, c)) < 1e-15);
  CHECK(away(turned(euler, radian + "<compiler eulerseq=\"zXy\"/>"), about(0, b) * about(2, a) * about(1, c)) < 1e-15);
  CHECK_THROWS_WITH(turned("", "<compiler eulerseq=\"abc\"/>"), containing("eulerseq"));
}

TEST_CASE("each spelling of an orientation gives its rotation", "[mjcf]") {
  CHECK(away(turned("quat=\"2 0 0 2\""), about(2, pi / 2)) < 1e-15);
  CHECK(away(turned("axisangle=\"0 3 0 90\""), about(1, pi / 2)) < 1e-15);
  CHECK(away(turned("xyaxes=\"0 2 0 -1 5 0\""), about(2, pi / 2)) < 1e-15);
  CHECK(away(turned("zaxis=\"1 0 0\""), about(1, pi / 2)) < 1e-15);
  CHECK(away(turned("zaxis=\"0 0 -2\""), about(0, pi)) < 1e-15);
  CHECK_THROWS_WITH(turned("quat=\"1 0 0 0\" euler=\"0 0 0\""), containing("both quat and euler"));
  CHECK_THROWS_WITH(turned("quat=\"0 0 0 0\""), containing("quat is zero"));
  CHECK_THROWS_WITH(turned("zaxis=\"0 0 0\""), containing("no direction"));
  CHECK_THROWS_WITH(turned("xyaxes=\"1 0 0 2 0 0\""), containing("no direction"));
}

TEST_CASE("several compiler elements are merged, attribute by attribute", "[mjcf]") {
  const std::string axis = "axisangle=\"0 0 1 0.5\"";
  CHECK(away(turned(axis, "<compiler angle=\"radian\"/><compiler eulerseq=\"zyx\"/>"), about(2, 0.5)) < 1e-15);
  CHECK(away(turned(axis, "<compiler angle=\"radian\"/><compiler angle=\"degree\"/>"), about(2, 0.5 * pi / 180)) < 1e-15);
  // A compiler element behind the bodies holds for them, too.
  const Model model = mjcf::parse("<mujoco><worldbody><body axisangle=\"0 0 1 0.5\"/></worldbody><compiler angle=\"radian\"/></mujoco>", "robot.xml");
  CHECK(away(model.bodies[1].joint.placement, about(2, 0.5)) < 1e-15);
  CHECK_THROWS_WITH(read("", "<compiler coordinate=\"global\"/>"), containing("global coordinates") && containing("2.3.4"));
  CHECK_NOTHROW(read("", "<compiler coordinate=\"local\"/>"));
}

TEST_CASE("degrees and radians hold within defaults, and slides have neither", "[mjcf]") {
  const std::string classes =
      "<default><joint range=\"-90 45\" ref=\"10\"/><default class=\"s\"><joint type=\"slide\" range=\"-2 3\"/></default></default>";
  const std::string bodies = "<body><joint name=\"h\"/>" + mass + "<body><joint name=\"s\" class=\"s\"/>" + mass + "</body></body>";
  const Model degrees = read(bodies, classes);
  CHECK(jointOf(degrees, "h").limits.lower[0] == approx(-pi / 2));
  CHECK(jointOf(degrees, "h").limits.upper[0] == approx(pi / 4));
  CHECK(away(jointOf(degrees, "h").placement, about(2, -10 * pi / 180)) < 1e-15);
  CHECK(jointOf(degrees, "s").limits.upper[0] == 3);
  CHECK(jointOf(degrees, "s").placement.p.z == -10);
  const Model radians = read(bodies, "<compiler angle=\"radian\"/>" + classes);
  CHECK(jointOf(radians, "h").limits.lower[0] == -90);
}

TEST_CASE("ranges hold by autolimits, or where limited says so", "[mjcf]") {
  const auto limits = [](const std::string& joint, const std::string& before = "") {
    return jointOf(read("<body><joint name=\"j\" type=\"slide\" " + joint + "/>" + mass + "</body>", before), "j").limits;
  };
  CHECK(limits("range=\"-1 2\"").upper == std::vector<double>{2});
  CHECK(limits("range=\"-1 2\" limited=\"false\"").upper.empty());
  CHECK(limits("").upper.empty());
  CHECK(limits("range=\"-1 2\" limited=\"true\"", "<compiler autolimits=\"false\"/>").lower == std::vector<double>{-1});
  CHECK_THROWS_WITH(limits("range=\"-1 2\"", "<compiler autolimits=\"false\"/>"), containing("limited") && containing("autolimits"));
  CHECK_THROWS_WITH(limits("range=\"2 -1\""), containing("range"));
  CHECK(limits("actuatorfrcrange=\"-7 7\"").effort == std::vector<double>{7});
}

TEST_CASE("all joints of a body carry it, the first one outermost", "[mjcf]") {
  const Model model = read(
      "<body name=\"b\" pos=\"0 0 1\"><joint name=\"x\" axis=\"1 0 0\"/><joint name=\"y\" axis=\"0 1 0\"/>"
      "<joint name=\"z\" type=\"slide\" axis=\"0 0 1\"/>" +
      mass + "</body>");
  const CompactModel compact = compile(model, registry());
  REQUIRE(compact.nv() == 3);
  Data data(compact);
  Eigen::VectorXd q(3);
  q << 0.3, 0.5, 0.7;
  forwardKinematics(compact, data, q);
  const SE3<double> X = framePlacement(compact, data, compact.frameId("b"));
  CHECK(away(X, about(0, 0.3) * about(1, 0.5)) < 1e-15);
  CHECK((toEigen(X.p) - (Eigen::Vector3d(0, 0, 1) + about(0, 0.3) * about(1, 0.5) * Eigen::Vector3d(0, 0, 0.7))).norm() < 1e-15);
  CHECK(std::isfinite(aba(compact, data, q, q, q).norm()));
}

TEST_CASE("a body keeps its frame where its joint is elsewhere", "[mjcf]") {
  const Model model = read("<body name=\"b\" pos=\"1 0 0\"><joint name=\"j\" axis=\"0 0 1\" pos=\"0 2 0\"/>" + mass + "</body>");
  const CompactModel compact = compile(model, registry());
  Data data(compact);
  forwardKinematics(compact, data, Eigen::VectorXd::Zero(1));
  CHECK(framePlacement(compact, data, compact.frameId("b")).p.x == 1);
  forwardKinematics(compact, data, Eigen::VectorXd::Constant(1, pi / 2));
  const SE3<double> X = framePlacement(compact, data, compact.frameId("b"));
  // The body turns about (1, 2, 0).
  CHECK((toEigen(X.p) - Eigen::Vector3d(3, 2, 0)).norm() < 1e-15);
}

TEST_CASE("bodies of the world, also several, have the world as their parent", "[mjcf]") {
  const Model model = read("<body name=\"a\"><joint/>" + mass + "<body name=\"b\"><joint/>" + mass +
                           "</body></body><body name=\"c\" pos=\"1 2 3\"><freejoint/>" + mass + "</body><body name=\"d\" pos=\"0 0 1\"/>");
  CHECK(bodyOf(model, "a").parent == 0);
  CHECK(bodyOf(model, "b").parent == model.findBody("a"));
  CHECK(bodyOf(model, "c").parent == 0);
  CHECK(bodyOf(model, "d").parent == 0);
  CHECK(bodyOf(model, "d").joint.type == "fixed");
  // A free joint's q is the pose in the world.
  CHECK(bodyOf(model, "c").joint.type == "free_flyer");
  CHECK(bodyOf(model, "c").joint.placement.p.x == 0);
}

TEST_CASE("classes nest, and childclass reaches all that is below", "[mjcf]") {
  const std::string classes =
      "<default><joint damping=\"1\"/><geom size=\"0.1 0.2 0.3\"/><default class=\"a\"><default class=\"b\"><joint axis=\"0 1 0\"/></default>"
      "<joint armature=\"2\"/></default></default>";
  const Model model = read("<body childclass=\"a\"><joint name=\"1\"/>" + mass + "<body><joint name=\"2\" class=\"b\"/>" + mass +
                               "<body childclass=\"main\"><joint name=\"3\"/>" + mass + "</body><body><joint name=\"4\" damping=\"5\"/>" + mass +
                               "</body></body></body>",
                           classes);
  CHECK(jointOf(model, "1").damping == std::vector<double>{1});
  CHECK(jointOf(model, "1").armature == std::vector<double>{2});
  // A class's own values come before the classes in it, wherever they stand in the file.
  CHECK(jointOf(model, "2").armature == std::vector<double>{2});
  CHECK(std::get<std::vector<double>>(jointOf(model, "2").parameters.at("axis")) == std::vector<double>{0, 1, 0});
  CHECK(jointOf(model, "3").armature.empty());
  CHECK(jointOf(model, "4").damping == std::vector<double>{5});
  CHECK_THROWS_WITH(read("<body childclass=\"legs\"/>", "<default><default class=\"leg\"/></default>"), containing("'legs'") && containing("'leg'"));
  CHECK_THROWS_WITH(read("<body><joint class=\"x\"/></body>"), containing("'x'"));
}

TEST_CASE("a geom replaces only the first sizes of its class", "[mjcf]") {
  const Model model = read("<geom name=\"g\" type=\"box\" size=\"1\"/>", "<default><geom size=\"0.1 0.2 0.3\"/></default>");
  const auto& box = std::get<geometry::Box>(model.geometries[0].shape);
  CHECK(box.size.x == 2);
  CHECK(box.size.y == 0.4);
  CHECK(box.size.z == 0.6);
}

TEST_CASE("geoms give mass and inertia to a body without an inertial", "[mjcf]") {
  const auto inertia = [](const std::string& inside, const std::string& before = "") {
    return bodyOf(read("<body name=\"b\"><freejoint/>" + inside + "</body>", before), "b").inertia;
  };
  const Inertia<double> ball = inertia("<geom size=\"0.1\" pos=\"1 2 3\"/>");
  CHECK(ball.mass == approx(1000 * 4 * pi / 3 * 1e-3));
  CHECK(ball.com.y == 2);
  CHECK(ball.rotational.xx == approx(ball.mass * 0.4 * 0.01));
  CHECK(inertia("<geom size=\"0.1\" mass=\"3\" density=\"7\"/>").mass == approx(3));
  CHECK(inertia("<geom size=\"0.1\" mass=\"3\"/><geom size=\"0.1\" mass=\"1\" pos=\"4 0 0\"/>").com.x == approx(1));
  const Inertia<double> rod = inertia("<geom type=\"cylinder\" fromto=\"0 0 0 2 0 0\" size=\"1e-5\" mass=\"12\"/>");
  CHECK(rod.com.x == approx(1));
  CHECK(rod.rotational.yy == approx(4));
  CHECK(inertia("<geom type=\"box\" size=\"1 1 1\" shellinertia=\"true\" mass=\"6\"/>").rotational.xx == approx(6 * 10 / 9.0));
  const std::string both = "<inertial pos=\"0 0 1\" mass=\"9\" diaginertia=\"1 2 2.5\"/><geom size=\"0.1\" mass=\"3\"/>";
  CHECK(inertia(both).mass == 9);
  CHECK(inertia(both, "<compiler inertiafromgeom=\"true\"/>").mass == approx(3));
  CHECK(inertia("<geom size=\"0.1\"/>", "<compiler inertiafromgeom=\"false\"/>").mass == 0);
  CHECK(inertia("<geom size=\"0.1\" mass=\"3\"/><geom size=\"0.1\" mass=\"5\" group=\"4\"/>", "<compiler inertiagrouprange=\"0 3\"/>").mass ==
        approx(3));
  const std::string flat = "<inertial pos=\"0 0 0\" mass=\"0.5\" diaginertia=\"1 1 7\"/>";
  CHECK(inertia(flat, "<compiler balanceinertia=\"true\"/>").rotational.xx == approx(3));
  CHECK(inertia(flat, "<compiler boundmass=\"2\" boundinertia=\"4\"/>").rotational.yy == approx(4));
  CHECK(inertia(flat, "<compiler boundmass=\"2\" boundinertia=\"4\"/>").mass == 2);
  CHECK(noted(read("<body>" + flat + "</body>"), "triangle inequality"));
  CHECK(inertia("<inertial pos=\"0 0 0\" mass=\"1\" fullinertia=\"1 2 3 0.1 0.2 0.3\"/>").rotational.yz == approx(0.3));
  CHECK(inertia("<inertial pos=\"0 0 0\" mass=\"1\" fullinertia=\"1 2 3 0.1 0.2 0.3\"/>").rotational.xz == approx(0.2));
  double total = 0;
  for (const BodyDescription& b :
       read("<body><freejoint/>" + mass + "</body><body><freejoint/>" + flat + "</body>", "<compiler settotalmass=\"10\"/>").bodies)
    total += b.inertia.mass;
  CHECK(total == approx(10));
}

TEST_CASE("a hollow geom is the difference of two solids, per thickness", "[mjcf]") {
  const auto inertia = [](const std::string& geom) { return read("<body><freejoint/><geom " + geom + "/></body>").bodies[1].inertia; };
  const double e = 1e-4;
  const auto sizes = [](std::initializer_list<double> x) {
    std::string out = " size=\"";
    for (const double s : x) out += std::to_string(s) + " ";
    return out + "\"";
  };
  // A capsule grows by its radius alone: its ends grow with it.
  const std::array<std::array<std::string, 4>, 4> shapes{
      {{"sphere", sizes({0.3}), sizes({0.3 + e}), sizes({0.3 - e})},
       {"capsule", sizes({0.3, 0.4}), sizes({0.3 + e, 0.4}), sizes({0.3 - e, 0.4})},
       {"cylinder", sizes({0.3, 0.4}), sizes({0.3 + e, 0.4 + e}), sizes({0.3 - e, 0.4 - e})},
       {"box", sizes({0.3, 0.4, 0.5}), sizes({0.3 + e, 0.4 + e, 0.5 + e}), sizes({0.3 - e, 0.4 - e, 0.5 - e})}}};
  for (const auto& [type, size, larger, smaller] : shapes) {
    INFO(type);
    const std::string solid = "type=\"" + type + "\"";
    const Inertia<double> shell = inertia(solid + size + " shellinertia=\"true\""), a = inertia(solid + larger), b = inertia(solid + smaller);
    CHECK(shell.mass == approx((a.mass - b.mass) / (2 * e)).epsilon(1e-6));
    CHECK(shell.rotational.xx == approx((a.rotational.xx - b.rotational.xx) / (2 * e)).epsilon(1e-6));
    CHECK(shell.rotational.zz == approx((a.rotational.zz - b.rotational.zz) / (2 * e)).epsilon(1e-6));
  }
}

TEST_CASE("a frame and a replica are the bodies that they stand for", "[mjcf]") {
  const std::string arm = "<joint axis=\"0 1 0\"/>" + mass;
  const Model framed = read(
      "<frame pos=\"1 0 0\" euler=\"0 0 90\"><body name=\"a\" pos=\"1 0 0\"><frame pos=\"0 0 1\"><joint name=\"j\" pos=\"0 0 1\" axis=\"1 0 0\"/>"
      "</frame>" +
      mass + "</body></frame>");
  const BodyDescription& a = bodyOf(framed, "a");
  CHECK(a.joint.placement.p.z == -2);
  const JointDescription& j = jointOf(framed, "j");
  CHECK(away(j.placement, about(2, pi / 2)) < 1e-15);
  CHECK((toEigen(j.placement.p) - Eigen::Vector3d(1, 1, 2)).norm() < 1e-15);

  const Model copies = read("<replicate count=\"12\" offset=\"1 0 0\" euler=\"0 0 90\" sep=\"-\"><body name=\"b\">" + arm + "</body></replicate>");
  CHECK(copies.findBody("b-00") > 0);
  CHECK(copies.findBody("b-11") > 0);
  CHECK((toEigen(bodyOf(copies, "b-01").joint.placement.p) - Eigen::Vector3d(1, 0, 0)).norm() < 1e-15);
  CHECK((toEigen(bodyOf(copies, "b-02").joint.placement.p) - Eigen::Vector3d(1, 1, 0)).norm() < 1e-15);
  CHECK(away(bodyOf(copies, "b-03").joint.placement, about(2, 3 * pi / 2)) < 1e-15);
  CHECK(copies.bodies.size() == 13);
  // Replicas of geoms belong to one body.
  CHECK(read("<body><freejoint/><replicate count=\"3\" offset=\"0 0 1\"><geom size=\"0.1\" mass=\"2\"/></replicate></body>").bodies[1].inertia.mass ==
        approx(6));
}

TEST_CASE("sites become frames and geoms become volumes", "[mjcf]") {
  const Model model = read(
      "<geom name=\"floor\" type=\"plane\" size=\"1 1 1\"/><body name=\"b\"><freejoint/><site name=\"tip\" pos=\"0 0 1\"/><site name=\"b\"/><site/>"
      "<geom type=\"capsule\" size=\"0.1 0.5\"/><geom type=\"ellipsoid\" size=\"1 2 3\"/>"
      "<geom type=\"box\" size=\"1 1 1\" contype=\"0\" conaffinity=\"0\"/></body>");
  REQUIRE(model.frames.size() == 3);
  CHECK(model.frames[0].name == "tip");
  CHECK(model.frames[0].placement.p.z == 1);
  // A frame and a body cannot share a name.
  CHECK(model.frames[1].name == "b_");
  CHECK(model.frames[2].name == "b_site_0");
  REQUIRE(model.geometries.size() == 3);
  CHECK(model.geometries[0].name == "floor");
  CHECK(std::holds_alternative<geometry::HalfSpace>(model.geometries[0].shape));
  CHECK(std::get<geometry::Capsule>(model.geometries[1].shape).length == 1);
  CHECK(model.geometries[1].name == "b_0");
  CHECK(model.geometries[2].role == GeometryDescription::Role::visual);
  CHECK(noted(model, "ellipsoid"));
}

TEST_CASE("contype, conaffinity, pairs and excludes decide which volumes collide", "[mjcf]") {
  const std::string bodies =
      "<body name=\"a\"><freejoint/><geom name=\"1\" size=\"1\" contype=\"1\" conaffinity=\"0\"/></body>"
      "<body name=\"b\"><freejoint/><geom name=\"2\" size=\"1\" contype=\"1\" conaffinity=\"0\"/></body>"
      "<body name=\"c\"><freejoint/><geom name=\"3\" size=\"1\"/></body>";
  const Model model = read(bodies, "<contact><exclude body1=\"a\" body2=\"c\"/></contact>");
  REQUIRE(model.disabled_collisions.size() == 2);
  CHECK(model.disabled_collisions[0].body == "a");
  CHECK(model.disabled_collisions[1].body == "1");
  CHECK(model.disabled_collisions[1].other == "2");
  CHECK(read(bodies, "<contact><pair geom1=\"2\" geom2=\"1\"/></contact>").disabled_collisions.empty());
  CHECK_THROWS_WITH(read(bodies, "<contact><exclude body1=\"a\" body2=\"d\"/></contact>"), containing("'d'") && containing("does not exist"));
}

TEST_CASE("equalities become constraints of the mechanism", "[mjcf]") {
  const std::string bodies = "<body name=\"a\" pos=\"1 0 0\"><joint name=\"i\" ref=\"90\"/>" + mass +
                             "</body><body name=\"b\" pos=\"0 2 0\"><joint name=\"j\" type=\"slide\" ref=\"3\"/>" + mass + "</body>";
  const Model model = read(bodies,
                           "<equality><connect body1=\"a\" body2=\"b\" anchor=\"0 0 1\"/><weld name=\"w\" body1=\"a\"/>"
                           "<joint joint1=\"j\" joint2=\"i\" polycoef=\"0.5 2 3 0 0\" solref=\"-9 -6\"/><joint joint1=\"i\" polycoef=\"1\"/>"
                           "<joint joint1=\"i\" active=\"false\"/></equality>");
  REQUIRE(model.constraints.size() == 4);
  const auto& connect = std::get<FrameConstraint>(model.constraints[0].relation);
  CHECK(connect.frame == "a");
  CHECK(connect.free == std::array<bool, 6>{false, false, false, true, true, true});
  CHECK((toEigen(connect.other_placement.p) - Eigen::Vector3d(1, -2, 1)).norm() < 1e-15);
  // MuJoCo's usual solref, 0.02 s and a damping ratio of 1.
  CHECK(model.constraints[0].baumgarte.position == approx(2500));
  CHECK(model.constraints[0].baumgarte.velocity == approx(100));
  const auto& weld = std::get<FrameConstraint>(model.constraints[1].relation);
  CHECK(model.constraints[1].name == "w");
  CHECK(weld.other == "universe");
  CHECK(weld.placement.p.x == -1);
  const auto& couple = std::get<JointCoupling>(model.constraints[2].relation);
  CHECK(couple.joint == "j");
  CHECK(couple.coupling.master == "i");
  const auto& c = std::get<std::vector<double>>(couple.coupling.parameters.at("coefficients"));
  for (const double x : {-0.7, 0.4, 2.0}) {
    const double y = c[0] + c[1] * x + c[2] * x * x, d = x - pi / 2;
    CHECK(y == approx(3 + 0.5 + 2 * d + 3 * d * d));
  }
  CHECK(model.constraints[2].baumgarte.position == 9);
  CHECK(model.constraints[2].baumgarte.velocity == 6);
  CHECK(std::get<JointLock>(model.constraints[3].relation).configuration[0] == approx(pi / 2 + 1));
  CHECK(noted(model, "not active"));
  CHECK_NOTHROW(ConstraintSet(compile(model, registry())));
}

TEST_CASE("equalities of fixed tendons of one or two joints couple these", "[mjcf]") {
  const std::string bodies =
      "<body><joint name=\"i\" type=\"slide\" ref=\"1\"/>" + mass + "</body><body><joint name=\"j\" type=\"slide\" ref=\"3\"/>" + mass + "</body>";
  const std::string tendons =
      "<tendon><fixed name=\"a\"><joint joint=\"i\" coef=\"2\"/></fixed><fixed name=\"b\"><joint joint=\"j\" coef=\"-4\"/></fixed>"
      "<fixed name=\"c\"><joint joint=\"i\"/><joint joint=\"j\" coef=\"5\"/></fixed><fixed name=\"d\"/></tendon>";
  const Model model = read(bodies, tendons +
                                       "<equality><tendon tendon1=\"a\" tendon2=\"b\" polycoef=\"1 2 3 0 0\"/><tendon tendon1=\"c\"/>"
                                       "<tendon tendon1=\"b\" polycoef=\"8\"/></equality>");
  REQUIRE(model.constraints.size() == 3);
  const auto i = [&](std::size_t k, double x) {
    const auto& c = std::get<std::vector<double>>(std::get<JointCoupling>(model.constraints[k].relation).coupling.parameters.at("coefficients"));
    return c[0] + c[1] * x + (c.size() > 2 ? c[2] * x * x : 0);
  };
  for (const double x : {-1.0, 3.0, 7.0}) {
    const double s = -4 * (x - 3);
    CHECK(2 * (i(0, x) - 1) == approx(1 + 2 * s + 3 * s * s));
    CHECK((i(1, x) - 1) + 5 * (x - 3) == approx(0).margin(1e-14));
  }
  CHECK(std::get<JointLock>(model.constraints[2].relation).configuration[0] == 1);
  CHECK(noted(model, "<fixed> in <tendon>, 1 time"));
}

TEST_CASE("keyframes become named configurations, with quaternions as libdyn has them", "[mjcf]") {
  const std::string bodies = "<body name=\"a\" pos=\"1 2 3\" quat=\"0 0 0 1\"><freejoint name=\"f\"/>" + mass +
                             "<body><joint name=\"b\" type=\"ball\"/>" + mass + "<body><joint name=\"h\" ref=\"90\"/>" + mass +
                             "</body></body></body>";
  const Model model =
      read(bodies, "<keyframe><key name=\"up\" qpos=\"0 0 1 2 0 0 2 1 0 0 0 0.5\" qvel=\"1 0 0 0 0 0 0 0 0 7\"/><key time=\"1\"/></keyframe>");
  REQUIRE(model.configurations.size() == 3);
  const auto& home = model.configurations[0];
  CHECK(home.name == "qpos0");
  CHECK(home.joints[0].q == std::vector<double>{1, 2, 3, 0, 0, 1, 0});
  CHECK(home.joints[2].q[0] == approx(pi / 2));
  const auto& up = model.configurations[1];
  CHECK(up.name == "up");
  CHECK(up.joints[0].joint == "f");
  CHECK(up.joints[0].q[5] == approx(std::sqrt(0.5)));
  CHECK(up.joints[0].q[6] == approx(std::sqrt(0.5)));
  // The base is turned by a quarter about z, so that x of the world is -y of the body.
  CHECK(up.joints[0].v[1] == approx(-1));
  CHECK(up.joints[1].q == std::vector<double>{0, 0, 0, 1});
  CHECK(up.joints[2].q == std::vector<double>{0.5});
  CHECK(up.joints[2].v == std::vector<double>{7});
  CHECK(model.configurations[2].name == "key_1");
  CHECK(noted(model, "attribute time of <key>"));
  CHECK(read("<body><joint/>" + mass + "</body>").configurations.empty());
  CHECK_THROWS_WITH(read(bodies, "<keyframe><key qpos=\"1 2\"/></keyframe>"), containing("must have 12 numbers"));
  CHECK_THROWS_WITH(read(bodies, "<keyframe><key name=\"k\"/><key name=\"k\"/></keyframe>"), containing("two keyframes"));
}

TEST_CASE("meshes give mass, and volumes keep their file", "[mjcf]") {
  const Folder folder;
  // A cube of side 2 with one corner at the origin, and one triangle of it as STL.
  std::string cube;
  for (int i = 0; i < 8; ++i) cube += "v " + std::to_string(2 * (i & 1)) + " " + std::to_string(i & 2) + " " + std::to_string((i & 4) / 2) + "\n";
  cube += "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
  folder.write("assets/cube.obj", cube);
  const auto load = [&](const std::string& mesh, const std::string& geom = "", const std::string& compiler = "") {
    return mjcf::load(
        folder.write("robot.xml", mujoco("<body name=\"b\"><freejoint/><geom type=\"mesh\" mesh=\"cube\" " + geom + "/></body>",
                                         "<compiler meshdir=\"assets\" " + compiler + "/><asset><mesh file=\"cube.obj\" " + mesh + "/></asset>")));
  };
  for (const char* how : {"legacy", "exact"}) {
    const Model model = load(std::string("inertia=\"") + how + "\"", "density=\"2\" pos=\"0 0 5\"");
    const Inertia<double> Y = model.bodies[1].inertia;
    CHECK(Y.mass == approx(16));
    CHECK(Y.com.z == approx(6));
    CHECK(Y.rotational.xx == approx(16 * 8 / 12.0));
    CHECK(std::get<geometry::MeshFile>(model.geometries[0].shape).uri == "assets/cube.obj");
    CHECK(std::get<geometry::MeshFile>(model.geometries[0].shape).convex);
  }
  CHECK(load("inertia=\"shell\"", "mass=\"6\"").bodies[1].inertia.rotational.xx == approx(6 * 10 / 9.0));
  CHECK(load("scale=\"-1 0.5 3\"").bodies[1].inertia.mass == approx(12000));
  CHECK(load("scale=\"-1 0.5 3\" inertia=\"exact\"").bodies[1].inertia.com.x == approx(-1));
  const Model moved = load("refpos=\"1 1 1\" refquat=\"1 0 0 1\" scale=\"2 2 2\"");
  CHECK(toEigen(moved.bodies[1].inertia.com).norm() < 1e-12);
  CHECK((toEigen(moved.geometries[0].placement.p) - Eigen::Vector3d(-2, 2, -2)).norm() < 1e-14);
  CHECK_THROWS_WITH(load("inertia=\"convex\""), containing("convex hull") && containing("<inertial>"));
  CHECK_THROWS_WITH(load("name=\"other\""), containing("no mesh 'cube'"));
  CHECK(load("", "", "assetdir=\"x\" strippath=\"true\" discardvisual=\"true\"").geometries.size() == 1);
  CHECK(load("", "contype=\"0\" conaffinity=\"0\"", "discardvisual=\"true\"").geometries.empty());
  folder.write("assets/cube.obj", "v 0 0 0\nf 1 2 3\n");
  CHECK_THROWS_WITH(load(""), containing("cube.obj:2") && containing("vertex that does not come before"));
  const Model written = read("<body><freejoint/><geom type=\"mesh\" mesh=\"t\"/></body>",
                             "<asset><mesh name=\"t\" vertex=\"0 0 0 1 0 0 0 1 0 0 0 1\" face=\"0 2 1 0 1 3 0 3 2 1 2 3\"/></asset>");
  CHECK(written.bodies[1].inertia.mass == approx(1000 / 6.0));
  CHECK(std::get<geometry::ConvexHull>(written.geometries[0].shape).points.size() == 4);
}

TEST_CASE("an STL gives the mass of its triangles", "[mjcf]") {
  const Folder folder;
  std::string stl(80, ' ');
  const float corners[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const int faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  stl += std::string("\4\0\0\0", 4);
  for (const auto& face : faces) {
    stl += std::string(12, '\0');
    for (const int corner : face) stl.append(reinterpret_cast<const char*>(corners[corner]), 12);
    stl += std::string(2, '\0');
  }
  const std::string model = mujoco("<body><freejoint/><geom type=\"mesh\" mesh=\"t\"/></body>", "<asset><mesh file=\"t.STL\"/></asset>");
  folder.write("t.STL", stl);
  CHECK(mjcf::load(folder.write("robot.xml", model)).bodies[1].inertia.mass == approx(1000 / 6.0));
  folder.write("t.STL", stl.substr(0, 200));
  CHECK_THROWS_WITH(mjcf::load((folder.path / "robot.xml").string()), containing("t.STL") && containing("cut off"));
  folder.write("t.STL", "solid t\nendsolid t\n" + std::string(100, ' '));
  CHECK_THROWS_WITH(mjcf::load((folder.path / "robot.xml").string()), containing("STL of text"));
}

TEST_CASE("included files take the place of include, and classes and settings in them hold everywhere", "[mjcf]") {
  const Folder folder;
  folder.write("parts/arm.xml",
               "<mujocoinclude><body name=\"arm\"><joint name=\"j\" axis=\"0 1 0\" range=\"-1 1\"/><geom size=\"0.1\"/><include "
               "file=\"hand.xml\"/></body></mujocoinclude>");
  folder.write("parts/hand.xml", "<mujoco><site name=\"hand\" pos=\"0 0 1\"/></mujoco>");
  folder.write("settings.xml", "<mujoco><compiler angle=\"radian\"/><default><joint damping=\"3\"/></default></mujoco>");
  const Model model = mjcf::load(folder.write("robot.xml", mujoco("<include file=\"parts/arm.xml\"/>", "<include file=\"settings.xml\"/>")));
  CHECK(jointOf(model, "j").limits.upper[0] == 1);
  CHECK(jointOf(model, "j").damping == std::vector<double>{3});
  CHECK(model.frames.at(0).name == "hand");
  CHECK(jointOf(model, "j").where.file == (folder.path / "parts/arm.xml").string());
}

TEST_CASE("gravity is an option, and a flag switches it off", "[mjcf]") {
  CHECK(read("").gravity.z == -9.81);
  CHECK(read("", "<option gravity=\"1 2 3\"/>").gravity.y == 2);
  CHECK(read("", "<option gravity=\"1 2 3\"><flag gravity=\"disable\"/></option>").gravity.y == 0);
}

TEST_CASE("what the reader does not represent is noted, each kind once", "[mjcf]") {
  const Model model = read(
      "<body gravcomp=\"1\"><joint name=\"j\" stiffness=\"2\"/><geom size=\"1\" friction=\"1 0 0\" rgba=\"1 0 0 1\"/>"
      "<geom size=\"1\" friction=\"1 0 0\"/><light/></body>",
      "<option timestep=\"0.1\"/><visual><map/></visual><actuator><motor joint=\"j\"/><motor joint=\"j\"/></actuator>"
      "<sensor><jointpos joint=\"j\"/></sensor><tendon><fixed/></tendon><deformable/>");
  const auto& notes = model.notes;
  for (const char* what :
       {"attribute gravcomp of <body>, 1 time, first at line 3", "attribute stiffness of <joint>, 1 time", "attribute friction of <geom>, 2 times",
        "attribute timestep of <option>", "<motor> in <actuator>, 2 times, first at line 2", "<jointpos> in <sensor>", "<fixed> in <tendon>",
        "<deformable> in <mujoco>"})
    CHECK(noted(model, what));
  for (const char* silent : {"rgba", "light", "visual", "map"}) CHECK_FALSE(noted(model, silent));
  CHECK(std::count_if(notes.begin(), notes.end(), [](const std::string& n) { return n.find("friction") != std::string::npos; }) == 1);
}

TEST_CASE("the root joint goes to the only body of the world", "[mjcf]") {
  const auto root = [](const std::string& world) { return mjcf::parse(mujoco(world), "robot.xml", {.root = "free_flyer"}); };
  CHECK(root("<body pos=\"0 0 1\">" + mass + "</body>").bodies[1].joint.type == "free_flyer");
  CHECK_THROWS_WITH(root("<body><joint/></body>"), containing("its own joint"));
  CHECK_THROWS_WITH(root("<body/><body/>"), containing("several bodies"));
}

TEST_CASE("load() knows MJCF by its ending or its root element", "[mjcf]") {
  const Folder folder;
  const std::string text = mujoco("<body name=\"b\"/>");
  CHECK(load(folder.write("a.mjcf", text)).bodies.size() == 2);
  CHECK(load(folder.write("a.xml", "<?xml version=\"1.0\"?>\n<!-- <robot> -->\n" + text)).bodies.size() == 2);
  CHECK(load(folder.write("b.xml", "<robot name=\"r\"><link name=\"a\"/></robot>")).bodies.size() == 2);
  CHECK(load(folder.write("c.txt", text), {}, "mjcf").bodies.size() == 2);
  CHECK(check(folder.write("d.xml", mujoco("<body><joint type=\"x\"/></body><geom type=\"y\"/>"))).size() == 2);
}
