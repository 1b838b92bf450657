// SPDX-License-Identifier: BSD-2-Clause
// Frames, volumes, equalities, keyframes, meshes and other files of MJCF.
#include "parsers/mjcf_texts.hpp"
#include "support/difference.hpp"
#include "support/folder.hpp"
#include "support/registry.hpp"

#include <dyn/dyn.hpp>
#include <dyn/lie/so3.hpp>
#include <dyn/parsers/load.hpp>

using namespace dyn;
using namespace dyn::test;

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

TEST_CASE("a body with several joints does not collide with the body that carries it, unless that is fixed to the world", "[mjcf]") {
  const std::string geom = "<geom size=\"1\"/>", joints = "<joint name=\"i\"/><joint name=\"j\" axis=\"0 1 0\"/>";
  const std::string arm = "<body name=\"a\">" + joints + geom + "</body>", fixed = "<body name=\"f\">" + geom + "</body>";
  CHECK(read("<body name=\"base\">" + geom + arm + "</body>").disabled_collisions.empty());
  const Model model = read("<body name=\"base\"><freejoint/>" + geom + arm + fixed + "</body>");
  REQUIRE(model.disabled_collisions.size() == 2);
  CHECK(model.disabled_collisions[0].body == "base");
  CHECK(model.disabled_collisions[0].other == "a");
  CHECK(model.disabled_collisions[1].body == "f");
  const std::string exclude = "<contact><exclude body1=\"a\" body2=\"base\"/></contact>";
  CHECK(read("<body name=\"base\"><freejoint/>" + geom + arm + "</body>", exclude).disabled_collisions.size() == 1);
}

TEST_CASE("a pair of geoms that libdyn cannot check is noted", "[mjcf]") {
  const auto with = [](const std::string& contact) {
    return noted(read("<body name=\"a\"><freejoint/><geom name=\"1\" size=\"1\"/><body name=\"b\"><joint/><geom name=\"2\" size=\"1\"/>"
                      "<body name=\"c\"><joint/><geom name=\"3\" size=\"1\"/></body></body></body>",
                      "<contact>" + contact + "</contact>"),
                 "a <pair> of geoms whose bodies are excluded, or neighbours");
  };
  CHECK(with("<pair geom1=\"1\" geom2=\"2\"/>"));
  CHECK(!with("<pair geom1=\"1\" geom2=\"3\"/>"));
  CHECK(with("<pair geom1=\"1\" geom2=\"3\"/><exclude body1=\"a\" body2=\"c\"/>"));
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

TEST_CASE("actuators, tendons and sensors are kept, completed by their default classes", "[mjcf]") {
  const Model model =
      read("<body><joint name=\"j\"/>" + mass + "</body>",
           "<default><motor gear=\"3\"/><tendon width=\"0.1\"/><default class=\"weak\"><motor ctrlrange=\"-1 1\"/></default></default>"
           "<actuator><motor name=\"m\" joint=\"j\"/><motor class=\"weak\" joint=\"j\" gear=\"5\"/></actuator>"
           "<sensor><jointpos name=\"s\" joint=\"j\"/></sensor><tendon><fixed name=\"t\"><joint joint=\"j\" coef=\"2\"/></fixed></tendon>");
  using Kind = DeviceDescription::Kind;
  std::vector<std::string> texts;
  for (const DeviceDescription& device : model.devices) texts.push_back(device.text);
  CHECK(texts == std::vector<std::string>{R"(<motor name="m" joint="j" gear="3"/>)", R"(<motor joint="j" gear="5" ctrlrange="-1 1"/>)",
                                          R"(<fixed name="t" width="0.1"><joint joint="j" coef="2"/></fixed>)", R"(<jointpos name="s" joint="j"/>)"});
  REQUIRE(model.devices.size() == 4);
  CHECK((model.devices[0].kind == Kind::actuator && model.devices[2].kind == Kind::tendon && model.devices[3].kind == Kind::sensor));
  CHECK((model.devices[0].name == "m" && model.devices[1].name.empty() && model.devices[3].type == "jointpos" && model.devices[0].where.line == 2));
  CHECK_FALSE(noted(model, "<motor> in <default>"));
  CHECK_THROWS_WITH(read("<body><joint name=\"j\"/>" + mass + "</body>", "<actuator><motor class=\"strong\" joint=\"j\"/></actuator>"),
                    containing("'strong'"));
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
