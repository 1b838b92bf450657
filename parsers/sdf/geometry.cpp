// SPDX-License-Identifier: BSD-2-Clause
// Inertias and volumes of links.
#include "parts.hpp"

#include <dyn/lie/so3.hpp>

#include <sdf/Box.hh>
#include <sdf/Capsule.hh>
#include <sdf/Cylinder.hh>
#include <sdf/Geometry.hh>
#include <sdf/Mesh.hh>
#include <sdf/Plane.hh>
#include <sdf/Sphere.hh>

namespace dyn::sdf {

namespace {

std::optional<GeometryShape> shapeOf(const Context& context, const ::sdf::Geometry& geometry) {
  if (const auto* x = geometry.BoxShape()) return geometry::Box{vectorOf(x->Size())};
  if (const auto* x = geometry.SphereShape()) return geometry::Sphere{x->Radius()};
  if (const auto* x = geometry.CylinderShape()) return geometry::Cylinder{x->Radius(), x->Length()};
  if (const auto* x = geometry.CapsuleShape()) return geometry::Capsule{x->Radius(), x->Length()};
  if (const auto* x = geometry.PlaneShape()) return geometry::HalfSpace{vectorOf(x->Normal()), 0};
  if (const auto* x = geometry.MeshShape()) {
    if (!x->Submesh().empty()) context.notes.add("ignored: <submesh>, so that the whole mesh is taken", context.where(*x).line);
    return geometry::MeshFile{x->Uri(), vectorOf(x->Scale()), false};
  }
  return std::nullopt;
}

template <class Volume>
void addVolume(const Context& context, const Volume& volume, const std::string& link, int body, GeometryDescription::Role role,
               std::vector<GeometryDescription>& out) {
  const Where where = context.where(volume);
  const std::optional<GeometryShape> shape = volume.Geom() ? shapeOf(context, *volume.Geom()) : std::nullopt;
  if (!shape) {
    const bool collides = role == GeometryDescription::Role::collision;
    context.notes.add(std::string("left out: a ") + (collides ? "collision" : "visual") + " whose shape libdyn does not have", where.line);
    return;
  }
  GeometryDescription description;
  description.name = link + "::" + volume.Name();
  description.body = body;
  description.placement = resolved(context, volume);
  description.shape = *shape;
  description.role = role;
  description.where = where;
  out.push_back(std::move(description));
}

}  // namespace

Vec3<double> vectorOf(const ignition::math::Vector3d& v) { return {v.X(), v.Y(), v.Z()}; }

SE3<double> poseOf(const ignition::math::Pose3d& pose) {
  SE3<double> out;
  out.R = Quaternion<double>{pose.Rot().X(), pose.Rot().Y(), pose.Rot().Z(), pose.Rot().W()}.matrix();
  out.p = vectorOf(pose.Pos());
  return out;
}

Inertia<double> inertiaOf(const Context& context, const ::sdf::Link& link, const std::string& name) {
  const Where where = context.where(link);
  const ::sdf::ElementPtr e = link.Element();
  if (e && !e->HasElement("inertial")) context.notes.add("a link has no <inertial> and gets 1 kg and 1 kg m^2, as SDF says", where.line);
  const auto& inertial = link.Inertial();
  const auto &diagonal = inertial.MassMatrix().DiagonalMoments(), &off = inertial.MassMatrix().OffDiagonalMoments();
  Inertia<double> Y;
  Y.mass = inertial.MassMatrix().Mass();
  Y.rotational = {diagonal.X(), off.X(), off.Y(), diagonal.Y(), off.Z(), diagonal.Z()};
  reader::judgeInertia(Y, name, context.options.inertias, where, context.notes);
  return cast<double>(cast<long double>(Y).transformed(cast<long double>(poseOf(inertial.Pose()))));
}

std::vector<GeometryDescription> geometriesOf(const Context& context, const ::sdf::Link& link, const std::string& name, int body) {
  std::vector<GeometryDescription> out;
  for (std::uint64_t k = 0; k < link.CollisionCount(); ++k)
    addVolume(context, *link.CollisionByIndex(k), name, body, GeometryDescription::Role::collision, out);
  for (std::uint64_t k = 0; k < link.VisualCount(); ++k)
    addVolume(context, *link.VisualByIndex(k), name, body, GeometryDescription::Role::visual, out);
  return out;
}

}  // namespace dyn::sdf
