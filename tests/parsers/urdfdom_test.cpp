// SPDX-License-Identifier: BSD-2-Clause
// libdyn's URDF reader compared with urdfdom, which shares no code with it, on every available robot. Also shows why libdyn has its own reader.
#include "support/catch.hpp"
#include "support/registry.hpp"
#include "support/shared.hpp"

#include <dyn/compile/compile.hpp>
#include <dyn/file.hpp>
#include <dyn/lie/so3.hpp>
#include <dyn/model/difference.hpp>
#include <dyn/parsers/urdfdom.hpp>
#include <dyn/spatial/eigen.hpp>

#include <console_bridge/console.h>
#include <urdf_parser/urdf_parser.h>

#include <filesystem>
#include <iostream>

using namespace dyn;
using namespace dyn::test;

namespace {

Vec3<double> vec3(const ::urdf::Vector3& x) { return {x.x, x.y, x.z}; }

SE3<double> pose(const ::urdf::Pose& p) {
  const Quaternion<double> q{p.rotation.x, p.rotation.y, p.rotation.z, p.rotation.w};
  return {q.normalized().matrix(), vec3(p.position)};
}

double off(const SE3<double>& a, const SE3<double>& b) { return (toEigen(a) - toEigen(b)).cwiseAbs().maxCoeff(); }

void checkLink(const BodyDescription& body, const ::urdf::Link& link) {
  if (!link.inertial) {
    CHECK(body.inertia.mass == 0);
    return;
  }
  const ::urdf::Inertial& i = *link.inertial;
  Inertia<double> Y{i.mass, {}, {i.ixx, i.ixy, i.ixz, i.iyy, i.iyz, i.izz}};
  Y = Y.transformed(pose(i.origin));
  CHECK(body.inertia.mass == i.mass);
  CHECK((toEigen(body.inertia.com) - toEigen(Y.com)).norm() == 0);
  const Eigen::Matrix3d ours = toEigen(body.inertia.rotational), theirs = toEigen(Y.rotational);
  CHECK((ours - theirs).norm() <= 8e-16 * theirs.norm());
}

void checkJoint(const JointDescription& joint, const ::urdf::Joint& other) {
  INFO("joint " << other.name);
  CHECK(joint.name == other.name);
  const SE3<double> placement = pose(other.parent_to_joint_origin_transform);
  CHECK(off({joint.placement.R, {}}, {placement.R, {}}) < 1e-15);
  CHECK((toEigen(joint.placement.p) - toEigen(placement.p)).norm() == 0);
  if (other.type == ::urdf::Joint::FIXED) {
    CHECK(joint.type == "fixed");
    return;
  }
  const Vec3<double> axis = vec3(other.axis);
  CHECK(std::get<std::vector<double>>(joint.parameters.at("axis")) == std::vector<double>{axis.x, axis.y, axis.z});
  if (other.limits && other.type != ::urdf::Joint::CONTINUOUS) {
    CHECK(joint.limits.lower.at(0) == other.limits->lower);
    CHECK(joint.limits.upper.at(0) == other.limits->upper);
  }
  if (other.limits) {
    CHECK(joint.limits.effort.at(0) == other.limits->effort);
    CHECK(joint.limits.velocity.at(0) == other.limits->velocity);
  }
  // urdfdom gives 0 for missing values.
  CHECK((joint.damping.empty() ? 0 : joint.damping[0]) == (other.dynamics ? other.dynamics->damping : 0));
  CHECK((joint.friction.empty() ? 0 : joint.friction[0]) == (other.dynamics ? other.dynamics->friction : 0));
  CHECK(joint.coupling.type.empty() == !other.mimic);
  if (other.mimic) {
    CHECK(joint.coupling.master == other.mimic->joint_name);
    CHECK(std::get<std::vector<double>>(joint.coupling.parameters.at("coefficients")) ==
          std::vector<double>{other.mimic->offset, other.mimic->multiplier});
  }
}

/// Compares `link` and its descendants. The bodies are in the order of a depth-first walk of urdfdom's tree.
void walk(const Model& model, const ::urdf::Link& link, std::size_t& next) {
  const BodyDescription& body = model.bodies.at(next++);
  INFO("link " << link.name);
  CHECK(body.name == link.name);
  checkLink(body, link);
  if (link.parent_joint) checkJoint(body.joint, *link.parent_joint);
  for (const auto& child : link.child_links) walk(model, *child, next);
}

const char* revolute_without_limits = R"(<robot name="r"><link name="a"/><link name="b"/>
  <joint name="j" type="revolute"><parent link="a"/><child link="b"/></joint></robot>)";
const char* speed_limit_only = R"(<robot name="r"><link name="a"/><link name="b"/>
  <joint name="j" type="revolute"><parent link="a"/><child link="b"/><limit lower="-1" upper="1" velocity="2"/></joint></robot>)";
const char* mass_with_comma = R"(<robot name="r"><link name="a"><inertial><mass value="1,5"/>
  <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link></robot>)";

/// Calls f with the path of each shared robot that urdfdom reads, and with what it reads; checks that they are the 18 that there should be.
template <class F>
void forEachRobot(const F& f) {
  console_bridge::setLogLevel(console_bridge::CONSOLE_BRIDGE_LOG_NONE);
  int compared = 0;
  for (const auto& entry : std::filesystem::directory_iterator(sharedFolder() + "/models")) {
    const std::string path = entry.path().string();
    const auto theirs = ::urdf::parseURDFFile(path);
    if (!theirs) continue;
    INFO(path);
    f(path, *theirs);
    ++compared;
  }
  if (std::getenv("DYN_SHOW_ERRORS")) std::cout << compared << " robots compared\n";
  CHECK(compared >= 18);
}

}  // namespace

TEST_CASE("the reader agrees with urdfdom on every robot that both can read", "[urdf]") {
  DYN_NEEDS_SHARED();
  forEachRobot([](const std::string& path, const ::urdf::ModelInterface& theirs) {
    dyn::urdf::Options options;
    options.inertias = dyn::urdf::Inertias::any;
    const Model model = dyn::urdf::load(path, options);
    REQUIRE(model.bodies.size() == theirs.links_.size() + 1);
    std::size_t next = 1;
    walk(model, *theirs.getRoot(), next);
  });
}

TEST_CASE("a robot that urdfdom has parsed becomes the model that the reader makes of its file", "[urdf]") {
  DYN_NEEDS_SHARED();
  forEachRobot([](const std::string& path, const ::urdf::ModelInterface& theirs) {
    // urdfdom does not read this element, which replaces shapes.
    const bool replaces_shapes = readFile(path, largest_model_file).find("<collision_checking>") != std::string::npos;
    for (const char* root : {"fixed", "free_flyer"}) {
      const dyn::urdf::Options options{.root = root, .inertias = Inertias::any};
      const Model ours = dyn::urdf::load(path, options), model = dyn::urdf::fromUrdfdom(theirs, options);
      for (const Difference& d : differences(ours, model, 1e-14))
        if (!(replaces_shapes && d.what == "shape")) FAIL_CHECK(d.topic << " " << d.name << " " << d.what << ": " << d.a << " | " << d.b);
      REQUIRE(ours.bodies.size() == model.bodies.size());
      for (std::size_t i = 0; i < ours.bodies.size(); ++i) CHECK(ours.bodies[i].name == model.bodies[i].name);
      CHECK(model.bodies.back().where.line == 0);
    }
  });
}

TEST_CASE("a robot of urdfdom that is no mechanism is refused by its name", "[urdf]") {
  console_bridge::setLogLevel(console_bridge::CONSOLE_BRIDGE_LOG_NONE);
  const auto theirs = ::urdf::parseURDF(R"(<robot name="heavy"><link name="a"><inertial><mass value="-1"/>
    <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link></robot>)");
  REQUIRE(theirs);
  CHECK_THROWS_WITH(dyn::urdf::fromUrdfdom(*theirs), containing("urdfdom's model 'heavy'") && containing("link 'a'") && containing("negative"));
  // Its notes do not name lines of a text that the program has never seen.
  const auto point = ::urdf::parseURDF(R"(<robot name="point"><link name="a"><inertial><mass value="1"/>
    <inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial></link></robot>)");
  REQUIRE(point);
  CHECK(dyn::urdf::fromUrdfdom(*point).notes == std::vector<std::string>{"link 'a': it has a mass but no inertia, as a point has"});
}

TEST_CASE("the reader takes what urdfdom refuses, and refuses what urdfdom lets pass", "[urdf]") {
  console_bridge::setLogLevel(console_bridge::CONSOLE_BRIDGE_LOG_NONE);
  // In libdyn joints without limits are unlimited. urdfdom refuses a file with such a joint.
  CHECK(::urdf::parseURDF(revolute_without_limits) == nullptr);
  CHECK(::urdf::parseURDF(speed_limit_only) == nullptr);
  const CompactModel unlimited = compile(dyn::urdf::parse(revolute_without_limits, "text"), registry());
  CHECK(unlimited.limits().upper.at(0) == std::numeric_limits<double>::infinity());
  const CompactModel fast = compile(dyn::urdf::parse(speed_limit_only, "text"), registry());
  CHECK(fast.limits().velocity.at(0) == 2);
  CHECK(fast.limits().effort.at(0) == std::numeric_limits<double>::infinity());
  // urdfdom silently drops an inertial whose mass has a decimal comma. libdyn reports an error with its line.
  const auto silent = ::urdf::parseURDF(mass_with_comma);
  REQUIRE(silent);
  CHECK_THROWS_WITH(dyn::urdf::parse(mass_with_comma, "text"), containing("text:1") && containing("1,5"));
}
