// SPDX-License-Identifier: BSD-2-Clause
#include "geom.hpp"

#include <cmath>

namespace dyn::mjcf {

namespace {

constexpr long double pi = 3.14159265358979323846264338327950288L;

enum class Type { plane, hfield, sphere, capsule, ellipsoid, cylinder, box, mesh, sdf };
using Size = std::array<long double, 3>;

Sym3<long double> diagonal(long double x, long double y, long double z) { return {x, 0, 0, y, 0, z}; }

/// The sum of a sphere's two halves, with distance 2 h between their flat sides, for unit mass: `second` is the second moment of the sphere along one
/// axis, and `centroid` the distance of a half's centre of mass from its flat side.
Sym3<long double> splitSphere(long double second, long double centroid, long double h) {
  const long double along = second + 2 * h * centroid + h * h;
  return diagonal(second + along, second + along, 2 * second);
}

/// Volume of a solid, and its inertia for unit density.
Inertia<long double> solid(Type type, const Size& s) {
  Inertia<long double> out;
  const long double a = s[0] * s[0], b = s[1] * s[1], c = s[2] * s[2];
  switch (type) {
    case Type::sphere:
      out.mass = 4 * pi / 3 * a * s[0];
      out.rotational = out.mass * diagonal(2 * a / 5, 2 * a / 5, 2 * a / 5);
      return out;
    case Type::ellipsoid:
      out.mass = 4 * pi / 3 * s[0] * s[1] * s[2];
      out.rotational = out.mass * diagonal((b + c) / 5, (a + c) / 5, (a + b) / 5);
      return out;
    case Type::box:
      out.mass = 8 * s[0] * s[1] * s[2];
      out.rotational = out.mass * diagonal((b + c) / 3, (a + c) / 3, (a + b) / 3);
      return out;
    case Type::cylinder:
    case Type::capsule: {
      const long double tube = 2 * pi * a * s[1], ball = type == Type::capsule ? 4 * pi / 3 * a * s[0] : 0;
      out.mass = tube + ball;
      const long double across = a / 4 + b / 3;
      out.rotational = tube * diagonal(across, across, a / 2) + ball * splitSphere(a / 5, 3 * s[0] / 8, s[1]);
      return out;
    }
    default:
      return out;
  }
}

/// Area of a surface, and its inertia for unit density.
Inertia<long double> shell(Type type, const Size& s) {
  Inertia<long double> out;
  const long double a = s[0] * s[0], b = s[1] * s[1], c = s[2] * s[2];
  switch (type) {
    case Type::sphere:
      out.mass = 4 * pi * a;
      out.rotational = out.mass * diagonal(2 * a / 3, 2 * a / 3, 2 * a / 3);
      return out;
    case Type::box: {
      // Second moments of the faces normal to x, y and z: c_x^2 for a face at x = s, and c_x^2 / 3 for one that extends along x.
      const long double x = 8 * s[1] * s[2], y = 8 * s[0] * s[2], z = 8 * s[0] * s[1];
      const long double xx = a * (x + (y + z) / 3), yy = b * (y + (x + z) / 3), zz = c * (z + (x + y) / 3);
      out.mass = x + y + z;
      out.rotational = diagonal(yy + zz, xx + zz, xx + yy);
      return out;
    }
    case Type::cylinder:
    case Type::capsule: {
      const long double tube = 4 * pi * s[0] * s[1], across = a / 2 + b / 3;
      out.rotational = tube * diagonal(across, across, a);
      if (type == Type::cylinder) {
        const long double discs = 2 * pi * a;
        out.mass = tube + discs;
        out.rotational += discs * diagonal(a / 4 + b, a / 4 + b, a / 2);
      } else {
        const long double ball = 4 * pi * a;
        out.mass = tube + ball;
        out.rotational += ball * splitSphere(a / 3, s[0] / 2, s[1]);
      }
      return out;
    }
    default:
      return out;
  }
}

/// The number of sizes that a shape has; all of them must be positive.
int sizesOf(Type type) {
  switch (type) {
    case Type::sphere:
      return 1;
    case Type::capsule:
    case Type::cylinder:
      return 2;
    case Type::ellipsoid:
    case Type::box:
      return 3;
    default:
      return 0;
  }
}

std::optional<GeometryShape> shapeOf(Type type, const Size& s) {
  const auto d = [](long double x) { return static_cast<double>(x); };
  switch (type) {
    case Type::sphere:
      return geometry::Sphere{d(s[0])};
    case Type::capsule:
      return geometry::Capsule{d(s[0]), d(2 * s[1])};
    case Type::cylinder:
      return geometry::Cylinder{d(s[0]), d(2 * s[1])};
    case Type::box:
      return geometry::Box{{d(2 * s[0]), d(2 * s[1]), d(2 * s[2])}};
    case Type::plane:
      return geometry::HalfSpace{};
    case Type::ellipsoid:
      if (s[0] == s[1] && s[0] == s[2]) return geometry::Sphere{d(s[0])};
      return std::nullopt;
    default:
      return std::nullopt;
  }
}

/// Returns the mass properties in the geom's frame, from mass or density.
Inertia<long double> weighed(const Values& v, Type type, const Size& size, const Mesh* mesh, const Context& c) {
  const bool given = v.has("mass"), hollow = v.flag("shellinertia", false);
  const double mass = v.positive("mass", 0), density = v.positive("density", 1000);
  if (given && mass == 0) return {};
  if (type == Type::plane || type == Type::hfield || (!given && density == 0)) return {};
  if (hollow && type == Type::ellipsoid) v.fail(v.described() + ": the inertia of an ellipsoid's shell has no closed form; write an <inertial>");
  Inertia<long double> unit;
  if (mesh != nullptr) {
    unit = c.meshes.mass(*mesh, hollow ? MeshInertia::shell : mesh->inertia);
  } else {
    unit = hollow ? shell(type, size) : solid(type, size);
  }
  const long double factor = given ? mass / unit.mass : static_cast<long double>(density);
  return {factor * unit.mass, unit.com, factor * unit.rotational};
}

}  // namespace

SE3<long double> poseBetween(const Values& v, long double& half_length) {
  const std::vector<double> x = v.numbers("fromto", 6, 6);
  const Vec3<long double> from{x[0], x[1], x[2]}, to{x[3], x[4], x[5]};
  // The shape's z axis points from the second point to the first.
  const Vec3<long double> axis = from - to;
  const long double length = std::sqrt(dot(axis, axis));
  if (!(length > 1e-14L)) v.fail(v.described() + ": the two points of its fromto are the same");
  half_length = length / 2;
  return {rotationToZ(axis), 0.5L * (from + to)};
}

Geom readGeom(const Values& v, const SE3<long double>& frame, bool weigh, const Context& c) {
  const auto type = static_cast<Type>(
      v.word("type", {"plane", "hfield", "sphere", "capsule", "ellipsoid", "cylinder", "box", "mesh", "sdf"}, static_cast<int>(Type::sphere)));
  const bool is_mesh = type == Type::mesh || type == Type::sdf;
  if (is_mesh && !v.has("mesh")) v.fail(v.described() + " is of type mesh but names no mesh", ErrorCode::syntax);
  const Mesh* mesh = is_mesh ? &c.meshes.find(v.text("mesh"), v.element()) : nullptr;

  const int group = v.integer("group", 0);
  weigh = weigh && group >= c.settings.inertia_groups[0] && group <= c.settings.inertia_groups[1];
  const Where where = c.source.where(v.element());
  const bool fitted = !is_mesh && v.has("mesh");
  if (fitted && weigh)
    v.fail(v.described() +
           " fits a primitive shape to a mesh, which this reader does not do; write its size and pose, or give the body an <inertial>");

  Size size{};
  const std::array<double, 3> given = v.size();
  std::copy(given.begin(), given.end(), size.begin());
  Geom out;
  if (v.has("fromto")) {
    if (type != Type::capsule && type != Type::cylinder && type != Type::ellipsoid && type != Type::box)
      v.fail(v.described() + ": fromto is for capsules, cylinders, ellipsoids and boxes");
    const int along = type == Type::capsule || type == Type::cylinder ? 1 : 2;
    if (along == 2) size[1] = size[0];
    out.pose = poseBetween(v, size[static_cast<std::size_t>(along)]);
  } else {
    out.pose = poseOf(v, c.settings);
  }
  out.pose = frame * out.pose;
  for (int i = 0; i < sizesOf(type) && !fitted; ++i)
    if (!(size[static_cast<std::size_t>(i)] > 0)) v.fail(v.described() + ": size " + std::to_string(i + 1) + " must be positive");

  out.contype = v.integer("contype", 1);
  out.conaffinity = v.integer("conaffinity", 1);
  out.shape_pose = out.pose;
  if (mesh != nullptr) {
    SE3<long double> inside;
    out.shape = c.meshes.shape(*mesh, !out.visual(), where.file, inside);
    out.shape_pose = out.pose * inside;
    if (!out.shape) c.notes.count("left out: the volume of a mesh that is both turned and scaled unevenly", where);
  } else if (fitted) {
    c.notes.count("left out: the volume of a primitive shape that is fitted to a mesh", where);
  } else {
    out.shape = shapeOf(type, size);
    if (type == Type::hfield) c.notes.count("left out: the volume of a height field", where);
    if (type == Type::ellipsoid && !out.shape) c.notes.count("left out: the volume of an ellipsoid, a shape that libdyn does not have", where);
  }
  if (weigh) {
    const Inertia<long double> own = weighed(v, type, size, mesh, c);
    // MuJoCo ignores tiny masses.
    if (own.mass > 1e-14L) out.inertia = own.transformed(out.pose);
  }
  return out;
}

}  // namespace dyn::mjcf
