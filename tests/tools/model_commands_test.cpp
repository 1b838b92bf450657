// SPDX-License-Identifier: BSD-2-Clause
// dyn with named states, dyn diff, and dyn convert to URDF and MJCF.
#include "command.hpp"
#include "support/catch.hpp"

#include <nlohmann/json.hpp>

using namespace dyn::test;

namespace {

const std::string arm = DYN_SOURCE_DIR "/models/arm.urdf";
const char* const semantics = R"(<robot name="arm"><group name="arm"><chain base_link="base" tip_link="flange"/></group>
  <group_state name="bent" group="arm"><joint name="bend" value="0.5"/></group_state>
  <group_state name="broken" group="arm"><joint name="bend" value="50"/></group_state></robot>)";

/// Converts each of our models from a file with this ending to `out`, and checks that nothing is lost and nothing differs.
void checkConverted(const std::string& ending, const std::string& out) {
  for (const char* name : {"arm", "biped", "cart", "four_bar"}) {
    INFO(name);
    const std::string model = std::string(DYN_SOURCE_DIR "/models/") + name + ending;
    const Answer converted = run("convert '" + model + "' '" + out + "'");
    CHECK(converted.code == 0);
    CHECK_THAT(converted.err, !containing("cannot say"));
    const Answer difference = run("diff '" + model + "' '" + out + "'");
    INFO(difference.out);
    CHECK(difference.code == 0);
  }
}

}  // namespace

TEST_CASE("every subcommand that takes a configuration takes the name of a state", "[command]") {
  const Folder folder;
  const std::string with = "'" + arm + "' --srdf '" + folder.write("arm.srdf", semantics) + "' ";
  const Answer computed = run("compute " + with + "--q bent --only rnea");
  INFO(computed.err);
  REQUIRE(computed.code == 0);
  const auto document = nlohmann::json::parse(computed.out);
  REQUIRE(document["samples"].size() == 1);
  for (const auto& joint : document["joints"])
    CHECK(document["samples"][0]["q"][joint["idx_q"].get<std::size_t>()] == (joint["name"] == "bend" ? 0.5 : 0.0));
  CHECK(run("compute " + with + "--q arm/bent --only rnea").out == computed.out);
  const auto collided = nlohmann::json::parse(run("collide " + with + "--q bent").out);
  CHECK(collided["states"][0]["minimum"] != nlohmann::json::parse(run("collide " + with).out)["states"][0]["minimum"]);
  const std::string out = (folder.path / "out.json").string();
  REQUIRE(run("simulate " + with + "--q bent --time 0.001 --out '" + out + "'").code == 0);
  CHECK(nlohmann::json::parse(textOf(out))["states"][0]["q"] == document["samples"][0]["q"]);
  REQUIRE(run("truth " + with + "--q bent --out '" + out + "'").code == 0);
  CHECK(nlohmann::json::parse(textOf(out))["samples"][0]["q"] == document["samples"][0]["q"]);
  CHECK_THAT(run("info " + with).out, containing("arm/bent: 1 joints") && containing("arm: shoulder1, shoulder2"));
  const Answer checked = run("check " + with + "--q bent");
  CHECK(checked.code == 0);
  CHECK_THAT(checked.out, containing("state 'arm/broken': joint 'bend' is outside of its limits"));

  const Answer misspelt = run("compute " + with + "--q bnet");
  CHECK(misspelt.code == 1);
  CHECK_THAT(misspelt.err, containing("no state 'bnet'; did you mean 'bent'"));
  CHECK_THAT(run("compute '" + arm + "' --q bent").err, containing("no named states"));
  const Answer neither = run("compute '" + arm + "'");
  CHECK(neither.code == 2);
  CHECK_THAT(neither.err, containing("--states or --q"));
  CHECK(run("compute " + with + "--q bent --states x.json").code == 2);
}

TEST_CASE("diff lists differences as a table or JSON, and its exit code tells them", "[command]") {
  const Folder folder;
  std::string text = textOf(arm);
  const std::size_t place = text.find("xyz=\"0 0 0.16\"");
  REQUIRE(place != std::string::npos);
  const std::string other = folder.write("other.urdf", text.replace(place, 14, "xyz=\"0 0 0.17\""));
  const Answer same = run("diff '" + arm + "' '" + arm + "'");
  CHECK(same.code == 0);
  CHECK(same.out == "no differences\n");
  const Answer found = run("diff '" + arm + "' '" + other + "'");
  CHECK(found.code == 1);
  CHECK_THAT(found.out, containing("placement  shoulder1  position [m]  0 0 0.16  0 0 0.17  10 mm") && containing("1 differences"));
  CHECK(run("diff '" + arm + "' '" + other + "' --tolerance 0.02").code == 0);
  const Answer json = run("diff '" + arm + "' '" + other + "' --json");
  CHECK(json.code == 1);
  const auto document = nlohmann::json::parse(json.out);
  CHECK(document["equal"] == false);
  CHECK(document["differences"][0]["name"] == "shoulder1");
  CHECK(run("diff '" + arm + "' /nowhere.urdf").code == 1);
  CHECK(run("diff '" + arm + "'").code == 2);
}

TEST_CASE("convert writes URDF that differs in nothing, and says what URDF cannot hold", "[command]") {
  const Folder folder;
  const std::string out = (folder.path / "out.urdf").string();
  checkConverted(".urdf", out);
  const Answer lost = run("convert '" + arm + "' '" + out + "' --srdf '" + folder.write("arm.srdf", semantics) + "'");
  CHECK(lost.code == 0);
  CHECK_THAT(lost.err, containing("URDF cannot say groups (an SRDF has them) of 'arm'"));
  CHECK(run("convert '" + arm + "' '" + (folder.path / "out.sdf").string() + "'").code == 2);
}

TEST_CASE("convert writes MJCF by the ending of the file, and says what MJCF cannot hold", "[command]") {
  const Folder folder;
  for (const char* ending : {"out.xml", "out.mjcf"}) {
    const std::string out = (folder.path / ending).string();
    checkConverted(".xml", out);
    const Answer lost = run("convert '" + arm + "' '" + out + "'");
    CHECK(lost.code == 0);
    CHECK_THAT(lost.err, containing("MJCF cannot say limits of velocity"));
  }
  const std::string none = (folder.path / "none.xml").string();
  const Answer refused = run("convert " DYN_SOURCE_DIR "/tests/truth/references/many_axes.urdf '" + none + "'");
  CHECK(refused.code == 1);
  CHECK_THAT(refused.err, containing("is not made of free, ball, hinge and slide"));
  CHECK_FALSE(std::filesystem::exists(none));
}

TEST_CASE("convert --embed-meshes writes a file that needs no meshes", "[command]") {
  const Folder folder;
  folder.write("tip.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
  const std::string mesh = "<collision><geometry><mesh filename=\"", end = "\"/></geometry></collision>";
  const std::string robot =
      folder.write("robot.urdf", "<robot name='r'><link name='a'>" + mesh + "tip.obj" + end + mesh + "none.obj" + end + "</link></robot>");
  const std::string out = (folder.path / "out.dyn.json").string(), convert = "convert '" + robot + "' '" + out + "' ";
  REQUIRE(run(convert).code == 0);
  CHECK_THAT(textOf(out), containing("mesh_file"));
  const Answer embedded = run(convert + "--embed-meshes");
  INFO(embedded.err);
  REQUIRE(embedded.code == 0);
  CHECK_THAT(embedded.out, containing("embedded 1 files in 1 volumes"));
  CHECK_THAT(embedded.err, containing("not embedded: volume 'a_1' (none.obj): the file is not there"));
  const auto shapes = nlohmann::json::parse(textOf(out))["geometries"];
  CHECK(shapes[0]["shape"]["mesh"]["triangles"].size() == 4);
  CHECK(shapes[1]["shape"]["mesh_file"]["uri"] == "none.obj");
  CHECK_THAT(run(convert + "--embed-meshes --largest-mesh 0.00001").err, containing("tip.obj): the file has"));
  CHECK(run(convert + "--largest-mesh 1").code == 2);
  const Answer urdf = run("convert '" + robot + "' '" + (folder.path / "out.urdf").string() + "' --embed-meshes");
  CHECK(urdf.code == 2);
  CHECK_THAT(urdf.err, containing("URDF names meshes by files"));
}
