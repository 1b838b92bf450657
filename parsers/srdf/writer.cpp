// SPDX-License-Identifier: BSD-2-Clause
#include <dyn/file.hpp>
#include <dyn/parsers/srdf.hpp>

#include <tinyxml2.h>

namespace dyn::srdf {

std::string text(const std::string& robot, const std::vector<DisabledCollision>& disabled) {
  tinyxml2::XMLPrinter printer;
  printer.PushHeader(false, true);
  printer.OpenElement("robot");
  printer.PushAttribute("name", robot.c_str());
  for (const DisabledCollision& d : disabled) {
    printer.OpenElement("disable_collisions");
    printer.PushAttribute("link1", d.body.c_str());
    printer.PushAttribute("link2", d.other.c_str());
    printer.PushAttribute("reason", d.reason.c_str());
    printer.CloseElement();
  }
  printer.CloseElement();
  return printer.CStr();
}

void write(const std::string& path, const std::string& robot, const std::vector<DisabledCollision>& disabled) {
  replaceFile(path, text(robot, disabled));
}

}  // namespace dyn::srdf
