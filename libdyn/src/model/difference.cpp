// SPDX-License-Identifier: BSD-2-Clause
#include "at.hpp"
#include "model/universe.hpp"
#include "number_text.hpp"

#include <dyn/lie/so3.hpp>
#include <dyn/model/difference.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace dyn {

namespace {

using Numbers = std::vector<double>;

std::string written(const Numbers& values) {
  std::string out;
  for (const double x : values) out += (out.empty() ? "" : " ") + number(x);
  return out.empty() ? "-" : out;
}
std::string written(const Vec3<double>& x) { return written(Numbers{x.x, x.y, x.z}); }
std::string written(const std::vector<std::string>& names) {
  std::string out;
  for (const std::string& name : names) out += (out.empty() ? "" : " ") + name;
  return out.empty() ? "-" : out;
}
std::string orNothing(const std::string& text) { return text.empty() ? "-" : text; }

/// The largest distance of entries, as a fraction of the largest entry; infinite for another number of entries or for an infinity on one side.
double fraction(const Numbers& a, const Numbers& b) {
  constexpr double apart = std::numeric_limits<double>::infinity();
  if (a.size() != b.size()) return apart;
  double distance = 0, largest = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    if (a[k] == b[k] || (std::isnan(a[k]) && std::isnan(b[k]))) {
      if (std::isfinite(a[k])) largest = std::max(largest, std::fabs(a[k]));
      continue;
    }
    if (!std::isfinite(a[k]) || !std::isfinite(b[k])) return apart;
    distance = std::max(distance, std::fabs(a[k] - b[k]));
    largest = std::max({largest, std::fabs(a[k]), std::fabs(b[k])});
  }
  return distance == 0 ? 0 : distance / largest;
}

double length(const Vec3<double>& x) { return std::sqrt(dot(x, x)); }

class Comparison {
 public:
  Comparison(const Model& a, const Model& b, double tolerance) : a_(a), b_(b), tolerance_(tolerance) {
    requireUniverse(a);
    requireUniverse(b);
  }

  std::vector<Difference> run() {
    texts("model", a_.name, "name", a_.name, b_.name);
    distance("model", a_.name, "gravity [m/s^2]", a_.gravity, b_.gravity, "m/s^2");
    byName("structure", "body", a_.bodies, b_.bodies, [&](const BodyDescription& x, const BodyDescription& y) { compareBodies(x, y); });
    byName("frame", "frame", a_.frames, b_.frames, [&](const FrameDescription& x, const FrameDescription& y) {
      texts("frame", x.name, "body", bodyOf(a_, x.body), bodyOf(b_, y.body));
      poses("frame", x.name, x.placement, y.placement);
    });
    byName("volume", "volume", a_.geometries, b_.geometries, [&](const GeometryDescription& x, const GeometryDescription& y) {
      texts("volume", x.name, "body", bodyOf(a_, x.body), bodyOf(b_, y.body));
      texts("volume", x.name, "role", roleOf(x), roleOf(y));
      poses("volume", x.name, x.placement, y.placement);
      compareShapes(x, y);
    });
    byName("constraint", "constraint", a_.constraints, b_.constraints,
           [&](const ConstraintDescription& x, const ConstraintDescription& y) { compareConstraints(x, y); });
    compareGroups();
    return std::move(out_);
  }

 private:
  void add(const std::string& topic, const std::string& name, const std::string& what, const std::string& a, const std::string& b,
           double size = std::numeric_limits<double>::infinity(), const std::string& unit = {}) {
    out_.push_back({topic, name, what, a, b, size, unit});
  }
  void texts(const std::string& topic, const std::string& name, const std::string& what, const std::string& a, const std::string& b) {
    if (a != b) add(topic, name, what, orNothing(a), orNothing(b));
  }
  void distance(const std::string& topic, const std::string& name, const std::string& what, const Vec3<double>& a, const Vec3<double>& b,
                const char* unit) {
    if (const double d = length(a - b); !(d <= tolerance_)) add(topic, name, what, written(a), written(b), d, unit);
  }
  void fractions(const std::string& topic, const std::string& name, const std::string& what, const Numbers& a, const Numbers& b) {
    if (const double d = fraction(a, b); !(d <= tolerance_)) add(topic, name, what, written(a), written(b), d, std::isfinite(d) ? "1" : "");
  }
  /// Values that mean the same if they are missing or all `nothing`.
  void optional(const std::string& topic, const std::string& name, const std::string& what, const Numbers& a, const Numbers& b, double nothing) {
    const auto given = [&](const Numbers& x) {
      return std::all_of(x.begin(), x.end(), [&](double value) { return value == nothing; }) ? Numbers() : x;
    };
    fractions(topic, name, what, given(a), given(b));
  }
  void poses(const std::string& topic, const std::string& name, const SE3<double>& a, const SE3<double>& b) {
    distance(topic, name, "position [m]", a.p, b.p, "m");
    if (std::equal(std::begin(a.R.m), std::end(a.R.m), std::begin(b.R.m))) return;
    const Vec3<double> turn = log3(transpose(a.R) * b.R);
    if (const double angle = length(turn); !(angle <= tolerance_))
      add(topic, name, "rotation vector [rad]", written(log3(a.R)), written(log3(b.R)), angle, "rad");
  }

  /// Compares records of one name. The order in which the first model has them is kept.
  template <class Record, class Compare>
  void byName(const std::string& topic, const std::string& what, const std::vector<Record>& a, const std::vector<Record>& b, const Compare& compare) {
    std::map<std::string, std::vector<const Record*>> of_b;
    for (const Record& record : b) of_b[record.name].push_back(&record);
    std::map<std::string, std::size_t> used;
    for (const Record& record : a) {
      const auto found = of_b.find(record.name);
      std::size_t& k = used[record.name];
      if (found == of_b.end() || k >= found->second.size()) {
        add(topic, record.name, what, "present", "-");
      } else {
        compare(record, *found->second[k++]);
      }
    }
    for (const Record& record : b)
      if (std::size_t& k = used[record.name]; k < of_b[record.name].size() && &record == of_b[record.name][k]) {
        add(topic, record.name, what, "-", "present");
        ++k;
      }
  }

  static const std::string& bodyOf(const Model& model, int body) {
    if (body < 0 || at(body) >= model.bodies.size())
      throw Error(ErrorCode::model, "the model '" + model.name + "' refers to body " + std::to_string(body) + ", which it does not have");
    return model.bodies[at(body)].name;
  }
  static std::string roleOf(const GeometryDescription& g) { return g.role == GeometryDescription::Role::visual ? "visual" : "collision"; }

  void compareBodies(const BodyDescription& x, const BodyDescription& y) {
    if (&x == &a_.bodies[0]) return;
    texts("structure", x.name, "parent", bodyOf(a_, x.parent), bodyOf(b_, y.parent));
    texts("structure", x.name, "joint's name", x.joint.name, y.joint.name);
    compareJoints(x.joint, y.joint, x.joint.name);
    const Inertia<double>&I = x.inertia, &J = y.inertia;
    fractions("inertia", x.name, "mass [kg]", {I.mass}, {J.mass});
    distance("inertia", x.name, "centre of mass [m]", I.com, J.com, "m");
    const auto moments = [](const Inertia<double>& Y) {
      const Sym3<double>& R = Y.rotational;
      return Numbers{R.xx, R.xy, R.xz, R.yy, R.yz, R.zz};
    };
    fractions("inertia", x.name, "xx xy xz yy yz zz [kg m^2]", moments(I), moments(J));
  }

  void compareJoints(const JointDescription& x, const JointDescription& y, const std::string& name) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    texts("joint", name, "type", x.type, y.type);
    compareParameters("joint", name, x.parameters, y.parameters);
    poses("placement", name, x.placement, y.placement);
    optional("limits", name, "lower", x.limits.lower, y.limits.lower, -infinity);
    optional("limits", name, "upper", x.limits.upper, y.limits.upper, infinity);
    for (const auto& [what, field] : {std::pair{"velocity", &JointLimits::velocity},
                                      {"effort", &JointLimits::effort},
                                      {"acceleration", &JointLimits::acceleration},
                                      {"deceleration", &JointLimits::deceleration},
                                      {"jerk", &JointLimits::jerk}})
      optional("limits", name, what, x.limits.*field, y.limits.*field, infinity);
    optional("dissipation", name, "damping", x.damping, y.damping, 0);
    optional("dissipation", name, "friction", x.friction, y.friction, 0);
    optional("inertia", name, "armature", x.armature, y.armature, 0);
    compareCouplings("coupling", name, x.coupling, y.coupling);
    if (x.held != y.held) add("joint", name, "held", x.held ? "yes" : "no", y.held ? "yes" : "no");
  }

  void compareCouplings(const std::string& topic, const std::string& name, const Coupling& x, const Coupling& y) {
    texts(topic, name, "coupling's type", x.type, y.type);
    texts(topic, name, "master", x.master, y.master);
    if (!x.type.empty() || !y.type.empty()) compareParameters(topic, name, x.parameters, y.parameters);
  }

  void compareParameters(const std::string& topic, const std::string& name, const Parameters& x, const Parameters& y) {
    std::set<std::string> keys;
    for (const auto& [key, value] : x) keys.insert(key);
    for (const auto& [key, value] : y) keys.insert(key);
    for (const std::string& key : keys) {
      const auto p = x.find(key), q = y.find(key);
      if (p == x.end() || q == y.end()) {
        add(topic, name, key, p == x.end() ? "-" : written(p->second), q == y.end() ? "-" : written(q->second));
      } else if (p->second.index() != q->second.index()) {
        add(topic, name, key, written(p->second), written(q->second));
      } else if (const auto* numbers = std::get_if<Numbers>(&p->second)) {
        fractions(topic, name, key, *numbers, std::get<Numbers>(q->second));
      } else if (const auto* text = std::get_if<std::string>(&p->second)) {
        texts(topic, name, key, *text, std::get<std::string>(q->second));
      } else {
        const auto &s = std::get<std::vector<JointDescription>>(p->second), &t = std::get<std::vector<JointDescription>>(q->second);
        if (s.size() != t.size()) add(topic, name, key, std::to_string(s.size()) + " joints", std::to_string(t.size()) + " joints");
        for (std::size_t k = 0; k < std::min(s.size(), t.size()); ++k) {
          const std::string part = name + "/" + (s[k].name.empty() ? std::to_string(k) : s[k].name);
          texts("joint", part, "name", s[k].name, t[k].name);
          compareJoints(s[k], t[k], part);
        }
      }
    }
  }
  static std::string written(const ParameterValue& value) {
    if (const auto* numbers = std::get_if<Numbers>(&value)) return dyn::written(*numbers);
    if (const auto* text = std::get_if<std::string>(&value)) return "'" + *text + "'";
    return std::to_string(std::get<std::vector<JointDescription>>(value).size()) + " joints";
  }
  template <class T>
  static std::string written(const T& value) {
    return dyn::written(value);
  }

  /// The shape's name, its texts and its numbers.
  struct Shape {
    std::string kind, text{};
    Numbers numbers{};
  };
  static Shape shapeOf(const GeometryShape& shape);
  void compareShapes(const GeometryDescription& x, const GeometryDescription& y) {
    const Shape s = shapeOf(x.shape), t = shapeOf(y.shape);
    texts("volume", x.name, "shape", s.kind, t.kind);
    if (s.kind != t.kind) return;
    texts("volume", x.name, "file", s.text, t.text);
    if (const double d = fraction(s.numbers, t.numbers); !(d <= tolerance_)) {
      const auto few = [](const Numbers& numbers) {
        return numbers.size() <= 6 ? dyn::written(numbers) : std::to_string(numbers.size()) + " numbers";
      };
      add("volume", x.name, "sizes of the " + s.kind, few(s.numbers), few(t.numbers), d, std::isfinite(d) ? "1" : "");
    }
  }

  void compareConstraints(const ConstraintDescription& x, const ConstraintDescription& y) {
    static constexpr const char* kinds[] = {"frames", "coupling", "lock"};
    static constexpr const char* axes[] = {"LOCAL", "OTHER", "LOCAL_WORLD_ALIGNED"};
    const std::string topic = "constraint";
    texts(topic, x.name, "kind", kinds[x.relation.index()], kinds[y.relation.index()]);
    fractions(topic, x.name, "gains", {x.baumgarte.position, x.baumgarte.velocity}, {y.baumgarte.position, y.baumgarte.velocity});
    if (x.relation.index() != y.relation.index()) return;
    if (const auto* f = std::get_if<FrameConstraint>(&x.relation)) {
      const auto& g = std::get<FrameConstraint>(y.relation);
      texts(topic, x.name, "frame", f->frame, g.frame);
      texts(topic, x.name, "other", f->other, g.other);
      poses(topic, x.name, f->placement, g.placement);
      poses(topic, x.name, f->other_placement, g.other_placement);
      const auto free = [](const FrameConstraint& c) {
        std::string out;
        for (const bool direction : c.free) out += direction ? '1' : '0';
        return out;
      };
      texts(topic, x.name, "free directions", free(*f), free(g));
      texts(topic, x.name, "axes", axes[static_cast<int>(f->axes)], axes[static_cast<int>(g.axes)]);
      texts(topic, x.name, "target", f->has_target ? "yes" : "no", g.has_target ? "yes" : "no");
    } else if (const auto* c = std::get_if<JointCoupling>(&x.relation)) {
      const auto& d = std::get<JointCoupling>(y.relation);
      texts(topic, x.name, "joint", c->joint, d.joint);
      compareCouplings(topic, x.name, c->coupling, d.coupling);
    } else {
      const auto &l = std::get<JointLock>(x.relation), &m = std::get<JointLock>(y.relation);
      texts(topic, x.name, "joint", l.joint, m.joint);
      fractions(topic, x.name, "configuration", l.configuration, m.configuration);
    }
  }

  void compareGroups();

  const Model &a_, &b_;
  double tolerance_;
  std::vector<Difference> out_;
};

Comparison::Shape Comparison::shapeOf(const GeometryShape& shape) {
  struct Visit {
    static void append(Numbers& out, const Vec3<double>& x) { out.insert(out.end(), {x.x, x.y, x.z}); }
    Shape operator()(const geometry::Sphere& s) const { return {"sphere", {}, {s.radius}}; }
    Shape operator()(const geometry::Box& s) const { return {"box", {}, {s.size.x, s.size.y, s.size.z}}; }
    Shape operator()(const geometry::Capsule& s) const { return {"capsule", {}, {s.radius, s.length}}; }
    Shape operator()(const geometry::Cylinder& s) const { return {"cylinder", {}, {s.radius, s.length}}; }
    Shape operator()(const geometry::Cone& s) const { return {"cone", {}, {s.radius, s.length}}; }
    Shape operator()(const geometry::HalfSpace& s) const { return {"half-space", {}, {s.normal.x, s.normal.y, s.normal.z, s.offset}}; }
    Shape operator()(const geometry::ConvexHull& s) const {
      Shape out{"convex hull"};
      for (const Vec3<double>& p : s.points) append(out.numbers, p);
      return out;
    }
    Shape operator()(const geometry::TriangleMesh& s) const {
      Shape out{"mesh"};
      for (const Vec3<double>& p : s.vertices) append(out.numbers, p);
      for (const auto& triangle : s.triangles) out.numbers.insert(out.numbers.end(), triangle.begin(), triangle.end());
      return out;
    }
    Shape operator()(const geometry::MeshFile& s) const {
      return {s.convex ? "hull of a mesh" : "mesh file", s.uri, {s.scale.x, s.scale.y, s.scale.z}};
    }
    Shape operator()(const geometry::Voxels& s) const {
      Shape out{"voxels"};
      for (const auto& cube : s.cubes) {
        append(out.numbers, cube.center);
        out.numbers.push_back(cube.size);
      }
      return out;
    }
    Shape operator()(const geometry::OctreeFile& s) const { return {"octree file", s.uri, {}}; }
  };
  return std::visit(Visit{}, shape);
}

void Comparison::compareGroups() {
  const auto pairs = [](const Model& model) {
    std::set<std::string> out;
    for (const DisabledCollision& d : model.disabled_collisions) out.insert(std::min(d.body, d.other) + " and " + std::max(d.body, d.other));
    return out;
  };
  const auto devices = [](const Model& model) {
    std::set<std::string> out;
    for (const DeviceDescription& d : model.devices) out.insert(d.type + (d.name.empty() ? ": " + d.text : " '" + d.name + "'"));
    return out;
  };
  const auto sets = [&](const std::string& topic, const std::string& what, const std::set<std::string>& x, const std::set<std::string>& y) {
    for (const std::string& name : x)
      if (!y.count(name)) add(topic, name, what, "present", "-");
    for (const std::string& name : y)
      if (!x.count(name)) add(topic, name, what, "-", "present");
  };
  sets("collision", "disabled pair", pairs(a_), pairs(b_));
  sets("group", "passive joint", {a_.passive_joints.begin(), a_.passive_joints.end()}, {b_.passive_joints.begin(), b_.passive_joints.end()});
  sets("structure", "device", devices(a_), devices(b_));
  byName("group", "group", a_.groups, b_.groups, [&](const GroupDescription& x, const GroupDescription& y) {
    const auto chains = [](const GroupDescription& group) {
      std::vector<std::string> out;
      for (const Chain& chain : group.chains) out.push_back(chain.base + ".." + chain.tip);
      return out;
    };
    texts("group", x.name, "bodies", written(x.bodies), written(y.bodies));
    texts("group", x.name, "joints", written(x.joints), written(y.joints));
    texts("group", x.name, "chains", written(chains(x)), written(chains(y)));
    texts("group", x.name, "groups", written(x.groups), written(y.groups));
  });
  byName("group", "end effector", a_.end_effectors, b_.end_effectors, [&](const EndEffectorDescription& x, const EndEffectorDescription& y) {
    texts("group", x.name, "end effector's group", x.group, y.group);
    texts("group", x.name, "end effector's body", x.body, y.body);
    texts("group", x.name, "end effector's parent group", x.parent_group, y.parent_group);
  });
  byName("group", "virtual joint", a_.virtual_joints, b_.virtual_joints, [&](const VirtualJointDescription& x, const VirtualJointDescription& y) {
    texts("group", x.name, "virtual joint's type", x.type, y.type);
    texts("group", x.name, "virtual joint's frame", x.frame, y.frame);
    texts("group", x.name, "virtual joint's body", x.body, y.body);
  });
  byName("state", "state", a_.configurations, b_.configurations, [&](const ConfigurationDescription& x, const ConfigurationDescription& y) {
    texts("state", x.name, "group", x.group, y.group);
    std::map<std::string, std::pair<const JointState*, const JointState*>> joints;
    for (const JointState& joint : x.joints) joints[joint.joint].first = &joint;
    for (const JointState& joint : y.joints) joints[joint.joint].second = &joint;
    for (const auto& [name, both] : joints) {
      static const JointState none;
      const JointState &s = both.first ? *both.first : none, &t = both.second ? *both.second : none;
      fractions("state", x.name, "q of " + name, s.q, t.q);
      fractions("state", x.name, "v of " + name, s.v, t.v);
    }
  });
}

}  // namespace

std::vector<Difference> differences(const Model& a, const Model& b, double tolerance) { return Comparison(a, b, tolerance).run(); }

}  // namespace dyn
