// SPDX-License-Identifier: BSD-2-Clause
#include "devices.hpp"

#include <array>
#include <memory>
#include <set>
#include <string_view>

namespace dyn::mjcf {

namespace {

using tinyxml2::XMLElement;

/// Attributes that name other things than joints and tendons.
constexpr std::string_view other_references[] = {"jointinparent", "site",   "body",  "cranksite", "slidersite", "refsite", "geom",
                                                 "geom1",         "geom2",  "body1", "body2",     "objname",    "refname", "objtype",
                                                 "actuator",      "camera", "mesh",  "plugin",    "instance"};

class DeviceWriter {
 public:
  DeviceWriter(const Joints& joints, xml::Output& out) : joints_(joints), out_(out) {}

  void write(const Model& model) {
    using Kind = DeviceDescription::Kind;
    // Tendons come first, because actuators and sensors name them.
    const std::array<std::pair<Kind, const char*>, 3> sections{{{Kind::tendon, "tendon"}, {Kind::actuator, "actuator"}, {Kind::sensor, "sensor"}}};
    for (const auto& [kind, section] : sections) {
      bool open = false;
      for (const DeviceDescription& device : model.devices) {
        if (device.kind != kind) continue;
        tinyxml2::XMLDocument document;
        if (document.Parse(device.text.data(), device.text.size()) != tinyxml2::XML_SUCCESS || !holds(document.RootElement(), device)) {
          out_.lose("actuators, tendons and sensors", device.name);
          continue;
        }
        if (!open) out_.open(section);
        open = true;
        out_.copy(*document.RootElement());
        if (kind == Kind::tendon) tendons_.insert(device.name);
      }
      if (open) out_.close();
    }
  }

 private:
  /// Whether the element is the device and its names mean the same in the file that is written.
  bool holds(const XMLElement* e, const DeviceDescription& device) const {
    if (e == nullptr || device.type != e->Name() || e->NextSibling() != nullptr) return false;
    if (device.kind != DeviceDescription::Kind::tendon) return refersWell(*e) && e->NoChildren();
    if (device.type != "fixed" || device.name.empty() || !refersWell(*e)) return false;
    for (const tinyxml2::XMLNode* child = e->FirstChild(); child; child = child->NextSibling()) {
      const XMLElement* joint = child->ToElement();
      if (joint == nullptr || std::string_view(joint->Name()) != "joint" || !refersWell(*joint) || !joint->NoChildren()) return false;
    }
    return true;
  }
  bool refersWell(const XMLElement& e) const {
    for (const std::string_view name : other_references)
      if (e.Attribute(std::string(name).c_str()) != nullptr) return false;
    const char *joint = e.Attribute("joint"), *tendon = e.Attribute("tendon");
    return (joint == nullptr || joints_.scalar(joint) == joint) && (tendon == nullptr || tendons_.count(tendon) > 0);
  }

  const Joints& joints_;
  xml::Output& out_;
  std::set<std::string, std::less<>> tendons_;
};

}  // namespace

void writeDevices(const Model& model, const Joints& joints, xml::Output& out) { DeviceWriter(joints, out).write(model); }

}  // namespace dyn::mjcf
