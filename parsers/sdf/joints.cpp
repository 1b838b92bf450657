// SPDX-License-Identifier: BSD-2-Clause
// Joints of the tree, closures of loops, and gearboxes.
#include "parts.hpp"
#include "xml/document.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <sdf/JointAxis.hh>

namespace dyn::sdf {

namespace {

using Type = ::sdf::JointType;
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double no_limit = 1e16;  ///< SDF's limit that is none

[[noreturn]] void refuse(const Context& context, const JointRead& read, const std::string& why) {
  throw Error(ErrorCode::model, why, context.where(*read.joint, read.name));
}

/// Returns the direction of an axis in the joint's frame.
Vec3<double> directionOf(const Context& context, const JointRead& read, unsigned number) {
  const ::sdf::JointAxis* axis = read.joint->Axis(number);
  if (axis == nullptr) refuse(context, read, std::string("has no <axis") + (number > 0 ? "2>" : ">"));
  ignition::math::Vector3d xyz;
  throwFirst(axis->ResolveXyz(xyz), context.sources);
  return vectorOf(xyz);
}

/// Appends the limits and the dissipation of one axis.
void appendAxis(const Context& context, const JointRead& read, unsigned number, JointDescription& joint) {
  const ::sdf::JointAxis& axis = *read.joint->Axis(number);
  const int line = context.where(axis).line;
  if (axis.Lower() > axis.Upper()) refuse(context, read, "its lower limit is above its upper one");
  if (axis.Damping() < 0 || axis.Friction() < 0) refuse(context, read, "its damping or friction is negative");
  if (axis.SpringStiffness() != 0) context.notes.add("ignored: the spring of a joint (spring_stiffness)", line);
  joint.limits.lower.push_back(axis.Lower() <= -no_limit ? -infinity : axis.Lower());
  joint.limits.upper.push_back(axis.Upper() >= no_limit ? infinity : axis.Upper());
  joint.limits.effort.push_back(axis.Effort());
  joint.limits.velocity.push_back(axis.MaxVelocity());
  joint.damping.push_back(axis.Damping());
  joint.friction.push_back(axis.Friction());
}

/// Lists of which every entry says nothing are left out.
void dropEmpty(JointDescription& joint) {
  const auto drop = [](std::vector<double>& list, double nothing) {
    if (std::all_of(list.begin(), list.end(), [&](double x) { return x == nothing; })) list.clear();
  };
  drop(joint.limits.lower, -infinity);
  drop(joint.limits.upper, infinity);
  drop(joint.limits.effort, infinity);
  drop(joint.limits.velocity, infinity);
  drop(joint.damping, 0);
  drop(joint.friction, 0);
}

/// Returns the number in an element that libsdformat may not know, because it is newer.
double numberIn(const Context& context, const JointRead& read, const ::sdf::ElementPtr& parent, const char* name, double otherwise) {
  if (!parent->HasElement(name)) return otherwise;
  std::vector<double> numbers;
  const std::string text = parent->GetElement(name)->Get<std::string>();
  if (!xml::onlyNumbers(text, numbers) || numbers.size() != 1) refuse(context, read, std::string("<") + name + "> must be a finite number");
  return numbers[0];
}

/// Returns the translation per radian of a screw. A <thread_pitch> of t rad/m moves by -1/t m/rad, so that positive ones are left-handed; the newer
/// <screw_thread_pitch> is the translation per revolution, of which positive ones are right-handed.
double pitchOf(const Context& context, const JointRead& read) {
  const ::sdf::ElementPtr e = read.joint->Element();
  if (e && e->HasElement("screw_thread_pitch")) return numberIn(context, read, e, "screw_thread_pitch", 0) / (2 * std::numbers::pi);
  const double thread = read.joint->ThreadPitch();
  if (thread == 0) refuse(context, read, "its <thread_pitch> is zero; it is in radians per metre");
  return -1 / thread;
}

void readMimic(const Context& context, const JointRead& read, JointDescription& joint) {
  const ::sdf::JointAxis* axis = read.joint->Axis(0);
  const ::sdf::ElementPtr e = axis ? axis->Element() : nullptr;
  if (!e || !e->HasElement("mimic")) return;
  const ::sdf::ElementPtr mimic = e->GetElement("mimic");
  if (context.options.mimic == Mimic::independent) return context.notes.add("a mimic joint moves on its own");
  context.notes.add("a mimic joint follows its master");
  if (!mimic->HasAttribute("joint")) refuse(context, read, "<mimic> names no joint");
  const double multiplier = numberIn(context, read, mimic, "multiplier", 1), offset = numberIn(context, read, mimic, "offset", 0),
               reference = numberIn(context, read, mimic, "reference", 0);
  joint.coupling.type = "mimic";
  // Names are those of the joint's own model.
  joint.coupling.master = read.name.substr(0, read.name.size() - read.joint->Name().size()) + mimic->Get<std::string>("joint");
  joint.coupling.parameters["coefficients"] = std::vector<double>{offset - multiplier * reference, multiplier};
}

std::vector<double> listOf(const Vec3<double>& v) { return {v.x, v.y, v.z}; }

JointDescription hinge(const Vec3<double>& axis) {
  JointDescription joint;
  joint.type = "revolute";
  joint.parameters["axis"] = listOf(axis);
  return joint;
}

/// Returns a right-handed frame whose z is along n.
Mat3<double> frameWithZ(const Vec3<double>& n) {
  const Vec3<double> other = std::fabs(n.x) < 0.6 ? Vec3<double>{1, 0, 0} : Vec3<double>{0, 1, 0};
  const Vec3<double> c = cross(n, other);
  const double length = std::sqrt(dot(c, c)), size = std::sqrt(dot(n, n));
  const Vec3<double> z = (1 / size) * n, x = (1 / length) * c, y = cross(z, x);
  Mat3<double> R;
  for (int i = 0; i < 3; ++i) {
    R(i, 0) = x[i];
    R(i, 1) = y[i];
    R(i, 2) = z[i];
  }
  return R;
}

double lengthOf(const Vec3<double>& v) { return std::sqrt(dot(v, v)); }

}  // namespace

JointMotion motionOf(const Context& context, const JointRead& read, bool reversed) {
  const Type type = read.joint->Type();
  const SE3<double>&in_parent = reversed ? read.in_child : read.in_parent, &in_child = reversed ? read.in_parent : read.in_child;
  JointMotion out;
  JointDescription& joint = out.joint;
  // A link whose origin is the joint's has the joint's motion; rounding of resolved poses does not count.
  out.from_link = type == Type::FIXED || type == Type::PRISMATIC || lengthOf(in_child.p) <= 1e-13 * read.size;
  const auto axis = [&](unsigned number) {
    const Vec3<double> n = (reversed ? -1.0 : 1.0) * directionOf(context, read, number);
    return out.from_link ? in_child.R * n : n;
  };
  const auto oneAxis = [&](const char* name) {
    joint.type = name;
    joint.parameters["axis"] = listOf(axis(0));
    appendAxis(context, read, 0, joint);
  };
  switch (type) {
    case Type::FIXED:
      joint.type = "fixed";
      break;
    case Type::REVOLUTE:
      oneAxis("revolute");
      break;
    case Type::CONTINUOUS:
      oneAxis(context.options.continuous == Continuous::angle ? "revolute" : "continuous");
      joint.limits.lower.clear();
      joint.limits.upper.clear();
      break;
    case Type::PRISMATIC:
      oneAxis("prismatic");
      break;
    case Type::SCREW:
      oneAxis("helical");
      joint.parameters["pitch"] = std::vector<double>{pitchOf(context, read)};
      break;
    case Type::BALL:
      joint.type = "spherical";
      break;
    case Type::UNIVERSAL:
      joint.type = "universal";
      joint.parameters["axis"] = listOf(axis(0));
      joint.parameters["axis2"] = listOf(axis(1));
      appendAxis(context, read, 0, joint);
      appendAxis(context, read, 1, joint);
      break;
    case Type::REVOLUTE2: {
      joint.type = "composite";
      std::vector<JointDescription> parts{hinge(axis(0)), hinge(axis(1))};
      for (unsigned k = 0; k < 2; ++k) {
        appendAxis(context, read, k, parts[k]);
        dropEmpty(parts[k]);
      }
      joint.parameters["parts"] = std::move(parts);
      break;
    }
    default:
      refuse(context, read, "its type is none that libdyn has");
  }
  const bool one_sided = type == Type::BALL || type == Type::UNIVERSAL || type == Type::REVOLUTE2;
  if (reversed && one_sided)
    refuse(context, read, "carries its parent from its child, because the child hangs on another joint; only joints of one axis can");
  dropEmpty(joint);
  readMimic(context, read, joint);
  joint.name = read.name;
  joint.where = context.where(*read.joint, read.name);
  joint.placement = out.from_link ? in_parent * in_child.inverse() : in_parent;
  return out;
}

ConstraintDescription closureOf(const Context& context, const JointRead& read, const std::string& parent, const std::string& child) {
  std::array<bool, 6> free{};
  Mat3<double> turn = Mat3<double>::identity();
  switch (read.joint->Type()) {
    case Type::FIXED:
      break;
    case Type::REVOLUTE:
    case Type::CONTINUOUS:
      free[5] = true;
      turn = frameWithZ(directionOf(context, read, 0));
      break;
    case Type::PRISMATIC:
      free[2] = true;
      turn = frameWithZ(directionOf(context, read, 0));
      break;
    case Type::BALL:
      free[3] = free[4] = free[5] = true;
      break;
    default:
      refuse(context, read,
             "closes a loop, which only fixed, revolute, continuous, prismatic and ball joints can; cut the loop at another joint, by "
             "<must_be_loop_joint>");
  }
  if (const auto* axis = read.joint->Axis(0);
      axis && (axis->Lower() > -no_limit || axis->Upper() < no_limit || axis->Damping() != 0 || axis->Friction() != 0))
    context.notes.add("ignored: limits and dynamics of a joint that closes a loop", context.where(*read.joint).line);
  ConstraintDescription out = closeLoop(read.name, child, parent, free);
  auto& relation = std::get<FrameConstraint>(out.relation);
  const SE3<double> aligned{turn, {}};
  relation.placement = read.in_child * aligned;
  relation.other_placement = read.in_parent * aligned;
  out.where = context.where(*read.joint, read.name);
  return out;
}

ConstraintDescription gearOf(const Context& context, const JointRead& gearbox, const JointRead& first, const JointRead& second) {
  // Both angles are seen from the reference body. Axes are compared in the two links' frames, at the zero configuration.
  const auto sign = [&](const JointRead& carrier, unsigned number, const SE3<double>& gear_in_link) {
    const Vec3<double> own = carrier.in_child.R * directionOf(context, carrier, 0), gear = gear_in_link.R * directionOf(context, gearbox, number);
    const double cosine = dot(own, gear);
    if (std::fabs(std::fabs(cosine) - 1) > 1e-6) refuse(context, gearbox, "has an axis that is not that of joint '" + carrier.name + "'");
    return cosine > 0 ? 1.0 : -1.0;
  };
  const double ratio = gearbox.joint->Element() ? numberIn(context, gearbox, gearbox.joint->Element(), "gearbox_ratio", 1) : 1;
  const double factor = -ratio * sign(first, 0, gearbox.in_parent) * sign(second, 1, gearbox.in_child);
  Coupling coupling;
  coupling.type = "mimic";
  coupling.master = first.name;
  coupling.parameters["coefficients"] = std::vector<double>{0, factor};
  ConstraintDescription out = coupleJoint(second.name, coupling);
  out.name = gearbox.name;
  out.where = context.where(*gearbox.joint, gearbox.name);
  return out;
}

}  // namespace dyn::sdf
