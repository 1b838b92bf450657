// SPDX-License-Identifier: BSD-2-Clause
// Messages of dyn: suggestions, --quiet and --verbose, colour, progress, and output that is lost.
#include "progress.hpp"
#include "support/skip.hpp"
#include "terminal.hpp"

#include <vector>

using namespace dyn::test;

namespace fs = std::filesystem;

namespace {

const std::string dyn_path = "'" DYN_BINARY_DIR "/bin/dyn' ";
const std::string arm = DYN_SOURCE_DIR "/models/four_bar.urdf";
const std::string escape = "\033[";

/// Removes variables of the environment that a test sets itself.
void cleanTerminal() {
  unsetenv("NO_COLOR");
  setenv("TERM", "xterm", 1);
}

/// A command line of each subcommand that prints something.
std::vector<std::string> commandsThatPrint(const Folder& folder) {
  const std::string states = folder.write("states.json", zero_state);
  return {"--version",
          "--help",
          "info " + biped,
          "check " + biped,
          "demo " + biped,
          "codegen " + biped + " --functions rnea",
          "compute " + biped + " --root free_flyer --states " + states,
          "collide " + biped,
          "collide " + biped + " --learn 10",
          "bench " + biped + " --only rnea",
          "bench " + biped + " --only rnea --json",
          "profile " + biped + " --json",
          "simulate " + biped + " --time 0.01",
          "plugin list",
          "plugin check '" DYN_BINARY_DIR "/examples/ball_screw.so' --rounds 1"};
}

}  // namespace

TEST_CASE("a misspelt subcommand, option, joint, frame or link is answered with the name that was meant", "[command]") {
  const Folder folder;
  const std::string robot = folder.write("r.urdf", R"(<robot name="r"><link name="base"/><link name="tool"/>
    <joint name="j" type="fixed"><parent link="bse"/><child link="tool"/></joint></robot>)");
  const std::string mimic = folder.write("mimic.urdf", R"(<robot name="r"><link name="a"/><link name="b"/><link name="c"/>
    <joint name="master" type="continuous"><parent link="a"/><child link="b"/></joint>
    <joint name="follower" type="continuous"><parent link="b"/><child link="c"/><mimic joint="mastr"/></joint></robot>)");
  const std::string srdf = folder.write("r.srdf", R"(<robot name="r"><disable_collisions link1="left_fot" link2="right_foot"/></robot>)");
  CHECK_THAT(run("collide " + biped + " --srdf " + srdf).err, containing("there is no link 'left_fot'; did you mean 'left_foot'"));
  const std::string states = folder.write("states.json", R"({"samples":[]})");
  const std::pair<std::string, const char*> wrong[] = {
      {"simulat x.urdf", "there is no subcommand 'simulat'; did you mean 'simulate'?"},
      {"plugin lst", "there is no subcommand 'lst'; did you mean 'list'?"},
      {"--quite info x.urdf", "dyn: error: there is no option '--quite'; did you mean '--quiet'?"},
      {"bench x.urdf --thread 3", "there is no option '--thread'; did you mean '--threads'?"},
      {"compute x.urdf --sates=x.json", "there is no option '--sates'; did you mean '--states'"},
      {"info " + mimic, "mimics joint 'mastr', which does not exist; did you mean 'master'?"},
      {"bench " + biped + " --only rnae", "--only rnae: there is no such algorithm; did you mean '"},
      {"plugin check '" DYN_BINARY_DIR "/examples/ball_screw.so' --type ball_scrw", "has no type 'ball_scrw'; did you mean 'ball_screw'"},
      {"info " + robot, "names link 'bse', which does not exist; did you mean 'base'?"},
      {"info " + biped + " --lock left_kne", "did you mean 'left_knee'"},
      {"simulate " + biped + " --ground left_fot", "did you mean 'left_foot'"},
      {"simulate " + biped + " --contacts left_fot:6d", "did you mean 'left_foot'"},
      {"compute " + biped + " --states " + states + " --frames left_fot", "did you mean 'left_foot'"}};
  for (const auto& [line, says] : wrong) {
    const Answer a = run(line);
    INFO(line << '\n' << a.err);
    CHECK(a.code != 0);
    CHECK_THAT(a.err, containing(says));
  }
  CHECK(run("bench x.urdf --entirely-different").err.find("did you mean") == std::string::npos);
}

TEST_CASE("--quiet leaves errors alone on standard error, --verbose tells what was loaded and how long it took", "[command]") {
  const Folder folder;
  const std::string robot = folder.write("r.urdf", R"(<robot name="r"><link name="a"/><link name="b"><inertial><mass value="1"/>
    <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
    <joint name="j" type="revolute"><parent link="a"/><child link="b"/></joint></robot>)");
  CHECK_THAT(run("info " + robot).err, containing("dyn: note: "));
  CHECK(run("info " + robot + " --quiet").err.empty());
  CHECK(run("-q info " + robot).err.empty());
  CHECK_THAT(run("info /nowhere.urdf --quiet").err, containing("dyn: error: /nowhere.urdf"));
  const Answer verbose = run("info " + robot + " --verbose");
  for (const char* part : {"plugin ", "dyn_standard.so has ", "read ", "r.urdf in ", "compiled 'r' for ", " ms"})
    CHECK_THAT(verbose.err, containing(part));
  CHECK(verbose.out == run("info " + robot).out);
  for (const std::string& both : {"info " + robot + " -q -v", "-q info -v " + robot, "-v -q info " + robot}) {
    const Answer a = run(both);
    INFO(both);
    CHECK(a.code == 2);
    CHECK_THAT(a.err, containing("--verbose excludes --quiet"));
  }
}

TEST_CASE("words are coloured on terminals, unless NO_COLOR, TERM or --color forbid it", "[command]") {
  cleanTerminal();
  const std::string line = "info " + biped, wrong = "info /nowhere.urdf";
  CHECK(run(line).out.find(escape) == std::string::npos);
  CHECK(run(wrong).err.find(escape) == std::string::npos);
  CHECK_THAT(run(line + " --color=always").out, containing(escape + "1mjoint types" + escape + "0m"));
  CHECK_THAT(run(wrong + " --color=always").err, containing(escape + "1;31merror:" + escape + "0m"));
  CHECK(run(line + " --color=sometimes").code == 2);
  CHECK_THAT(runOnTerminal(dyn_path + line).out, containing(escape + "1mjoint types"));
  CHECK_THAT(runOnTerminal("NO_COLOR= " + dyn_path + line).out, containing(escape + "1mjoint types"));
  for (const std::string& plain :
       {"NO_COLOR=1 " + dyn_path + line, "TERM=dumb " + dyn_path + line, dyn_path + line + " --color=never", dyn_path + line + " | cat"}) {
    INFO(plain);
    const Answer a = runOnTerminal(plain);
    CHECK_THAT(a.out, containing("joint types"));
    CHECK(a.out.find(escape) == std::string::npos);
  }
}

TEST_CASE("a progress bar tells part, rate, time left and what is being done, within the terminal's width", "[command]") {
  using dyn::tool::progressText;
  CHECK(progressText(0, 10, "states", 0, "first", 80) == "[------------------------]   0 %  first");
  CHECK(progressText(5, 20, "states", 2, "", 80) == "[######------------------]  25 %  2.5 states/s, 6 s left");
  CHECK(progressText(1, 101, "steps", 1, "rk4", 80) == "[------------------------]   0 %  1 steps/s, 1 min 40 s left  rk4");
  CHECK_THAT(progressText(1, 10001, "steps", 1, "", 80), containing("2 h 46 min left"));
  CHECK_THAT(progressText(30, 20, "steps", 1, "", 80), containing("100 %") && containing(", 0 s left"));
  CHECK(progressText(5, 20, "states", 2, "a name that is long", 20).size() == 20);
}

TEST_CASE("what lasts shows its progress on terminals, and nowhere else or with --quiet", "[command]") {
  cleanTerminal();
  const Folder folder;
  const std::string states = folder.write("states.json", zero_state);
  const std::vector<std::string> lines = {"bench " + biped + " --only rnea",
                                          "profile " + biped + " --json",
                                          "collide " + biped + " --learn 10",
                                          "collide " + biped + " --root free_flyer --states " + states,
                                          "compute " + biped + " --root free_flyer --states " + states,
                                          "simulate " + biped + " --time 0.01",
                                          "codegen " + biped + " --functions rnea",
                                          "truth '" + arm + "' --count 1 --out '" + (folder.path / "truth.json").string() + "'",
                                          "plugin check '" DYN_BINARY_DIR "/examples/ball_screw.so' --rounds 1"};
  for (const std::string& line : lines) {
    INFO(line);
    CHECK_THAT(runOnTerminal(dyn_path + line).out, containing("]   0 %"));
    CHECK(run(line).err.find("0 %") == std::string::npos);
    CHECK(runOnTerminal(dyn_path + line + " --quiet").out.find("]   0 %") == std::string::npos);
    CHECK(runOnTerminal("TERM=dumb " + dyn_path + line).out.find("]   0 %") == std::string::npos);
  }
  // Results begin on a line of their own.
  CHECK_THAT(runOnTerminal(dyn_path + "collide " + biped + " --learn 10").out, containing("\r" + escape + "K<?xml"));
}

TEST_CASE("lost output is an error of every subcommand: a full disk, a reader that has ended", "[command]") {
  const Folder folder;
  const fs::path err = folder.path / "err";
  int ends[2];
  REQUIRE(pipe(ends) == 0);
  close(ends[0]);
  // Some shells take numbers of one digit only.
  REQUIRE(dup2(ends[1], 9) == 9);
  close(ends[1]);
  const std::string closed = "&9";
  for (const std::string& line : commandsThatPrint(folder))
    for (const std::string& target : {std::string("/dev/full"), closed}) {
      if (target == "/dev/full" && !fs::exists(target)) continue;
      INFO(line << " >" << target);
      const int status = std::system((dyn_path + line + " >" + target + " 2>'" + err.string() + "'").c_str());
      REQUIRE(WIFEXITED(status));
      CHECK(WEXITSTATUS(status) == 1);
      CHECK_THAT(textOf(err), containing("not all of the output could be written"));
    }
  close(9);
}

TEST_CASE("a result that fills the disk is an error that names its file", "[command]") {
  if (!fs::exists("/dev/full")) DYN_SKIP("there is no /dev/full");
  const Folder folder;
  for (const char* name : {"full.csv", "full.json", "full.svg"}) fs::create_symlink("/dev/full", folder.path / name);
  const std::string in = folder.path.string() + "/";
  for (const std::string& line :
       {"simulate " + biped + " --time 0.01 --out " + in + "full.csv", "simulate " + biped + " --time 0.01 --out " + in + "full.json",
        "simulate " + biped + " --time 0.01 --plot " + in + "full.svg", "simulate " + biped + " --time 0.01 --save /dev/full",
        "profile " + biped + " --json --plot " + in + "full.svg", "collide " + biped + " --learn 10 --out /dev/full",
        "truth '" + arm + "' --count 1 --out " + in + "full.json"}) {
    const Answer a = run(line);
    INFO(line << '\n' << a.err);
    CHECK(a.code == 1);
    CHECK_THAT(a.err, containing("full") && containing("cannot be written"));
  }
  // No file may be larger than 512 bytes.
  const std::pair<std::string, std::string> folders[] = {
      {"plugin new my_joint --directory ", "my_joint"}, {"codegen " + biped + " --functions rnea --out ", "biped.c"}, {"help --man-pages ", "dyn.1"}};
  const std::string err = in + "err";
  for (const auto& [line, unfinished] : folders) {
    INFO(line);
    const std::string command = "trap '' XFSZ; ulimit -f 1; " + dyn_path + line + "'" + in + "' >/dev/null 2>'" + err + "'";
    CHECK(WEXITSTATUS(std::system(command.c_str())) == 1);
    CHECK_THAT(textOf(err), containing("cannot be written"));
    CHECK_FALSE(fs::exists(folder.path / unfinished));
  }
}
