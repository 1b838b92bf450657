// SPDX-License-Identifier: BSD-2-Clause
// Broken and hostile SDF gives an Error that says what is wrong and where, and nothing on the terminal.
#include "support/folder.hpp"

#include <dyn/dyn.hpp>
#include <dyn/parsers/sdf.hpp>

#include <clocale>
#include <iostream>
#include <sstream>
#include <string>

using namespace dyn;
using namespace dyn::test;

namespace {

const std::string inertial = "<inertial><mass>1</mass><inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz></inertia></inertial>";
std::string linkText(const std::string& name, const std::string& inside = inertial) { return "<link name='" + name + "'>" + inside + "</link>\n"; }
std::string joint(const std::string& name, const std::string& type, const std::string& parent, const std::string& child,
                  const std::string& inside = "<axis><xyz>0 0 1</xyz></axis>") {
  return "<joint name='" + name + "' type='" + type + "'><parent>" + parent + "</parent><child>" + child + "</child>" + inside + "</joint>\n";
}
Model parse(const std::string& text, const LoadOptions& options = {}) { return sdf::parse(text, "robot.sdf", options); }
Model read(const std::string& model, const LoadOptions& options = {}) {
  return parse("<sdf version='1.9'><model name='m'>\n" + model + "</model></sdf>", options);
}

/// Takes text that is written to the terminal's error stream.
class Silence {
 public:
  Silence() : before_(std::cerr.rdbuf(said_.rdbuf())) {}
  ~Silence() { std::cerr.rdbuf(before_); }
  std::string said() const { return said_.str(); }

 private:
  std::ostringstream said_;
  std::streambuf* before_;
};

}  // namespace

TEST_CASE("a broken file is refused with what is wrong and where, and nothing is printed", "[fault]") {
  const Silence silence;
  CHECK_THROWS_WITH(sdf::load("/nowhere/robot.sdf"), containing("/nowhere/robot.sdf") && containing("does not exist"));
  CHECK_THROWS_WITH(parse(""), containing("is empty"));
  CHECK_THROWS_WITH(parse("<sdf version='1.9'><model name='m'>"), containing("robot.sdf:1"));
  CHECK_THROWS_WITH(parse("<mujoco/>"), containing("another format"));
  CHECK_THROWS_WITH(parse("<sdf version='1.9'/>"), containing("no <link>"));
  CHECK_THROWS_WITH(parse("<sdf><model name='m'>" + linkText("a") + "</model></sdf>"), containing("robot.sdf"));
  CHECK_THROWS_WITH(parse("<!DOCTYPE sdf [<!ENTITY a 'b'>]><sdf/>"), containing("document type"));
  CHECK_THROWS_WITH(parse("<sdf version='1.9'><model>" + linkText("a") + "</model></sdf>"), containing("robot.sdf"));
  CHECK_THROWS_WITH(read(""), containing("robot.sdf"));
  CHECK_THROWS_WITH(read(linkText("a") + linkText("a")), containing("a") && containing("robot.sdf"));
  CHECK_THROWS_WITH(read(linkText("a") + linkText("universe")), containing("reserved"));
  CHECK_THROWS_WITH(read(linkText("a") + joint("j", "revolute", "a", "b")), containing("b") && containing("robot.sdf"));
  CHECK_THROWS_WITH(read(linkText("a") + joint("j", "revolute", "a", "a")), containing("robot.sdf"));
  CHECK_THROWS_WITH(read(linkText("a") + linkText("b") + joint("j", "hinge", "a", "b")), containing("hinge") && containing("robot.sdf"));
  CHECK_THROWS_WITH(read(linkText("a") + linkText("b") + joint("j", "revolute", "a", "b", "")), containing("no <axis>") && containing("robot.sdf:4"));
  CHECK_THROWS_WITH(
      read(linkText("a") + linkText("b") + joint("j", "screw", "a", "b", "<axis><xyz>0 0 1</xyz></axis><thread_pitch>0</thread_pitch>")),
      containing("thread_pitch"));
  CHECK_THROWS_WITH(read(linkText("a", "<pose relative_to='nothing'/>")), containing("nothing"));
  CHECK_THROWS_WITH(read(linkText("a", "<pose relative_to='b'/>") + linkText("b", "<pose relative_to='a'/>")), containing("robot.sdf"));
  CHECK_THAT(silence.said(), Catch::Matchers::Equals(""));
}

TEST_CASE("numbers that libdsdformat would take for others are refused with their line", "[fault]") {
  for (const char* mass : {"0,5", "1kg", "nan", "inf", "0x10", "1 2", "+-1"}) {
    INFO(mass);
    CHECK_THROWS_WITH(read(linkText("a", "<inertial><mass>" + std::string(mass) + "</mass></inertial>")),
                      containing("robot.sdf:2") && containing("<mass>"));
  }
  CHECK_THROWS_WITH(read("\n" + linkText("a", inertial + "<pose>0 0 0 0 0</pose>")), containing("robot.sdf:3") && containing("6 numbers"));
  CHECK_THROWS_WITH(read(linkText("a") + linkText("b") + joint("j", "revolute", "a", "b", "<axis><xyz>0 0</xyz></axis>")), containing("3 numbers"));
  CHECK_THROWS_WITH(read(linkText("a") + linkText("b") + joint("j", "revolute", "a", "b", "<axis><xyz>0 0 0</xyz></axis>")), containing("zero"));
}

TEST_CASE("limits and inertias that mean nothing are refused", "[fault]") {
  const auto limited = [](const std::string& inside) {
    return read(linkText("a") + linkText("b") + joint("j", "revolute", "a", "b", "<axis><xyz>0 0 1</xyz>" + inside + "</axis>"));
  };
  CHECK_THROWS_WITH(limited("<limit><lower>1</lower><upper>-1</upper></limit>"), containing("lower limit is above") && containing("'j'"));
  CHECK_THROWS_WITH(limited("<dynamics><damping>-1</damping></dynamics>"), containing("negative"));
  const auto heavy = [](const std::string& mass, const std::string& ixx) {
    return linkText("a", "<inertial><mass>" + mass + "</mass><inertia><ixx>" + ixx + "</ixx><iyy>1</iyy><izz>1</izz></inertia></inertial>");
  };
  CHECK_THROWS_WITH(read(heavy("-1", "1")), containing("mass is negative") && containing("robot.sdf:2"));
  CHECK_THROWS_WITH(read(heavy("1", "-1")), containing("positive semi-definite"));
  CHECK_NOTHROW(read(heavy("1", "-1"), {.inertias = Inertias::any}));
  CHECK_NOTHROW(read(linkText("a", "<inertial><mass>0</mass><inertia><ixx>0</ixx><iyy>0</iyy><izz>0</izz></inertia></inertial>")));
  CHECK_THROWS_WITH(read(linkText("a") + linkText("b") + linkText("c") + joint("w", "fixed", "world", "a") + joint("p", "ball", "a", "b") +
                         joint("q", "universal", "b", "c", "<axis><xyz>1 0 0</xyz></axis><axis2><xyz>0 1 0</xyz></axis2>") +
                         joint("r", "universal", "a", "c", "<axis><xyz>1 0 0</xyz></axis><axis2><xyz>0 1 0</xyz></axis2>")),
                    containing("closes a loop") && containing("'r'"));
}

TEST_CASE("includes that leave the folder, do not exist or include themselves are refused", "[fault]") {
  const Folder folder;
  const auto with = [&](const std::string& uri, const LoadOptions& options = {}) {
    return sdf::load(folder.write("models/robot.sdf", "<sdf version='1.9'><model name='m'>\n" + linkText("a") + "<include><uri>" + uri +
                                                          "</uri></include></model></sdf>"),
                     options);
  };
  folder.write("outside.sdf", "<sdf version='1.9'><model name='o'>" + linkText("o") + "</model></sdf>");
  CHECK_THROWS_WITH(with("../outside.sdf"), containing("robot.sdf:3") && containing("outside the model's folder"));
  CHECK_THROWS_WITH(with("../../etc/passwd"), containing("robot.sdf:3"));
  CHECK_THROWS_WITH(with("/etc/passwd"), containing("outside the model's folder"));
  CHECK_THROWS_WITH(with("file:///etc/passwd"), containing("outside the model's folder"));
  CHECK_NOTHROW(with("../outside.sdf", {.files = Files::anywhere}));
  CHECK_THROWS_WITH(with("/etc/passwd", {.files = Files::anywhere}), containing("/etc/passwd"));
  CHECK_THROWS_WITH(with("nothing.sdf"), containing("does not exist"));
  CHECK_THROWS_WITH(with("https://example.org/model"), containing("not on this machine"));
  CHECK_THROWS_WITH(with(""), containing("names no file"));
  CHECK_THROWS_WITH(with("robot.sdf"), containing("includes itself"));
  folder.write("models/one.sdf", "<sdf version='1.9'><model name='one'><include><uri>two.sdf</uri></include></model></sdf>");
  folder.write("models/two.sdf", "<sdf version='1.9'><model name='two'><include><uri>one.sdf</uri></include></model></sdf>");
  CHECK_THROWS_WITH(with("one.sdf"), containing("two.sdf:1") && containing("includes itself"));
  folder.write("models/bad.sdf", "<sdf version='1.9'><model name='bad'>\n<link name='a'><inertial><mass>x</mass></inertial></link></model></sdf>");
  CHECK_THROWS_WITH(with("bad.sdf"), containing("bad.sdf:2"));
}

TEST_CASE("includes that grow without bound are counted before they are read", "[fault]") {
  const Folder folder;
  const auto twice = [](const std::string& file) {
    return "<include><name>x</name><uri>" + file + "</uri></include><include><name>y</name><uri>" + file + "</uri></include>";
  };
  folder.write("0.sdf", "<sdf version='1.9'><model name='m'>" + linkText("a") + "</model></sdf>");
  for (int k = 1; k <= 30; ++k)
    folder.write(std::to_string(k) + ".sdf", "<sdf version='1.9'><model name='m'>" + twice(std::to_string(k - 1) + ".sdf") + "</model></sdf>");
  CHECK_THROWS_WITH(sdf::load((folder.path / "30.sdf").string()), containing("more than") || containing("altogether"));
}

TEST_CASE("a model that takes libsdformat more than memory allows is refused at once, with the way out", "[fault]") {
  std::string links;
  for (int k = 0; k < 100000; ++k) links += "<link name='l" + std::to_string(k) + "'/>\n";
  CHECK_THROWS_WITH(read(links),
                    containing("robot.sdf:20000") && containing("more than 20000 elements") && containing(".dyn.json") && containing("append()"));
}

TEST_CASE("elements nested 10^5 deep and text that a terminal would obey are refused", "[fault]") {
  std::string deep = "<sdf version='1.9'>";
  for (int i = 0; i < 100000; ++i) deep += "<model name='m'>";
  CHECK_THROWS_WITH(parse(deep), containing("deep"));
  CHECK_THROWS_WITH(read(linkText("a\x1b[31m")), containing("control character"));
}

TEST_CASE("SDF's numbers are the same under a locale with decimal commas", "[fault]") {
  const std::string before = std::setlocale(LC_ALL, nullptr);
  const bool set = std::setlocale(LC_ALL, "de_DE.UTF-8") != nullptr;
  const Model model = read(linkText("a", "<inertial><pose>0.5 0 0 0 0 0</pose><mass>0.25</mass></inertial>"));
  std::setlocale(LC_ALL, before.c_str());
  CHECK(model.bodies[1].inertia.mass == 0.25);
  CHECK(model.bodies[1].inertia.com.x == 0.5);
  (void)set;
}
