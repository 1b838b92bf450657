// SPDX-License-Identifier: BSD-2-Clause
// Broken files give an Error that says what is wrong and where, within seconds and bounded memory. Long chains do not exhaust the stack.
#include "support/folder.hpp"
#include "support/skip.hpp"

#include <dyn/dyn.hpp>
#include <dyn/parsers/urdf.hpp>

#include <clocale>
#include <filesystem>
#include <fstream>
#include <sstream>

using namespace dyn;
using namespace dyn::test;

namespace {

std::string robot(const std::string& body) { return "<?xml version=\"1.0\"?>\n<robot name=\"r\">\n" + body + "</robot>\n"; }
std::string linkText(const std::string& name, const std::string& mass = "1", const std::string& inertia = "1") {
  return "<link name=\"" + name + "\"><inertial><mass value=\"" + mass + "\"/><inertia ixx=\"" + inertia + "\" ixy=\"0\" ixz=\"0\" iyy=\"" + inertia +
         "\" iyz=\"0\" izz=\"" + inertia + "\"/></inertial></link>\n";
}
std::string jointText(const std::string& name, const std::string& parent, const std::string& child, const std::string& type = "revolute",
                      const std::string& inside = "<limit lower=\"-1\" upper=\"1\" effort=\"1\" velocity=\"1\"/>") {
  return "<joint name=\"" + name + "\" type=\"" + type + "\"><parent link=\"" + parent + "\"/><child link=\"" + child +
         "\"/><origin xyz=\"0 0 0.1\"/><axis xyz=\"0 1 0\"/>" + inside + "</joint>\n";
}

CompactModel read(const std::string& text, const urdf::Options& options = {}) {
  return compile(urdf::parse(text, "robot.urdf", options), JointRegistry::standard());
}

}  // namespace

TEST_CASE("a broken file is refused with what is wrong and where", "[fault]") {
  CHECK_THROWS_WITH(urdf::load("/nowhere/robot.urdf"), containing("/nowhere/robot.urdf") && containing("does not exist"));
  CHECK_THROWS_WITH(urdf::load("/tmp"), containing("folder"));
  CHECK_THROWS_WITH(read(""), containing("empty"));
  CHECK_THROWS_WITH(read("<robot name=\"r\"><link name=\"a\">"), containing("robot.urdf:"));
  CHECK_THROWS_WITH(read("this is no XML"), containing("robot.urdf"));
  CHECK_THROWS_WITH(read("<mujoco/>"), containing("another format"));
  CHECK_THROWS_WITH(read("<!DOCTYPE robot [<!ENTITY a \"b\">]><robot/>"), containing("document type"));
  CHECK_THROWS_WITH(read(robot("")), containing("no <link>"));
  CHECK_THROWS_WITH(read(robot(linkText("a") + linkText("b") + jointText("j", "a", "b") + jointText("k", "b", "a"))), containing("circle"));
  CHECK_THROWS_WITH(read(robot(linkText("a") + linkText("b"))), containing("'a'") && containing("'b'") && containing("one root"));
  CHECK_THROWS_WITH(read(robot(linkText("a") + linkText("a"))), containing("two links are called 'a'") && containing(":4:"));
  CHECK_THROWS_WITH(read(robot(linkText("a") + linkText("b") + jointText("j", "a", "b", "hinge"))),
                    containing("unknown type 'hinge'") && containing(":5"));
  CHECK_THROWS_WITH(read(robot(linkText("a", "nan"))), containing("nan") && containing(":3"));
  CHECK_THROWS_WITH(read(robot(linkText("a", "-1"))), containing("negative"));
  CHECK_THROWS_WITH(read(robot(linkText("a") + linkText("b") + jointText("j", "a", "b", "revolute", "<mimic joint=\"j\"/>"))),
                    containing("mimics itself"));
  CHECK_THROWS_WITH(read(robot(linkText("a", "+-0.5"))), containing("'+-0.5'") && containing(":3"));
  CHECK(urdf::parse(robot(linkText("a", "+0.5")), "robot.urdf").bodies[1].inertia.mass == 0.5);
  urdf::Options options;
  options.root = "no_such_joint";
  CHECK_THROWS_WITH(read(robot(linkText("a")), options), containing("no_such_joint") && containing("searched") && containing("DYN_PLUGIN_PATH"));
}

TEST_CASE("names that libdyn gives are reserved, or given up to the file", "[fault]") {
  CHECK_THROWS_WITH(read(robot(linkText("a") + linkText("universe") + jointText("j", "a", "universe"))),
                    containing("link is called 'universe'") && containing("reserved") && containing("robot.urdf:4"));
  CHECK_THROWS_WITH(read(robot(linkText("a") + linkText("b") + jointText("universe", "a", "b"))),
                    containing("joint is called 'universe'") && containing("robot.urdf:5"));
  const std::string own = robot(linkText("a") + linkText("b") + jointText("root_joint", "a", "b"));
  const Model model = urdf::parse(own, "robot.urdf");
  CHECK(model.bodies[1].joint.name == "root_joint_");
  CHECK(model.bodies[2].joint.name == "root_joint");
  REQUIRE(model.notes.size() == 1);
  CHECK_THAT(model.notes[0], containing("root_joint_"));
  CHECK(read(own).nv() == 1);
}

TEST_CASE("text that is no UTF-8 is refused with its line", "[fault]") {
  // Latin-1, bytes that begin no character, truncated characters, overlong forms, a surrogate, and a code point beyond U+10FFFF.
  for (const char* bytes : {"\xe9", "\x80", "\xff", "\xe2\x82", "\xc0\xaf", "\xe0\x80\xaf", "\xed\xa0\x80", "\xf4\x90\x80\x80", "\xf0\x9f\x98"}) {
    CHECK_THROWS_WITH(read(robot(linkText("a") + "<!-- " + bytes + " -->\n")), containing("robot.urdf:4") && containing("UTF-8"));
    CHECK_THROWS_WITH(read(robot(linkText("a") + "<!-- -->") + bytes), containing("robot.urdf:5") && containing("UTF-8"));
  }
  for (const char* reference : {"&#0;", "&#xD800;", "&#x110000;", "&#99999999999999999999;"})
    CHECK_THROWS_WITH(read(robot(linkText(reference))), containing("robot.urdf:3") && containing(reference));
  for (const char* name : {"\xc3\xa9", "\xe2\x82\xac", "\xed\x9f\xbf", "\xf0\x9f\x98\x80", "\xf4\x8f\xbf\xbf", "&#233;", "&#x1F600;"})
    CHECK_NOTHROW(read(robot(linkText(name))));
}

TEST_CASE("noise of 100 MB and elements nested 10^5 deep are refused", "[fault]") {
  const std::string path = (std::filesystem::temp_directory_path() / "libdyn_noise.urdf").string();
  {
    std::ofstream file(path, std::ios::binary);
    const std::string block(1 << 20, '\x5a');
    for (int i = 0; i < 100; ++i) file << block;
  }
  CHECK_THROWS_WITH(urdf::load(path), containing("64 MB"));
  std::filesystem::remove(path);
  std::string deep = "<robot name=\"r\">";
  for (int i = 0; i < 100000; ++i) deep += "<a>";
  CHECK_THROWS_WITH(read(deep), containing("deep"));
}

TEST_CASE("a chain of 50,000 links loads and computes", "[fault]") {
  std::string text = linkText("l0");
  for (int i = 1; i <= 50000; ++i)
    text += linkText("l" + std::to_string(i)) + jointText("j" + std::to_string(i), "l" + std::to_string(i - 1), "l" + std::to_string(i));
  const CompactModel model = read(robot(text));
  REQUIRE(model.nv() == 50000);
  Data data(model);
  const Eigen::VectorXd q = Eigen::VectorXd::Constant(model.nv(), 1e-5), v = Eigen::VectorXd::Zero(model.nv());
  const Eigen::VectorXd tau = rnea(model, data, q, v, v);
  CHECK(std::isfinite(tau.norm()));
  CHECK(std::isfinite(aba(model, data, q, v, tau).norm()));
}

TEST_CASE("100,000 nested fixed joints are welded into one body", "[fault]") {
  std::string text = linkText("l0");
  for (int i = 1; i <= 100000; ++i)
    text += linkText("l" + std::to_string(i)) + jointText("j" + std::to_string(i), "l" + std::to_string(i - 1), "l" + std::to_string(i), "fixed");
  urdf::Options options;
  options.root = "free_flyer";
  const CompactModel model = read(robot(text), options);
  CHECK(model.nq() == 7);
  CHECK(model.mass() == 100001);
}

TEST_CASE("a chain of 30000 mimics is followed once", "[fault]") {
  constexpr int n = 30000;
  std::string text = linkText("base");
  for (int i = 0; i < n; ++i) {
    const std::string k = std::to_string(i), mimic = i < n - 1 ? "<mimic joint=\"j" + std::to_string(i + 1) + "\"/>" : "";
    text += linkText("l" + k) + jointText("j" + k, "base", "l" + k, "continuous", mimic);
  }
  CHECK(read(robot(text)).nv() == 1);
}

TEST_CASE("a circle of 30000 mimics, and what hangs on it, is said once", "[fault]") {
  constexpr int n = 30000;
  std::string text = linkText("base");
  for (int i = 0; i < n; ++i) {
    const std::string k = std::to_string(i), master = std::to_string(i + 1 < n ? i + 1 : n / 2);
    text += linkText("l" + k) + jointText("j" + k, "base", "l" + k, "continuous", "<mimic joint=\"j" + master + "\"/>");
  }
  const test::Folder folder;
  const std::vector<Error> errors = urdf::check(folder.write("robot.urdf", robot(text)));
  REQUIRE(errors.size() == 1);
  CHECK_THAT(errors[0].what(), containing("joint 'j15000' mimics itself"));
}

TEST_CASE("numbers are read the same under a locale with decimal commas", "[fault]") {
  const std::string before = std::setlocale(LC_ALL, nullptr);
  if (!std::setlocale(LC_ALL, "de_DE.UTF-8") && !std::setlocale(LC_ALL, "de_DE")) DYN_SKIP("the locale de_DE is not installed");
  const Model model = urdf::parse(robot(linkText("a", "0.5", "0.25")), "robot.urdf");
  std::setlocale(LC_ALL, before.c_str());
  CHECK(model.bodies[1].inertia.mass == 0.5);
  CHECK(model.bodies[1].inertia.rotational.xx == 0.25);
}

TEST_CASE("vectors of wrong sizes are named with what they have and what is wanted", "[fault]") {
  const CompactModel model = read(robot(linkText("a") + linkText("b") + jointText("j", "a", "b")));
  Data data(model);
  const Eigen::VectorXd one = Eigen::VectorXd::Zero(1), two = Eigen::VectorXd::Zero(2);
  CHECK_THROWS_WITH(rnea(model, data, two, one, one), containing("q has 2") && containing("wants 1"));
  CHECK_THROWS_WITH(rnea(model, data, one, two, one), containing("v has 2"));
  CHECK_THROWS_WITH(aba(model, data, one, one, two), containing("tau has 2"));
  CHECK_THROWS_WITH(crba(model, data, one), containing("Need::mass_matrix"));
  CHECK_THROWS_WITH(integrate(model, one, two), containing("v has 2"));
  Eigen::MatrixXd J(3, 1);
  CHECK_THROWS_WITH(computeFrameJacobian(model, data, one, 0, ReferenceFrame::LOCAL, J), containing("3 x 1") && containing("6 x 1"));
  Data other(read(robot(linkText("a"))));
  CHECK_THROWS_WITH(rnea(model, other, one, one, one), containing("another model"));
  forwardKinematics(model, data, one);
  CHECK_THROWS_WITH(framePlacement(model, data, 99), containing("99"));
}

TEST_CASE("a plugin joint is described by the extension element", "[parser]") {
  const std::string text =
      robot(linkText("a") + linkText("b") + jointText("screw", "a", "b", "floating", "") +
            "<libdyn><joint name=\"screw\" type=\"helical\" axis=\"0 0 1\" pitch=\"0.01\" damping=\"0.5\" armature=\"0.1\"/></libdyn>\n");
  const Model model = urdf::parse(text, "robot.urdf");
  CHECK(model.bodies[2].joint.type == "helical");
  CHECK(model.bodies[2].joint.damping == std::vector<double>{0.5});
  CHECK(compile(model, JointRegistry::standard()).nv() == 1);
  const auto with = [&](const std::string& attributes) {
    return read(
        robot(linkText("a") + linkText("b") + jointText("screw", "a", "b", "floating", "") + "<libdyn><joint " + attributes + "/></libdyn>\n"));
  };
  CHECK_THROWS_WITH(with("name=\"screw\" type=\"helical\" axis=\"0 0 1\""),
                    containing("'pitch' is missing") && containing("screw") && containing(":6"));
  CHECK_THROWS_WITH(with("name=\"screw\" type=\"helical\" axis=\"0 0 1\" pitch=\"1\" speed=\"3\""), containing("'speed' is unknown"));
  CHECK_THROWS_WITH(with("name=\"screw\" type=\"helical\" axis=\"0 0\" pitch=\"1\""), containing("'axis' must be three numbers"));
  CHECK_THROWS_WITH(with("name=\"nobody\" type=\"helical\""), containing("'nobody'"));
}

TEST_CASE("ignored tags are reported once each", "[parser]") {
  const Model model = urdf::parse(robot(linkText("a") + "<gazebo/><gazebo/><transmission/>\n"), "robot.urdf");
  int gazebo = 0;
  for (const std::string& note : model.notes) gazebo += note.find("<gazebo>") != std::string::npos && note.find("2 times") != std::string::npos;
  CHECK(gazebo == 1);
}

TEST_CASE("what of a file nothing reads is said, wherever it stands", "[parser]") {
  const auto noted = [](const std::string& text, const std::string& word) {
    const Model model = urdf::parse(text, "robot.urdf");
    INFO(word);
    CHECK(std::any_of(model.notes.begin(), model.notes.end(), [&](const std::string& note) { return note.find(word) != std::string::npos; }));
  };
  const std::string two = "<link name=\"a\"/><link name=\"b\"/>";
  const auto joint = [&](const std::string& type, const std::string& inside, const std::string& attributes = "") {
    return "<robot name=\"r\">" + two + "<joint name=\"j\" type=\"" + type + "\"" + attributes + "><parent link=\"a\"/><child link=\"b\"/>" + inside +
           "</joint></robot>";
  };
  const std::string limit = "<limit lower=\"-1\" upper=\"1\" effort=\"1\" velocity=\"1\"/>";
  noted(joint("revolute", limit + "<dynamics><friction>2</friction></dynamics>"), "<friction> in <dynamics>");
  noted(joint("revolute", limit + "<dynamics fricton=\"2\"/>"), "attribute fricton of <dynamics>");
  noted(joint("revolute", limit + limit), "<limit> in <joint> after the first");
  noted(joint("revolute", limit, " mode=\"fast\""), "attribute mode of <joint>");
  noted(joint("revolute", "<limit effort=\"1\" velocity=\"1\"/>"), "range is zero");
  noted(joint("continuous", limit), "(continuous): lower and upper");
  noted(joint("prismatic", limit + "<axis xyz=\"0 0 1\" unit=\"mm\"/>"), "attribute unit of <axis>");
  const auto link = [](const std::string& inside) { return "<robot name=\"r\"><link name=\"a\">" + inside + "</link></robot>"; };
  noted(link("<collision><geometry><box size=\"1 1 1\"/><box size=\"2 2 2\"/></geometry></collision>"), "<box> in <geometry> after the first");
  noted(link("<collision><pose xyz=\"1 0 0\"/><geometry><sphere radius=\"1\"/></geometry></collision>"), "<pose> in <collision>");
  noted(link("<inertial><mass value=\"1\" unit=\"g\"/><inertia ixx=\"1\" iyy=\"1\" izz=\"1\"/></inertial>"), "attribute unit of <mass>");
  // Visual geometry causes no note.
  CHECK(urdf::parse(link("<visual><geometry><box size=\"1 1 1\"/></geometry><material name=\"red\"/></visual>"), "robot.urdf").notes.empty());
}

TEST_CASE("characters that a terminal would obey are refused, however they are written", "[fault]") {
  for (const char* escape : {"\x1b", "&#27;", "&#x1B;", "\x07"}) {
    INFO(escape);
    CHECK_THROWS_WITH(urdf::parse(std::string("<robot name=\"r\"><link name=\"a") + escape + "[31m\"/></robot>", "robot.urdf"),
                      containing("robot.urdf:1") && containing("is not XML"));
  }
}

TEST_CASE("an inertia that no body has is refused at every scale", "[parser]") {
  const auto load = [](const std::string& exponent, const std::string& mantissa) {
    const std::string one = "\"1" + exponent + "\"";
    return urdf::parse("<robot name=\"r\"><link name=\"a\"><inertial><mass value=\"1\"/><inertia ixx=" + one + " iyy=" + one + " izz=" + one +
                           " ixy=\"" + mantissa + exponent + "\"/></inertial></link></robot>",
                       "robot.urdf");
  };
  for (const char* exponent : {"", "e150", "e300", "e-150", "e-300"}) {
    INFO(exponent);
    CHECK_THROWS_WITH(load(exponent, "100"), containing("not positive semi-definite"));
    CHECK_THROWS_WITH(load(exponent, "1.01"), containing("not positive semi-definite"));
    CHECK_NOTHROW(load(exponent, "0.4"));
  }
}

TEST_CASE("an origin may be turned by a quaternion", "[parser]") {
  const auto pose = [](const std::string& origin) {
    return urdf::parse(
               "<robot name=\"r\"><link name=\"a\"/><link name=\"b\"/><joint name=\"j\" type=\"fixed\"><parent link=\"a\"/>"
               "<child link=\"b\"/><origin xyz=\"1 2 3\" " +
                   origin + "/></joint></robot>",
               "robot.urdf")
        .bodies.back()
        .joint.placement;
  };
  // A third of a turn about (1, 1, 1) maps x to y, y to z and z to x.
  const SE3<double> X = pose("quat_xyzw=\"0.5 0.5 0.5 0.5\"");
  const double cyclic[9] = {0, 0, 1, 1, 0, 0, 0, 1, 0};
  for (int i = 0; i < 9; ++i) CHECK(X.R.m[i] == approx(cyclic[i]).margin(1e-15));
  CHECK(X.p.y == 2);
  CHECK_THROWS_WITH(pose("quat_xyzw=\"0 0 0 1\" rpy=\"0 0 1\""), containing("both rpy and quat_xyzw"));
  CHECK_THROWS_WITH(pose("quat_xyzw=\"0 0 0 2\""), containing("length 1"));
  CHECK_THROWS_WITH(pose("quat_xyzw=\"0 0 1\""), containing("four numbers"));
}

TEST_CASE("losses of the description act in the dynamics, unless they are switched off", "[parser]") {
  const std::string text =
      robot(linkText("a") + linkText("b") +
            jointText("j", "a", "b", "revolute",
                      "<limit lower=\"-1\" upper=\"1\" effort=\"1\" velocity=\"1\"/><dynamics damping=\"0.5\" friction=\"0.25\"/>"));
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(1), v = Eigen::VectorXd::Constant(1, 2.0);
  const CompactModel with = read(text);
  CompileOptions options;
  options.dissipation = false;
  const CompactModel without = compile(urdf::parse(text, "robot.urdf"), JointRegistry::standard(), options);
  Data d1(with), d2(without);
  CHECK(rnea(with, d1, zero, v, zero)[0] - rnea(without, d2, zero, v, zero)[0] == approx(1.25));
  CHECK(rnea(with, d1, zero, v, Eigen::VectorXd(aba(with, d1, zero, v, zero)))[0] == approx(0).margin(1e-12));
}
