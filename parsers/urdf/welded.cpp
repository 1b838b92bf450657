// SPDX-License-Identifier: BSD-2-Clause
#include "welded.hpp"

#include "extension.hpp"

#include <algorithm>
#include <cmath>
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

bool isPositiveSemidefinite(const Sym3<double>& I, double slack) {
  const double scale = std::max({std::fabs(I.xx), std::fabs(I.yy), std::fabs(I.zz), std::fabs(I.xy), std::fabs(I.xz), std::fabs(I.yz)});
  if (scale == 0) return true;
  // Scaled by the largest entry, so that no product of three entries leaves the range of doubles.
  const double s = slack / scale, xy = I.xy / scale, xz = I.xz / scale, yz = I.yz / scale;
  const double xx = I.xx / scale + s, yy = I.yy / scale + s, zz = I.zz / scale + s;
  const double determinant = xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz);
  return !(xx < 0 || yy < 0 || zz < 0 || xx * yy < xy * xy || xx * zz < xz * xz || yy * zz < yz * yz || determinant < 0);
}

double slackOf(const Inertia<double>& Y) {
  const Sym3<double>& I = Y.rotational;
  const double scale = std::max({std::fabs(I.xx), std::fabs(I.yy), std::fabs(I.zz), std::fabs(I.xy), std::fabs(I.xz), std::fabs(I.yz)});
  return 1e-6 * scale + 1e-15 * Y.mass * dot(Y.com, Y.com);
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

bool WeldedBodies::isPhysical(const std::string& link) const {
  const Inertia<double> Y = cast<double>(bodies_[of_.at(link)].inertia);
  return isPositiveSemidefinite(Y.rotational, slackOf(Y));
}

}  // namespace dyn::urdf
