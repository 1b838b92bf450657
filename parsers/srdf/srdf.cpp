// SPDX-License-Identifier: BSD-2-Clause
#include "urdf/document.hpp"

#include <dyn/file.hpp>
#include <dyn/near_names.hpp>
#include <dyn/parsers/srdf.hpp>

namespace dyn::srdf {

void parse(const std::string& text, const std::string& name, Model& model) {
  const urdf::Document document(text, name);
  std::vector<DisabledCollision> found;
  std::vector<std::string> notes;
  for (const tinyxml2::XMLElement* e = document.robot().FirstChildElement("disable_collisions"); e; e = e->NextSiblingElement("disable_collisions")) {
    DisabledCollision d{document.text(*e, "link1"), document.text(*e, "link2"), e->Attribute("reason") ? e->Attribute("reason") : ""};
    for (const std::string& link : {d.body, d.other})
      if (model.findBody(link) < 0) {
        // Only the first notes have suggestions, because each costs a search of all names.
        const std::string near = notes.size() < 10 ? nearNames(link, namesOf(model.bodies)) : "";
        notes.push_back(name + ":" + std::to_string(e->GetLineNum()) + ": there is no link '" + link + "'" + near);
      }
    found.push_back(std::move(d));
  }
  model.disabled_collisions.insert(model.disabled_collisions.end(), found.begin(), found.end());
  model.notes.insert(model.notes.end(), notes.begin(), notes.end());
}

void load(const std::string& path, Model& model) { parse(readFile(path, urdf::largest_file), path, model); }

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
