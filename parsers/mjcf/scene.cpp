// SPDX-License-Identifier: BSD-2-Clause
#include "common/reader.hpp"
#include "names.hpp"

#include <cmath>
#include <cstring>

namespace dyn::mjcf {

namespace {

/// The most elements of bodies that are read, replicas counted one by one.
constexpr std::size_t most_elements = 1'000'000;

bool is(const XMLElement& e, const char* name) { return std::strcmp(e.Name(), name) == 0; }

class SceneReader {
 public:
  SceneReader(const Context& context, const LoadOptions& options, const Guard& guard) : c_(context), options_(options), guard_(guard) {}

  Scene run() {
    model_.name = c_.source.root().Attribute("model") ? c_.source.root().Attribute("model") : "MuJoCo Model";
    model_.gravity = c_.settings.gravity;
    scene_.bodies.push_back({"world", 0, 0, {}, nullptr});
    scene_.body.emplace("world", 0);
    const DefaultClass& main = c_.defaults.find("", c_.source.root());
    bool any = false;
    c_.source.forEach(c_.source.root(), [&](const XMLElement& e) {
      if (!is(e, "worldbody")) return;
      any = true;
      contents(e, {{}, &main, ""}, 0, 0);
    });
    guard_([&] {
      if (!any) c_.source.fail(c_.source.root(), "has no <worldbody>", ErrorCode::syntax);
      weigh();
      addRoot();
    });
    nameAll(scene_);
    return std::move(scene_);
  }

 private:
  /// The surroundings of an element.
  struct Scope {
    SE3<long double> frame;           ///< pose in the body's frame
    const DefaultClass* child_class;  ///< of elements that name no class
    std::string suffix;               ///< of names, within replicas
  };
  struct Item {
    const XMLElement* element;
    Scope scope;
  };

  void visit(const XMLElement& e) {
    if (++visited_ > most_elements) c_.source.fail(e, "the model has more than " + std::to_string(most_elements) + " elements with all its replicas");
  }

  /// Lists the elements of a body; frames and replicas are replaced by what they contain.
  void gather(const XMLElement& e, const Scope& scope, int depth, std::vector<Item>& items) {
    if (depth > deepest) c_.source.fail(e, "bodies and frames are nested deeper than " + std::to_string(deepest), ErrorCode::syntax);
    c_.source.forEach(e, [&](const XMLElement& child) {
      visit(child);
      for (const char* maker : {"composite", "flexcomp", "attach"})
        if (is(child, maker))
          c_.source.fail(child, std::string("<") + maker +
                                    "> makes bodies, which this reader does not do; load the model with MuJoCo and save it "
                                    "(mj_saveLastXML, or its program `compile`): the saved file lists the bodies");
      if (is(child, "frame")) {
        const Values v(c_.source, child, nullptr);
        gather(child, {scope.frame * poseOf(v, c_.settings), classOf(v, scope), scope.suffix}, depth + 1, items);
      } else if (is(child, "replicate")) {
        replicate(Values(c_.source, child, nullptr), scope, depth + 1, items);
      } else {
        items.push_back({&child, scope});
      }
    });
  }

  const DefaultClass* classOf(const Values& v, const Scope& scope) const {
    return v.has("childclass") ? &c_.defaults.find(v.text("childclass"), v.element()) : scope.child_class;
  }

  void replicate(const Values& v, const Scope& scope, int depth, std::vector<Item>& items) {
    if (!v.has("count")) v.fail("<replicate> has no attribute 'count'", ErrorCode::syntax);
    const int count = v.integer("count", 0);
    if (count < 1) v.fail("<replicate>: its count must be positive");
    if (static_cast<std::size_t>(count) > most_elements) v.fail("<replicate>: its count is larger than " + std::to_string(most_elements));
    const Vec3<long double> offset = v.vector3("offset"), euler = v.vector3("euler");
    const DefaultClass* child_class = classOf(v, scope);
    Vec3<long double> p;
    const std::size_t digits = std::to_string(count).size();
    for (int i = 0; i < count; ++i) {
      const auto angle = [&](long double x) { return c_.settings.angle(static_cast<long double>(i) * x); };
      const SE3<long double> pose{eulerRotation({angle(euler.x), angle(euler.y), angle(euler.z)}, c_.settings.eulerseq), p};
      p = pose.act(offset);
      const std::string number = std::to_string(i);
      visit(v.element());
      gather(v.element(), {scope.frame * pose, child_class, v.text("sep") + std::string(digits - number.size(), '0') + number + scope.suffix}, depth,
             items);
    }
  }

  /// Reads what a body, or the world, contains.
  void contents(const XMLElement& e, const Scope& scope, std::size_t record, int depth) {
    guard_([&] {
      std::vector<Item> items;
      gather(e, scope, depth, items);
      const bool world = record == 0;
      if (world) {
        for (const Item& item : items)
          if (is(*item.element, "joint") || is(*item.element, "freejoint") || is(*item.element, "inertial"))
            c_.source.fail(*item.element,
                           "the world has no " + std::string(is(*item.element, "inertial") ? "mass" : "joints") + "; put it into a <body>");
      } else {
        joints(items, record);
      }
      volumes(items, record);
      for (const Item& item : items)
        if (is(*item.element, "body")) body(item, record, depth + 1);
    });
  }

  std::string nameOf(const Item& item) const {
    const char* name = item.element->Attribute("name");
    return name && *name ? name + item.scope.suffix : "";
  }

  /// Enters a name into an index. Throws Error(model) for one that is used twice.
  void enter(const Item& item, const char* kind, const std::string& name, std::size_t index, std::unordered_map<std::string, std::size_t>& names) {
    if (name.empty()) return;
    if (name == "universe")
      c_.source.fail(*item.element, std::string("a ") + kind + " is called 'universe', which is reserved for the world; rename it");
    const auto [first, is_new] = lines_.emplace(std::string(kind) + " " + name, c_.source.where(*item.element));
    if (!is_new || names.count(name))
      c_.source.fail(*item.element, std::string("two ") + (std::strcmp(kind, "body") == 0 ? "bodies" : kind + std::string("s")) + " are called '" +
                                        name + "'" +
                                        (is_new ? "; the world has that name" : "; the other is at line " + std::to_string(first->second.line)));
    names.emplace(name, index);
  }

  void body(const Item& item, std::size_t parent, int depth) {
    guard_([&] {
      const Values v(c_.source, *item.element, nullptr);
      BodyRecord record;
      record.name = nameOf(item);
      record.element = item.element;
      record.home = item.scope.frame * poseOf(v, c_.settings);
      const std::size_t index = scene_.bodies.size();
      enter(item, "body", record.name, index, scene_.body);
      parents_.push_back(parent);
      scene_.bodies.push_back(record);
      if (v.flag("mocap", false)) c_.notes.count("bodies that motion capture would move are fixed", c_.source.where(*item.element));
      contents(*item.element, {{}, classOf(v, item.scope), item.scope.suffix}, index, depth);
    });
  }

  /// Adds the bodies that a body's joints carry, and the body's mass. `home` holds the body's pose in its parent until then.
  void joints(const std::vector<Item>& items, std::size_t index) {
    BodyRecord& record = scene_.bodies[index];
    const std::size_t parent = parents_[index - 1];
    const SE3<long double> place = record.home;
    record.home = scene_.bodies[parent].home * place;
    int carrier = static_cast<int>(scene_.bodies[parent].last);
    record.first = record.last = model_.bodies.size();
    SE3<long double> at = place;  // pose of the body's frame in `carrier`
    const Where where = c_.source.where(*record.element);
    int count = 0;
    bool free = false;
    for (const Item& item : items) {
      if (!is(*item.element, "joint") && !is(*item.element, "freejoint")) continue;
      guard_([&] {
        const Values v = c_.defaults.of(*item.element, *item.scope.child_class);
        Joint joint = readJoint(v, item.scope.frame, c_);
        if (++count > 1 && (free || joint.free)) v.fail("a free joint is the only joint of its body");
        free = joint.free;
        if (free && parent != 0) v.fail("a free joint belongs to a body of the world; this one is inside another body");
        JointDescription& j = joint.description;
        j.name = nameOf(item);
        j.where = c_.source.where(*item.element, j.name);
        // A free joint's q is the body's pose in the world, as in MuJoCo.
        j.placement = free ? SE3<double>{} : cast<double>(at * joint.pose);
        enter(item, "joint", j.name, scene_.joints.size(), scene_.joint);
        scene_.joints.push_back({model_.bodies.size(), index, joint.ref, free ? 7 : (j.type == "spherical" ? 4 : 1)});
        at = joint.after;
        record.last = model_.bodies.size();
        carrier = model_.addBody("", carrier, std::move(j));
        model_.bodies.back().where = where;
      });
    }
    const bool inside = at.p.x == 0 && at.p.y == 0 && at.p.z == 0;
    // A joint with an error carries no body.
    if (record.last == model_.bodies.size() || !inside) {
      JointDescription fixed;
      fixed.placement = cast<double>(at);
      fixed.where = where;
      record.last = model_.bodies.size();
      model_.addBody("", carrier, std::move(fixed));
      model_.bodies.back().where = where;
    }
  }

  void volumes(const std::vector<Item>& items, std::size_t index) {
    const BodyRecord& record = scene_.bodies[index];
    const XMLElement* inertial = nullptr;
    Inertia<long double> own, geoms;
    for (const Item& item : items)
      if (is(*item.element, "inertial")) {
        if (inertial != nullptr) c_.source.fail(*item.element, "the body has two <inertial>");
        inertial = item.element;
        guard_([&] { own = readInertial(Values(c_.source, *inertial, nullptr), item.scope.frame, options_.inertias, c_); });
      }
    using From = Settings::FromGeoms;
    const From from = c_.settings.inertia_from_geoms;
    const bool weigh = index != 0 && (from == From::always || (from == From::if_missing && inertial == nullptr));
    for (const Item& item : items) {
      if (is(*item.element, "geom")) guard_([&] { geom(item, index, weigh, geoms); });
      if (is(*item.element, "site")) guard_([&] { site(item, index); });
    }
    if (index == 0) return;
    // Without geoms that have mass, <inertial> holds all the same.
    model_.bodies[record.last].inertia = cast<double>(bounded(weigh && (inertial == nullptr || geoms.mass > 0) ? geoms : own, c_.settings));
  }

  void geom(const Item& item, std::size_t index, bool weigh, Inertia<long double>& sum) {
    const Values v = c_.defaults.of(*item.element, *item.scope.child_class);
    const Geom geom = readGeom(v, item.scope.frame, weigh, c_);
    sum = sum + geom.inertia;
    const std::string name = nameOf(item);
    enter(item, "geom", name, scene_.geoms.size(), scene_.geom);
    if (!geom.shape || (geom.visual() && c_.settings.discard_visual)) {
      if (!name.empty()) scene_.geom[name] = left_out;
      return;
    }
    GeometryDescription g;
    g.body = static_cast<int>(scene_.bodies[index].last);
    g.placement = cast<double>(geom.shape_pose);
    g.shape = *geom.shape;
    g.role = geom.visual() ? GeometryDescription::Role::visual : GeometryDescription::Role::collision;
    g.where = c_.source.where(*item.element);
    model_.geometries.push_back(std::move(g));
    scene_.geoms.push_back({name, index, geom.contype, geom.conaffinity});
  }

  void site(const Item& item, std::size_t index) {
    const Values v = c_.defaults.of(*item.element, *item.scope.child_class);
    long double length = 0;
    const SE3<long double> pose = item.scope.frame * (v.has("fromto") ? poseBetween(v, length) : poseOf(v, c_.settings));
    const std::string name = nameOf(item);
    const std::size_t frame = model_.frames.size();
    std::unordered_map<std::string, std::size_t> unused;
    enter(item, "site", name, frame, unused);
    model_.addFrame(name, static_cast<int>(scene_.bodies[index].last), cast<double>(pose));
    if (!name.empty()) scene_.site.emplace(name, SiteRecord{frame, index, pose});
  }

  /// Scales all masses to the total that the settings ask for.
  void weigh() {
    if (!(c_.settings.total_mass > 0)) return;
    long double sum = 0;
    for (const BodyDescription& b : model_.bodies) sum += b.inertia.mass;
    if (!(sum > 0)) c_.source.fail(c_.source.root(), "settotalmass wants a mass of a model whose bodies have none");
    const long double factor = c_.settings.total_mass / sum;
    for (BodyDescription& b : model_.bodies) {
      const Inertia<long double> Y = cast<long double>(b.inertia);
      b.inertia = cast<double>(Inertia<long double>{factor * Y.mass, Y.com, factor * Y.rotational});
    }
  }

  /// Gives the root joint of the options to the only body of the world.
  void addRoot() {
    if (options_.root == LoadOptions().root) return;
    const std::string& file = c_.source.of(c_.source.root()).file();
    std::size_t root = 0;
    for (std::size_t i = 1; i < scene_.bodies.size(); ++i) {
      if (parents_[i - 1] != 0) continue;
      if (root != 0) reader::refuseRoot(options_.root, file, "has several bodies in the world");
      root = i;
    }
    if (root == 0) reader::refuseRoot(options_.root, file, "has no body");
    JointDescription& joint = model_.bodies[scene_.bodies[root].first].joint;
    if (joint.type != "fixed") reader::refuseRoot(options_.root, file);
    joint.type = options_.root;
    joint.name = "root_joint";
    while (scene_.joint.count(joint.name)) joint.name += '_';
  }

  const Context& c_;
  const LoadOptions& options_;
  const Guard& guard_;
  Scene scene_;
  Model& model_ = scene_.model;
  std::size_t visited_ = 0;
  std::vector<std::size_t> parents_;  ///< of scene_.bodies, the world left out
  std::unordered_map<std::string, Where> lines_;
};

}  // namespace

Scene readScene(const Context& context, const LoadOptions& options, const Guard& guard) { return SceneReader(context, options, guard).run(); }

}  // namespace dyn::mjcf
