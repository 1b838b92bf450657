// SPDX-License-Identifier: BSD-2-Clause
// Links, joints and frames of all models of a file, as one tree with constraints.
#include "parts.hpp"

#include <dyn/file.hpp>
#include <dyn/near_names.hpp>
#include <dyn/parsers/sdf.hpp>

#include <cmath>
#include <filesystem>
#include <numeric>
#include <sdf/Frame.hh>
#include <set>
#include <unordered_map>

namespace dyn::sdf {

namespace {

using Type = ::sdf::JointType;

struct LinkRead {
  const ::sdf::Link* link = nullptr;
  std::string name;
  SE3<double> pose;        ///< in the world at the zero configuration
  bool is_static = false;  ///< its model is
  bool canonical = false;  ///< its model's canonical link
  int carrier = -1;        ///< the joint that carries it; -1: none
  int parent = -1;         ///< link; -1: the world
  bool reversed = false;   ///< the carrier's child is the parent
  int body = 0;
};

/// The components of a graph, which grows edge by edge.
class Components {
 public:
  explicit Components(std::size_t nodes) : above_(nodes) { std::iota(above_.begin(), above_.end(), std::size_t{0}); }
  std::size_t of(std::size_t node) {
    while (above_[node] != node) node = above_[node] = above_[above_[node]];
    return node;
  }
  /// Joins two nodes; returns false if they were joined already.
  bool join(std::size_t a, std::size_t b) {
    a = of(a);
    b = of(b);
    if (a == b) return false;
    above_[std::max(a, b)] = std::min(a, b);
    return true;
  }

 private:
  std::vector<std::size_t> above_;
};

class Reader {
 public:
  explicit Reader(const Context& context) : c_(context) {}

  Model run(const ::sdf::Root& root) {
    model_.name = std::filesystem::path(c_.sources.original("")).stem().string();
    if (root.WorldCount() > 1) c_.notes.add("the file has " + std::to_string(root.WorldCount()) + " worlds, of which the first is read");
    if (const ::sdf::World* world = root.WorldByIndex(0)) {
      model_.name = world->Name();
      model_.gravity = vectorOf(world->Gravity());
      const std::uint64_t count = world->ModelCount();
      for (std::uint64_t k = 0; k < count; ++k) {
        const ::sdf::Model& model = *world->ModelByIndex(k);
        collect(model, count > 1 ? model.Name() + "::" : "", {}, false);
        prefixes_[model.Name()] = count > 1 ? model.Name() + "::" : "";
      }
    } else if (root.Model() != nullptr) {
      model_.name = root.Model()->Name();
      collect(*root.Model(), "", {}, false);
    }
    if (links_.empty()) throw Error(ErrorCode::model, "has no <link>", {c_.sources.original(""), 0, ""});
    buildTree();
    addBodies();
    addConstraints();
    checkMasters();
    addFrames();
    if (const ::sdf::World* world = root.WorldByIndex(0))
      for (std::uint64_t k = 0; k < world->FrameCount(); ++k) addWorldFrame(*world->FrameByIndex(k));
    model_.notes = c_.notes.list();
    return std::move(model_);
  }

 private:
  void collect(const ::sdf::Model& model, const std::string& prefix, const SE3<double>& around, bool is_static) {
    const SE3<double> pose = around * resolved(c_, model);
    is_static = is_static || model.Static();
    if (model.LinkCount() > 1 && !model.SelfCollide() && hasCollisions(model))
      c_.notes.add("<self_collide> is false for a model; libdyn checks the pairs that its program or an SRDF leaves", c_.where(model).line);
    for (std::uint64_t k = 0; k < model.LinkCount(); ++k) {
      const ::sdf::Link& link = *model.LinkByIndex(k);
      const std::string name = prefix + link.Name();
      if (name == "universe")
        throw Error(ErrorCode::model, "a link is called 'universe', which is reserved for the world; rename it", c_.where(link));
      index_.emplace(name, static_cast<int>(links_.size()));
      links_.push_back({&link, name, pose * resolved(c_, link), is_static, model.CanonicalLink() == &link});
    }
    models_.push_back({&model, prefix, pose});
    for (std::uint64_t k = 0; k < model.ModelCount(); ++k) {
      const ::sdf::Model& nested = *model.ModelByIndex(k);
      collect(nested, prefix + nested.Name() + "::", pose, is_static);
    }
    // Links of nested models are known now.
    for (std::uint64_t k = 0; k < model.JointCount(); ++k) collectJoint(*model.JointByIndex(k), prefix, pose);
  }

  static bool hasCollisions(const ::sdf::Model& model) {
    for (std::uint64_t k = 0; k < model.LinkCount(); ++k)
      if (model.LinkByIndex(k)->CollisionCount() > 0) return true;
    return false;
  }

  void collectJoint(const ::sdf::Joint& joint, const std::string& prefix, const SE3<double>& model_pose) {
    JointRead read;
    read.joint = &joint;
    read.name = prefix + joint.Name();
    std::string parent, child;
    throwFirst(joint.ResolveParentLink(parent), c_.sources);
    throwFirst(joint.ResolveChildLink(child), c_.sources);
    read.child = linkNamed(read, prefix + child);
    read.in_child = resolved(c_, joint, child);
    if (parent == "world") {
      read.in_parent = model_pose * resolved(c_, joint, "__model__");
    } else {
      read.parent = linkNamed(read, prefix + parent);
      read.in_parent = resolved(c_, joint, parent);
    }
    const auto length = [](const Vec3<double>& v) { return std::sqrt(dot(v, v)); };
    read.size = length(read.in_parent.p) + length(links_[static_cast<std::size_t>(read.child)].pose.p);
    if (read.parent == read.child) throw Error(ErrorCode::model, "joins link '" + prefix + child + "' to itself", c_.where(joint, read.name));
    const ::sdf::ElementPtr e = joint.Element();
    if (e && e->HasElement("physics") && e->GetElement("physics")->HasElement("simbody"))
      read.cut = e->GetElement("physics")->GetElement("simbody")->Get<bool>("must_be_loop_joint", false).first;
    if (const bool is_static = links_[static_cast<std::size_t>(read.child)].is_static; is_static)
      return c_.notes.add("a joint of a static model does not move", c_.where(joint).line);
    joints_.push_back(std::move(read));
  }

  int linkNamed(const JointRead& read, const std::string& name) const {
    const auto found = index_.find(name);
    if (found != index_.end()) return found->second;
    throw Error(ErrorCode::model, "names link '" + name + "', which does not exist", c_.where(*read.joint, read.name));
  }

  /// Chooses the joints that carry links: those that close no loop, in the file's order. The rest become constraints.
  void buildTree() {
    const auto node = [](int link) { return static_cast<std::size_t>(link + 1); };
    Components components(links_.size() + 1);
    std::vector<std::vector<int>> around(links_.size() + 1);  // joints of the tree at each node
    std::vector<bool> is_child(links_.size());
    for (std::size_t k = 0; k < joints_.size(); ++k) {
      const JointRead& read = joints_[k];
      if (read.joint->Type() == Type::GEARBOX) {
        gearboxes_.push_back(static_cast<int>(k));
      } else if (read.cut || !components.join(node(read.parent), node(read.child))) {
        closures_.push_back(static_cast<int>(k));
      } else {
        around[node(read.parent)].push_back(static_cast<int>(k));
        around[node(read.child)].push_back(static_cast<int>(k));
        is_child[static_cast<std::size_t>(read.child)] = true;
      }
    }
    std::vector<bool> reached(links_.size() + 1);
    std::vector<int> stack;
    const auto spread = [&](int root) {
      reached[node(root)] = true;
      stack.push_back(root);
      while (!stack.empty()) {
        const int at = stack.back();
        stack.pop_back();
        for (const int k : around[node(at)]) {
          const JointRead& read = joints_[static_cast<std::size_t>(k)];
          const int other = read.parent == at ? read.child : read.parent;
          if (reached[node(other)]) continue;
          reached[node(other)] = true;
          LinkRead& link = links_[static_cast<std::size_t>(other)];
          link.carrier = k;
          link.parent = at;
          link.reversed = read.parent != at;
          stack.push_back(other);
        }
      }
    };
    spread(-1);
    // Roots: links that no joint has as its child, canonical ones first; or any link of a circle.
    for (const int choice : {0, 1, 2})
      for (std::size_t k = 0; k < links_.size(); ++k) {
        if (reached[k + 1] || (choice < 2 && is_child[k]) || (choice == 0 && !links_[k].canonical)) continue;
        if (!links_[k].is_static) ++free_roots_;
        spread(static_cast<int>(k));
      }
    if (free_roots_ == 0 && c_.options.root != LoadOptions().root) reader::refuseRoot(c_.options.root, c_.sources.original(""));
    if (free_roots_ > 0 && c_.options.root == "fixed")
      c_.notes.add(std::to_string(free_roots_) + (free_roots_ == 1 ? " link that no joint carries is" : " links that no joint carries are") +
                   " fixed to the world by the root joint; SDF lets such a model move freely (--root free_flyer)");
  }

  JointDescription rootJoint(const LinkRead& link) {
    JointDescription joint;
    joint.type = link.is_static ? "fixed" : c_.options.root;
    joint.name = reader::freeName(!link.is_static && free_roots_ == 1 ? "root_joint" : link.name + "_root_joint", joint_names_);
    joint.placement = link.pose;
    joint.where = c_.where(*link.link, joint.name);
    return joint;
  }

  void addBodies() {
    std::vector<int> parents;
    std::vector<std::string> names;
    for (const JointRead& read : joints_) joint_names_.insert(read.name);
    for (const LinkRead& link : links_) {
      parents.push_back(link.parent);
      names.push_back(link.carrier < 0 ? "" : joints_[static_cast<std::size_t>(link.carrier)].name);
    }
    for (const int k : reader::depthFirst(parents, names, c_.options.order)) addBody(links_[static_cast<std::size_t>(k)]);
  }

  void addBody(LinkRead& link) {
    const Inertia<double> inertia = inertiaOf(c_, *link.link, link.name);
    const Where where = c_.where(*link.link);
    const int parent = link.parent < 0 ? 0 : links_[static_cast<std::size_t>(link.parent)].body;
    if (link.carrier < 0) {
      link.body = model_.addBody(link.name, 0, rootJoint(link), inertia);
    } else {
      const JointRead& read = joints_[static_cast<std::size_t>(link.carrier)];
      JointMotion motion = motionOf(c_, read, link.reversed);
      if (motion.from_link) {
        link.body = model_.addBody(link.name, parent, std::move(motion.joint), inertia);
      } else {
        // The joint is elsewhere in the link. Its frame, which has its name in SDF, moves, and carries the link.
        const int frame = model_.addBody(read.name, parent, std::move(motion.joint));
        model_.bodies.back().where = c_.where(*read.joint);
        JointDescription weld;
        weld.name = reader::freeName(read.name + "_to_link", joint_names_);
        weld.placement = (link.reversed ? read.in_parent : read.in_child).inverse();
        weld.where = c_.where(*read.joint, weld.name);
        link.body = model_.addBody(link.name, frame, weld, inertia);
      }
    }
    model_.bodies.back().where = where;
    for (GeometryDescription& volume : geometriesOf(c_, *link.link, link.name, link.body)) model_.geometries.push_back(std::move(volume));
  }

  std::string bodyName(int link) const { return link < 0 ? "universe" : links_[static_cast<std::size_t>(link)].name; }

  void addConstraints() {
    for (const int k : closures_) {
      const JointRead& read = joints_[static_cast<std::size_t>(k)];
      model_.constraints.push_back(closureOf(c_, read, bodyName(read.parent), bodyName(read.child)));
    }
    for (const int k : gearboxes_) {
      const JointRead& gearbox = joints_[static_cast<std::size_t>(k)];
      model_.constraints.push_back(gearOf(c_, gearbox, hingeOf(gearbox, gearbox.parent), hingeOf(gearbox, gearbox.child)));
    }
  }

  /// Returns the hinge that carries a link of a gearbox from the reference body.
  const JointRead& hingeOf(const JointRead& gearbox, int link) const {
    const std::string prefix = gearbox.name.substr(0, gearbox.name.size() - gearbox.joint->Name().size());
    const std::string reference = prefix + gearbox.joint->Element()->Get<std::string>("gearbox_reference_body", "").first;
    const LinkRead* at = link < 0 ? nullptr : &links_[static_cast<std::size_t>(link)];
    const JointRead* carrier = at == nullptr || at->carrier < 0 ? nullptr : &joints_[static_cast<std::size_t>(at->carrier)];
    const bool hinge = carrier && !at->reversed && (carrier->joint->Type() == Type::REVOLUTE || carrier->joint->Type() == Type::CONTINUOUS);
    if (!hinge || bodyName(at->parent) != reference)
      throw Error(ErrorCode::model,
                  "a gearbox couples two links that hinges carry from its <gearbox_reference_body>; link '" + bodyName(link) + "' is none",
                  c_.where(*gearbox.joint, gearbox.name));
    return *carrier;
  }

  void checkMasters() const {
    for (const BodyDescription& body : model_.bodies)
      if (const std::string& master = body.joint.coupling.master; !master.empty() && !joint_names_.count(master))
        throw Error(ErrorCode::model,
                    "mimics joint '" + master + "', which does not exist" + nearNames(master, {joint_names_.begin(), joint_names_.end()}),
                    body.joint.where);
  }

  void addFrames() {
    for (const auto& [model, prefix, pose] : models_)
      for (std::uint64_t k = 0; k < model->FrameCount(); ++k) {
        const ::sdf::Frame& frame = *model->FrameByIndex(k);
        std::string link;
        throwFirst(frame.ResolveAttachedToBody(link), c_.sources);
        const auto found = index_.find(prefix + link);
        if (found == index_.end()) {
          model_.addFrame(prefix + frame.Name(), 0, pose * resolved(c_, frame, "__model__"));
        } else {
          model_.addFrame(prefix + frame.Name(), links_[static_cast<std::size_t>(found->second)].body, resolved(c_, frame, link));
        }
      }
  }

  void addWorldFrame(const ::sdf::Frame& frame) {
    std::string link;
    throwFirst(frame.ResolveAttachedToBody(link), c_.sources);
    if (link == "world") {
      model_.addFrame(frame.Name(), 0, resolved(c_, frame, "world"));
      return;
    }
    const std::size_t end = link.find("::");
    const auto prefix = prefixes_.find(link.substr(0, end));
    const auto found = prefix == prefixes_.end() || end == std::string::npos ? index_.end() : index_.find(prefix->second + link.substr(end + 2));
    if (found == index_.end()) throw Error(ErrorCode::model, "the frame '" + frame.Name() + "' is attached to no link", c_.where(frame));
    model_.addFrame(frame.Name(), links_[static_cast<std::size_t>(found->second)].body, resolved(c_, frame, link));
  }

  struct ModelRead {
    const ::sdf::Model* model;
    std::string prefix;
    SE3<double> pose;
  };

  const Context& c_;
  Model model_;
  std::vector<ModelRead> models_;
  std::vector<LinkRead> links_;
  std::vector<JointRead> joints_;
  std::vector<int> closures_, gearboxes_;
  std::unordered_map<std::string, int> index_;
  std::map<std::string, std::string> prefixes_;  ///< of the world's models
  std::set<std::string> joint_names_;
  int free_roots_ = 0;
};

}  // namespace

Model parse(const std::string& text, const std::string& name, const LoadOptions& options) {
  reader::Notes notes;
  const Sources sources(text, name, options.files, notes);
  ::sdf::Root root;
  load(sources, root, notes);
  return Reader(Context{sources, options, notes}).run(root);
}

Model load(const std::string& path, const LoadOptions& options) { return parse(readFile(path, largest_model_file), path, options); }

}  // namespace dyn::sdf
