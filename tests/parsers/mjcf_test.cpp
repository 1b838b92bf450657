// SPDX-License-Identifier: BSD-2-Clause
// Bodies, joints and masses of MJCF, and the traps that readers of MJCF fall into.
#include "parsers/mjcf_texts.hpp"
#include "support/difference.hpp"
#include "support/folder.hpp"
#include "support/registry.hpp"

#include <dyn/dyn.hpp>
#include <dyn/lie/so3.hpp>
#include <dyn/parsers/load.hpp>

using namespace dyn;
using namespace dyn::test;

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
