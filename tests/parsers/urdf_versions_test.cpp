// SPDX-License-Identifier: BSD-2-Clause
// Versions of URDF after 1.0 and what they added; inertias of links that are welded to others.
#include "support/catch.hpp"
#include "support/folder.hpp"
#include "support/registry.hpp"
#include "support/shared.hpp"

#include <dyn/dyn.hpp>
#include <dyn/parsers/json.hpp>
#include <dyn/parsers/urdf.hpp>

using namespace dyn;
using namespace dyn::test;

namespace {

std::string allNotes(const Model& model) {
  std::string all;
  for (const std::string& note : model.notes) all += note + "\n";
  return all;
}

Model versioned(const std::string& version, urdf::Versions versions = urdf::Versions::known) {
  return urdf::parse("<?xml version=\"1.0\"?>\n<robot name=\"r\" version=\"" + version + "\"><link name=\"a\"/></robot>", "r.urdf",
                     {.versions = versions});
}

std::string inertial(double mass, double moment, double product) {
  const std::string m = std::to_string(moment);
  return "<inertial><mass value=\"" + std::to_string(mass) + "\"/><inertia ixx=\"" + m + "\" iyy=\"" + m + "\" izz=\"" + m + "\" ixy=\"" +
         std::to_string(product) + "\" ixz=\"0\" iyz=\"0\"/></inertial>";
}

/// A base that carries an arm on a joint, and the arm an antenna on another one. The types of both joints are given.
std::string antenna(const std::string& arm_joint, const std::string& antenna_joint, double product, const std::string& extension = "") {
  const auto joint = [](const std::string& name, const std::string& type, const std::string& parent, const std::string& child) {
    return "<joint name=\"" + name + "\" type=\"" + type + "\"><origin xyz=\"0.1 0.2 0.3\" rpy=\"0.3 0.2 0.1\"/><parent link=\"" + parent +
           "\"/><child link=\"" + child + "\"/></joint>\n";
  };
  return "<robot name=\"r\">\n<link name=\"base\">" + inertial(10, 1, 0) + "</link>\n<link name=\"arm\">" + inertial(1, 0.1, 0) +
         "</link>\n<link name=\"antenna\">" + inertial(0.001, 0.001, product) + "</link>\n" + joint("shoulder", arm_joint, "base", "arm") +
         joint("mount", antenna_joint, "arm", "antenna") + extension + "</robot>";
}

}  // namespace

TEST_CASE("files of the versions 1.0, 1.1 and 1.2 are read, and newer ones are refused unless asked", "[urdf]") {
  for (const char* version : {"1.0", "1.1", "1.2"}) CHECK(versioned(version).notes.empty());
  for (const char* version : {"1.3", "1.10", "2.0", "99999999999999999999999.0", "1.99999999999999999999999"}) {
    INFO(version);
    CHECK_THROWS_WITH(versioned(version), containing("r.urdf:2") && containing(std::string("version ") + version + " of URDF") &&
                                              containing("1.0 to 1.2") && containing("--versions any"));
    CHECK_THAT(allNotes(versioned(version, urdf::Versions::any)), containing("parts of it may be missing"));
  }
  for (const char* version : {"", "one", "1", "1.", "1.2.3", "1.2b", "-1.0", "0.9"}) {
    INFO(version);
    CHECK_THAT(allNotes(versioned(version)), containing("is no version of URDF"));
  }
}

TEST_CASE("limits of acceleration, deceleration and jerk are kept for planners", "[urdf]") {
  const std::string text = R"(<robot name="r" version="1.2"><link name="a"/><link name="b"/><joint name="j" type="revolute">
    <parent link="a"/><child link="b"/>
    <limit lower="-1" upper="1" effort="2" velocity="3" acceleration="4" deceleration="5" jerk="6"/></joint></robot>)";
  const Model model = urdf::parse(text, "r.urdf");
  CHECK(model.notes.empty());
  const JointLimits& limits = model.bodies[2].joint.limits;
  CHECK(limits.acceleration == std::vector<double>{4});
  CHECK(limits.deceleration == std::vector<double>{5});
  CHECK(limits.jerk == std::vector<double>{6});
  CHECK_NOTHROW(compile(model, registry()));
  const Model read = json::parse(json::write(model), "text");
  CHECK(read.bodies[2].joint.limits.jerk == std::vector<double>{6});
  CHECK(read.bodies[2].joint.limits.deceleration == std::vector<double>{5});
  Model wrong = model;
  wrong.bodies[2].joint.limits.jerk = {1, 2};
  CHECK_THROWS_WITH(compile(wrong, registry()), containing("jerk has 2 entries"));
}

TEST_CASE("capsules are volumes", "[urdf]") {
  const Model model = urdf::parse(R"(<robot name="r" version="1.2"><link name="a"><collision><geometry><capsule radius="0.1" length="0.5"/></geometry>
    </collision></link></robot>)",
                                  "r.urdf");
  REQUIRE(model.geometries.size() == 1);
  const auto& capsule = std::get<geometry::Capsule>(model.geometries[0].shape);
  CHECK(capsule.radius == 0.1);
  CHECK(capsule.length == 0.5);
  CHECK(model.notes.empty());
}

TEST_CASE("a link with an impossible inertia is noted if the rigid body to which it is fixed is possible", "[urdf]") {
  const Model model = urdf::parse(antenna("revolute", "fixed", 0.002), "r.urdf");
  CHECK_THAT(allNotes(model),
             containing("line 4: link 'antenna'") && containing("not positive semi-definite") && containing("rigid body of 2 links"));
  CHECK_NOTHROW(urdf::parse(antenna("fixed", "fixed", 0.002), "r.urdf"));
}

TEST_CASE("a link with an impossible inertia is refused where it would move with it", "[urdf]") {
  CHECK_THROWS_WITH(urdf::parse(antenna("revolute", "revolute", 0.002), "r.urdf"), containing("r.urdf:4") && containing("link 'antenna'"));
  // The arm cannot make up for a large one.
  CHECK_THROWS_WITH(urdf::parse(antenna("revolute", "fixed", 2), "r.urdf"), containing("nor has the rigid body of 2 links"));
  CHECK_NOTHROW(urdf::parse(antenna("revolute", "fixed", 2), "r.urdf", {.inertias = urdf::Inertias::any}));
  // The base can, if the arm is fixed to it.
  CHECK_NOTHROW(urdf::parse(antenna("fixed", "fixed", 1), "r.urdf"));
  // An extension may let a fixed joint move.
  const std::string moving = "<libdyn><joint name=\"mount\" type=\"spherical\"/></libdyn>";
  CHECK_THROWS_WITH(urdf::parse(antenna("revolute", "fixed", 0.002, moving), "r.urdf"), containing("link 'antenna'"));
}

TEST_CASE("every robot of the reference data loads by default", "[urdf]") {
  DYN_NEEDS_SHARED();
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(sharedFolder() + "/models")) {
    if (entry.path().extension() != ".urdf") continue;
    INFO(entry.path());
    CHECK_NOTHROW(urdf::load(entry.path().string()));
    ++count;
  }
  CHECK(count >= 20);
  const Model tiago = urdf::load(sharedFolder() + "/models/tiago.urdf");
  CHECK_THAT(allNotes(tiago), containing("base_antenna_left_link") && containing("not positive semi-definite"));
}

TEST_CASE("one hundred thousand welded links with impossible inertias are judged in linear time", "[urdf]") {
  std::string text = "<robot name=\"r\"><link name=\"l0\">" + inertial(1e6, 1e6, 0) + "</link>";
  for (int i = 1; i <= 100000; ++i) {
    const std::string k = std::to_string(i), before = std::to_string(i - 1);
    text += "<link name=\"l" + k + "\">" + inertial(0.001, 0.001, 0.002) + "</link><joint name=\"j" + k + "\" type=\"fixed\"><parent link=\"l" +
            before + "\"/><child link=\"l" + k + "\"/></joint>";
  }
  CHECK(urdf::parse(text + "</robot>", "r.urdf").bodies.size() == 100002);
}
