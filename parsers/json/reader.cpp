// SPDX-License-Identifier: BSD-2-Clause
#include "json/value.hpp"

#include <dyn/file.hpp>
#include <dyn/parsers/json.hpp>

#include <cmath>
#include <map>
#include <set>

namespace dyn::json {

namespace {

using Json = nlohmann::json;

constexpr int deepest_joints = 16;  ///< joints that are made of joints that are made of joints ...

SE3<double> poseOf(const Value& x) {
  x.only({"rotation", "position"});
  SE3<double> out;
  if (x.has("rotation")) {
    const std::vector<double> R = x["rotation"].numbers(9);
    std::copy(R.begin(), R.end(), out.R.m);
    const Mat3<double> product = transpose(out.R) * out.R;
    for (int k = 0; k < 9; ++k)
      if (!(std::fabs(product.m[k] - (k % 4 == 0 ? 1 : 0)) < 1e-6)) x["rotation"].fail("is no rotation matrix, row after row");
  }
  if (x.has("position")) out.p = x["position"].vector();
  return out;
}

void read(const Value& x, const char* key, SE3<double>& out) {
  if (x.has(key)) out = poseOf(x[key]);
}

JointDescription jointOf(const Value& x, int depth);

Parameters parametersOf(const Value& x, int depth) {
  Parameters out;
  x.eachMember([&](const std::string& name, const Value& value) {
    if (value.json().is_array()) {
      out[name] = value.numbers();
    } else if (value.json().is_string()) {
      out[name] = value.text();
    } else if (value.json().is_number()) {
      out[name] = std::vector<double>{value.number()};
    } else {
      value.only({"joints"});
      if (depth >= deepest_joints) value.fail("joints within joints are nested too deep");
      std::vector<JointDescription> parts;
      value["joints"].each([&](const Value& part) { parts.push_back(jointOf(part, depth + 1)); });
      out[name] = std::move(parts);
    }
  });
  return out;
}

Coupling couplingOf(const Value& x, int depth) {
  x.only({"type", "master", "parameters"});
  Coupling out{x["type"].text(), x["master"].text(), {}};
  if (x.has("parameters")) out.parameters = parametersOf(x["parameters"], depth);
  return out;
}

JointDescription jointOf(const Value& x, int depth) {
  x.only({"name", "type", "parameters", "placement", "lower", "upper", "velocity", "effort", "acceleration", "deceleration", "jerk", "damping",
          "friction", "armature", "coupling", "held", "where"});
  JointDescription j;
  j.name = x["name"].text();
  j.type = x["type"].text();
  if (x.has("parameters")) j.parameters = parametersOf(x["parameters"], depth);
  read(x, "placement", j.placement);
  read(x, "lower", j.limits.lower);
  read(x, "upper", j.limits.upper);
  read(x, "velocity", j.limits.velocity);
  read(x, "effort", j.limits.effort);
  read(x, "acceleration", j.limits.acceleration);
  read(x, "deceleration", j.limits.deceleration);
  read(x, "jerk", j.limits.jerk);
  read(x, "damping", j.damping);
  read(x, "friction", j.friction);
  read(x, "armature", j.armature);
  if (x.has("coupling")) j.coupling = couplingOf(x["coupling"], depth);
  read(x, "held", j.held);
  j.where = whereOf(x);
  return j;
}

Inertia<double> inertiaOf(const Value& x) {
  x.only({"mass", "com", "rotational"});
  const std::vector<double> I = x["rotational"].numbers(6);
  return {x["mass"].number(), x["com"].vector(), {I[0], I[1], I[2], I[3], I[4], I[5]}};
}

ConstraintDescription constraintOf(const Value& x) {
  x.only({"name", "frames", "coupling", "lock", "baumgarte", "where"});
  ConstraintDescription out;
  out.name = x["name"].text();
  if (x.has("frames")) {
    const Value f = x["frames"];
    f.only({"frame", "other", "placement", "other_placement", "free", "axes", "has_target"});
    FrameConstraint relation;
    relation.frame = f["frame"].text();
    relation.other = f["other"].text();
    read(f, "placement", relation.placement);
    read(f, "other_placement", relation.other_placement);
    std::size_t count = 0;
    f["free"].each([&](const Value& one) {
      if (count == 6) f["free"].fail("must have 6 entries");
      relation.free[count++] = one.boolean();
    });
    if (count != 6) f["free"].fail("must have 6 entries");
    const std::string axes = f["axes"].text();
    if (axes != "LOCAL" && axes != "OTHER" && axes != "LOCAL_WORLD_ALIGNED") f["axes"].fail("must be LOCAL, OTHER or LOCAL_WORLD_ALIGNED");
    relation.axes = axes == "LOCAL" ? ConstraintAxes::LOCAL : axes == "OTHER" ? ConstraintAxes::OTHER : ConstraintAxes::LOCAL_WORLD_ALIGNED;
    read(f, "has_target", relation.has_target);
    out.relation = relation;
  } else if (x.has("coupling")) {
    x["coupling"].only({"joint", "coupling"});
    out.relation = JointCoupling{x["coupling"]["joint"].text(), couplingOf(x["coupling"]["coupling"], 0)};
  } else if (x.has("lock")) {
    x["lock"].only({"joint", "configuration"});
    JointLock lock{x["lock"]["joint"].text(), {}};
    read(x["lock"], "configuration", lock.configuration);
    out.relation = lock;
  } else {
    x.fail("must have one of 'frames', 'coupling' and 'lock'");
  }
  if (x.has("baumgarte")) {
    x["baumgarte"].only({"position", "velocity"});
    out.baumgarte = {x["baumgarte"]["position"].number(), x["baumgarte"]["velocity"].number()};
  }
  out.where = whereOf(x);
  return out;
}

std::vector<Vec3<double>> pointsOf(const Value& x) {
  std::vector<Vec3<double>> out;
  x.each([&](const Value& p) { out.push_back(p.vector()); });
  return out;
}

GeometryShape shapeOf(const Value& x) {
  x.only({"sphere", "box", "capsule", "cylinder", "cone", "half_space", "convex_hull", "mesh", "mesh_file", "voxels", "octree_file"});
  if (x.json().size() != 1) x.fail("must have one member, the shape");
  const std::string kind = x.json().begin().key();
  const Value s = x[kind.c_str()];
  if (kind == "sphere") return geometry::Sphere{s.only({"radius"})["radius"].number()};
  if (kind == "box") return geometry::Box{s.only({"size"})["size"].vector()};
  if (kind == "half_space") return geometry::HalfSpace{s.only({"normal", "offset"})["normal"].vector(), s["offset"].number()};
  if (kind == "convex_hull") return geometry::ConvexHull{pointsOf(s.only({"points"})["points"])};
  if (kind == "octree_file") return geometry::OctreeFile{s.only({"uri"})["uri"].text()};
  if (kind == "mesh") {
    s.only({"vertices", "triangles"});
    geometry::TriangleMesh mesh{pointsOf(s["vertices"]), {}};
    s["triangles"].each([&](const Value& t) {
      std::vector<int> corners;
      t.each([&](const Value& i) { corners.push_back(i.integer()); });
      if (corners.size() != 3) t.fail("must have 3 indices");
      mesh.triangles.push_back({corners[0], corners[1], corners[2]});
    });
    return mesh;
  }
  if (kind == "mesh_file") {
    s.only({"uri", "scale", "convex"});
    geometry::MeshFile file;
    file.uri = s["uri"].text();
    if (s.has("scale")) file.scale = s["scale"].vector();
    read(s, "convex", file.convex);
    return file;
  }
  if (kind == "voxels") {
    geometry::Voxels voxels;
    s.only({"cubes"})["cubes"].each([&](const Value& cube) {
      cube.only({"center", "size"});
      voxels.cubes.push_back({cube["center"].vector(), cube["size"].number()});
    });
    return voxels;
  }
  s.only({"radius", "length"});
  const double radius = s["radius"].number(), length = s["length"].number();
  if (kind == "capsule") return geometry::Capsule{radius, length};
  if (kind == "cylinder") return geometry::Cylinder{radius, length};
  return geometry::Cone{radius, length};
}

/// Bodies by name, or by index where two have the same name.
class Bodies {
 public:
  explicit Bodies(const Model& model) { add(model.bodies[0].name); }
  void add(const std::string& name) { index_.emplace(name, count_++); }
  int operator()(const Value& x) const {
    if (x.json().is_number_integer()) {
      const int index = x.integer();
      if (index < 0 || index >= count_) x.fail("there is no body " + std::to_string(index) + " before this place", ErrorCode::model);
      return index;
    }
    const auto found = index_.find(x.text());
    if (found == index_.end()) {
      std::vector<std::string> names;
      for (const auto& [name, index] : index_) names.push_back(name);
      x.fail("there is no body '" + x.text() + "' before this place" + nearNames(x.text(), names), ErrorCode::model);
    }
    return found->second;
  }

 private:
  std::map<std::string, int> index_;
  int count_ = 0;
};

Json documentOf(const std::string& text, const std::string& name) {
  std::vector<std::set<std::string>> open;  // the names of the members so far, of each object that has begun
  const auto refuseTwins = [&](int, Json::parse_event_t event, const Json& value) {
    if (event == Json::parse_event_t::object_start) open.emplace_back();
    if (event == Json::parse_event_t::object_end) open.pop_back();
    if (event == Json::parse_event_t::key && !open.back().insert(value.get<std::string>()).second)
      throw Error(ErrorCode::syntax, "two members of one object are called '" + printable(value.get<std::string>()) + "'", {name, 0, ""});
    return true;
  };
  try {
    return Json::parse(text, refuseTwins);
  } catch (const Json::parse_error& e) {
    const auto end = text.begin() + static_cast<std::ptrdiff_t>(std::min(text.size(), e.byte > 0 ? e.byte - 1 : 0));
    const int line = 1 + static_cast<int>(std::count(text.begin(), end, '\n'));
    throw Error(ErrorCode::syntax, "is malformed JSON: expected something else here, or the text ends too soon", {name, line, ""});
  } catch (const Json::exception& e) {
    throw Error(ErrorCode::syntax, std::string("is malformed JSON: ") + e.what(), {name, 0, ""});
  }
}

}  // namespace

Model parse(const std::string& text, const std::string& name) {
  const Json document = documentOf(text, name);
  const Value x(document, "", name);
  if (!document.is_object() || !x.has("format") || !x["format"].json().is_string() || x["format"].text() != "libdyn model")
    x.fail("is no model of libdyn: it needs \"format\": \"libdyn model\"");
  if (const int version = x["version"].integer(); version < 1 || version > format_version)
    x["version"].fail("is " + std::to_string(version) + ", and this libdyn reads 1 to " + std::to_string(format_version) + "; use a newer libdyn");
  x.only({"format", "version", "name", "gravity", "bodies", "frames", "constraints", "geometries", "disabled_collisions", "groups", "end_effectors",
          "virtual_joints", "passive_joints", "configurations", "devices", "notes"});
  Model model;
  model.name = x["name"].text();
  if (x.has("gravity")) model.gravity = x["gravity"].vector();
  Bodies bodies(model);
  x["bodies"].each([&](const Value& b) {
    b.only({"name", "parent", "joint", "inertia", "where"});
    BodyDescription body;
    body.name = b["name"].text();
    body.parent = bodies(b["parent"]);
    body.joint = jointOf(b["joint"], 0);
    if (b.has("inertia")) body.inertia = inertiaOf(b["inertia"]);
    body.where = whereOf(b);
    bodies.add(body.name);
    model.bodies.push_back(std::move(body));
  });
  if (x.has("frames"))
    x["frames"].each([&](const Value& f) {
      f.only({"name", "body", "placement"});
      FrameDescription frame{f["name"].text(), bodies(f["body"]), {}};
      read(f, "placement", frame.placement);
      model.frames.push_back(frame);
    });
  if (x.has("constraints")) x["constraints"].each([&](const Value& c) { model.constraints.push_back(constraintOf(c)); });
  if (x.has("geometries"))
    x["geometries"].each([&](const Value& g) {
      g.only({"name", "body", "shape", "placement", "role", "where"});
      GeometryDescription out;
      out.name = g["name"].text();
      out.body = bodies(g["body"]);
      out.shape = shapeOf(g["shape"]);
      read(g, "placement", out.placement);
      if (g.has("role")) {
        if (g["role"].text() != "visual" && g["role"].text() != "collision") g["role"].fail("must be collision or visual");
        if (g["role"].text() == "visual") out.role = GeometryDescription::Role::visual;
      }
      out.where = whereOf(g);
      model.geometries.push_back(std::move(out));
    });
  if (x.has("disabled_collisions"))
    x["disabled_collisions"].each([&](const Value& pair) {
      pair.only({"body", "other", "reason"});
      DisabledCollision out{pair["body"].text(), pair["other"].text(), {}};
      read(pair, "reason", out.reason);
      model.disabled_collisions.push_back(out);
    });
  readGroups(x, model);
  if (x.has("notes")) x["notes"].each([&](const Value& note) { model.notes.push_back(note.text()); });
  return model;
}

Model load(const std::string& path) { return parse(readFile(path, largest_file), path); }

}  // namespace dyn::json
