// SPDX-License-Identifier: BSD-2-Clause
// dyn codegen writes source that builds anywhere and passes its own test.
#include "command.hpp"

using namespace dyn::test;

namespace fs = std::filesystem;

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
  CHECK(vectors.code == 2);
  CHECK_THAT(vectors.err, containing("--plain"));
  const Answer digit = run("codegen '" + arm + "' --functions rnea --prefix 1x");
  CHECK(digit.code == 2);
  CHECK_THAT(digit.err, containing("--prefix") && containing("1x"));
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

TEST_CASE("codegen --compile compares each function with the library's own, where it has one", "[command]") {
  const Folder folder;
  const std::string arm = DYN_SOURCE_DIR "/models/arm.urdf";
  setenv("LIBDYN_CACHE", folder.path.c_str(), 1);
  for (const std::string how : {"", " --lanes 4", " --float"}) {
    INFO(how);
    const Answer a = run("codegen '" + arm + "' --functions rnea,frames --compile" + how);
    INFO(a.err);
    REQUIRE(a.code == 0);
    const std::size_t rnea = a.out.rfind("\nrnea "), frames = a.out.rfind("\nframes ");
    REQUIRE(rnea < frames);
    CHECK(a.out.substr(rnea, frames - rnea).find(" ns a state, the library takes ") != std::string::npos);
    CHECK(a.out.find("library", frames) == std::string::npos);
  }
  unsetenv("LIBDYN_CACHE");
}
