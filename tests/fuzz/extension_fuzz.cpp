// SPDX-License-Identifier: BSD-2-Clause
// Fuzzes the text of extension elements such as <libdyn>, appended to a valid robot.
#include "exercise.hpp"
#include "fuzz.hpp"

#include <dyn/parsers/urdf.hpp>

using namespace dyn;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const JointRegistry registry = JointRegistry::standard();
  const std::string inertial =
      "<inertial><mass value='1'/><origin xyz='0.1 0 0'/><inertia ixx='0.1' iyy='0.1' izz='0.1' ixy='0' ixz='0' iyz='0'/></inertial>";
  std::string text = "<robot name='r'><link name='a'/>";
  for (const char* name : {"b", "c", "d"}) text += std::string("<link name='") + name + "'>" + inertial + "</link>";
  text +=
      "<joint name='j' type='revolute'><parent link='a'/><child link='b'/><axis xyz='0 0 1'/><limit lower='-1' upper='1' effort='1' velocity='1'/>"
      "</joint><joint name='k' type='continuous'><parent link='b'/><child link='c'/><axis xyz='0 1 0'/></joint>"
      "<joint name='l' type='prismatic'><parent link='b'/><child link='d'/><axis xyz='1 0 0'/><limit lower='-1' upper='1' effort='1' velocity='1'/>"
      "</joint>";
  text.append(reinterpret_cast<const char*>(data), size);
  text += "</robot>";
  fuzz::succeeds([&] {
    const Model description = urdf::parse(text, "fuzz.urdf");
    fuzz::exercise(description, compile(description, registry), size);
  });
  return 0;
}
