// SPDX-License-Identifier: BSD-2-Clause
// Every subcommand of dyn: exit codes and messages for valid and for broken input.
#include "command.hpp"
#include "support/skip.hpp"

#include <nlohmann/json.hpp>

using namespace dyn::test;

namespace fs = std::filesystem;

TEST_CASE("a robot that cannot be read exits with 1 and says file and reason, in every subcommand", "[command]") {
  const Folder folder;
  const std::string broken = folder.write("broken.urdf", "<robot name='r'>\n<link name='a'/>\n<link name='a'/>\n</robot>\n");
  const std::string states = folder.write("states.json", R"({"samples":[]})");
  for (const std::string sub : {"info", "check", "codegen", "collide", "compute", "demo", "bench", "profile", "truth"}) {
    INFO(sub);
    const std::string extra = sub == "compute"   ? " --states " + states
                              : sub == "codegen" ? " --functions rnea"
                              : sub == "truth"   ? " --out '" + (folder.path / "truth.json").string() + "'"
                                                 : "";
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

TEST_CASE("bench measures what is asked for", "[command]") {
  const Answer a = run("bench " + biped + " --only rnea,step_rk4 --json");
  REQUIRE(a.code == 0);
  std::istringstream lines(a.out);
  std::string names;
  for (std::string line; std::getline(lines, line);) names += nlohmann::json::parse(line)["algorithm"].get<std::string>() + " ";
  CHECK(names == "rnea step_rk4 rnea rnea ");  // one state, then batches of doubles and floats
  const Answer few = run("bench " + biped + " --only rnea --states 8 --json");
  CHECK_THAT(few.out, containing("\"mode\":\"batch\",\"states\":8") && containing("\"mode\":\"single\",\"states\":256"));
  CHECK(run("bench " + biped + " --states 0").code == 2);
  const Answer unknown = run("bench " + biped + " --only speed");
  CHECK(unknown.code == 2);
  CHECK_THAT(unknown.err, containing("speed") && containing("joint_jacobians"));
}

TEST_CASE("plugins are listed, checked, and begun", "[command]") {
  const Answer list = run("plugin list");
  CHECK(list.code == 0);
  for (const char* part : {"searched", "dyn_standard.so", "cam_follower", "h [m]", "mimic"}) CHECK_THAT(list.out, containing(part));
  const Answer check = run("plugin check '" DYN_BINARY_DIR "/examples/ball_screw.so' --rounds 1");
  CHECK(check.code == 0);
  CHECK_THAT(check.out, containing("subspace"));
  for (const char* set : {"avx2", "avx512"}) {
    if (!fs::exists(fs::path(DYN_BINARY_DIR) / "examples" / set)) continue;  // tools/test builds the best set alone
    const bool checked = check.out.find(std::string("checked with it: " DYN_BINARY_DIR "/examples/") + set) != std::string::npos;
    const bool named = check.out.find(std::string("not checked: " DYN_BINARY_DIR "/examples/") + set) != std::string::npos;
    CHECK(checked != named);
  }
  CHECK(run("plugin check /nowhere.so").code == 1);
  CHECK(run("plugin check " + biped).code == 1);
  const Folder folder;
  const std::string there = " --directory " + folder.path.string();
  CHECK(run("plugin new my_joint" + there).code == 0);
  for (const char* file : {"CMakeLists.txt", "my_joint.cpp", "my_joint.urdf", "README.md"}) CHECK(fs::exists(folder.path / "my_joint" / file));
  CHECK(run("plugin new my_joint" + there).code == 1);  // the folder exists already
  CHECK(run("plugin new 7up" + there).code == 2);
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

TEST_CASE("a plugin that throws, ends its host, never loads, or changes arithmetic fails its check and says so", "[command]") {
  const auto check = [](const std::string& name) {
    return run("plugin check '" DYN_BINARY_DIR "/bad_plugins/" + name + ".so' --any-plugin --time-limit 2");
  };
  const Answer throws = check("throws_in_pose");
  CHECK(throws.code == 1);
  CHECK_THAT(throws.err, containing("'throws_in_pose'") && containing("the table ends at 0.1"));
  CHECK_THAT(throws.out, containing("FAILED") && containing("1 types"));
  const Answer ends = check("ends_only_its_host");
  CHECK(ends.code == 1);
  CHECK_THAT(ends.out, containing("FAILED  loading") && containing("ended the process"));
  const Answer never = check("never_ends_loading");
  CHECK(never.code == 1);
  CHECK_THAT(never.out, containing("FAILED  loading") && containing("no end within 2 s"));
  const Answer flushes = check("flushes_to_zero");
  CHECK(flushes.code == 1);
  CHECK_THAT(flushes.out, containing("FAILED  loading") && containing("-ffast-math") && containing("1 checks failed"));
}

TEST_CASE("a joint type whose function throws ends the command with its name, and with exit code 1", "[command]") {
  const Folder folder;
  const std::string robot = folder.write("robot.urdf", R"(<robot name="r"><link name="a"/><link name="b"/>
    <joint name="j" type="prismatic"><parent link="a"/><child link="b"/><axis xyz="1 0 0"/><limit lower="0.2" upper="0.4" effort="1" velocity="1"/></joint>
    <libdyn><joint name="j" type="throws_in_pose"/></libdyn></robot>)");
  const std::string states = folder.write("states.json", R"({"samples":[{"q":[0.3],"v":[0],"a":[0],"tau":[0]}]})");
  const Answer a = run("compute " + robot + " --any-plugin --plugin '" DYN_BINARY_DIR "/bad_plugins/throws_in_pose.so' --states " + states);
  CHECK(a.code == 1);
  CHECK_THAT(a.err, containing("'throws_in_pose'") && containing("the table ends at 0.1"));
}

TEST_CASE("what is not finite is an error wherever it comes up, and names itself", "[command]") {
  const Folder folder;
  const std::string ball = "<collision><geometry><sphere radius=\"0.5\"/></geometry></collision>";
  const std::string robot =
      folder.write("far.urdf", "<robot name=\"far\"><link name=\"a\">" + ball + "</link><link name=\"m\"/><link name=\"b\">" + ball +
                                   "</link><joint name=\"x\" type=\"prismatic\"><parent link=\"a\"/><child link=\"m\"/></joint>"
                                   "<joint name=\"y\" type=\"prismatic\"><parent link=\"m\"/><child link=\"b\"/></joint></robot>");
  const std::string far = folder.write("far.json", R"({"samples":[{"q":[0,1]},{"q":[1e200,1e200]}]})");
  const Answer apart = run("collide " + robot + " --states " + far);
  CHECK(apart.code == 1);
  CHECK_THAT(apart.err, containing("state 1") && containing("minimum") && containing("not finite"));
  const std::string huge =
      folder.write("huge.urdf", R"(<robot name="h"><link name="a"><collision><geometry><box size="1e200 1 1"/></geometry></collision></link>
    </robot>)");
  const Answer box = run("collide " + robot + " --scene " + huge);
  CHECK(box.code == 1);
  CHECK_THAT(box.err, containing("1e+200 m") && containing("huge.urdf:1"));
  const std::string heavy =
      folder.write("heavy.urdf", R"(<robot name="h"><link name="a"/><link name="b"><inertial><origin xyz="0 0 1e160"/><mass value="1e160"/>
    <inertia ixx="1" iyy="1" izz="1"/></inertial></link><joint name="j" type="revolute"><parent link="a"/><child link="b"/><axis xyz="1 0 0"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>)");
  const Answer moved = run("simulate " + heavy + " --time 0.01");
  CHECK(moved.code == 1);
  CHECK_THAT(moved.err, containing("not finite"));
  CHECK(moved.out.find("nan") == std::string::npos);
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
  for (const std::string set : {"scalar", "baseline"}) {
    setenv("DYN_SIMD", set.c_str(), 1);
    const Answer forced = run("info " + biped);
    if (std::string(" " DYN_KERNEL_SETS " ").find(" " + set + " ") != std::string::npos) {
      CHECK(forced.code == 0);
    } else {
      CHECK(forced.code == 1);
      CHECK_THAT(forced.err, containing("DYN_SIMD=" + set) && containing("-DDYN_INSTRUCTION_SETS=all"));
    }
  }
  setenv("DYN_SIMD", "mmx", 1);
  const Answer a = run("info " + biped);
  CHECK(a.code == 1);
  CHECK_THAT(a.err, containing("mmx") && containing("avx2"));
  unsetenv("DYN_SIMD");
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

TEST_CASE("truth writes references that bench reads, and the same ones again from its own file", "[command][truth]") {
  const Folder folder;
  const std::string first = (folder.path / "first.json").string(), again = (folder.path / "again.json").string();
  const std::string model = DYN_SOURCE_DIR "/models/four_bar.urdf";
  REQUIRE(run("truth " + model + " --count 1 --seed 5 --out '" + first + "'").code == 0);
  REQUIRE(run("truth " + model + " --states '" + first + "' --out '" + again + "'").code == 0);
  CHECK(textOf(first) == textOf(again));
  const Answer bench = run("bench " + model + " --only rnea,crba --states 4 --truth '" + first + "'");
  CHECK(bench.code == 0);
  const Answer refused = run("truth " + model + " --lock A --out '" + again + "'");
  CHECK(refused.code == 2);
  CHECK_THAT(refused.err, containing("--lock"));
}
