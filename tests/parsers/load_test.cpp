// SPDX-License-Identifier: BSD-2-Clause
// One door: dyn::load finds a file's format by its ending or its content, and refuses what it cannot read by name.
#include "support/folder.hpp"

#include <dyn/parsers/load.hpp>

#include <algorithm>

using namespace dyn;
using namespace dyn::test;

namespace {

const std::string urdf_text = "<?xml version=\"1.0\"?>\n<!-- <sdf> -->\n<robot name=\"r\"><link name=\"a\"/></robot>";
const std::string json_text = R"({"format": "libdyn model", "version": 1, "name": "r", "bodies": []})";
const std::string lua_text = "-- a model\nreturn { frames = { { name = 'a', parent = 'ROOT' } } }";
const std::string sdf_text = "<sdf version='1.9'><model name='r'><link name='a'/></model></sdf>";

const std::string mjcf_text = "<mujoco><worldbody><body name='a'/></worldbody></mujoco>";

std::string textOf(const std::string& format) {
  return format == "urdf"   ? urdf_text
         : format == "mjcf" ? mjcf_text
         : format == "json" ? json_text
         : format == "lua"  ? lua_text
         : format == "sdf"  ? sdf_text
                            : "";
}

}  // namespace

TEST_CASE("every format that was built is found by its ending, by its content, and by its name", "[parser]") {
  const Folder folder;
  int read = 0;
  for (const ModelFormat& format : modelFormats()) {
    const std::string text = textOf(format.name);
    if (!format.missing.empty() || text.empty()) continue;
    INFO(format.name);
    ++read;
    for (const std::string& ending : format.endings) CHECK_NOTHROW(load(folder.write("robot" + ending, text)));
    CHECK_NOTHROW(load(folder.write("robot.txt", text)));
    CHECK_NOTHROW(load(folder.write("robot", text)));
    CHECK_NOTHROW(load(folder.write("misleading.urdf", text), {}, format.name));
    CHECK(check(folder.write("robot.txt", text)).empty());
  }
  CHECK(read >= 2);
}

TEST_CASE("a format that this libdyn was built without is refused, with what is missing", "[parser]") {
  const Folder folder;
  for (const ModelFormat& format : modelFormats()) {
    if (format.missing.empty()) continue;
    INFO(format.name);
    const std::string path = folder.write("robot" + format.endings.front(), textOf(format.name));
    CHECK_THROWS_WITH(load(path), containing(path) && containing(format.name == "xacro" ? "run `xacro " + path : "DYN_BUILD_"));
    CHECK(check(path).size() == 1);
  }
  const std::vector<ModelFormat> formats = modelFormats();
  CHECK(std::any_of(formats.begin(), formats.end(), [](const ModelFormat& f) { return f.name == "urdf"; }));
}

TEST_CASE("a file of no known format is refused, and the message says which there are", "[parser]") {
  const Folder folder;
  CHECK_THROWS_WITH(load(folder.write("robot", "hello")), containing("no model by its ending or content") && containing("urdf (.urdf)"));
  CHECK_THROWS_WITH(load(folder.write("robot.txt", "<collada/>")), containing("its root element is <collada>"));
  CHECK_THROWS_WITH(load(folder.write("empty", "")), containing("is empty"));
  CHECK_THROWS_WITH(load("/nowhere/robot"), containing("does not exist"));
  CHECK_THROWS_WITH(load(folder.write("robot.urdf", urdf_text), {}, "urfd"), containing("no format 'urfd'") && containing("did you mean 'urdf'"));
}

TEST_CASE("check() finds all errors of a URDF, whatever its name", "[parser]") {
  const Folder folder;
  const std::string two =
      "<robot name=\"r\"><link name=\"a\"/><joint name=\"j\" type=\"hinge\"><parent link=\"a\"/><child link=\"b\"/></joint></robot>";
  CHECK(check(folder.write("robot.txt", two)).size() >= 2);
  CHECK(check(folder.write("robot.json", "{")).size() == 1);
}
