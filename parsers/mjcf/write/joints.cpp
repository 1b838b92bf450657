// SPDX-License-Identifier: BSD-2-Clause
#include "joints.hpp"

#include "common/reader.hpp"
#include "types.hpp"

#include <dyn/lie/so3.hpp>

#include <algorithm>
#include <cmath>

namespace dyn::mjcf {

namespace {

using Numbers = std::vector<double>;
using Kind = PlainJoint::Type;

constexpr Vec3<double> x_axis{1, 0, 0}, y_axis{0, 1, 0}, z_axis{0, 0, 1};

Vec3<double> column(const Mat3<double>& R, int k) { return {R(0, k), R(1, k), R(2, k)}; }

/// Composite joints may be nested so deep.
constexpr int deepest_parts = 8;

}  // namespace

std::string Joints::scalar(const std::string& name) const {
  const auto found = scalars_.find(name);
  return found == scalars_.end() ? "" : found->second;
}

JointChain Joints::chainOf(const JointDescription& joint, bool on_world) {
  JointChain out;
  add(joint, joint.name, cast<long double>(joint.placement), on_world, 0, out);
  return out;
}

void Joints::add(const JointDescription& joint, const std::string& name, const SE3<long double>& placement, bool on_world, int depth,
                 JointChain& chain) {
  const std::size_t first = chain.joints.size();
  chain.after = chain.after * placement;
  if (joint.type == "composite") {
    if (depth > deepest_parts) refuse(joint, "joints made of joints are nested deeper than " + std::to_string(deepest_parts));
    const std::vector<JointDescription>& parts = partsOf(joint);
    if (depth == 0) out_.lose("joints of the type 'composite', which become the joints of their parts", name);
    for (std::size_t k = 0; k < parts.size(); ++k) {
      const JointDescription& part = parts[k];
      add(part, name + "/" + (part.name.empty() ? std::to_string(k) : part.name), cast<long double>(part.placement), false, depth + 1, chain);
    }
  } else {
    addPlain(joint, name, on_world, chain);
    follow(joint, name, chain.joints.size() > first && spaceOf(joint).nv == 1);
  }
  layOut(joint, first, name, chain);
}

void Joints::addPlain(const JointDescription& joint, const std::string& name, bool on_world, JointChain& chain) {
  const std::string& t = joint.type;
  const std::size_t nv = spaceOf(joint).nv;  // refuses unknown types
  const std::size_t first = chain.joints.size();
  const auto put = [&](Kind type, const Vec3<double>& axis, std::size_t nq, std::size_t own) {
    PlainJoint plain;
    plain.type = type;
    plain.axis = axis;
    plain.nq = nq;
    plain.nv = own;
    plain.placement = chain.after;
    chain.after = {};
    chain.joints.push_back(std::move(plain));
  };
  const auto hinge = [&](const Vec3<double>& axis, std::size_t nq = 1) { put(Kind::hinge, axis, nq, 1); };
  const auto slide = [&](const Vec3<double>& axis) { put(Kind::slide, axis, 1, 1); };
  const auto slides = [&] {
    for (const Vec3<double>& axis : {x_axis, y_axis, z_axis}) slide(axis);
  };
  const char* becomes = nullptr;
  if (t == "revolute") {
    hinge(vectorIn(joint, "axis"));
  } else if (t == "continuous") {
    hinge(vectorIn(joint, "axis"), 2);
    out_.lose("coordinates cos and sin of continuous joints, which become an angle", joint.name);
  } else if (t == "prismatic") {
    slide(vectorIn(joint, "axis"));
  } else if (t == "helical") {
    hinge(vectorIn(joint, "axis"));
    put(Kind::slide, vectorIn(joint, "axis"), 0, 0);
    becomes = "a hinge and a slide, tied by an equality";
  } else if (t == "cylindrical") {
    hinge(vectorIn(joint, "axis"));
    slide(vectorIn(joint, "axis"));
    becomes = "a hinge and a slide";
  } else if (t == "universal") {
    hinge(vectorIn(joint, "axis"));
    hinge(vectorIn(joint, "axis2"));
    becomes = "two hinges";
  } else if (t == "spherical") {
    put(Kind::ball, {}, 4, 3);
  } else if (t == "spherical_zyx") {
    for (const Vec3<double>& axis : {z_axis, y_axis, x_axis}) hinge(axis);
    becomes = "three hinges";
  } else if (t == "translation") {
    slides();
    becomes = "three slides";
  } else if (t == "planar") {
    const Mat3<double> axes = planeOf(joint);
    slide(column(axes, 0));
    slide(column(axes, 1));
    hinge(column(axes, 2), 2);
    becomes = "two slides and a hinge, with an angle, and with velocities, forces and losses along the axes of the parent";
  } else if (t == "free_flyer" && on_world) {
    put(Kind::free, {}, 7, 6);
    if (!isIdentity(chain.joints.back().placement.R) || dot(chain.joints.back().placement.p, chain.joints.back().placement.p) != 0)
      out_.lose("places of free joints, whose coordinates become the pose in the world", joint.name);
  } else if (t == "free_flyer") {
    slides();
    put(Kind::ball, {}, 4, 3);
    becomes = "three slides and a ball, with velocities, forces and losses along the axes of the parent";
  }
  if (becomes != nullptr) out_.lose("joints of the type '" + t + "', which become " + becomes, joint.name);
  const bool one = nv == 1 || chain.joints.size() - first == 1;
  for (std::size_t k = first; k < chain.joints.size(); ++k) {
    PlainJoint& plain = chain.joints[k];
    const bool own = one && k == first;
    // The names of the model's joints are kept for them; those of parts have a prefix.
    plain.name = own && name == joint.name ? name : reader::freeName(own ? name : name + "/" + std::to_string(k - first), names_);
    if (nv == 1 && own) scalars_.emplace(name, plain.name);
  }
  if (t == "helical") {
    scalars_.emplace(chain.joints.back().name, chain.joints.back().name);
    dependences_.push_back({chain.joints.back().name, name, {0, pitchOf(joint)}});
  }
}

void Joints::follow(const JointDescription& joint, const std::string& name, bool scalar) {
  if (joint.coupling.type.empty()) return;
  const auto found = joint.coupling.parameters.find("coefficients");
  const auto* numbers = found == joint.coupling.parameters.end() ? nullptr : std::get_if<Numbers>(&found->second);
  if (!scalar || joint.coupling.type != "mimic" || numbers == nullptr || numbers->empty() || numbers->size() > 5) {
    out_.lose("couplings of joints that are no polynomial of degree 4 or less, so that these joints move on their own", name);
    return;
  }
  out_.lose("dependent joints, which become joints of their own, tied by an equality", name);
  dependences_.push_back({name, joint.coupling.master, *numbers});
}

void Joints::layOut(const JointDescription& joint, std::size_t first, const std::string& name, JointChain& chain) {
  std::size_t q = 0, v = 0;
  for (std::size_t i = first; i < chain.joints.size(); ++i) {
    PlainJoint& plain = chain.joints[i];
    for (const auto& [values, bound] : {std::pair{&joint.limits.lower, &plain.lower}, {&joint.limits.upper, &plain.upper}}) {
      if (plain.nq == 0 || values->size() < q + plain.nq) continue;
      if (plain.nq == 1) {
        *bound = (*values)[q];
      } else if (std::any_of(values->data() + q, values->data() + q + plain.nq, [](double x) { return std::isfinite(x); })) {
        out_.lose("limits of the positions of ball and free joints and of angles as cos and sin", name);
      }
    }
    const std::pair<const Numbers*, double*> shared[] = {{&joint.limits.effort, &plain.effort},
                                                         {&joint.armature, &plain.armature},
                                                         {&joint.damping, &plain.damping},
                                                         {&joint.friction, &plain.friction}};
    for (const auto& [values, one] : shared) {
      if (plain.nv == 0 || values->size() < v + plain.nv) continue;
      const double* own = values->data() + v;
      const bool equal = std::all_of(own, own + plain.nv, [&](double x) { return x == *own; });
      if (plain.nv > 1 && (!equal || (one == &plain.effort && std::isfinite(*own)))) {
        out_.lose("limits of effort of ball and free joints, and armature, damping and friction that differ between their axes", name);
      } else {
        *one = *own;
      }
    }
    q += plain.nq;
    v += plain.nv;
  }
  const JointLimits& l = joint.limits;
  for (const Numbers* values : {&l.velocity, &l.acceleration, &l.deceleration, &l.jerk})
    if (std::any_of(values->begin(), values->end(), [](double x) { return std::isfinite(x); }))
      out_.lose("limits of velocity, acceleration, deceleration and jerk", name);
  if (joint.held) out_.lose("marks of joints that reduce() holds", name);
}

bool isIdentity(const Mat3<long double>& R) {
  const Mat3<long double> one = Mat3<long double>::identity();
  return std::equal(std::begin(R.m), std::end(R.m), std::begin(one.m));
}

void putPose(xml::Output& out, const SE3<double>& X) {
  if (X.p.x != 0 || X.p.y != 0 || X.p.z != 0) out.put("pos", X.p);
  const Mat3<long double> R = cast<long double>(X.R);
  if (isIdentity(R)) return;
  const Quaternion<long double> q = quaternionOf(R);
  Numbers wxyz;
  for (const long double x : {q.w, q.x, q.y, q.z}) wxyz.push_back(static_cast<double>(x) + 0.0);  // no -0
  out.put("quat", wxyz);
}

void writeJoint(xml::Output& out, const PlainJoint& joint, const SE3<long double>& frame) {
  const bool bare = joint.armature == 0 && joint.damping == 0 && joint.friction == 0;
  static constexpr const char* types[] = {"free", "ball", "slide", "hinge"};
  out.open(joint.type == Kind::free && bare ? "freejoint" : "joint");
  out.put("name", joint.name);
  if (joint.type != Kind::free || !bare) out.put("type", std::string(types[static_cast<int>(joint.type)]));
  if (joint.type != Kind::free && dot(frame.p, frame.p) != 0) out.put("pos", cast<double>(frame.p));
  if (joint.axial()) {
    out.put("axis", isIdentity(frame.R) ? joint.axis : cast<double>(frame.R * cast<long double>(joint.axis)));
    constexpr double most = std::numeric_limits<double>::max();
    if (joint.lower != -unlimited || joint.upper != unlimited) {
      if (joint.lower < joint.upper) {
        if (joint.lower == -unlimited || joint.upper == unlimited)
          out.lose("infinite limits beside finite ones, which become the largest number", joint.name);
        out.put("range", Numbers{std::max(joint.lower, -most), std::min(joint.upper, most)});
      } else {
        out.lose("ranges of a single position", joint.name);
      }
    }
    if (std::isfinite(joint.effort) && joint.effort > 0) out.put("actuatorfrcrange", Numbers{-joint.effort, joint.effort});
    if (joint.effort <= 0) out.lose("limits of effort of zero", joint.name);
  }
  if (joint.armature != 0) out.put("armature", joint.armature);
  if (joint.damping != 0) out.put("damping", joint.damping);
  if (joint.friction != 0) out.put("frictionloss", joint.friction);
  out.close();
}

}  // namespace dyn::mjcf
