// SPDX-License-Identifier: BSD-2-Clause
#include "common/characters.hpp"
#include "json/value.hpp"

#include <dyn/file.hpp>
#include <dyn/parsers/json.hpp>

#include <nlohmann/json.hpp>

#include <cmath>
#include <map>

namespace dyn::json {

namespace {

using Json = nlohmann::ordered_json;

/// JSON has no numbers for infinity and NaN, so they are texts.
Json written(double x) {
  if (std::isfinite(x)) return x;
  return std::isnan(x) ? "nan" : x > 0 ? "inf" : "-inf";
}
template <class Numbers>
Json numbers(const Numbers& x) {
  Json out = Json::array();
  for (const double value : x) out.push_back(written(value));
  return out;
}
Json written(const Vec3<double>& x) { return numbers(std::array{x.x, x.y, x.z}); }

Json written(const SE3<double>& X) { return {{"rotation", numbers(X.R.m)}, {"position", written(X.p)}}; }

bool same(const SE3<double>& a, const SE3<double>& b) {
  return std::equal(std::begin(a.R.m), std::end(a.R.m), std::begin(b.R.m)) && a.p.x == b.p.x && a.p.y == b.p.y && a.p.z == b.p.z;
}

void put(Json& out, const char* key, const std::string& x) {
  if (!x.empty()) out[key] = x;
}
void put(Json& out, const char* key, const std::vector<double>& x) {
  if (!x.empty()) out[key] = numbers(x);
}
void put(Json& out, const char* key, const SE3<double>& x) {
  if (!same(x, {})) out[key] = written(x);
}
void put(Json& out, const char* key, bool x) {
  if (x) out[key] = true;
}
void put(Json& out, const Where& where) {
  if (where.file.empty() && where.line == 0 && where.joint.empty()) return;
  Json place;
  put(place, "file", where.file);
  if (where.line != 0) place["line"] = where.line;
  put(place, "joint", where.joint);
  out["where"] = place;
}

Json written(const JointDescription& joint);

Json written(const Parameters& parameters) {
  Json out = Json::object();
  for (const auto& [name, value] : parameters) {
    if (const auto* x = std::get_if<std::vector<double>>(&value)) {
      out[name] = numbers(*x);
    } else if (const auto* text = std::get_if<std::string>(&value)) {
      out[name] = *text;
    } else {
      Json parts = Json::array();
      for (const JointDescription& part : std::get<std::vector<JointDescription>>(value)) parts.push_back(written(part));
      // An empty list of joints must not read as an empty list of numbers.
      out[name] = Json{{"joints", parts}};
    }
  }
  return out;
}

Json written(const Coupling& coupling) {
  Json out{{"type", coupling.type}, {"master", coupling.master}};
  if (!coupling.parameters.empty()) out["parameters"] = written(coupling.parameters);
  return out;
}

Json written(const JointDescription& j) {
  Json out{{"name", j.name}, {"type", j.type}};
  if (!j.parameters.empty()) out["parameters"] = written(j.parameters);
  put(out, "placement", j.placement);
  put(out, "lower", j.limits.lower);
  put(out, "upper", j.limits.upper);
  put(out, "velocity", j.limits.velocity);
  put(out, "effort", j.limits.effort);
  put(out, "acceleration", j.limits.acceleration);
  put(out, "deceleration", j.limits.deceleration);
  put(out, "jerk", j.limits.jerk);
  put(out, "damping", j.damping);
  put(out, "friction", j.friction);
  put(out, "armature", j.armature);
  if (!j.coupling.type.empty() || !j.coupling.master.empty()) out["coupling"] = written(j.coupling);
  put(out, "held", j.held);
  put(out, j.where);
  return out;
}

Json written(const Inertia<double>& Y) {
  const Sym3<double>& I = Y.rotational;
  return {{"mass", written(Y.mass)}, {"com", written(Y.com)}, {"rotational", numbers(std::array{I.xx, I.xy, I.xz, I.yy, I.yz, I.zz})}};
}

bool isZero(const Inertia<double>& Y) {
  const Sym3<double>& I = Y.rotational;
  for (const double x : {Y.mass, Y.com.x, Y.com.y, Y.com.z, I.xx, I.xy, I.xz, I.yy, I.yz, I.zz})
    if (x != 0 || std::signbit(x)) return false;
  return true;
}

/// Names of bodies. One that is not unique is replaced by its index.
class BodyNames {
 public:
  explicit BodyNames(const Model& model) : model_(model) {
    for (const BodyDescription& body : model.bodies) ++count_[body.name];
  }
  Json operator()(int index, const char* what) const {
    if (index < 0 || static_cast<std::size_t>(index) >= model_.bodies.size())
      throw Error(ErrorCode::model, std::string(what) + " refers to body " + std::to_string(index) + ", which the model has not");
    const std::string& name = model_.bodies[static_cast<std::size_t>(index)].name;
    return count_.at(name) == 1 ? Json(name) : Json(index);
  }

 private:
  const Model& model_;
  std::map<std::string, int> count_;
};

Json written(const ConstraintDescription& c) {
  Json out{{"name", c.name}};
  if (const auto* frame = std::get_if<FrameConstraint>(&c.relation)) {
    static constexpr const char* axes[] = {"LOCAL", "OTHER", "LOCAL_WORLD_ALIGNED"};
    Json relation{{"frame", frame->frame}, {"other", frame->other}};
    put(relation, "placement", frame->placement);
    put(relation, "other_placement", frame->other_placement);
    relation["free"] = frame->free;
    relation["axes"] = axes[static_cast<int>(frame->axes)];
    put(relation, "has_target", frame->has_target);
    out["frames"] = relation;
  } else if (const auto* coupling = std::get_if<JointCoupling>(&c.relation)) {
    out["coupling"] = Json{{"joint", coupling->joint}, {"coupling", written(coupling->coupling)}};
  } else {
    const auto& lock = std::get<JointLock>(c.relation);
    out["lock"] = Json{{"joint", lock.joint}};
    put(out["lock"], "configuration", lock.configuration);
  }
  if (c.baumgarte.position != 0 || c.baumgarte.velocity != 0)
    out["baumgarte"] = Json{{"position", written(c.baumgarte.position)}, {"velocity", written(c.baumgarte.velocity)}};
  put(out, c.where);
  return out;
}

void put(Json& out, const char* key, const std::vector<std::string>& x) {
  if (!x.empty()) out[key] = x;
}

Json written(const GroupDescription& group) {
  Json out{{"name", group.name}};
  put(out, "bodies", group.bodies);
  put(out, "joints", group.joints);
  for (const Chain& chain : group.chains) out["chains"].push_back(Json{{"base", chain.base}, {"tip", chain.tip}});
  put(out, "groups", group.groups);
  put(out, group.where);
  return out;
}

Json written(const EndEffectorDescription& e) {
  Json out{{"name", e.name}, {"group", e.group}, {"body", e.body}};
  put(out, "parent_group", e.parent_group);
  put(out, e.where);
  return out;
}

Json written(const VirtualJointDescription& joint) {
  Json out{{"name", joint.name}, {"type", joint.type}, {"frame", joint.frame}, {"body", joint.body}};
  put(out, joint.where);
  return out;
}

Json written(const ConfigurationDescription& state) {
  Json out{{"name", state.name}};
  put(out, "group", state.group);
  Json& joints = out["joints"] = Json::array();
  for (const JointState& joint : state.joints) {
    Json entry{{"joint", joint.joint}};
    put(entry, "q", joint.q);
    put(entry, "v", joint.v);
    joints.push_back(std::move(entry));
  }
  put(out, state.where);
  return out;
}

Json written(const DeviceDescription& device) {
  Json out{{"kind", std::string(kindNames[static_cast<std::size_t>(device.kind)])}, {"type", device.type}};
  put(out, "name", device.name);
  out["text"] = device.text;
  put(out, device.where);
  return out;
}

template <class Records>
void putAll(Json& out, const char* key, const Records& records) {
  for (const auto& record : records) out[key].push_back(written(record));
}

struct ShapeWriter {
  static Json points(const std::vector<Vec3<double>>& all) {
    Json out = Json::array();
    for (const Vec3<double>& p : all) out.push_back(written(p));
    return out;
  }
  Json operator()(const geometry::Sphere& s) const { return {{"sphere", {{"radius", written(s.radius)}}}}; }
  Json operator()(const geometry::Box& s) const { return {{"box", {{"size", written(s.size)}}}}; }
  Json operator()(const geometry::Capsule& s) const { return {{"capsule", {{"radius", written(s.radius)}, {"length", written(s.length)}}}}; }
  Json operator()(const geometry::Cylinder& s) const { return {{"cylinder", {{"radius", written(s.radius)}, {"length", written(s.length)}}}}; }
  Json operator()(const geometry::Cone& s) const { return {{"cone", {{"radius", written(s.radius)}, {"length", written(s.length)}}}}; }
  Json operator()(const geometry::HalfSpace& s) const { return {{"half_space", {{"normal", written(s.normal)}, {"offset", written(s.offset)}}}}; }
  Json operator()(const geometry::ConvexHull& s) const { return {{"convex_hull", {{"points", points(s.points)}}}}; }
  Json operator()(const geometry::TriangleMesh& s) const { return {{"mesh", {{"vertices", points(s.vertices)}, {"triangles", s.triangles}}}}; }
  Json operator()(const geometry::MeshFile& s) const {
    Json out{{"uri", s.uri}, {"scale", written(s.scale)}};
    put(out, "convex", s.convex);
    return {{"mesh_file", out}};
  }
  Json operator()(const geometry::Voxels& s) const {
    Json cubes = Json::array();
    for (const auto& cube : s.cubes) cubes.push_back({{"center", written(cube.center)}, {"size", written(cube.size)}});
    return {{"voxels", {{"cubes", cubes}}}};
  }
  Json operator()(const geometry::OctreeFile& s) const { return {{"octree_file", {{"uri", s.uri}}}}; }
};

/// Throws for texts that load() would refuse.
void checkTexts(const Json& x) {
  const auto check = [](const std::string& text) {
    if (!isPlainText(text))
      throw Error(ErrorCode::model, "cannot be written: the text '" + printable(text) + "' is no UTF-8, or has control characters");
  };
  if (x.is_string()) check(x.get_ref<const std::string&>());
  if (!x.is_structured()) return;
  for (const auto& [key, value] : x.items()) {
    if (x.is_object()) check(key);
    checkTexts(value);
  }
}

/// Small values on one line, others by lines, so that people can read the text and compare two by line.
void print(const Json& x, const std::string& indent, std::string& out) {
  if (std::string one = x.dump(); !x.is_structured() || one.size() + indent.size() <= 120) {
    out += one;
    return;
  }
  const bool object = x.is_object();
  const std::string deeper = indent + " ";
  out += object ? "{\n" : "[\n";
  bool first = true;
  for (const auto& [key, value] : x.items()) {
    out += (first ? "" : ",\n") + deeper + (object ? Json(key).dump() + ": " : "");
    print(value, deeper, out);
    first = false;
  }
  out += "\n" + indent + (object ? "}" : "]");
}

}  // namespace

std::string write(const Model& model) {
  if (model.bodies.empty() || model.bodies[0].name != Model().bodies[0].name)
    throw Error(ErrorCode::model, "cannot be written: bodies[0] must be the world, called 'universe'");
  const BodyNames bodies(model);
  Json out{{"format", "libdyn model"}, {"version", format_version}, {"name", model.name}, {"gravity", written(model.gravity)}};
  Json& list = out["bodies"] = Json::array();
  for (std::size_t i = 1; i < model.bodies.size(); ++i) {
    const BodyDescription& body = model.bodies[i];
    Json entry{{"name", body.name}, {"parent", bodies(body.parent, "a body's parent")}, {"joint", written(body.joint)}};
    if (!isZero(body.inertia)) entry["inertia"] = written(body.inertia);
    put(entry, body.where);
    list.push_back(std::move(entry));
  }
  for (const FrameDescription& frame : model.frames) {
    Json entry{{"name", frame.name}, {"body", bodies(frame.body, "a frame")}};
    put(entry, "placement", frame.placement);
    out["frames"].push_back(std::move(entry));
  }
  putAll(out, "constraints", model.constraints);
  for (const GeometryDescription& g : model.geometries) {
    Json entry{{"name", g.name}, {"body", bodies(g.body, "a volume")}, {"shape", std::visit(ShapeWriter{}, g.shape)}};
    put(entry, "placement", g.placement);
    if (g.role == GeometryDescription::Role::visual) entry["role"] = "visual";
    put(entry, g.where);
    out["geometries"].push_back(std::move(entry));
  }
  for (const DisabledCollision& pair : model.disabled_collisions) {
    Json entry{{"body", pair.body}, {"other", pair.other}};
    put(entry, "reason", pair.reason);
    out["disabled_collisions"].push_back(std::move(entry));
  }
  putAll(out, "groups", model.groups);
  putAll(out, "end_effectors", model.end_effectors);
  putAll(out, "virtual_joints", model.virtual_joints);
  put(out, "passive_joints", model.passive_joints);
  putAll(out, "configurations", model.configurations);
  putAll(out, "devices", model.devices);
  if (!model.notes.empty()) out["notes"] = model.notes;
  checkTexts(out);
  std::string text;
  print(out, "", text);
  return text + "\n";
}

void save(const Model& model, const std::string& path) { replaceFile(path, write(model)); }

}  // namespace dyn::json
