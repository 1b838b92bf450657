// SPDX-License-Identifier: BSD-2-Clause
#include "equality.hpp"

#include "common/reader.hpp"

#include <algorithm>

namespace dyn::mjcf {

namespace {

using Numbers = std::vector<double>;

bool isZero(const SE3<double>& X) { return X.p.x == 0 && X.p.y == 0 && X.p.z == 0 && isIdentity(cast<long double>(X.R)); }

}  // namespace

EqualityWriter::EqualityWriter(const Model& model, xml::Output& out, std::set<std::string> names)
    : model_(model), out_(out), names_(std::move(names)), sites_(model.bodies.size()) {
  for (std::size_t i = 0; i < model.bodies.size(); ++i) places_.emplace(model.bodies[i].name, Place{i, {}, false});
  for (const FrameDescription& f : model.frames) {
    places_.emplace(f.name, Place{static_cast<std::size_t>(f.body), f.placement, true});
    sites_[static_cast<std::size_t>(f.body)].push_back({f.name, f.placement});
  }
  for (const ConstraintDescription& c : model.constraints)
    if (const auto* frames = std::get_if<FrameConstraint>(&c.relation)) findTies(c, *frames);
}

std::string EqualityWriter::siteOf(const std::string& frame, const SE3<double>& placement, const std::string& name) {
  const auto found = places_.find(frame);
  if (found == places_.end()) throw Error(ErrorCode::model, "cannot be written: a constraint names frame '" + frame + "', which does not exist");
  const auto& [body, pose, is_site] = found->second;
  if (is_site && isZero(placement)) return frame;
  sites_[body].push_back({reader::freeName(name, names_), cast<double>(cast<long double>(pose) * cast<long double>(placement))});
  return sites_[body].back().name;
}

void EqualityWriter::findTies(const ConstraintDescription& c, const FrameConstraint& f) {
  const auto turning = std::count(f.free.begin() + 3, f.free.end(), true), sliding = std::count(f.free.begin(), f.free.begin() + 3, true);
  if (!f.has_target || sliding > 0 || turning == 2) {
    out_.lose(f.has_target ? "loops that slide or turn about two axes" : "contacts of frames, which hold a point wherever it is", c.name);
    return;
  }
  if (f.axes != ConstraintAxes::OTHER) out_.lose("axes of a constraint's forces, which become those of its second frame", c.name);
  const std::string one = c.name + "_1", other = c.name + "_2";
  ties_.push_back({&c, siteOf(f.frame, f.placement, one), siteOf(f.other, f.other_placement, other), turning == 0});
  if (turning != 1) return;
  // Two points of an axis that coincide make a hinge. The axis is that of the second frame, and of the first one in the closed loop.
  SE3<double> along;
  for (std::size_t k = 0; k < 3; ++k) along.p[static_cast<int>(k)] = f.free[3 + k] ? 1 : 0;
  out_.lose("loops that turn about one axis, which become two points that are connected, 1 m apart", c.name);
  ties_.push_back(
      {&c, siteOf(f.frame, f.placement * along, one + "_axis"), siteOf(f.other, f.other_placement * along, other + "_axis"), false, true});
}

void EqualityWriter::begin(const char* element, const std::string& name) {
  if (!open_) out_.open("equality");
  open_ = true;
  out_.open(element);
  out_.put("name", reader::freeName(name, used_));
}

void EqualityWriter::putFeedback(const Baumgarte& gains) {
  // Numbers that are not positive are stiffness and damping themselves.
  out_.put("solref", Numbers{0 - gains.position, 0 - gains.velocity});
}

void EqualityWriter::couple(const std::string& name, const std::string& joint, const std::string& master, const Numbers& coefficients) {
  begin("joint", name);
  out_.put("joint1", joint);
  if (!master.empty()) out_.put("joint2", master);
  Numbers all = coefficients;
  all.resize(5, 0);
  out_.put("polycoef", all);
}

void EqualityWriter::relate(const ConstraintDescription& c, const Joints& joints) {
  if (const auto* lock = std::get_if<JointLock>(&c.relation)) {
    const std::string joint = joints.scalar(lock->joint);
    if (joint.empty() || lock->configuration.size() != 1) {
      out_.lose("locks of joints with several coordinates, or without a position", c.name);
      return;
    }
    couple(c.name, joint, "", lock->configuration);
  } else if (const auto* coupling = std::get_if<JointCoupling>(&c.relation)) {
    const auto found = coupling->coupling.parameters.find("coefficients");
    const auto* numbers = found == coupling->coupling.parameters.end() ? nullptr : std::get_if<Numbers>(&found->second);
    const std::string joint = joints.scalar(coupling->joint), master = joints.scalar(coupling->coupling.master);
    if (coupling->coupling.type != "mimic" || numbers == nullptr || numbers->empty() || numbers->size() > 5 || joint.empty() || master.empty()) {
      out_.lose("gears that are no polynomial of degree 4 or less between two hinges or slides", c.name);
      return;
    }
    couple(c.name, joint, master, *numbers);
  } else {
    return;
  }
  putFeedback(c.baumgarte);
  out_.close();
}

void EqualityWriter::write(const Joints& joints) {
  std::size_t next = 0;
  for (const ConstraintDescription& c : model_.constraints) {
    for (; next < ties_.size() && ties_[next].constraint == &c; ++next) {
      const Tie& tie = ties_[next];
      begin(tie.weld ? "weld" : "connect", tie.unnamed_axis ? c.name + "_axis" : c.name);
      out_.put("site1", tie.one);
      out_.put("site2", tie.other);
      putFeedback(c.baumgarte);
      out_.close();
    }
    relate(c, joints);
  }
  for (const Dependence& d : joints.dependences()) {
    const std::string joint = joints.scalar(d.joint), master = joints.scalar(d.master);
    if (master.empty())
      throw Error(ErrorCode::model, "cannot be written: joint '" + d.joint + "' depends on '" + d.master + "', which is no joint of one coordinate");
    couple(d.joint, joint, master, d.coefficients);
    out_.close();
  }
  if (open_) out_.close();
}

}  // namespace dyn::mjcf
