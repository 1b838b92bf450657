// SPDX-License-Identifier: BSD-2-Clause
// The commands dyn simulate and dyn collide.
#include "command.hpp"

#include <nlohmann/json.hpp>

#include <fstream>

using namespace dyn::test;

namespace fs = std::filesystem;

TEST_CASE("collide says what touches and how far the rest is, and learns which pairs never do", "[command]") {
  const std::string arm = DYN_SOURCE_DIR "/models/arm.urdf";
  const Folder folder;
  const std::string states = folder.write("s.json", R"({"samples":[{"q":[0,0,0,0,0,0,0]},{"q":[0,1.5,0,2,0,2,0]}]})");
  const std::string scene = folder.write("scene.urdf", R"(<robot name="scene"><link name="table"><collision><origin xyz="0 0 1.4"/>
      <geometry><box size="2 2 0.1"/></geometry></collision></link></robot>)");
  const Answer answer = run("collide '" + arm + "' --scene '" + scene + "' --states '" + states + "'");
  REQUIRE(answer.code == 0);
  const auto json = nlohmann::json::parse(answer.out);
  CHECK(json["states"].size() == 2);
  // The arm is upright and its flange ends at z = 1.3 m. The table's underside is at 1.35 m.
  CHECK(json["states"][0]["collisions"].empty());
  CHECK(json["states"][0]["minimum"]["a"] == "flange_0");
  CHECK(json["states"][0]["minimum"]["b"] == "scene/table_0");
  CHECK(json["states"][0]["minimum"]["distance"].get<double>() == approx(0.05).epsilon(1e-9));
  for (const auto& hit : json["states"][1]["collisions"]) CHECK(hit["depth"].get<double>() >= 0);
  CHECK(nlohmann::json::parse(run("collide '" + arm + "' --distances").out)["states"][0]["distances"].size() == json["pairs"].get<std::size_t>() - 7);

  const std::string fcl = "collide '" + arm + "' --scene '" + scene + "' --narrow fcl";
  const auto by_fcl = nlohmann::json::parse(run(fcl + " --fcl-tolerance 1e-9").out);
  CHECK(by_fcl["report"].back() == "narrow phase: FCL's, to 1e-09 m");
  CHECK(std::abs(by_fcl["states"][0]["minimum"]["distance"].get<double>() - 0.05) < 1e-5);
  CHECK_THAT(run(fcl + " --fcl-tolerance -1").err, containing("fcl_tolerance is -1"));
  CHECK(run("collide '" + arm + "' --narrow bullet").code == 2);
  const Answer without = run("collide '" + arm + "' --fcl-tolerance 1e-9");
  CHECK(without.code == 2);
  CHECK_THAT(without.err, containing("--fcl-tolerance") && containing("needs --narrow fcl"));

  const std::string srdf = (folder.path / "arm.srdf").string();
  const Answer learned = run("collide '" + arm + "' --learn 500 --out '" + srdf + "'");
  REQUIRE(learned.code == 0);
  CHECK_THAT(learned.err, containing("never do"));
  CHECK_THAT(textOf(srdf), containing("reason=\"Never\""));
  const auto fewer = nlohmann::json::parse(run("collide '" + arm + "' --srdf '" + srdf + "'").out);
  CHECK(fewer["pairs"] < json["pairs"]);
  CHECK_THAT(run("collide '" + arm + "' --learn 50").out, containing("<disable_collisions"));

  const Answer refused = run("collide '" + arm + "' --srdf /nowhere.srdf");
  CHECK(refused.code == 1);
  CHECK_THAT(refused.err, containing("/nowhere.srdf"));
  const std::string mesh =
      folder.write("mesh.urdf", R"(<robot name="m"><link name="a"><collision><geometry><mesh filename="package://p/a.stl"/></geometry>
      </collision></link></robot>)");
  CHECK_THAT(run("collide '" + mesh + "' --root free_flyer --scene '" + scene + "'").err, containing("package://p/a.stl"));
  CHECK(run("collide '" + mesh + "' --root free_flyer --scene '" + scene + "' --skip-missing").code == 0);
}

TEST_CASE("simulate writes what it passed through, and says what was kept", "[command][simulate]") {
  const Folder folder;
  const std::string csv = (folder.path / "out.csv").string(), json = (folder.path / "out.json").string(), svg = (folder.path / "out.svg").string();
  const std::string robot = "simulate " + biped + " --root free_flyer --time 0.05 --dt 0.001 ";
  for (const char* integrator : {"semi_implicit_euler", "rk4", "dormand_prince", "implicit_midpoint", "gauss6", "radau5", "variational"}) {
    const Answer a = run(robot + "--integrator " + integrator + " --out " + csv);
    INFO(integrator << a.err);
    CHECK(a.code == 0);
    CHECK_THAT(a.out, containing("steps/s"));
    CHECK_THAT(a.out, containing("momentum: linear changed by"));
  }
  const std::string table = textOf(csv);
  CHECK(table.rfind("t,q:", 0) == 0);
  CHECK(std::count(table.begin(), table.end(), '\n') == 52);  // the header, the first state and one state after each step
  CHECK(run(robot + "--out " + json + " --plot " + svg + " --every 0.01").code == 0);
  const nlohmann::json states = nlohmann::json::parse(textOf(json));
  CHECK(states["states"].size() == 6);
  CHECK(states["states"][5]["t"] == 0.05);
  CHECK_THAT(textOf(svg), containing("</svg>"));

  // A run in two parts gives the same as the whole run.
  const std::string saved = (folder.path / "saved").string(), whole = (folder.path / "whole").string(), halves = (folder.path / "halves").string();
  CHECK(run(robot + "--save " + whole).code == 0);
  CHECK(run("simulate " + biped + " --root free_flyer --time 0.02 --save " + saved).code == 0);
  CHECK(run("simulate " + biped + " --root free_flyer --time 0.03 --resume " + saved + " --save " + halves).code == 0);
  CHECK(textOf(whole) == textOf(halves));

  const Answer loop = run("simulate " DYN_SOURCE_DIR "/models/four_bar.urdf --time 0.1");
  CHECK_THAT(loop.out, containing("constraints: 5 rows"));
  const Answer stands = run("simulate " + biped + " --root free_flyer --time 0.01 --contacts left_foot:6d,right_foot:6d");
  INFO(stands.err);
  CHECK_THAT(stands.out, containing("constraints: 12 rows"));
  const Answer falls = run("simulate " DYN_SOURCE_DIR "/models/arm.urdf --time 0.3 --limits --restitution 0.2");
  CHECK(falls.code == 0);
}

TEST_CASE("simulate lets bodies touch by their volumes", "[command][simulate]") {
  const Folder folder;
  const std::string table = (folder.path / "table.urdf").string(), arm = "simulate " DYN_SOURCE_DIR "/models/arm.urdf --root free_flyer --time 1 ";
  std::ofstream(table) << R"(<robot name="table"><link name="table"><collision name="top"><origin xyz="0 0 -1"/>
    <geometry><box size="10 10 1"/></geometry></collision></link></robot>)";
  const auto energy = [](const Answer& a) { return std::stod(a.out.substr(a.out.find("at first, ") + 10)); };
  const Answer lies = run(arm + "--touching --scene " + table), falls = run(arm);
  CHECK_THAT(lies.out, containing("steps in touch"));
  CHECK(energy(falls) > 100);  // it keeps all of its initial energy
  CHECK(energy(lies) < 10);
  CHECK_THAT(run(arm + "--scene " + table).err, containing("requires --touching"));
  CHECK_THAT(run(arm + "--touching --scene nowhere.urdf").err, containing("nowhere.urdf"));
}

TEST_CASE("simulate refuses what makes no sense, and keeps what there was of a motion that broke off", "[command][simulate]") {
  const Folder folder;
  const auto fails = [](const std::string& line, const std::string& why, int code = 1) {
    const Answer a = run("simulate " + line);
    INFO(line << a.err);
    CHECK(a.code == code);
    CHECK_THAT(a.err, containing(why));
  };
  fails(biped + " --dt 0", "must be positive", 2);
  fails(biped + " --dt=-1", "must be positive", 2);
  fails(biped + " --dt nan", "is no number", 2);
  fails(biped + " --time=-1", "must be 0 or more", 2);
  fails(biped + " --time inf", "must be 0 or more", 2);
  fails(biped + " --integrator leapfrog", "leapfrog", 2);
  fails(biped + " --out trajectory.txt", ".csv or .json", 2);
  fails(biped + " --every 1e-12", "larger --every");
  fails(biped + " --every=-0.1", "--every", 2);
  fails(biped + " --tolerance=-1", "tolerance", 2);
  fails(biped + " --ground nowhere", "no frame 'nowhere'");
  fails(biped + " --resume " + (folder.path / "missing").string(), "does not exist");
  fails(biped + " --restitution 2", "restitution", 2);
  fails("missing.urdf", "missing.urdf");
  for (const char* option : {"--out none/x.csv", "--plot none/x.svg", "--save none/x"}) {
    // The error must come before the run, not after it.
    const Answer a = run("simulate " + biped + " --time 0.01 " + option);
    CHECK(a.code == 1);
    CHECK_THAT(a.err, containing("none/x") && containing("cannot be written"));
    CHECK_THAT(a.out, !containing("steps/s"));
  }
  fails(biped + " --resume there --state here", "--state", 2);
  const fs::path broken = folder.path / "state.json", out = folder.path / "out.csv";
  std::ofstream(broken) << R"({"samples":[{"q":[NaN]}]})";
  fails(biped + " --state " + broken.string(), "not finite");
  // The squares of these speeds overflow.
  std::ofstream(broken) << R"({"samples":[{"q":[0.1,0.1,0.1,0.1,0.1,0.1,0.1],"v":[1e160,1e160,1e160,1e160,1e160,1e160,1e160]}]})";
  fails(DYN_SOURCE_DIR "/models/arm.urdf --state " + broken.string() + " --out " + out.string(), "the energy is not finite");
  CHECK_FALSE(fs::exists(out));
  // These speeds grow until they overflow.
  std::ofstream(broken) << R"({"samples":[{"q":[0.1,0.1,0.1,0.1,0.1,0.1,0.1],"v":[1e100,1e100,1e100,1e100,1e100,1e100,1e100]}]})";
  fails(DYN_SOURCE_DIR "/models/arm.urdf --state " + broken.string() + " --out " + out.string(), "t = ");
  const std::string kept = textOf(out);
  CHECK(std::count(kept.begin(), kept.end(), '\n') == 2);  // the header and the first state
}
