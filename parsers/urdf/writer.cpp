// SPDX-License-Identifier: BSD-2-Clause
#include "common/attached.hpp"
#include "common/reader.hpp"
#include "output.hpp"

#include <dyn/file.hpp>
#include <dyn/parsers/urdf.hpp>

#include <algorithm>

namespace dyn::urdf {

namespace {

class Writer {
 public:
  explicit Writer(const Model& model) : model_(model), attached_(model) {
    for (const BodyDescription& body : model.bodies) {
      links_.insert(body.name);
      joints_.insert(body.joint.name);
    }
    for (const FrameDescription& frame : model.frames) links_.insert(frame.name);
  }

  Written write() {
    out_.open("robot");
    out_.put("name", model_.name);
    const int root = plainRoot();
    if (root < 0) writeWorld();
    for (std::size_t i = 1; i < model_.bodies.size(); ++i) {
      const BodyDescription& body = model_.bodies[i];
      writeLink(body.name, body.inertia, i);
      if (static_cast<int>(i) != root) {
        const std::string& parent = body.parent == 0 ? world_ : model_.bodies[static_cast<std::size_t>(body.parent)].name;
        writeJoint(out_, body.joint, parent, body.name, masterIsJoint(body.joint));
      }
    }
    for (const FrameDescription& frame : model_.frames) writeFrame(frame);
    writeExtensions(root);
    loseOthers();
    out_.close();
    return {out_.text(), out_.lost()};
  }

 private:
  /// Returns the only body on the world, if its joint says nothing that a reader does not add itself; otherwise -1.
  int plainRoot() const {
    int root = -1;
    for (std::size_t i = 1; i < model_.bodies.size(); ++i) {
      if (model_.bodies[i].parent != 0) continue;
      if (root >= 0) return -1;
      root = static_cast<int>(i);
    }
    if (root < 0 || !attached_.volumes[0].empty() || !attached_.frames[0].empty()) return -1;
    const JointDescription& joint = model_.bodies[static_cast<std::size_t>(root)].joint;
    const SE3<double> identity;
    const bool at_origin = std::equal(std::begin(joint.placement.R.m), std::end(joint.placement.R.m), std::begin(identity.R.m)) &&
                           joint.placement.p.x == 0 && joint.placement.p.y == 0 && joint.placement.p.z == 0;
    return joint.type == "fixed" && at_origin && joint.name.starts_with("root_joint") && !needsExtension(joint, false) ? root : -1;
  }

  void writeWorld() {
    world_ = reader::freeName("world", links_);
    out_.lose("the world, which becomes a link '" + world_ + "'");
    writeLink(world_, {}, 0);
  }

  bool masterIsJoint(const JointDescription& joint) const { return joints_.count(joint.coupling.master) > 0; }

  void writeLink(const std::string& name, const Inertia<double>& Y, std::size_t body) {
    out_.open("link");
    out_.put("name", name);
    const Sym3<double>& I = Y.rotational;
    const std::pair<const char*, double> moments[] = {{"ixx", I.xx}, {"ixy", I.xy}, {"ixz", I.xz}, {"iyy", I.yy}, {"iyz", I.yz}, {"izz", I.zz}};
    if (Y.mass != 0 || std::any_of(std::begin(moments), std::end(moments), [](const auto& moment) { return moment.second != 0; })) {
      out_.open("inertial");
      out_.origin({Mat3<double>::identity(), Y.com});
      out_.element("mass", "value", Y.mass);
      out_.open("inertia");
      for (const auto& [entry, value] : moments) out_.put(entry, value);
      out_.close();
      out_.close();
    }
    int count[2] = {0, 0};
    std::vector<std::string> convex;
    for (const GeometryDescription* g : attached_.volumes[body]) {
      const bool visual = g->role == GeometryDescription::Role::visual;
      if (!writeVolume(*g)) continue;
      if (g->name != name + (visual ? "_visual_" : "_") + std::to_string(count[visual]++)) out_.lose("names of volumes", g->name);
      const auto* mesh = std::get_if<geometry::MeshFile>(&g->shape);
      if (mesh && mesh->convex) convex.push_back(g->name);
    }
    if (!convex.empty()) {
      out_.open("collision_checking");
      for (const std::string& volume : convex) out_.element("convex", "name", volume);
      out_.close();
    }
    out_.close();
  }

  /// A fixed joint is all that URDF has for a frame.
  void writeFrame(const FrameDescription& frame) {
    out_.lose("frames, which become links on fixed joints", frame.name);
    out_.open("link");
    out_.put("name", frame.name);
    out_.close();
    JointDescription joint;
    joint.name = reader::freeName(frame.name + "_mount", joints_);
    joint.placement = frame.placement;
    writeJoint(out_, joint, frame.body == 0 ? world_ : model_.bodies[static_cast<std::size_t>(frame.body)].name, frame.name, false);
  }

  struct ShapeWriter {
    Writer& w;
    const GeometryDescription& g;
    bool operator()(const geometry::Sphere& s) const { return one("sphere", {{"radius", s.radius}}); }
    bool operator()(const geometry::Capsule& s) const { return one("capsule", {{"radius", s.radius}, {"length", s.length}}); }
    bool operator()(const geometry::Cylinder& s) const { return one("cylinder", {{"radius", s.radius}, {"length", s.length}}); }
    bool operator()(const geometry::Cone& s) const { return one("cone", {{"radius", s.radius}, {"length", s.length}}); }
    bool operator()(const geometry::Box& s) const {
      begin();
      w.out_.element("box", "size", s.size);
      return end();
    }
    bool operator()(const geometry::HalfSpace& s) const {
      begin();
      w.out_.open("plane");
      w.out_.put("normal", s.normal);
      w.out_.put("offset", s.offset);
      w.out_.close();
      return end();
    }
    bool operator()(const geometry::MeshFile& s) const {
      begin();
      w.out_.loseFolder(s.uri, g.where.file);
      w.out_.open("mesh");
      w.out_.put("filename", s.uri);
      if (s.scale.x != 1 || s.scale.y != 1 || s.scale.z != 1) w.out_.put("scale", s.scale);
      w.out_.close();
      return end();
    }
    bool operator()(const geometry::OctreeFile& s) const {
      begin();
      w.out_.loseFolder(s.uri, g.where.file);
      w.out_.element("octree", "filename", s.uri);
      return end();
    }
    bool operator()(const geometry::ConvexHull&) const { return lose(); }
    bool operator()(const geometry::TriangleMesh&) const { return lose(); }
    bool operator()(const geometry::Voxels&) const { return lose(); }

   private:
    void begin() const {
      w.out_.open(g.role == GeometryDescription::Role::visual ? "visual" : "collision");
      w.out_.put("name", g.name);
      w.out_.origin(g.placement);
      w.out_.open("geometry");
    }
    bool end() const {
      w.out_.close();
      w.out_.close();
      return true;
    }
    bool one(const char* shape, std::initializer_list<std::pair<const char*, double>> sizes) const {
      begin();
      w.out_.open(shape);
      for (const auto& [name, size] : sizes) w.out_.put(name, size);
      w.out_.close();
      return end();
    }
    bool lose() const {
      w.out_.lose("volumes whose points are in the model and not in a file", g.name);
      return false;
    }
  };

  /// Returns whether URDF can say the volume's shape.
  bool writeVolume(const GeometryDescription& g) { return std::visit(ShapeWriter{*this, g}, g.shape); }

  void writeExtensions(int root) {
    const auto extended = [&](std::size_t i) {
      return static_cast<int>(i) != root && needsExtension(model_.bodies[i].joint, masterIsJoint(model_.bodies[i].joint));
    };
    bool any = !model_.constraints.empty();
    for (std::size_t i = 1; i < model_.bodies.size(); ++i) any = any || extended(i);
    if (!any) return;
    out_.open("libdyn");
    for (std::size_t i = 1; i < model_.bodies.size(); ++i)
      if (extended(i)) writeExtension(out_, model_.bodies[i].joint, masterIsJoint(model_.bodies[i].joint));
    for (const ConstraintDescription& constraint : model_.constraints) writeConstraint(constraint);
    out_.close();
  }

  void writeConstraint(const ConstraintDescription& c) {
    const auto* frames = std::get_if<FrameConstraint>(&c.relation);
    const auto* coupling = std::get_if<JointCoupling>(&c.relation);
    if (frames && frames->has_target && frames->axes == ConstraintAxes::OTHER && frames->frame != model_.bodies[0].name) {
      out_.open("loop");
      out_.put("name", c.name);
      out_.put("link", frames->frame);
      out_.putPose(frames->placement);
      if (frames->other != model_.bodies[0].name) out_.put("other", frames->other);
      out_.putPose(frames->other_placement, "other_xyz", "other_rpy");
      static constexpr const char* directions[] = {"x", "y", "z", "rx", "ry", "rz"};
      std::string free;
      for (std::size_t k = 0; k < 6; ++k)
        if (frames->free[k]) free += (free.empty() ? "" : " ") + std::string(directions[k]);
      if (!free.empty()) out_.put("free", free);
    } else if (coupling) {
      if (c.name != coupling->joint) out_.lose("names of gears", c.name);
      out_.open("gear");
      out_.put("joint", coupling->joint);
      out_.put("type", coupling->coupling.type);
      out_.put("master", coupling->coupling.master);
      writeParameters(out_, coupling->coupling.parameters, coupling->joint);
    } else {
      out_.lose(frames ? "constraints between frames that close no loop" : "locks of joints", c.name);
      return;
    }
    if (c.baumgarte.position != 0) out_.put("position_gain", c.baumgarte.position);
    if (c.baumgarte.velocity != 0) out_.put("velocity_gain", c.baumgarte.velocity);
    out_.close();
  }

  void loseOthers() {
    const Vec3<double> usual = Model().gravity, &g = model_.gravity;
    if (g.x != usual.x || g.y != usual.y || g.z != usual.z) out_.lose("gravity other than 9.81 m/s^2 along -z");
    for (const DisabledCollision& d : model_.disabled_collisions) out_.lose("pairs without collision checks (an SRDF has them)", d.body);
    out_.loseGroups(model_);
    for (const DeviceDescription& device : model_.devices) out_.lose("actuators, tendons and sensors", device.name);
    for (const ConfigurationDescription& state : model_.configurations) out_.lose("named states (an SRDF has them)", state.name);
  }

  const Model& model_;
  Output out_;
  std::string world_;
  const reader::Attached attached_;
  std::set<std::string> links_, joints_;  ///< names that are in use
};

}  // namespace

Written write(const Model& model) { return Writer(model).write(); }

std::vector<std::string> save(const Model& model, const std::string& path) {
  Written written = write(model);
  replaceFile(path, written.text);
  return std::move(written.lost);
}

}  // namespace dyn::urdf
