// SPDX-License-Identifier: BSD-2-Clause
// Actuators, tendons and sensors, which the description keeps as elements that need no default class.
#include "scene.hpp"

#include <cstring>

namespace dyn::mjcf {

namespace {

/// The element in XML, with the attributes of its default class and without the name of that.
std::string textOf(const Context& context, const XMLElement& e, const DefaultClass& main) {
  tinyxml2::XMLDocument document;
  XMLElement& copy = *e.DeepClone(&document)->ToElement();
  document.InsertEndChild(&copy);
  const DefaultClass& own = context.defaults.classOf(e, main);
  // Tendons of all kinds share the values of <tendon>.
  const auto values = own.kinds.find(std::strcmp(e.Parent()->Value(), "tendon") == 0 ? "tendon" : e.Name());
  copy.DeleteAttribute("class");
  if (values != own.kinds.end())
    for (const auto& [attribute, holder] : values->second->attributes) {
      const std::string key(attribute);
      if (copy.Attribute(key.c_str()) == nullptr && key != "class" && key != "name") copy.SetAttribute(key.c_str(), holder->Attribute(key.c_str()));
    }
  tinyxml2::XMLPrinter printer(nullptr, true);
  copy.Accept(&printer);
  return printer.CStr();
}

}  // namespace

void readDevices(const Context& context, Scene& scene, const Guard& guard) {
  using Kind = DeviceDescription::Kind;
  const XMLElement& root = context.source.root();
  const DefaultClass& main = context.defaults.find("", root);
  for (const auto& [section, kind] : {std::pair("actuator", Kind::actuator), std::pair("tendon", Kind::tendon), std::pair("sensor", Kind::sensor)})
    context.source.forEach(root, [&, section = section, kind = kind](const XMLElement& e) {
      if (std::strcmp(e.Name(), section) != 0) return;
      context.source.forEach(e, [&](const XMLElement& device) {
        guard([&] {
          const char* name = device.Attribute("name");
          scene.model.devices.push_back({kind, device.Name(), name ? name : "", textOf(context, device, main), context.source.where(device)});
        });
      });
    });
}

}  // namespace dyn::mjcf
