// SPDX-License-Identifier: BSD-2-Clause
// The command line of dyn: arguments that it refuses with exit code 2, and the messages.
#include "command.hpp"

using namespace dyn::test;

namespace fs = std::filesystem;

TEST_CASE("help is there for every subcommand, and a wrong command line exits with 2", "[command]") {
  for (const char* sub : {"", "accuracy", "info", "check", "codegen", "collide", "compute", "demo", "bench", "profile", "plugin", "plugin list",
                          "plugin check", "plugin new", "simulate", "truth", "help", "completion"}) {
    const Answer a = run(std::string(sub) + " --help");
    INFO(sub << a.err);
    CHECK(a.code == 0);
    CHECK_THAT(a.out, containing("--help") && containing("--quiet") && containing("--color"));
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
                                          "accuracy --instruction-sets mmx",
                                          "truth x.urdf",
                                          "truth x.urdf --losses --out x.json"};
  for (const std::string& line : wrong) {
    const Answer a = run(line);
    INFO(line);
    CHECK(a.code == 2);
    CHECK(!a.err.empty());
    CHECK(a.out.empty());
  }
}

TEST_CASE("dyn help prints what --help prints, and knows no other subcommands", "[command]") {
  for (const std::string sub : {"", "simulate", "plugin", "plugin check"}) {
    const Answer a = run("help " + sub);
    INFO(sub);
    CHECK(a.code == 0);
    CHECK(a.out == run(sub + " --help").out);
  }
  const Answer unknown = run("help plugin chek");
  CHECK(unknown.code == 2);
  CHECK_THAT(unknown.err, containing("'dyn plugin' has no subcommand 'chek'; did you mean 'check'?"));
  CHECK(run("completion tcsh").code == 2);
}

TEST_CASE("dyn --version names the library, the instruction set and the plugin interface", "[command]") {
  const Answer a = run("--version");
  CHECK(a.code == 0);
  CHECK_THAT(a.out, containing("dyn 0.") && containing(" (") && containing("instruction set ") && containing("plugin interface ") &&
                        containing("reads urdf, mjcf, json"));
}

TEST_CASE("a word that is no subcommand is named, with those that there are", "[command]") {
  const Answer a = run("fly robot.urdf"), b = run("plugin fly");
  CHECK(a.code == 2);
  CHECK_THAT(a.err, containing("'fly'") && containing("info, ") && containing("simulate"));
  CHECK(b.code == 2);
  CHECK_THAT(b.err, containing("'fly'") && containing("list, ") && !containing("simulate"));
  CHECK(run("fly --help").code == 0);
}

TEST_CASE("a number out of its range is refused with a range that can be read", "[command]") {
  const std::pair<const char*, const char*> wrong[] = {{"--restitution 2", "dyn simulate: error: --restitution: 2 must be in 0 to 1"},
                                                       {"--time abc", "--time: 'abc' is no number"},
                                                       {"--time=-1", "--time: -1 must be 0 or more"},
                                                       {"--tolerance 1e400", "--tolerance: "},
                                                       {"--dt nan", "--dt: 'nan' is no number"},
                                                       {"--dt inf", "--dt: inf must be positive"}};
  for (const auto& [arguments, says] : wrong) {
    const Answer a = run("simulate " + biped + " " + arguments);
    INFO(a.err);
    CHECK(a.code == 2);
    CHECK_THAT(a.err, containing(says) && containing("`dyn simulate --help`"));
    CHECK(a.err.size() < 200);
  }
  CHECK_THAT(run("plugin check x.so --rounds 0").err, containing("dyn plugin check: error: --rounds: 0 must be in 1 to 1000"));
  CHECK_THAT(run("bench " + biped + " --threads 1000").err, containing("1000 must be in 1 to 256"));
  CHECK_THAT(run("truth " + biped + " --out x.json --count 1001").err, containing("1001 must be in 1 to 1000"));
  CHECK_THAT(run("collide " + biped + " --learn 0").err, containing("0 must be in 1 to 1e+09"));
  const Answer many = run("simulate " + biped + " --every 1e-9");
  CHECK(many.code == 1);
  CHECK_THAT(many.err, containing("every 1e-09 s") && containing("larger --every"));
}

TEST_CASE("a file without a name, and a picture in a format that dyn does not write, are refused before any work", "[command]") {
  for (const std::string line : {"info ''", "check ''", "plugin check ''", "truth x.urdf --out x.json --states ''"}) {
    const Answer a = run(line);
    INFO(line << a.err);
    CHECK(a.code == 2);
    CHECK_THAT(a.err, containing("the file's name is empty"));
  }
  const Folder folder;
  for (const std::string& line : {"simulate " + biped + " --plot ", "profile " + biped + " --plot "}) {
    const std::string picture = (folder.path / "x.png").string();
    const Answer png = run(line + picture), none = run(line + "''");
    INFO(line << png.err);
    CHECK(png.code == 2);
    CHECK_THAT(png.err, containing("pictures end in .svg") && containing("x.png"));
    CHECK(!fs::exists(picture));
    CHECK(none.code == 2);
  }
  CHECK_THAT(run("simulate " + biped + " --out x.txt").err, containing("trajectories end in .csv or .json"));
}

TEST_CASE("a joint to hold and a joint type to begin need names", "[command]") {
  const Answer lock = run("info " + biped + " --lock ''"), type = run("plugin new 'bad name'");
  CHECK(lock.code == 1);
  CHECK_THAT(lock.err, containing("a joint to hold has no name"));
  CHECK(type.code == 2);
  CHECK_THAT(type.err, containing("'bad name' cannot name a joint type"));
}

TEST_CASE("what is no shared object is refused in the loader's words and no library's", "[command]") {
  const Folder folder;
  const std::string text = folder.write("text.so", "this is no shared object");
  const Answer a = run("info " + biped + " --plugin " + text);
  INFO(a.err);
  CHECK(a.code == 1);
  CHECK_THAT(a.err, containing("text.so: cannot be loaded: ") && !containing("boost") && !containing("/proc/self"));
}

TEST_CASE("a mass is printed in digits that it has", "[command]") {
  const Folder folder;
  std::string robot = "<robot name='r'><link name='a'/>";
  for (const char* name : {"b", "c", "d"})
    robot += std::string("<link name='") + name +
             "'><inertial><mass value='5.1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial></link>"
             "<joint name='j" +
             name + "' type='continuous'><parent link='a'/><child link='" + name + "'/></joint>";
  CHECK_THAT(run("info " + folder.write("r.urdf", robot + "</robot>")).out, containing(" 15.3 kg\n"));
}
