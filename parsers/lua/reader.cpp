// SPDX-License-Identifier: BSD-2-Clause
// Bodies, joints and frames of an RBDL model.
#include "parts.hpp"

#include <dyn/file.hpp>
#include <dyn/near_names.hpp>

#include <cmath>
#include <filesystem>
#include <set>
#include <unordered_map>
#include <utility>

namespace dyn::lua {

namespace {

constexpr const char* root_name = "ROOT";

/// One axis of a joint: angular part first. Its angular part is a unit vector or zero; a translation without rotation is a unit vector.
JointDescription axisOf(const Value& axis) {
  const std::vector<double> s = axis.numbers(6);
  const Vec3<double> turn{s[0], s[1], s[2]}, move{s[3], s[4], s[5]};
  const double turns = std::sqrt(dot(turn, turn)), moves = std::sqrt(dot(move, move));
  JointDescription joint;
  joint.where = axis.where();
  if (turns == 0 && moves == 0) axis.fail("has no direction");
  if (std::fabs((turns > 0 ? turns : moves) - 1) > 1e-6)
    axis.fail("must have length 1, as RBDL's axes have; it has " + std::to_string(turns > 0 ? turns : moves));
  const Vec3<double> direction = turns > 0 ? turn : move;
  joint.type = turns == 0 ? "prismatic" : (moves == 0 ? "revolute" : "helical");
  joint.parameters["axis"] = std::vector<double>{direction.x, direction.y, direction.z};
  if (turns > 0 && moves > 0) {
    const Vec3<double> across = cross(turn, move);
    if (std::sqrt(dot(across, across)) > 1e-9 * moves)
      axis.fail("turns about one direction and moves along another; a screw moves along its own axis");
    joint.parameters["pitch"] = std::vector<double>{dot(turn, move)};
  }
  return joint;
}

JointDescription about(double x, double y, double z) {
  JointDescription joint;
  joint.type = "revolute";
  joint.parameters["axis"] = std::vector<double>{x, y, z};
  return joint;
}

JointDescription ofType(const char* type) {
  JointDescription joint;
  joint.type = type;
  return joint;
}

/// Returns the joint that moves by its parts, one after the other.
JointDescription series(std::vector<JointDescription> parts) {
  if (parts.size() == 1) return std::move(parts.front());
  JointDescription joint = ofType("composite");
  joint.parameters["parts"] = std::move(parts);
  return joint;
}

JointDescription namedJoint(const Value& name) {
  const std::pair<const char*, std::vector<JointDescription>> known[] = {{"JointTypeSpherical", {ofType("spherical")}},
                                                                         {"JointTypeEulerZYX", {ofType("spherical_zyx")}},
                                                                         {"JointTypeEulerXYZ", {about(1, 0, 0), about(0, 1, 0), about(0, 0, 1)}},
                                                                         {"JointTypeEulerYXZ", {about(0, 1, 0), about(1, 0, 0), about(0, 0, 1)}},
                                                                         {"JointTypeTranslationXYZ", {ofType("translation")}},
                                                                         {"JointTypeFloatingBase", {ofType("translation"), ofType("spherical")}}};
  std::vector<std::string> names;
  for (const auto& [type, parts] : known) {
    if (name.text() == type) return series(parts);
    names.emplace_back(type);
  }
  name.fail("there is no joint '" + name.text() + "'" + nearNames(name.text(), names) + "; a joint is a list of axes, or one of RBDL's names");
}

JointDescription jointOf(const Value& joint) {
  const int count = joint.length();
  if (count == 0) return ofType("fixed");
  if (count > 6) joint.fail("has " + std::to_string(count) + " degrees of freedom; a joint has at most 6");
  if (const Value first = joint[1]; count == 1 && first.isText()) return namedJoint(first);
  std::vector<JointDescription> parts;
  for (int k = 1; k <= count; ++k) parts.push_back(axisOf(joint[k]));
  return series(std::move(parts));
}

/// Reads mass, com and inertia about the centre of mass. Missing ones are those that RBDL documents: 1 kg, zero, the identity.
Inertia<double> inertiaOf(const Value& body) {
  if (!body.exists()) return {};
  body.noteOthers("body", {"mass", "com", "inertia", "name", "length"});
  const Value mass = body["mass"];
  if (!mass.exists()) body.notes().add("a body has no mass and gets 1 kg, as RBDL documents", body.where().line);
  Inertia<double> Y;
  Y.mass = mass.number(1);
  Y.com = body["com"].vector(Vec3<double>{});
  const Value inertia = body["inertia"];
  if (!inertia.exists()) {
    body.notes().add("a body has no inertia and gets the identity, as RBDL documents", body.where().line);
    Y.rotational = {1, 0, 0, 1, 0, 1};
    return Y;
  }
  const Mat3<double> I = inertia.matrix();
  if (I(0, 1) != I(1, 0) || I(0, 2) != I(2, 0) || I(1, 2) != I(2, 1))
    body.notes().add("an inertia is not symmetric; its lower triangle counts, as in RBDL", inertia.where().line);
  Y.rotational = {I(0, 0), I(1, 0), I(2, 0), I(1, 1), I(2, 1), I(2, 2)};
  return Y;
}

/// An entry of `frames`, before bodies are put in order.
struct Entry {
  BodyDescription body;
  int parent = -1;  ///< entry; -1: the world
  std::vector<GeometryDescription> visuals;
  std::vector<std::pair<std::string, Vec3<double>>> markers;
};

class Reader {
 public:
  Reader(const Sandbox& sandbox, const LoadOptions& options) : sandbox_(sandbox), options_(options) {}

  Model run() {
    const Value top(sandbox_, notes_);
    if (!top.isTable()) top.fail(top.exists() ? "must be a table" : "is missing; the script must end with `return model`");
    top.noteOthers("model", {"name", "gravity", "frames", "points", "local_frames", "constraint_sets"});
    model_.name = top["name"].text(std::filesystem::path(sandbox_.file()).stem().string());
    if (const Value gravity = top["gravity"]; gravity.exists()) {
      model_.gravity = gravity.vector();
    } else {
      model_.gravity = {0, -9.81, 0};
      notes_.add("the model has no gravity and gets 0 -9.81 0, as in RBDL");
    }
    readFrames(top["frames"]);
    applyRoot();
    addBodies();
    readPoints(top["points"]);
    readLocalFrames(top["local_frames"]);
    readConstraints(top["constraint_sets"]);
    if (sandbox_.printed()) notes_.add("ignored: the script's calls of print");
    model_.notes = notes_.list();
    return std::move(model_);
  }

  std::vector<NamedConstraints> sets() { return std::move(sets_); }
  /// Sets of constraints are wanted, so that one which cannot be read is an error.
  bool wants_sets = false;

 private:
  void readFrames(const Value& frames) {
    const int count = frames.length();
    if (count == 0) frames.fail("has no entry; a model has at least one body");
    std::unordered_map<std::string, int> index;
    for (int k = 1; k <= count; ++k) {
      const Value frame = frames[k];
      frame.noteOthers("frame", {"name", "parent", "body", "joint", "joint_frame", "joint_name", "visuals", "markers"});
      Entry entry;
      entry.body.name = frame["name"].text();
      const std::string& name = entry.body.name;
      if (name.empty()) frame.fail("has an empty name");
      if (name == root_name || name == "universe") frame.fail("is called '" + name + "', which is reserved for the world; rename it");
      const Value parent_name = frame["parent"];
      const std::string parent = parent_name.text();
      if (parent != root_name) {
        const auto found = index.find(parent);
        if (found == index.end()) {
          std::vector<std::string> names{root_name};
          for (const Entry& e : entries_) names.push_back(e.body.name);
          parent_name.fail("'" + parent + "' is no frame before this one" + nearNames(parent, names) + "; parents come first");
        }
        entry.parent = found->second;
      }
      if (!index.emplace(name, k - 1).second) frame.fail("two frames are called '" + name + "'");
      entry.body.where = frame.where();
      entry.body.joint = jointOf(frame["joint"]);
      entry.body.joint.placement = frame["joint_frame"].pose();
      frame["joint_frame"].noteOthers("joint_frame", {"r", "E"});
      entry.body.joint.name = frame["joint_name"].text("");
      entry.body.joint.where = {sandbox_.file(), entry.body.where.line, entry.body.joint.name};
      entry.body.inertia = inertiaOf(frame["body"]);
      reader::judgeInertia(entry.body.inertia, name, options_.inertias, entry.body.where, notes_);
      entry.visuals = readVisuals(frame["visuals"], name);
      if (const Value markers = frame["markers"]; markers.exists())
        for (const std::string& marker : markers.names()) entry.markers.emplace_back(marker, markers[marker.c_str()].vector());
      entries_.push_back(std::move(entry));
    }
    nameJoints();
  }

  /// Joints without a name are called after their bodies.
  void nameJoints() {
    std::set<std::string> taken;
    for (const Entry& entry : entries_)
      if (const JointDescription& joint = entry.body.joint; !joint.name.empty() && !taken.insert(joint.name).second)
        throw Error(ErrorCode::model, "two joints are called '" + joint.name + "'", joint.where);
    for (Entry& entry : entries_) {
      JointDescription& joint = entry.body.joint;
      if (!joint.name.empty()) continue;
      joint.name = reader::freeName(entry.body.name + "_joint", taken);
      joint.where.joint = joint.name;
    }
  }

  /// The only body on the world, if it is fixed there, is a root link as in other formats.
  void applyRoot() {
    if (options_.root == LoadOptions().root) return;
    Entry* root = nullptr;
    int roots = 0;
    for (Entry& entry : entries_)
      if (entry.parent < 0 && ++roots > 0) root = &entry;
    if (roots != 1 || root->body.joint.type != "fixed") reader::refuseRoot(options_.root, sandbox_.file());
    root->body.joint.type = options_.root;
  }

  void addBodies() {
    std::vector<int> parents;
    std::vector<std::string> joints;
    for (const Entry& entry : entries_) {
      parents.push_back(entry.parent);
      joints.push_back(entry.body.joint.name);
    }
    names_.bodies[root_name] = 0;
    std::vector<int> body_of(entries_.size());
    for (const int k : reader::depthFirst(parents, joints, options_.order)) {
      Entry& entry = entries_[static_cast<std::size_t>(k)];
      entry.body.parent = entry.parent < 0 ? 0 : body_of[static_cast<std::size_t>(entry.parent)];
      const int body = body_of[static_cast<std::size_t>(k)] = static_cast<int>(model_.bodies.size());
      names_.bodies[entry.body.name] = body;
      taken_.insert(entry.body.name);
      for (GeometryDescription& volume : entry.visuals) {
        volume.body = body;
        model_.geometries.push_back(std::move(volume));
      }
      model_.bodies.push_back(std::move(entry.body));
    }
    taken_.insert(model_.bodies[0].name);
    for (std::size_t k = 0; k < entries_.size(); ++k)
      for (const auto& [name, point] : entries_[k].markers) addFrame(name, body_of[k], {Mat3<double>::identity(), point});
  }

  /// Adds a frame; one whose name is taken gets another.
  FrameDescription addFrame(const std::string& name, int body, const SE3<double>& placement) {
    const std::string free = reader::freeName(name, taken_);
    if (free != name) notes_.add("the name '" + name + "' is taken; the frame is called '" + free + "'");
    model_.addFrame(free, body, placement);
    return model_.frames.back();
  }

  void addNamed(const Value& entry, const SE3<double>& placement, std::map<std::string, FrameDescription>& among) {
    const std::string name = entry["name"].text();
    if (among.count(name)) entry.fail("the name '" + name + "' is given twice");
    among[name] = addFrame(name, names_.body(entry["body"]), placement);
  }

  void readPoints(const Value& points) {
    for (int k = 1, count = points.length(); k <= count; ++k) {
      const Value point = points[k];
      point.noteOthers("point", {"name", "body", "point"});
      addNamed(point, {Mat3<double>::identity(), point["point"].vector(Vec3<double>{})}, names_.points);
    }
  }

  void readLocalFrames(const Value& frames) {
    for (int k = 1, count = frames.length(); k <= count; ++k) {
      const Value frame = frames[k];
      frame.noteOthers("local frame", {"name", "body", "r", "E"});
      addNamed(frame, frame.pose(), names_.frames);
    }
  }

  /// Loops of the only set belong to the mechanism. Sets are alternatives where there are several, and contacts come and go.
  void readConstraints(const Value& sets) {
    if (!sets.exists()) return;
    const std::size_t count = sets.names().size();
    if (count > 1 && !wants_sets) {
      notes_.add("the model has " + std::to_string(count) +
                 " constraint sets, none of which is part of it; C++ programs read them by lua::constraintSets");
      return;
    }
    sets_ = readConstraintSets(sets, model_, names_);
    if (count != 1) return;
    std::size_t contacts = 0;
    for (const ConstraintDescription& constraint : sets_[0].constraints)
      if (std::get<FrameConstraint>(constraint.relation).has_target) {
        model_.constraints.push_back(constraint);
      } else {
        ++contacts;
      }
    if (contacts > 0)
      notes_.add("the constraint set '" + sets_[0].name + "' has " + std::to_string(contacts) +
                 " contacts, which are not part of the model; C++ programs read them by lua::constraintSets");
  }

  const Sandbox& sandbox_;
  const LoadOptions& options_;
  reader::Notes notes_;
  Model model_;
  std::vector<Entry> entries_;
  Names names_;
  std::set<std::string> taken_;  ///< names of bodies and frames
  std::vector<NamedConstraints> sets_;
};

}  // namespace

int Names::body(const Value& name) const {
  const auto found = bodies.find(name.text());
  if (found != bodies.end()) return found->second;
  std::vector<std::string> all;
  for (const auto& [known, index] : bodies) all.push_back(known);
  name.fail("there is no body '" + name.text() + "'" + nearNames(name.text(), all));
}

const FrameDescription& Names::frame(const Value& name, const std::map<std::string, FrameDescription>& among, const char* what) const {
  const auto found = among.find(name.text());
  if (found != among.end()) return found->second;
  std::vector<std::string> all;
  for (const auto& [known, frame] : among) all.push_back(known);
  name.fail("there is no " + std::string(what) + " '" + name.text() + "'" + nearNames(name.text(), all));
}

Model parse(const std::string& text, const std::string& name, const LoadOptions& options) { return Reader(Sandbox(text, name), options).run(); }

Model load(const std::string& path, const LoadOptions& options) { return parse(readFile(path, largest_model_file), path, options); }

std::vector<NamedConstraints> parseConstraintSets(const std::string& text, const std::string& name) {
  const Sandbox sandbox(text, name);
  const LoadOptions options{.inertias = Inertias::any};
  Reader reader(sandbox, options);
  reader.wants_sets = true;
  reader.run();
  return reader.sets();
}

std::vector<NamedConstraints> constraintSets(const std::string& path) { return parseConstraintSets(readFile(path, largest_model_file), path); }

}  // namespace dyn::lua
