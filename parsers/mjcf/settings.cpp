// SPDX-License-Identifier: BSD-2-Clause
#include "settings.hpp"

#include <dyn/lie/so3.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace dyn::mjcf {

namespace {

using Vector = Vec3<long double>;

void readCompiler(const Values& v, Settings& out) {
  out.degrees = v.word("angle", {"radian", "degree"}, out.degrees) == 1;
  if (v.word("coordinate", {"local", "global"}, 0) == 1)
    v.fail("global coordinates are not read, because MuJoCo itself removed them in version 2.3.4; load the model with an older MuJoCo and save it");
  if (v.has("eulerseq")) {
    out.eulerseq = v.text("eulerseq");
    if (out.eulerseq.size() != 3 || out.eulerseq.find_first_not_of("xyzXYZ") != std::string::npos)
      v.fail("eulerseq=\"" + out.eulerseq + "\" must be three letters of x, y, z, X, Y, Z", ErrorCode::syntax);
  }
  out.autolimits = v.flag("autolimits", out.autolimits);
  out.inertia_from_geoms =
      static_cast<Settings::FromGeoms>(v.word("inertiafromgeom", {"false", "true", "auto"}, static_cast<int>(out.inertia_from_geoms)));
  if (v.has("inertiagrouprange")) {
    const std::vector<double> range = v.numbers("inertiagrouprange", 2, 2);
    // Groups are small numbers, and any bound beyond them means all groups.
    for (std::size_t i = 0; i < 2; ++i) out.inertia_groups[i] = static_cast<int>(std::clamp(range[i], -1e6, 1e6));
  }
  out.balance_inertia = v.flag("balanceinertia", out.balance_inertia);
  out.least_mass = v.positive("boundmass", out.least_mass);
  out.least_inertia = v.positive("boundinertia", out.least_inertia);
  out.total_mass = v.number("settotalmass", out.total_mass);
  if (v.has("assetdir")) out.mesh_folder = v.text("assetdir");
  if (v.has("meshdir")) out.mesh_folder = v.text("meshdir");
  out.strip_path = v.flag("strippath", out.strip_path);
  out.discard_visual = v.flag("discardvisual", out.discard_visual);
  out.exact_mesh_inertia = v.flag("exactmeshinertia", out.exact_mesh_inertia);
}

Vector direction(const Values& v, const char* what, const Vector& x) {
  const long double length = std::sqrt(dot(x, x));
  if (!(length > 1e-14L)) v.fail(v.described() + ": its " + what + " has no direction");
  return (1 / length) * x;
}

Mat3<long double> columns(const Vector& x, const Vector& y, const Vector& z) { return {{x.x, y.x, z.x, x.y, y.y, z.y, x.z, y.z, z.z}}; }

Mat3<long double> about(const Vector& unit, long double angle) {
  const long double s = std::sin(angle / 2);
  return Quaternion<long double>{s * unit.x, s * unit.y, s * unit.z, std::cos(angle / 2)}.matrix();
}

}  // namespace

Settings readSettings(const Source& source) {
  Settings out;
  bool gravity = true;
  source.forEach(source.root(), [&](const XMLElement& e) {
    const Values v(source, e, nullptr);
    if (std::strcmp(e.Name(), "compiler") == 0) readCompiler(v, out);
    if (std::strcmp(e.Name(), "option") != 0) return;
    if (v.has("gravity")) out.gravity = cast<double>(v.vector3("gravity"));
    source.forEach(e, [&](const XMLElement& flag) {
      if (std::strcmp(flag.Name(), "flag") == 0) gravity = Values(source, flag, nullptr).word("gravity", {"disable", "enable"}, gravity) == 1;
    });
  });
  if (!gravity) out.gravity = {};
  return out;
}

Mat3<long double> rotationToZ(const Vector& axis) {
  // The axis of rotation is z x axis; a half turn about x turns z into -z.
  const long double s = std::hypot(axis.x, axis.y);
  const Vector n = s < 1e-10L * std::fabs(axis.z) ? Vector{1, 0, 0} : Vector{-axis.y / s, axis.x / s, 0};
  return about(n, std::atan2(s, axis.z));
}

Mat3<long double> eulerRotation(const Vector& angles, const std::string& sequence) {
  Mat3<long double> R = Mat3<long double>::identity();
  for (int i = 0; i < 3; ++i) {
    const char letter = sequence[static_cast<std::size_t>(i)];
    const bool moving = letter >= 'x';
    Vector axis;
    axis[letter - (moving ? 'x' : 'X')] = 1;
    const Mat3<long double> turn = about(axis, angles[i]);
    R = moving ? R * turn : turn * R;
  }
  return R;
}

Mat3<long double> rotationOf(const Values& v, const Settings& settings) {
  const char* spelling = nullptr;
  // The element's own spelling comes before that of its class.
  for (const bool own : {true, false}) {
    for (const char* attribute : {"quat", "axisangle", "xyaxes", "zaxis", "euler"}) {
      if (!(own ? v.own(attribute) : v.has(attribute))) continue;
      if (spelling != nullptr) v.fail(v.described() + " has both " + spelling + " and " + attribute + "; give one of them", ErrorCode::syntax);
      spelling = attribute;
    }
    if (spelling != nullptr) break;
  }
  if (spelling == nullptr) return Mat3<long double>::identity();
  const std::string what = spelling;
  if (what == "quat") {
    const std::vector<double> q = v.numbers("quat", 4, 4);
    if (std::all_of(q.begin(), q.end(), [](double x) { return std::fabs(x) < 1e-150; })) v.fail(v.described() + ": its quat is zero");
    return Quaternion<long double>{q[1], q[2], q[3], q[0]}.matrix();
  }
  if (what == "axisangle") {
    const std::vector<double> a = v.numbers("axisangle", 4, 4);
    return about(direction(v, "axisangle", {a[0], a[1], a[2]}), settings.angle(a[3]));
  }
  if (what == "xyaxes") {
    const std::vector<double> a = v.numbers("xyaxes", 6, 6);
    const Vector x = direction(v, "x axis", {a[0], a[1], a[2]}), given{a[3], a[4], a[5]};
    const Vector y = direction(v, "y axis", given - dot(x, given) * x);
    return columns(x, y, cross(x, y));
  }
  if (what == "zaxis") return rotationToZ(direction(v, "zaxis", v.vector3("zaxis")));
  const Vector given = v.vector3("euler");
  return eulerRotation({settings.angle(given.x), settings.angle(given.y), settings.angle(given.z)}, settings.eulerseq);
}

SE3<long double> poseOf(const Values& v, const Settings& settings) { return {rotationOf(v, settings), v.vector3("pos")}; }

}  // namespace dyn::mjcf
