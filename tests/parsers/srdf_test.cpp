// SPDX-License-Identifier: BSD-2-Clause
// SRDF: groups, named states and what else planners say about a robot, by the names of the model.
#include "support/catch.hpp"
#include "support/registry.hpp"

#include <dyn/compile/edit.hpp>
#include <dyn/dyn.hpp>
#include <dyn/parsers/json.hpp>
#include <dyn/parsers/srdf.hpp>
#include <dyn/parsers/urdf.hpp>

#include <algorithm>

using namespace dyn;
using namespace dyn::test;

namespace {

/// A cart with an arm of two joints, a wheel that turns without end, and a gripper whose right finger follows the left one.
const char* const robot = R"(<robot name="r">
  <link name="cart"/> <link name="wheel"/> <link name="upper"/> <link name="lower"/> <link name="palm"/> <link name="left"/> <link name="right"/>
  <joint name="rolling" type="continuous"> <parent link="cart"/> <child link="wheel"/> <axis xyz="0 1 0"/> </joint>
  <joint name="shoulder" type="revolute"> <parent link="cart"/> <child link="upper"/> <limit lower="-1" upper="1" effort="1" velocity="1"/> </joint>
  <joint name="elbow" type="revolute"> <parent link="upper"/> <child link="lower"/> <limit lower="-2" upper="2" effort="1" velocity="1"/> </joint>
  <joint name="flange" type="fixed"> <parent link="lower"/> <child link="palm"/> </joint>
  <joint name="grip" type="prismatic"> <parent link="palm"/> <child link="left"/> <limit lower="0" upper="1" effort="1" velocity="1"/> </joint>
  <joint name="follow" type="prismatic"> <parent link="palm"/> <child link="right"/> <limit lower="0" upper="1" effort="1" velocity="1"/>
    <mimic joint="grip"/> </joint></robot>)";

const char* const semantics = R"(<robot name="r">
  <virtual_joint name="world_joint" type="planar" parent_frame="odom" child_link="cart"/>
  <group name="arm"> <chain base_link="cart" tip_link="palm"/> </group>
  <group name="hand"> <link name="left"/> <joint name="follow"/> </group>
  <group name="all"> <group name="hand"/> <group name="arm"/> <joint name="world_joint"/> <joint name="rolling"/> </group>
  <end_effector name="gripper" group="hand" parent_link="palm" parent_group="arm"/>
  <passive_joint name="follow"/>
  <group_state name="home" group="arm"> <joint name="shoulder" value="0.5"/> <joint name="elbow" value="-0.25"/> </group_state>
  <group_state name="home" group="hand"> <joint name="grip" value="0.125"/> <joint name="follow" value="0.125"/> </group_state>
  <group_state name="parked" group="all"> <joint name="world_joint" value="1 2 0.5"/> <joint name="rolling" value="2"/> </group_state>
  <disable_collisions link1="upper" link2="lower" reason="Adjacent"/>
</robot>)";

using Names = std::vector<std::string>;

Model described(const char* root = "planar") {
  Model model = urdf::parse(robot, "r.urdf", {.root = root});
  model.notes.clear();
  return model;
}

Model complete(const char* root = "planar") {
  Model model = described(root);
  srdf::parse(semantics, "r.srdf", model);
  return model;
}

/// The notes on a text whose robot has these elements.
std::string notesOn(const std::string& elements) {
  Model model = described();
  srdf::parse("<robot name=\"r\">" + elements + "</robot>", "r.srdf", model);
  std::string all;
  for (const std::string& note : model.notes) all += note + "\n";
  return all;
}

}  // namespace

TEST_CASE("groups have the joints of their links, chains and subgroups, in the model's order", "[srdf]") {
  const Model model = complete();
  CHECK(model.notes.empty());
  CHECK(model.jointsOf("arm") == Names{"shoulder", "elbow", "flange"});
  CHECK(model.jointsOf("hand") == Names{"follow", "grip"});
  CHECK(model.jointsOf("all") == Names{"root_joint", "rolling", "shoulder", "elbow", "flange", "follow", "grip"});
  CHECK_THROWS_WITH(model.jointsOf("hnad"), containing("did you mean 'hand'"));
  REQUIRE(model.end_effectors.size() == 1);
  CHECK(model.end_effectors[0].body == "palm");
  CHECK(model.end_effectors[0].parent_group == "arm");
  CHECK(model.passive_joints == Names{"follow"});
  REQUIRE(model.virtual_joints.size() == 1);
  CHECK(model.virtual_joints[0].type == "planar");
  CHECK(model.virtual_joints[0].frame == "odom");
  CHECK(model.disabled_collisions.size() == 1);
}

TEST_CASE("groups that contain each other are one group, not an endless search", "[srdf]") {
  Model model = described();
  model.groups = {{.name = "a", .joints = {"elbow"}, .groups = {"b"}}, {.name = "b", .joints = {"grip"}, .groups = {"a"}}};
  CHECK(model.jointsOf("a") == Names{"elbow", "grip"});
  model.groups[0].joints = {"knee"};
  CHECK_THROWS_WITH(model.jointsOf("b"), containing("group 'a' has the joint 'knee', which does not exist"));
  model.groups[0] = {.name = "a", .chains = {{"wheel", "palm"}}};
  CHECK_THROWS_WITH(model.jointsOf("a"), containing("chain from 'wheel' to 'palm'"));
}

TEST_CASE("a named state is a configuration of the compiled model", "[srdf]") {
  const Model model = complete();
  const CompactModel compact = compile(model, registry());
  const auto at = [&](const char* joint) { return compact.joints()[static_cast<std::size_t>(compact.jointId(joint))].idx_q; };
  Eigen::VectorXd expected = neutral(compact);
  expected[at("shoulder")] = 0.5;
  expected[at("elbow")] = -0.25;
  CHECK(namedConfiguration(compact, model, "arm/home") == expected);
  // The name alone means the states of all groups that have one of that name. The follower has no coordinate.
  expected[at("grip")] = 0.125;
  CHECK(namedConfiguration(compact, model, "home") == expected);
  // One angle becomes its cosine and sine.
  const int root = at("root_joint"), rolling = at("rolling");
  expected.segment<4>(root) << 1, 2, std::cos(0.5), std::sin(0.5);
  expected.segment<2>(rolling) << std::cos(2), std::sin(2);
  CHECK(namedConfiguration(compact, model, "home,parked") == expected);
  CHECK(namedVelocity(compact, model, "home").norm() == 0);
  CHECK_THROWS_WITH(namedConfiguration(compact, model, "arm/hom"), containing("has no state 'arm/hom'; did you mean 'arm/home'"));
  CHECK_THROWS_WITH(namedConfiguration(compact, described(), "home"), containing("no named states"));
}

TEST_CASE("states of held joints are left out, and contradictions are refused", "[srdf]") {
  Model model = complete();
  const CompactModel held = compile(model, registry(), {.lock = {{"elbow", {}}}});
  CHECK(namedConfiguration(held, model, "arm/home").size() == held.nq());
  const Model reduced = reduce(model, registry(), {{"elbow", {}}});
  CHECK(namedConfiguration(compile(reduced, registry()), reduced, "arm/home") == namedConfiguration(held, model, "arm/home"));
  const CompactModel compact = compile(model, registry());
  model.configurations.push_back({.name = "home", .group = "all", .joints = {{"elbow", {1}, {}}}});
  CHECK_THROWS_WITH(namedConfiguration(compact, model, "home"), containing("joint 'elbow'") && containing("'all/home'"));
  CHECK_NOTHROW(namedConfiguration(compact, model, "all/home"));
  model.configurations = {{.name = "odd", .joints = {{"elbow", {1, 2}, {}}}}, {.name = "lost", .joints = {{"knee", {1}, {}}}}};
  CHECK_THROWS_WITH(namedConfiguration(compact, model, "odd"), containing("has 2 coordinates") && containing("wants 1"));
  CHECK_THROWS_WITH(namedConfiguration(compact, model, "lost"), containing("joint 'knee'") && containing("does not have"));
}

TEST_CASE("a state may have velocities", "[srdf]") {
  Model model = complete();
  model.configurations = {{.name = "swing", .joints = {{"elbow", {0.5}, {2}}, {"rolling", {}, {-1}}}}};
  const CompactModel compact = compile(model, registry());
  Eigen::VectorXd v = Eigen::VectorXd::Zero(compact.nv());
  v[compact.joints()[static_cast<std::size_t>(compact.jointId("elbow"))].idx_v] = 2;
  v[compact.joints()[static_cast<std::size_t>(compact.jointId("rolling"))].idx_v] = -1;
  CHECK(namedVelocity(compact, model, "swing") == v);
  const int rolling = compact.joints()[static_cast<std::size_t>(compact.jointId("rolling"))].idx_q;
  CHECK(namedConfiguration(compact, model, "swing")[rolling] == 1);
}

TEST_CASE("a copy in another model keeps its groups and states, under new names", "[srdf]") {
  const Model both = append(complete(), complete("fixed"), "palm", {}, "tool_");
  CHECK(both.jointsOf("tool_arm") == Names{"tool_shoulder", "tool_elbow", "tool_flange"});
  CHECK(both.virtual_joints.size() == 1);
  const CompactModel compact = compile(both, registry());
  CHECK(namedConfiguration(compact, both, "tool_arm/tool_home")[compact.joints()[static_cast<std::size_t>(compact.jointId("tool_elbow"))].idx_q] ==
        -0.25);
  CHECK_THROWS_WITH(append(both, complete("fixed"), "palm", {}, "tool_"), containing("would be there twice"));
}

TEST_CASE("libdyn's own format keeps groups and states", "[srdf]") {
  const Model model = complete();
  const std::string text = json::write(model);
  const Model read = json::parse(text, "text");
  CHECK(json::write(read) == text);
  CHECK(read.jointsOf("all") == model.jointsOf("all"));
  CHECK(read.configurations.size() == 3);
  CHECK(read.configurations[2].joints[1].q == std::vector<double>{std::cos(2), std::sin(2)});
  CHECK(read.virtual_joints.at(0).frame == "odom");
}

TEST_CASE("names that the model does not have are noted with their line and left out", "[srdf]") {
  CHECK_THAT(notesOn("\n<group name=\"g\"><joint name=\"elbw\"/></group>"), containing("r.srdf:2: there is no joint 'elbw'; did you mean 'elbow'"));
  CHECK_THAT(notesOn("<group name=\"g\"><link name=\"palms\"/></group>"), containing("did you mean 'palm'"));
  CHECK_THAT(notesOn("<group name=\"g\"><chain base_link=\"wheel\" tip_link=\"palm\"/></group>"), containing("'wheel' does not carry 'palm'"));
  CHECK_THAT(notesOn("<group name=\"g\"><group name=\"h\"/></group>"), containing("no group 'h'"));
  CHECK_THAT(notesOn("<group_state name=\"s\" group=\"g\"/>"), containing("no group 'g'"));
  CHECK_THAT(notesOn("<end_effector name=\"e\" group=\"g\" parent_link=\"nowhere\"/>"),
             containing("no group 'g'") && containing("no link 'nowhere'"));
  CHECK_THAT(notesOn("<passive_joint name=\"nobody\"/>"), containing("no joint 'nobody'"));
  CHECK_THAT(notesOn("<group name=\"g\"/><group_state name=\"s\" group=\"g\"><joint name=\"flange\" value=\"1\"/></group_state>"),
             containing("'flange', which is fixed"));
  Model model = described();
  srdf::parse("<robot name=\"r\"><group name=\"g\"><joint name=\"elbw\"/><joint name=\"elbow\"/></group></robot>", "r.srdf", model);
  CHECK(model.jointsOf("g") == Names{"elbow"});
}

TEST_CASE("elements that are not read are noted once each", "[srdf]") {
  const std::string notes =
      notesOn("<link_sphere_approximation link=\"a\"/><link_sphere_approximation link=\"b\"/><passive_joint name=\"elbow\" x=\"1\"/>");
  CHECK_THAT(notes, containing("r.srdf: ignored: <link_sphere_approximation> in <robot>, 2 times, first at line 1"));
  CHECK_THAT(notes, containing("attribute x of <passive_joint>"));
}

TEST_CASE("a virtual joint of another type than the root joint is noted, and its states are left out", "[srdf]") {
  Model model = complete("fixed");
  REQUIRE(model.notes.size() == 2);  // of the joint, and of the group with the joint
  CHECK_THAT(model.notes[0], containing("'world_joint' is of type planar") && containing("root joint 'root_joint' of type fixed; --root planar"));
  const CompactModel compact = compile(model, registry());
  CHECK(namedConfiguration(compact, model, "parked").size() == compact.nq());
}

TEST_CASE("a malformed SRDF is refused with its line and leaves the model as it was", "[srdf]") {
  Model model = described();
  const auto refused = [&](const std::string& elements, const std::string& message) {
    INFO(elements);
    CHECK_THROWS_WITH(srdf::parse("<robot name=\"r\"><group name=\"ok\"/>\n" + elements + "</robot>", "r.srdf", model),
                      containing("r.srdf:2") && containing(message));
    CHECK(model.groups.empty());
    CHECK(model.notes.empty());
  };
  refused("<group/>", "no attribute 'name'");
  refused("<group name=\"ok\"/>", "two groups are called 'ok'");
  refused("<group_state name=\"s\" group=\"ok\"><joint name=\"elbow\" value=\"1,5\"/></group_state>", "1,5");
  refused("<group_state name=\"s\" group=\"ok\"><joint name=\"elbow\" value=\"\"/></group_state>", "no number");
  refused("<group_state name=\"s\" group=\"ok\"><joint name=\"elbow\" value=\"1\"/><joint name=\"elbow\" value=\"1\"/></group_state>", "twice");
  refused("<virtual_joint name=\"v\" type=\"ball\" parent_frame=\"odom\" child_link=\"cart\"/>", "unknown type 'ball'");
}
