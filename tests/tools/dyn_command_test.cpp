// The command dyn as a user runs it: exit codes, keys, messages; every subcommand on good and on broken input.
#include "errors.hpp"
#include "support/folder.hpp"
#include "support/shared.hpp"

#include <sys/wait.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>

using namespace dyn::test;
using namespace dyn::tool;

namespace {

namespace fs = std::filesystem;

const std::string biped = DYN_SOURCE_DIR "/models/biped.urdf";

std::string textOf(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

struct Answer {
  int code;
  std::string out, err;
};

Answer run(const std::string& arguments) {
  const Folder folder;
  const fs::path out = folder.path / "out", err = folder.path / "err";
  const std::string command = "'" DYN_BINARY_DIR "/bin/dyn' " + arguments + " >'" + out.string() + "' 2>'" + err.string() + "' </dev/null";
  const int status = std::system(command.c_str());
  REQUIRE(WIFEXITED(status));
  return {WEXITSTATUS(status), textOf(out), textOf(err)};
}

const std::string zero_state = R"({"samples":[{"q":[0,0,0,0,0,0,1)" + [] {
  std::string rest;
  for (int i = 0; i < 16; ++i) rest += ",0.1";
  return rest;
}() + "]}]}";

}  // namespace

TEST_CASE("help is there for every subcommand, and a wrong command line exits with 2", "[command]") {
  for (const char* sub : {"", "accuracy", "info", "check", "codegen", "collide", "compute", "demo", "bench", "profile", "plugin", "plugin list",
                          "plugin check", "plugin new", "simulate"}) {
    const Answer a = run(std::string(sub) + " --help");
    INFO(sub << a.err);
    CHECK(a.code == 0);
    CHECK_THAT(a.out, containing("--help"));
  }
  const std::vector<std::string> wrong = {"",
                                          "fly",
                                          "info",
                                          "info " + biped + " --order backwards",
                                          "compute x.urdf",
                                          "compute x.urdf --states x.json --only rnea,fly",
                                          "codegen x.urdf --functions fly",
                                          "codegen x.urdf --functions rnea --lanes 3",
                                          "plugin",
                                          "plugin check",
                                          "bench x.urdf --unknown-option",
                                          "accuracy --instruction-sets mmx"};
  for (const std::string& line : wrong) {
    const Answer a = run(line);
    INFO(line);
    CHECK(a.code == 2);
    CHECK(!a.err.empty());
    CHECK(a.out.empty());
  }
}

TEST_CASE("a word that is no subcommand is named, with those that there are", "[command]") {
  const Answer a = run("fly robot.urdf"), b = run("plugin fly");
  CHECK(a.code == 2);
  CHECK_THAT(a.err, containing("'fly'") && containing("info, ") && containing("simulate"));
  CHECK(b.code == 2);
  CHECK_THAT(b.err, containing("'fly'") && containing("list, ") && !containing("simulate"));
  CHECK(run("fly --help").code == 0);
}

TEST_CASE("a robot that cannot be read exits with 1 and says file and reason, in every subcommand", "[command]") {
  const Folder folder;
  const std::string broken = folder.write("broken.urdf", "<robot name='r'>\n<link name='a'/>\n<link name='a'/>\n</robot>\n");
  const std::string states = folder.write("states.json", R"({"samples":[]})");
  for (const std::string sub : {"info", "check", "codegen", "collide", "compute", "demo", "bench", "profile"}) {
    INFO(sub);
    const std::string extra = sub == "compute" ? " --states " + states : sub == "codegen" ? " --functions rnea" : "";
    const Answer missing = run(sub + " /nowhere/robot.urdf" + extra), bad = run(sub + " " + broken + extra);
    CHECK(missing.code == 1);
    CHECK_THAT(missing.err, containing("/nowhere/robot.urdf") && containing("does not exist"));
    CHECK(bad.code == 1);
    CHECK_THAT(bad.err, containing("broken.urdf:3") && containing("two links are called 'a'"));
    const Answer root = run(sub + " " + biped + " --root no_such_joint" + extra);
    CHECK(root.code == 1);
    CHECK_THAT(root.err, containing("no_such_joint"));
  }
}

TEST_CASE("info tells plugins, types, passes and the tree", "[command]") {
  const Answer a = run("info " + biped + " --root free_flyer");
  CHECK(a.code == 0);
  for (const char* part :
       {"dyn_standard.so", "revolute", "closed form", "weld:", "canonicalise:", "data:", "root_joint", "|- ", "frames", "left_foot"})
    CHECK_THAT(a.out, containing(part));
}

TEST_CASE("a robot of one link has a demo", "[command]") {
  const Folder folder;
  const Answer a = run("demo '" + folder.write("still.urdf", R"(<robot name="still"><link name="a"/></robot>)") + "'");
  CHECK(a.code == 0);
  CHECK_THAT(a.out, containing("kinetic energy 0 J"));
}

TEST_CASE("what has no mass has all results but those of its centre of mass", "[command]") {
  const Folder folder;
  const std::string robot = folder.write("light.urdf", R"(<robot name="light"><link name="a"/><link name="b"/>
<joint name="j" type="continuous"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/></joint></robot>)");
  const std::string states = folder.write("states.json", R"({"samples":[{"q":[1,0]}]})");
  const Answer a = run("compute '" + robot + "' --states '" + states + "'");
  INFO(a.err);
  REQUIRE(a.code == 0);
  const nlohmann::json sample = nlohmann::json::parse(a.out)["samples"][0];
  CHECK(sample["rnea"] == nlohmann::json{0.0});
  for (const std::string key : {"com", "vcom", "acom", "Jcom", "hg", "aba"}) {
    INFO(key);
    CHECK(sample[key].is_null());
    CHECK_THAT(sample[key + "_error"].get<std::string>(), containing("mass"));
  }
  CHECK(run("compute '" + robot + "' --states '" + states + "' --only com").code == 1);
}

TEST_CASE("check reports all errors of a file and exits with 1; a sound robot exits with 0", "[command]") {
  CHECK(run("check " + biped).code == 0);
  const Folder folder;
  const std::string robot = folder.write("robot.urdf", R"(<robot name="r">
<link name="a"/>
<link name="b"><inertial><mass value="-1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
<link name="c"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="9"/></inertial></link>
<link name="c"/>
<joint name="j" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 0 0"/></joint>
<joint name="k" type="revolute"><parent link="b"/><child link="c"/><axis xyz="0 0 1"/></joint>
<link name="island"/>
</robot>
)");
  const Answer a = run("check " + robot);
  CHECK(a.code == 1);
  for (const char* part :
       {"robot.urdf:3", "mass is negative", "robot.urdf:5", "two links are called 'c'", "robot.urdf:6", "axis is zero", "'island'"})
    CHECK_THAT(a.err, containing(part));

  const std::string odd = folder.write("odd.urdf", R"(<robot name="r">
<link name="a"/>
<link name="b"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="9"/></inertial></link>
<link name="c"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
<link name="d"/>
<joint name="j" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/></joint>
<joint name="k" type="continuous"><parent link="b"/><child link="c"/><axis xyz="0 0 1"/><mimic joint="j"/></joint>
<joint name="l" type="continuous"><parent link="c"/><child link="d"/><axis xyz="0 0 1"/><mimic joint="k"/></joint>
</robot>
)");
  const Answer b = run("check " + odd);
  CHECK(b.code == 1);  // link d has no mass, so M is singular
  CHECK_THAT(b.err, containing("singular") && containing("'l'"));
  for (const char* part : {"triangle", "has no <limit>", "mimics another joint", "moves nothing that has mass"}) CHECK_THAT(b.out, containing(part));
}

TEST_CASE("states that cannot be used are refused with the sample's number", "[command]") {
  const Folder folder;
  const auto compute = [&](const std::string& states) {
    return run("compute " + biped + " --root free_flyer --states " + folder.write("states.json", states));
  };
  const auto refused = [&](const std::string& states, const std::string& why) {
    const Answer a = compute(states);
    INFO(states << "\n" << a.err);
    CHECK(a.code == 1);
    CHECK(a.out.empty());
    CHECK_THAT(a.err, containing(why) && containing("states.json"));
  };
  CHECK(compute(zero_state).code == 0);
  refused("", "not JSON");
  refused("[1,2", "not JSON");
  refused("{}", "samples");
  refused(R"({"samples":[1]})", "sample 0");
  refused(R"({"samples":[{"v":[]}]})", "sample 0: q is missing");
  refused(R"({"samples":[{"q":[1,2]}]})", "sample 0: q has 2 entries");
  refused(R"({"samples":[{"q":"x"}]})", "sample 0: q is not an array");
  std::string second = zero_state;
  second.insert(second.rfind("]}"), "," + zero_state.substr(zero_state.find("{\"q\""), zero_state.rfind("]}") - zero_state.find("{\"q\"")));
  CHECK(compute(second).code == 0);
  for (const char* number : {"NaN", "Infinity", "-Infinity", "1e999"}) {
    std::string bad = second;
    bad.replace(bad.rfind("0.1"), 3, number);
    INFO(number);
    const Answer a = compute(bad);
    CHECK(a.code == 1);
    CHECK_THAT(a.err, containing("sample 1") && containing("not finite"));
  }
  CHECK(run("compute " + biped + " --states /nowhere.json").code == 1);
  const std::string fine = folder.write("fine.json", zero_state);
  CHECK_THAT(run("compute " + biped + " --root free_flyer --states " + fine + " --only speed").err, containing("speed"));
  CHECK_THAT(run("compute " + biped + " --root free_flyer --states " + fine + " --frames nose").err, containing("nose"));
}

TEST_CASE("compute knows contacts by frames", "[command]") {
  const Folder folder;
  const std::string states = folder.write("states.json", zero_state), line = "compute " + biped + " --root free_flyer --states " + states;
  const Answer all = run(line + " --contacts left_foot:6d,right_foot:3d");
  INFO(all.err);
  CHECK(all.code == 0);
  const nlohmann::json sample = nlohmann::json::parse(all.out)["samples"][0];
  for (const char* key : {"contact_lambda", "contact_gamma", "impulse_lambda", "impulse_restitution_0.5_lambda"}) CHECK(sample[key].size() == 9);
  for (const char* key : {"contact_ddq", "impulse_v_after", "impulse_restitution_0.5_v_after"}) CHECK(sample[key].size() == sample["v"].size());
  CHECK(sample["contact_J"].size() == 9 * sample["v"].size());
  CHECK(sample.contains("rnea"));
  const nlohmann::json one = nlohmann::json::parse(run(line + " --contacts left_foot:6d --only contact_ddq").out)["samples"][0];
  CHECK(one.contains("contact_ddq"));
  CHECK_FALSE(one.contains("contact_lambda"));
  CHECK_FALSE(one.contains("rnea"));
  CHECK_THAT(run(line + " --contacts left_foot").err, containing("FRAME:6d or FRAME:3d"));
  CHECK_THAT(run(line + " --contacts nose:6d").err, containing("no body or frame 'nose'"));
  CHECK_THAT(run(line + " --contacts left_foot:6d,left_foot:3d").err, containing("two constraints of that name"));
  CHECK_THAT(run(line + " --only contact_ddq").err, containing("name the contacts"));
}

TEST_CASE("compute takes a golden file as it is and answers with its keys", "[command]") {
  DYN_NEEDS_SHARED();
  const std::string file = sharedFolder() + "/golden/hyq.json";
  const nlohmann::json golden = readJson(file);
  std::string frames;
  for (const auto& frame : golden["jacobian_frames"]) frames += (frames.empty() ? "" : ",") + frame["name"].get<std::string>();
  const Answer a = run("compute " + sharedFolder() + "/models/" + golden["file"].get<std::string>() + " --root " + golden["root"].get<std::string>() +
                       " --states " + file + " --frames " + frames);
  REQUIRE(a.code == 0);
  const nlohmann::json answer = nlohmann::json::parse(a.out);
  for (const char* key : {"robot", "root", "nq", "nv", "gravity"}) CHECK(answer[key] == golden[key]);
  REQUIRE(answer["joints"].size() == golden["joints"].size());
  for (std::size_t j = 0; j < golden["joints"].size(); ++j)
    for (const char* key : {"name", "parent", "idx_q", "idx_v", "nq", "nv"}) CHECK(answer["joints"][j][key] == golden["joints"][j][key]);
  REQUIRE(answer["samples"].size() == golden["samples"].size());
  const nlohmann::json &x = answer["samples"][3], &y = golden["samples"][3];
  for (const char* key : {"rnea",
                          "nle",
                          "gravity_torque",
                          "M",
                          "aba",
                          "com",
                          "vcom",
                          "acom",
                          "Jcom",
                          "frame0_J_local",
                          "frame1_dJ_local",
                          "frame0_J_world",
                          "frame1_velocity_local",
                          "frame0_acceleration_world_aligned_classical",
                          "Minv",
                          "dtau_dq",
                          "dtau_dv",
                          "ddq_dq",
                          "ddq_dv",
                          "hg",
                          "Ag",
                          "dAg",
                          "dhg",
                          "coriolis_matrix",
                          "dhg_dq",
                          "dhgdot_dq",
                          "dhgdot_dv",
                          "dhgdot_da"}) {
    INFO(key);
    CHECK(relativeError(x[key].get<std::vector<double>>(), flatten(y[key])) < 200);
  }
  for (std::size_t f = 0; f < y["oMf"].size(); ++f) CHECK(x["oMf"][f]["name"] == y["oMf"][f]["name"]);

  const Answer only =
      run("compute " + sharedFolder() + "/models/" + golden["file"].get<std::string>() + " --root free_flyer --only M,rnea --states " + file);
  const nlohmann::json sample = nlohmann::json::parse(only.out)["samples"][0];
  CHECK(sample.contains("M"));
  CHECK(!sample.contains("aba"));
}

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
  // The arm stands upright, its flange ends at z = 1.3 m; the table's underside is at 1.35 m.
  CHECK(json["states"][0]["collisions"].empty());
  CHECK(json["states"][0]["minimum"]["a"] == "flange_0");
  CHECK(json["states"][0]["minimum"]["b"] == "scene/table_0");
  CHECK(json["states"][0]["minimum"]["distance"].get<double>() == approx(0.05).epsilon(1e-9));
  for (const auto& hit : json["states"][1]["collisions"]) CHECK(hit["depth"].get<double>() >= 0);
  CHECK(nlohmann::json::parse(run("collide '" + arm + "' --distances").out)["states"][0]["distances"].size() == json["pairs"].get<std::size_t>() - 7);

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

TEST_CASE("codegen writes source that compiles anywhere and passes its own test", "[command]") {
  const Folder folder;
  const std::string out = (folder.path / "generated").string(), arm = DYN_SOURCE_DIR "/models/arm.urdf";
  for (const std::string how : {"", " --lanes 4", " --float"}) {
    INFO(how);
    const Answer a = run("codegen '" + arm + "' --functions rnea,crba,aba,rnea_derivatives,frames --out '" + out + "'" + how);
    REQUIRE(a.code == 0);
    CHECK_THAT(a.out, containing("rnea") && containing("operations"));
    const std::string program = (folder.path / "test").string();
    const std::string c =
        "cd '" + out + "' && cc -std=c99 -O1 -Wall -Werror arm.c arm_test.c -lm -o '" + program + "' && '" + program + "' >/dev/null";
    CHECK(std::system(c.c_str()) == 0);
  }
  CHECK_THAT(textOf(fs::path(out) / "arm.h"), containing("void rnea(const dyn_real* q, const dyn_real* v, const dyn_real* a, dyn_real* tau)"));
  CHECK_THAT(textOf(fs::path(out) / "CMakeLists.txt"), containing("add_test"));
  const Answer unknown = run("codegen '" + arm + "' --functions fly");
  CHECK(unknown.code == 2);
  CHECK_THAT(unknown.err, containing("fly") && containing("rnea"));
  CHECK(run("codegen '" + arm + "' --functions rnea --out /proc/none").code == 1);
  const Answer vectors = run("codegen '" + arm + "' --functions rnea --plain --lanes 4");
  CHECK(vectors.code == 1);
  CHECK_THAT(vectors.err, containing("--plain"));
}

TEST_CASE("codegen of a robot called as libraries and targets are, and where M is singular, builds and passes its test", "[command]") {
  const Folder folder;
  for (const std::string name : {"m", "test", "all"}) {
    INFO(name);
    const std::string robot = folder.write(name + ".urdf", "<robot name='" + name + R"('><link name="a"/><link name="b"/><link name="c"/>
<joint name="j" type="continuous"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/></joint>
<joint name="k" type="revolute"><parent link="b"/><child link="c"/><axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
</robot>)");
    const std::string out = (folder.path / ("of_" + name)).string();
    const Answer a = run("codegen '" + robot + "' --functions rnea,aba,minverse --prefix robot_ --out '" + out + "'");
    INFO(a.err);
    REQUIRE(a.code == 0);
    CHECK_THAT(textOf(fs::path(out) / (name + ".h")), containing("void robot_aba(") && !containing("void aba("));
    const std::string build = "cd '" + out + "' && { cmake -S . -B build && cmake --build build && cd build && ctest -V; } >log 2>&1";
    const int built = std::system(build.c_str());
    const std::string log = textOf(fs::path(out) / "log");
    INFO(log);
    CHECK(built == 0);
    CHECK_THAT(log, containing("not compared") && !containing("warning"));
  }
}

TEST_CASE("codegen of a robot that does not move compiles, too", "[command]") {
  const Folder folder;
  const std::string still = folder.write("still.urdf", R"(<robot name="still"><link name="a"/><link name="b"/>
<joint name="j" type="fixed"><parent link="a"/><child link="b"/><origin xyz="0 0 1"/></joint></robot>)");
  const std::string out = (folder.path / "generated").string();
  for (const std::string how : {"", " --lanes 4"}) {
    INFO(how);
    const Answer a = run("codegen '" + still + "' --functions rnea,crba,frames,centroidal_map --out '" + out + "'" + how);
    INFO(a.err);
    REQUIRE(a.code == 0);
    CHECK(std::system(("cd '" + out + "' && cc -std=c99 -pedantic -Wall -Werror still.c still_test.c -lm -o t && ./t >/dev/null").c_str()) == 0);
  }
}

TEST_CASE("where the output is lost the exit code says so", "[command]") {
  if (!fs::exists("/dev/full")) {
    WARN("skipped: there is no /dev/full");
    return;
  }
  const Folder folder;
  const fs::path err = folder.path / "err";
  for (const std::string what : {"info '" + biped + "'", std::string("plugin list"), std::string("info --help")}) {
    INFO(what);
    const int status = std::system(("'" DYN_BINARY_DIR "/bin/dyn' " + what + " >/dev/full 2>'" + err.string() + "'").c_str());
    CHECK(WEXITSTATUS(status) == 1);
    CHECK_THAT(textOf(err), containing("output"));
  }
  CHECK(std::system(("'" DYN_BINARY_DIR "/bin/dyn' info '" + biped + "' >/dev/null").c_str()) == 0);
}

TEST_CASE("where the mass matrix is singular aba says so", "[command]") {
  DYN_NEEDS_SHARED();
  const Folder folder;
  const std::string robot = sharedFolder() + "/models/romeo.urdf";
  const Answer info = run("info " + robot);
  REQUIRE(info.code == 0);
  const Answer bench = run("bench " + robot + " --json");
  CHECK_THAT(bench.err, containing("aba") && containing("singular"));
  CHECK_THAT(bench.out, !containing("\"aba\""));
}

TEST_CASE("bench prints one JSON object a line", "[command]") {
  const Answer a = run("bench " + biped + " --json");
  REQUIRE(a.code == 0);
  std::istringstream lines(a.out);
  int count = 0;
  for (std::string line; std::getline(lines, line); ++count) {
    const nlohmann::json row = nlohmann::json::parse(line);
    for (const char* key : {"robot", "algorithm", "scalar", "mode", "ns"}) CHECK(row.contains(key));
    CHECK(row["ns"].get<double>() > 0);
  }
  CHECK(count >= 9);
}

TEST_CASE("plugins are listed, checked, and begun", "[command]") {
  const Answer list = run("plugin list");
  CHECK(list.code == 0);
  for (const char* part : {"searched", "dyn_standard.so", "cam_follower", "h [m]", "mimic"}) CHECK_THAT(list.out, containing(part));
  const Answer check = run("plugin check '" DYN_BINARY_DIR "/examples/ball_screw.so' --rounds 1");
  CHECK(check.code == 0);
  CHECK_THAT(check.out, containing("subspace"));
  CHECK(run("plugin check /nowhere.so").code == 1);
  CHECK(run("plugin check " + biped).code == 1);
  const Folder folder;
  const std::string there = " --directory " + folder.path.string();
  CHECK(run("plugin new my_joint" + there).code == 0);
  for (const char* file : {"CMakeLists.txt", "my_joint.cpp", "my_joint.urdf", "README.md"}) CHECK(fs::exists(folder.path / "my_joint" / file));
  CHECK(run("plugin new my_joint" + there).code == 1);  // is there already
  CHECK(run("plugin new 7up" + there).code == 1);
  const Answer taken = run("plugin new revolute" + there);
  CHECK(taken.code == 1);
  CHECK_THAT(taken.err, containing("'revolute'") && containing("dyn_standard.so"));
}

TEST_CASE("a type that crashes or never ends is named with the checks that it was in, and the next ones are checked", "[command]") {
  const Answer a = run("plugin check '" DYN_BINARY_DIR "/bad_plugins/never_ends_or_crashes.so' --any-plugin --time-limit 2");
  CHECK(a.code == 1);
  CHECK_THAT(a.out, containing("never_ends, seed 1") && containing("FAILED  motion") && containing("no end within 2 s"));
  CHECK_THAT(a.out, containing("crashes, seed 1") && containing("crashed: Aborted"));
  CHECK_THAT(a.out, containing("sound_after_them, seed 3") && containing("2 checks failed"));
}

TEST_CASE("profile names the four ways of dispatch, and draws them", "[command]") {
  const Folder folder;
  const std::string picture = (folder.path / "p.svg").string();
  const Answer a = run("profile " + biped + " --root free_flyer --json --plot '" + picture + "'");
  CHECK(a.code == 0);
  std::map<std::string, int> ways;
  std::istringstream lines(a.out);
  for (std::string line; std::getline(lines, line);) {
    const nlohmann::json object = nlohmann::json::parse(line);
    CHECK(object["robot"] == "biped");
    CHECK(object["ns"].get<double>() > 0);
    CHECK(object["dispatches"].get<int>() >= 0);
    ++ways[object["dispatch"].get<std::string>()];
  }
  CHECK(ways == std::map<std::string, int>{{"monomorphic", 4}, {"static_variant", 4}, {"virtual_per_batch", 4}, {"virtual_per_joint", 4}});
  CHECK_THAT(textOf(picture), containing("<svg") && containing("static_variant") && containing("</svg>"));
  CHECK(run("profile " + biped + " --plot /nowhere/p.svg").code == 1);
}

TEST_CASE("DYN_SIMD forces an instruction set, and says what it cannot", "[command]") {
  setenv("DYN_SIMD", "scalar", 1);
  CHECK(run("info " + biped).code == 0);
  setenv("DYN_SIMD", "mmx", 1);
  const Answer a = run("info " + biped);
  CHECK(a.code == 1);
  CHECK_THAT(a.err, containing("mmx") && containing("avx2"));
  unsetenv("DYN_SIMD");
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
  CHECK(std::count(table.begin(), table.end(), '\n') == 52);  // names, and a state a step with both ends
  CHECK(run(robot + "--out " + json + " --plot " + svg + " --every 0.01").code == 0);
  const nlohmann::json states = nlohmann::json::parse(textOf(json));
  CHECK(states["states"].size() == 6);
  CHECK(states["states"][5]["t"] == 0.05);
  CHECK_THAT(textOf(svg), containing("</svg>"));

  // Half and half is the whole.
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
  CHECK(energy(falls) > 100);  // all of what it started with
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
  fails(biped + " --dt 0", "must be positive");
  fails(biped + " --dt -1", "must be positive");
  fails(biped + " --time -1", "not negative");
  fails(biped + " --integrator leapfrog", "leapfrog", 2);
  fails(biped + " --out trajectory.txt", ".csv or .json");
  fails(biped + " --every 1e-12", "keep fewer");
  fails(biped + " --every=-0.1", "--every");
  fails(biped + " --tolerance=-1", "tolerance");
  fails(biped + " --ground nowhere", "no frame 'nowhere'");
  fails(biped + " --resume " + (folder.path / "missing").string(), "does not exist");
  fails(biped + " --restitution 2", "restitution");
  fails("missing.urdf", "missing.urdf");
  for (const char* option : {"--out none/x.csv", "--plot none/x.svg", "--save none/x"}) {
    // Before the run, not after it.
    const Answer a = run("simulate " + biped + " --time 0.01 " + option);
    CHECK(a.code == 1);
    CHECK_THAT(a.err, containing("none/x") && containing("cannot be written"));
    CHECK_THAT(a.out, !containing("steps/s"));
  }
  fails(biped + " --resume there --state here", "--state", 2);
  const fs::path broken = folder.path / "state.json", out = folder.path / "out.csv";
  std::ofstream(broken) << R"({"samples":[{"q":[NaN]}]})";
  fails(biped + " --state " + broken.string(), "not finite");
  // Speeds whose squares no double holds.
  std::ofstream(broken) << R"({"samples":[{"q":[0.1,0.1,0.1,0.1,0.1,0.1,0.1],"v":[1e160,1e160,1e160,1e160,1e160,1e160,1e160]}]})";
  fails(DYN_SOURCE_DIR "/models/arm.urdf --state " + broken.string() + " --out " + out.string(), "t = ");
  const std::string kept = textOf(out);
  CHECK(std::count(kept.begin(), kept.end(), '\n') == 2);  // names and the first state
}

TEST_CASE("accuracy writes a page that needs nothing else", "[command][accuracy]") {
  const Folder folder;
  const std::string out = (folder.path / "report").string();
  const Answer a = run("accuracy --quick --out " + out);
  INFO(a.err);
  CHECK(a.code == 0);
  const std::string page = textOf(out + "/index.html");
  CHECK_THAT(page, containing("</html>"));
  CHECK(page.find("src=") == std::string::npos);
  CHECK(page.find("http://") == page.find("http://www.w3.org/2000/svg"));
  const nlohmann::json report = nlohmann::json::parse(textOf(out + "/report.json"));
  CHECK(report["sections"].size() == 6);
  for (const auto& row : report["sections"][0]["rows"]) {
    INFO(row.dump());
    const std::string mode = row["mode"], algorithm = row["algorithm"];
    if (mode.rfind("differences", 0) != 0)
      CHECK(row["error max [u]"].get<double>() < (algorithm.find("derivatives") == std::string::npos ? 15 : 200));
  }
  CHECK(run("accuracy --quick --models missing.urdf --out " + out).code == 1);
  CHECK(run("accuracy --quick --peers " + out + "/index.html --out " + out).code == 1);
}
