// SPDX-License-Identifier: BSD-2-Clause
#include "welded.hpp"

#include "common/inertia.hpp"
#include "extension.hpp"

#include <cstring>
#include <unordered_set>

namespace dyn::urdf {

using tinyxml2::XMLElement;

namespace {

/// The joints to which an extension gives a type that moves.
std::unordered_set<std::string> movedByExtensions(const Document& document) {
  std::unordered_set<std::string> out;
  for (const XMLElement* block = document.robot().FirstChildElement("libdyn"); block; block = block->NextSiblingElement("libdyn"))
    for (const XMLElement* e = block->FirstChildElement("joint"); e; e = e->NextSiblingElement("joint"))
      if (e->Attribute("name") && e->Attribute("type") && std::strcmp(e->Attribute("type"), "fixed") != 0) out.insert(e->Attribute("name"));
  return out;
}

}  // namespace

Inertia<double> inertiaOf(const Document& document, const XMLElement& link) {
  const XMLElement* e = link.FirstChildElement("inertial");
  if (e == nullptr) return {};
  const XMLElement& m = *e->FirstChildElement("mass");
  const XMLElement& i = *e->FirstChildElement("inertia");
  Inertia<double> Y;
  Y.mass = document.number(m, "value");
  Y.rotational = {document.number(i, "ixx"), document.number(i, "ixy", 0), document.number(i, "ixz", 0),
                  document.number(i, "iyy"), document.number(i, "iyz", 0), document.number(i, "izz")};
  const XMLElement* origin = e->FirstChildElement("origin");
  const SE3<double> X = origin ? poseOf(document, *origin) : SE3<double>{};
  return cast<double>(cast<long double>(Y).transformed(cast<long double>(X)));
}

WeldedBodies::WeldedBodies(const Document& document, const Outline& outline) {
  const std::unordered_set<std::string> moved = movedByExtensions(document);
  struct Entry {
    std::string link;
    std::size_t body;
    SE3<long double> pose;  ///< of the link in the frame of the body's first link
  };
  bodies_.emplace_back();
  std::vector<Entry> stack{{outline.root, 0, {}}};
  while (!stack.empty()) {
    const Entry e = std::move(stack.back());
    stack.pop_back();
    of_.emplace(e.link, e.body);
    Body& body = bodies_[e.body];
    body.inertia = body.inertia + cast<long double>(inertiaOf(document, *outline.link.at(e.link))).transformed(e.pose);
    ++body.links;
    const auto below = outline.joints_below.find(e.link);
    if (below == outline.joints_below.end()) continue;
    for (const XMLElement* joint : below->second) {
      const std::string child = linkOf(document, *joint, "child");
      if (std::strcmp(joint->Attribute("type"), "fixed") != 0 || moved.count(joint->Attribute("name"))) {
        stack.push_back({child, bodies_.size(), {}});
        bodies_.emplace_back();
      } else {
        const XMLElement* origin = joint->FirstChildElement("origin");
        stack.push_back({child, e.body, origin ? e.pose * cast<long double>(poseOf(document, *origin)) : e.pose});
      }
    }
  }
}

bool WeldedBodies::isPhysical(const std::string& link) const { return !reader::faultsOf(cast<double>(bodies_[of_.at(link)].inertia)).indefinite; }

}  // namespace dyn::urdf
