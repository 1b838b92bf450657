// SPDX-License-Identifier: BSD-2-Clause
// Broken MJCF gives an Error that says what is wrong and where, within seconds and bounded memory. Work grows linearly with the model.
#include "alloc_guard.hpp"
#include "support/folder.hpp"
#include "support/skip.hpp"

#include <dyn/dyn.hpp>
#include <dyn/parsers/mjcf.hpp>

#include <clocale>
#include <filesystem>
#include <fstream>

using namespace dyn;
using namespace dyn::test;

namespace {

std::string robot(const std::string& world, const std::string& before = "") {
  return "<?xml version=\"1.0\"?>\n<mujoco>\n" + before + "<worldbody>\n" + world + "</worldbody>\n</mujoco>\n";
}
std::string bodyText(const std::string& name, const std::string& inside = "", const std::string& mass = "1", const std::string& inertia = "1 1 1") {
  return "<body name=\"" + name + "\"><inertial pos=\"0 0 0\" mass=\"" + mass + "\" diaginertia=\"" + inertia + "\"/>\n" + inside + "</body>\n";
}
std::string jointText(const std::string& name, const std::string& attributes = "range=\"-1 1\"") {
  return "<joint name=\"" + name + "\" axis=\"0 1 0\" " + attributes + "/>\n";
}
CompactModel read(const std::string& text, const LoadOptions& options = {}) {
  return compile(mjcf::parse(text, "robot.xml", options), JointRegistry::standard());
}

}  // namespace

TEST_CASE("a broken MJCF is refused with what is wrong and where", "[fault]") {
  CHECK_THROWS_WITH(mjcf::load("/nowhere/robot.xml"), containing("/nowhere/robot.xml") && containing("does not exist"));
  CHECK_THROWS_WITH(mjcf::load("/tmp"), containing("folder"));
  CHECK_THROWS_WITH(read(""), containing("empty"));
  CHECK_THROWS_WITH(read("<mujoco><worldbody>"), containing("robot.xml:"));
  CHECK_THROWS_WITH(read("this is no XML"), containing("robot.xml"));
  CHECK_THROWS_WITH(read("<robot name=\"r\"/>"), containing("another format") && containing("<mujoco>"));
  CHECK_THROWS_WITH(read("<!DOCTYPE mujoco [<!ENTITY a \"b\">]><mujoco/>"), containing("document type"));
  CHECK_THROWS_WITH(read("<mujoco/>"), containing("no <worldbody>"));
  CHECK_THROWS_WITH(read(robot(bodyText("a") + bodyText("a"))), containing("two bodies are called 'a'") && containing(":6"));
  CHECK_THROWS_WITH(read(robot(bodyText("a", jointText("j")) + bodyText("b", jointText("j")))),
                    containing("two joints are called 'j'") && containing(":8"));
  CHECK_THROWS_WITH(read(robot("<geom name=\"g\" size=\"1\"/><geom name=\"g\" size=\"1\"/>")), containing("two geoms"));
  CHECK_THROWS_WITH(read(robot("<site name=\"s\"/><site name=\"s\"/>")), containing("two sites"));
  CHECK_THROWS_WITH(read(robot("", "<asset><mesh name=\"m\"/><mesh name=\"m\"/></asset>")), containing("two meshes"));
  CHECK_THROWS_WITH(read(robot("", "<default><default class=\"c\"/><default class=\"c\"/></default>")), containing("two default classes"));
  CHECK_THROWS_WITH(read(robot("", "<default><default/></default>")), containing("'class'"));
  CHECK_THROWS_WITH(read(robot(bodyText("a", jointText("j", "type=\"hinj\"")))),
                    containing("hinj") && containing("free, ball, slide, hinge") && containing(":5"));
  CHECK_THROWS_WITH(read(robot("<geom type=\"cone\" size=\"1\"/>")), containing("cone") && containing("capsule"));
  CHECK_THROWS_WITH(read(robot("", "<compiler angle=\"grad\"/>")), containing("radian, degree"));
  CHECK_THROWS_WITH(read(robot(bodyText("a", jointText("j", "limited=\"maybe\"")))), containing("false, true, auto"));
  CHECK_THROWS_WITH(read(robot("<joint/>")), containing("world has no joints"));
  CHECK_THROWS_WITH(read(robot(bodyText("a", "<freejoint/>" + jointText("j")))), containing("only joint"));
  CHECK_THROWS_WITH(read(robot(bodyText("a", bodyText("b", "<freejoint/>")))), containing("inside another body"));
  CHECK_THROWS_WITH(read(robot(bodyText("a", "<joint axis=\"0 0 0\"/>"))), containing("axis is zero"));
  CHECK_THROWS_WITH(read(robot(bodyText("a", "<joint class=\"no\"/>"))), containing("no default class 'no'"));
  CHECK_THROWS_WITH(read(robot("<geom type=\"mesh\" mesh=\"no\"/>")), containing("no mesh 'no'"));
  CHECK_THROWS_WITH(read(robot("", "<equality><joint joint1=\"no\"/></equality>")), containing("'no', which does not exist"));
  CHECK_THROWS_WITH(read(robot("<body><inertial pos=\"0 0 0\" mass=\"1\"/><inertial pos=\"0 0 0\" mass=\"1\"/></body>")),
                    containing("two <inertial>"));
  LoadOptions options;
  options.root = "no_such_joint";
  CHECK_THROWS_WITH(read(robot(bodyText("a")), options), containing("no_such_joint") && containing("searched"));
}

TEST_CASE("numbers of MJCF that are none, not finite, too many or impossible are refused with their line", "[fault]") {
  CHECK_THROWS_WITH(read(robot(bodyText("a", "", "nan"))), containing("nan") && containing(":4"));
  CHECK_THROWS_WITH(read(robot(bodyText("a", "", "inf"))), containing("inf"));
  CHECK_THROWS_WITH(read(robot(bodyText("a", "", "-1"))), containing("mass is negative"));
  CHECK_THROWS_WITH(read(robot(bodyText("a", "", "1,5"))), containing("1,5"));
  CHECK_THROWS_WITH(read(robot(bodyText("a", "", "1kg"))), containing("1kg"));
  CHECK_THROWS_WITH(read(robot(bodyText("a", "", "1", "1 1"))), containing("3 numbers, it has 2"));
  CHECK_THROWS_WITH(read(robot(bodyText("a", "", "1", "1 1 -1"))), containing("positive semi-definite"));
  CHECK_THROWS_WITH(read(robot("<body><inertial pos=\"0 0 0\" mass=\"1\" fullinertia=\"1 1 1 5 0 0\"/></body>")),
                    containing("positive semi-definite"));
  LoadOptions any;
  any.inertias = Inertias::any;
  CHECK_NOTHROW(mjcf::parse(robot(bodyText("a", "", "1", "1 1 -1")), "robot.xml", any));
  CHECK_THROWS_WITH(read(robot("<body><inertial pos=\"0 0 0\" diaginertia=\"1 1 1\"/></body>")), containing("no attribute 'mass'"));
  CHECK_THROWS_WITH(read(robot("<geom size=\"0\"/>")), containing("must be positive"));
  CHECK_THROWS_WITH(read(robot("<geom type=\"box\" size=\"1 1\"/>")), containing("size 3 must be positive"));
  CHECK_THROWS_WITH(read(robot("<geom size=\"1 1 1 1\"/>")), containing("1 to 3 numbers, it has 4"));
  CHECK_THROWS_WITH(read(robot("<geom type=\"capsule\" size=\"1\" fromto=\"1 2 3 1 2 3\"/>")), containing("the same"));
  CHECK_THROWS_WITH(read(robot("<geom size=\"1\" fromto=\"1 2 3 1 2 4\"/>")), containing("fromto is for"));
  CHECK_THROWS_WITH(read(robot("<body><geom size=\"1\" mass=\"-2\"/></body>")), containing("mass is negative"));
  CHECK_THROWS_WITH(read(robot("<geom size=\"1\" contype=\"0.5\"/>")), containing("whole number"));
  CHECK_THROWS_WITH(read(robot(bodyText("a", jointText("j", "damping=\"-1\"")))), containing("damping is negative"));
  CHECK_THROWS_WITH(read(robot("", "<default><joint damping=\"x\"/></default>")), containing("'x' is not a finite number"));
}

TEST_CASE("names that libdyn gives are reserved for the world in MJCF, too", "[fault]") {
  CHECK_THROWS_WITH(read(robot(bodyText("universe"))), containing("'universe'") && containing("reserved") && containing(":4"));
  CHECK_THROWS_WITH(read(robot(bodyText("world"))), containing("'world'"));
}

TEST_CASE("bytes of an MJCF that are no UTF-8, and characters that a terminal would obey, are refused", "[fault]") {
  for (const char* bytes : {"\xe9", "\xc0\xaf", "\xed\xa0\x80"})
    CHECK_THROWS_WITH(read(robot("<!-- " + std::string(bytes) + " -->\n")), containing("robot.xml:4") && containing("UTF-8"));
  for (const char* escape : {"\x1b", "&#27;", "&#x110000;"})
    CHECK_THROWS_WITH(read(robot(bodyText(std::string("a") + escape))), containing("is not XML"));
}

TEST_CASE("noise of 100 MB, elements nested 10^5 deep and a billion laughs are refused", "[fault]") {
  const std::string path = (std::filesystem::temp_directory_path() / "libdyn_noise.xml").string();
  {
    std::ofstream file(path, std::ios::binary);
    const std::string block(1 << 20, '\x5a');
    for (int i = 0; i < 100; ++i) file << block;
  }
  CHECK_THROWS_WITH(mjcf::load(path), containing("64 MB"));
  std::filesystem::remove(path);
  std::string deep = "<mujoco><worldbody>";
  for (int i = 0; i < 100000; ++i) deep += "<body>";
  CHECK_THROWS_WITH(read(deep), containing("deep"));
  std::string classes = "<mujoco>";
  for (int i = 0; i < 100000; ++i) classes += "<default class=\"c" + std::to_string(i) + "\">";
  CHECK_THROWS_WITH(read(classes), containing("deep"));
  std::string laughs = "<?xml version=\"1.0\"?><!DOCTYPE m [<!ENTITY l0 \"ha\">";
  for (int i = 1; i < 10; ++i) laughs += "<!ENTITY l" + std::to_string(i) + " \"&l" + std::to_string(i - 1) + ";&l" + std::to_string(i - 1) + ";\">";
  CHECK_THROWS_WITH(read(laughs + "]><mujoco model=\"&l9;\"/>"), containing("document type"));
}

TEST_CASE("replicas without bound are refused, also where they are nested", "[fault]") {
  CHECK_THROWS_WITH(read(robot("<replicate count=\"1000000000\"><body/></replicate>")), containing("count is larger") && containing(":4"));
  CHECK_THROWS_WITH(read(robot("<replicate count=\"1e300\"><body/></replicate>")), containing("whole number"));
  CHECK_THROWS_WITH(read(robot("<replicate count=\"0\"><body/></replicate>")), containing("positive"));
  CHECK_THROWS_WITH(read(robot("<replicate><body/></replicate>")), containing("'count'"));
  std::string nested = "<geom size=\"1\"/>", empty;
  for (int i = 0; i < 30; ++i) {
    nested = "<replicate count=\"1000\">" + nested + "</replicate>";
    empty = "<replicate count=\"1000\">" + empty + "</replicate>";
  }
  CHECK_THROWS_WITH(read(robot(nested)), containing("more than 1000000 elements"));
  CHECK_THROWS_WITH(read(robot(empty)), containing("more than 1000000 elements"));
}

TEST_CASE("includes that are missing, repeat themselves or leave the model's folder are refused", "[fault]") {
  const Folder folder;
  const auto load = [&](const std::string& inside, const LoadOptions& options = {}) {
    return mjcf::load(folder.write("model/robot.xml", robot(inside)), options);
  };
  CHECK_THROWS_WITH(load("<include file=\"none.xml\"/>"), containing("none.xml") && containing("does not exist") && containing("robot.xml:4"));
  CHECK_THROWS_WITH(load("<include/>"), containing("'file'"));
  CHECK_THROWS_WITH(load("<include file=\"robot.xml\"/>"), containing("includes itself"));
  CHECK_THROWS_WITH(load("<include file=\".\"/>"), containing("not a file"));
  folder.write("model/a.xml", "<mujoco><include file=\"b.xml\"/></mujoco>");
  folder.write("model/b.xml", "<mujoco><include file=\"a.xml\"/></mujoco>");
  CHECK_THROWS_WITH(load("<include file=\"a.xml\"/>"), containing("included twice") && containing("robot.xml:4"));
  folder.write("model/c.xml", "<mujoco><geom size=\"1\"/></mujoco>");
  CHECK_THROWS_WITH(load("<include file=\"c.xml\"/>\n<include file=\"c.xml\"/>"), containing("included twice") && containing("robot.xml:5"));
  CHECK_THROWS_WITH(load("<include file=\"c.xml\"><body/></include>"), containing("elements of its own"));
  folder.write("model/broken.xml", "<mujoco>\n<geom size=\"1\">");
  CHECK_THROWS_WITH(load("<include file=\"broken.xml\"/>"), containing("broken.xml:"));
  folder.write("model/latin.xml", "<mujoco>\xe9</mujoco>");
  CHECK_THROWS_WITH(load("<include file=\"latin.xml\"/>"), containing("latin.xml:1") && containing("UTF-8"));

  folder.write("outside.xml", "<mujoco><geom name=\"far\" size=\"1\"/></mujoco>");
  std::filesystem::create_symlink(folder.path / "outside.xml", folder.path / "model/link.xml");
  for (const std::string& name : {std::string("../outside.xml"), (folder.path / "outside.xml").string(), std::string("link.xml"),
                                  std::string("/etc/passwd"), std::string("x/../../outside.xml")})
    CHECK_THROWS_WITH(load("<include file=\"" + name + "\"/>"), containing("outside the model's folder") && containing("Files::anywhere"));
  LoadOptions anywhere;
  anywhere.files = Files::anywhere;
  CHECK(load("<include file=\"../outside.xml\"/>", anywhere).geometries.size() == 1);
  CHECK_THROWS_WITH(load("<body><geom type=\"mesh\" mesh=\"m\"/></body></worldbody><asset><mesh name=\"m\" file=\"../m.stl\"/></asset><worldbody>"),
                    containing("outside the model's folder"));
  CHECK_THROWS_WITH(load("<body><geom type=\"mesh\" mesh=\"m\"/></body></worldbody><asset><mesh name=\"m\" file=\"m.stl\"/></asset><worldbody>"),
                    containing("m.stl") && containing("does not exist"));
}

TEST_CASE("a chain of includes that is too deep is refused", "[fault]") {
  const Folder folder;
  for (int i = 0; i < 600; ++i) folder.write(std::to_string(i) + ".xml", "<mujoco><include file=\"" + std::to_string(i + 1) + ".xml\"/></mujoco>");
  folder.write("600.xml", "<mujoco/>");
  CHECK_THROWS_WITH(mjcf::load(folder.write("robot.xml", robot("<include file=\"0.xml\"/>"))), containing("nested deeper than 500"));
}

TEST_CASE("elements that make bodies are refused with the way to list these", "[fault]") {
  CHECK_THROWS_WITH(read(robot("<composite type=\"rope\"/>")), containing("<composite>") && containing("mj_saveLastXML"));
  CHECK_THROWS_WITH(read(robot(bodyText("a", "<flexcomp type=\"grid\"/>"))), containing("<flexcomp>"));
  CHECK_THROWS_WITH(read(robot("<attach model=\"m\" prefix=\"x\"/>")), containing("<attach>"));
}

TEST_CASE("check() of an MJCF lists all errors", "[fault]") {
  const Folder folder;
  const std::vector<Error> errors = mjcf::check(folder.write("robot.xml", robot(bodyText("a", "<geom size=\"0\"/>" + jointText("j", "type=\"x\"")) +
                                                                                bodyText("b", "<geom size=\"0\"/>") + "<geom type=\"y\"/>")));
  REQUIRE(errors.size() == 4);
  CHECK(mjcf::check(folder.write("robot.xml", robot(bodyText("a")))).empty());
  CHECK(mjcf::check((folder.path / "none.xml").string()).size() == 1);
}

TEST_CASE("100,000 bodies load, and work grows linearly with their number", "[fault]") {
  // Side by side under one body, as XML nests at most 100 deep. Names, classes and constraints are looked up, not searched.
  const auto text = [](int count) {
    std::string bodies, pairs;
    for (int i = 0; i < count; ++i) {
      const std::string n = std::to_string(i);
      bodies += "<body name=\"b" + n + "\" childclass=\"c\"><joint name=\"j" + n + "\"/><geom name=\"g" + n + "\" size=\"0.1\"/></body>\n";
      if (i % 10 == 0) pairs += "<exclude body1=\"b" + n + "\" body2=\"b0\"/>\n";
    }
    return robot("<body name=\"root\">" + bodies + "</body>",
                 "<default><default class=\"c\"><joint damping=\"1\"/></default></default><contact>" + pairs + "</contact>");
  };
  const Model model = mjcf::parse(text(100000), "robot.xml");
  REQUIRE(model.bodies.size() == 100002);
  CHECK(model.bodies.back().joint.damping == std::vector<double>{1});
  CHECK(model.disabled_collisions.size() == 10000);
  if (!tool::canCountAllocations()) DYN_SKIP("allocations cannot be counted here");
  const auto work = [&](int count) {
    const std::string given = text(count);
    const long before = tool::allocationCount();
    mjcf::parse(given, "robot.xml");
    return static_cast<double>(tool::allocationCount() - before);
  };
  CHECK(work(20000) < 2.1 * work(10000));
}

TEST_CASE("100,000 nameless bodies, replicas and classes get names without searching", "[fault]") {
  CHECK(mjcf::parse(robot("<replicate count=\"100000\"><body><joint/><geom size=\"0.1\"/><site/></body></replicate>"), "robot.xml").bodies.size() ==
        100001);
  std::string classes;
  for (int i = 0; i < 100000; ++i) classes += "<default class=\"c" + std::to_string(i) + "\"><joint damping=\"1\"/></default>";
  CHECK(mjcf::parse(robot("", "<default>" + classes + "</default>"), "robot.xml").bodies.size() == 1);
}

TEST_CASE("numbers of MJCF are read the same under a locale with decimal commas", "[fault]") {
  const std::string before = std::setlocale(LC_ALL, nullptr);
  if (!std::setlocale(LC_ALL, "de_DE.UTF-8") && !std::setlocale(LC_ALL, "de_DE")) DYN_SKIP("the locale de_DE is not installed");
  const Model model = mjcf::parse(robot(bodyText("a", "", "0.5")), "robot.xml");
  std::setlocale(LC_ALL, before.c_str());
  CHECK(model.bodies[1].inertia.mass == 0.5);
}
