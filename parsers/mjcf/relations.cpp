// SPDX-License-Identifier: BSD-2-Clause
// Elements that tie bodies, geoms and joints together: <contact> and <equality>.
#include "scene.hpp"

#include <dyn/lie/so3.hpp>
#include <dyn/near_names.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <set>

namespace dyn::mjcf {

namespace {

/// The most pairs of geoms that contype and conaffinity keep apart one by one.
constexpr std::size_t most_pairs = 100'000;

class Relations {
 public:
  Relations(const Context& context, Scene& scene, const Guard& guard) : c_(context), s_(scene), guard_(guard), main_(c_.defaults.find("", root())) {}

  void run() {
    forAll("contact", [&](const XMLElement& e) {
      if (is(e, "exclude")) exclude(Values(c_.source, e, nullptr));
      if (is(e, "pair")) pair(Values(c_.source, e, nullptr));
    });
    guard_([&] { masks(); });
    guard_([&] { parents(); });
    forAll("tendon", [&](const XMLElement& e) {
      const char* name = e.Attribute("name");
      if (name && !tendons_.emplace(name, &e).second) c_.source.fail(e, std::string("two tendons are called '") + name + "'");
    });
    forAll("equality", [&](const XMLElement& e) {
      if (is(e, "connect") || is(e, "weld")) tie(valuesOf(e));
      if (is(e, "joint")) couple(valuesOf(e));
      if (is(e, "tendon")) coupleTendons(valuesOf(e));
    });
    forAll("tendon", [&](const XMLElement& e) {
      if (is(e, "fixed") && !used_.count(&e)) c_.notes.count("ignored: <fixed> in <tendon>", c_.source.where(e));
    });
  }

 private:
  static bool is(const XMLElement& e, const char* name) { return std::strcmp(e.Name(), name) == 0; }
  const XMLElement& root() const { return c_.source.root(); }

  /// Calls f for each element in each top-level element of that name.
  template <class F>
  void forAll(const char* section, const F& f) {
    c_.source.forEach(root(), [&](const XMLElement& e) {
      if (is(e, section)) c_.source.forEach(e, [&](const XMLElement& inside) { guard_([&] { f(inside); }); });
    });
  }

  /// The values of a relation, completed by those that a class has for <equality>.
  Values valuesOf(const XMLElement& e) const {
    const DefaultClass& own = c_.defaults.classOf(e, main_);
    const auto values = own.kinds.find("equality");
    return {c_.source, e, values == own.kinds.end() ? nullptr : values->second.get()};
  }

  /// Returns the place of a name in an index.
  template <class Index>
  auto find(const Values& v, const char* attribute, const char* kind, const Index& index) {
    if (!v.has(attribute)) v.fail(v.described() + " has no attribute '" + attribute + "'", ErrorCode::syntax);
    const std::string name = v.text(attribute);
    const auto found = index.find(name);
    if (found != index.end()) return found->second;
    // Only the first errors have suggestions, because each costs a search of all names.
    std::vector<std::string> names;
    if (++unknown_ <= 10)
      for (const auto& [known, place] : index) names.push_back(known);
    std::sort(names.begin(), names.end());
    v.fail(v.described() + " names " + kind + " '" + name + "', which does not exist" + nearNames(name, names));
  }

  const std::string& nameOf(std::size_t body) const { return s_.model.bodies[s_.bodies[body].last].name; }

  void exclude(const Values& v) {
    const std::size_t one = find(v, "body1", "body", s_.body), other = find(v, "body2", "body", s_.body);
    s_.model.disabled_collisions.push_back({nameOf(one), nameOf(other), v.text("name", "exclude")});
  }

  void pair(const Values& v) {
    const std::size_t one = find(v, "geom1", "geom", s_.geom), other = find(v, "geom2", "geom", s_.geom);
    if (one == left_out || other == left_out) {
      c_.notes.count("ignored: a <pair> of a geom whose volume is left out", c_.source.where(v.element()));
      return;
    }
    for (const std::size_t g : {one, other}) s_.model.geometries[g].role = GeometryDescription::Role::collision;
    paired_.insert(std::minmax(one, other));
  }

  /// Disables the pairs of geoms that contype and conaffinity keep apart.
  void masks() {
    std::map<std::pair<int, int>, std::vector<std::size_t>> groups;
    for (std::size_t i = 0; i < s_.geoms.size(); ++i)
      if (s_.model.geometries[i].role == GeometryDescription::Role::collision) groups[{s_.geoms[i].contype, s_.geoms[i].conaffinity}].push_back(i);
    std::size_t pairs = 0;
    for (auto a = groups.begin(); a != groups.end(); ++a)
      for (auto b = a; b != groups.end(); ++b) {
        if ((a->first.first & b->first.second) || (b->first.first & a->first.second)) continue;
        pairs += a->second.size() * b->second.size();
        if (pairs > most_pairs) {
          c_.notes.count("ignored: contype and conaffinity, which keep more than " + std::to_string(most_pairs) + " pairs of geoms apart",
                         c_.source.where(root()));
          return;
        }
      }
    for (auto a = groups.begin(); a != groups.end(); ++a)
      for (auto b = a; b != groups.end(); ++b) {
        if ((a->first.first & b->first.second) || (b->first.first & a->first.second)) continue;
        for (const std::size_t i : a->second)
          for (const std::size_t j : b->second)
            if ((a != b || i < j) && s_.geoms[i].body != s_.geoms[j].body && !paired_.count(std::minmax(i, j)))
              s_.model.disabled_collisions.push_back({s_.model.geometries[i].name, s_.model.geometries[j].name, mask_reason});
      }
  }

  /// Disables the pairs of bodies with several joints and the bodies that carry them, as MuJoCo does unless these are fixed to the world. The joints
  /// make bodies between the two, so that they are no neighbours for compileGeometry(), which leaves out those of single joints by itself.
  void parents() {
    std::unordered_map<int, std::size_t> of_last;
    for (std::size_t i = 0; i < s_.bodies.size(); ++i) of_last.emplace(static_cast<int>(s_.bodies[i].last), i);
    std::vector<int> joints(s_.bodies.size());
    for (const JointRecord& joint : s_.joints) ++joints[joint.record];
    std::vector<bool> solid(s_.bodies.size());
    for (std::size_t g = 0; g < s_.geoms.size(); ++g)
      if (s_.model.geometries[g].role == GeometryDescription::Role::collision) solid[s_.geoms[g].body] = true;
    std::set<std::pair<std::string, std::string>> known;
    for (const DisabledCollision& d : s_.model.disabled_collisions) known.insert(std::minmax(d.body, d.other));
    // Bodies without joints are fixed to their parents, which come first.
    std::vector<std::size_t> parent(s_.bodies.size()), fixed_to(s_.bodies.size());
    std::vector<std::vector<std::size_t>> rigid(s_.bodies.size());
    for (std::size_t i = 1; i < s_.bodies.size(); ++i) {
      parent[i] = of_last.at(s_.model.bodies[s_.bodies[i].first].parent);
      fixed_to[i] = joints[i] > 0 ? i : fixed_to[parent[i]];
      if (solid[i]) rigid[fixed_to[i]].push_back(i);
    }
    for (const auto& [g, h] : paired_) {
      const std::size_t a = s_.geoms[g].body, b = s_.geoms[h].body;
      const auto carries = [&](std::size_t x, std::size_t y) {
        const std::size_t above = parent[fixed_to[y]];
        return fixed_to[y] != 0 && (fixed_to[x] == 0 ? x == above && x != 0 : fixed_to[x] == fixed_to[above]);
      };
      if (fixed_to[a] == fixed_to[b] || carries(a, b) || carries(b, a) || known.count(std::minmax(nameOf(a), nameOf(b))))
        c_.notes.count("ignored: a <pair> of geoms whose bodies are excluded, or neighbours", s_.model.geometries[g].where);
    }
    std::size_t pairs = 0;
    for (std::size_t i = 1; i < s_.bodies.size(); ++i) {
      const std::size_t carrier = fixed_to[parent[i]];
      if (joints[i] < 2 || carrier == 0) continue;
      pairs += rigid[i].size() * rigid[carrier].size();
      if (pairs > most_pairs) {
        c_.notes.count("ignored: pairs of bodies and those that carry them, more than " + std::to_string(most_pairs), c_.source.where(root()));
        return;
      }
      for (const std::size_t a : rigid[carrier])
        for (const std::size_t b : rigid[i])
          if (known.insert(std::minmax(nameOf(a), nameOf(b))).second) s_.model.disabled_collisions.push_back({nameOf(a), nameOf(b), parent_reason});
    }
  }

  /// The feedback of a soft constraint: MuJoCo's reference acceleration, as if its impedance were 1.
  Baumgarte feedback(const Values& v) const {
    if (v.word("active", {"false", "true"}, 1) == 0) return {};
    std::vector<double> solref{0.02, 1};
    if (v.has("solref")) {
      const std::vector<double> given = v.numbers("solref", 1, 2);
      std::copy(given.begin(), given.end(), solref.begin());
    }
    // Negative numbers are stiffness and damping themselves.
    if (solref[0] <= 0) return {-solref[0], std::max(0.0, -solref[1])};
    const double position = 1 / (solref[0] * solref[0] * solref[1] * solref[1]);
    if (!(solref[1] > 0) || !std::isfinite(position)) v.fail(v.described() + ": its solref has a time constant or a damping ratio that is zero");
    return {position, 2 / solref[0]};
  }

  void add(const Values& v, ConstraintDescription constraint) {
    if (v.word("active", {"false", "true"}, 1) == 0) {
      c_.notes.count("left out: a constraint that is not active", c_.source.where(v.element()));
      return;
    }
    constraint.name = v.text("name");
    if (constraint.name.empty()) constraint.name = std::string(v.element().Name()) + "_" + std::to_string(s_.model.constraints.size() + 1);
    const std::string given = constraint.name;
    while (!names_.insert(constraint.name).second) constraint.name += '_';
    if (v.has("name") && given != constraint.name) v.fail("two constraints are called '" + given + "'");
    constraint.baumgarte = feedback(v);
    constraint.where = c_.source.where(v.element());
    s_.model.constraints.push_back(std::move(constraint));
  }

  /// <connect> and <weld>: two frames of bodies have one origin, or one pose.
  void tie(const Values& v) {
    const bool weld = is(v.element(), "weld");
    const std::array<bool, 6> free{false, false, false, !weld, !weld, !weld};
    if (v.has("site1") || v.has("site2")) {
      if (v.has("body1") || v.has("body2") || v.has("anchor"))
        v.fail(v.described() + " names sites and also bodies or an anchor; give one of them", ErrorCode::syntax);
      const SiteRecord one = find(v, "site1", "site", s_.site), other = find(v, "site2", "site", s_.site);
      if (one.body == other.body) v.fail(v.described() + " ties a body to itself");
      add(v, closeLoop("", s_.model.frames[one.frame].name, s_.model.frames[other.frame].name, free));
      return;
    }
    const std::size_t one = find(v, "body1", "body", s_.body), other = v.has("body2") ? find(v, "body2", "body", s_.body) : 0;
    if (one == other) v.fail(v.described() + " ties a body to itself");
    const SE3<long double> between = s_.bodies[one].home.inverse() * s_.bodies[other].home;  // pose of `other` in `one`
    SE3<long double> in_one, in_other;
    if (weld) {
      // The bodies keep their pose at the file's configuration, unless relpose has a rotation.
      std::vector<double> relpose{0, 1, 0, 0, 0, 0, 0};
      if (v.has("relpose")) relpose = v.numbers("relpose", 7, 7);
      in_one = between;
      if (relpose[3] != 0 || relpose[4] != 0 || relpose[5] != 0 || relpose[6] != 0)
        in_one = {Quaternion<long double>{relpose[4], relpose[5], relpose[6], relpose[3]}.matrix(), {relpose[0], relpose[1], relpose[2]}};
      // The anchor is a point of `other`. A rigid weld is the same wherever it is; it is the origin of the constraint's forces.
      in_other.p = v.vector3("anchor");
      in_one = in_one * in_other;
    } else {
      if (!v.has("anchor")) v.fail(v.described() + " has no attribute 'anchor'", ErrorCode::syntax);
      in_one.p = v.vector3("anchor");
      in_other = between.inverse() * in_one;
      in_other.R = Mat3<long double>::identity();
    }
    ConstraintDescription constraint = closeLoop("", nameOf(one), nameOf(other), free);
    auto& relation = std::get<FrameConstraint>(constraint.relation);
    relation.placement = cast<double>(in_one);
    relation.other_placement = cast<double>(in_other);
    add(v, std::move(constraint));
  }

  const JointRecord& scalar(const Values& v, const char* attribute) {
    const JointRecord& joint = s_.joints[find(v, attribute, "joint", s_.joint)];
    if (joint.nq != 1) v.fail(v.described() + ": joint '" + v.text(attribute) + "' is neither a hinge nor a slide");
    return joint;
  }

  /// The numbers a0 to a4 of a polynomial.
  static std::vector<double> polynomialOf(const Values& v) {
    std::vector<double> a{0, 1, 0, 0, 0};
    if (v.has("polycoef")) {
      const std::vector<double> given = v.numbers("polycoef", 1, 5);
      std::copy(given.begin(), given.end(), a.begin());
    }
    return a;
  }

  /// A multiple of a joint's way from the place where the file puts it: scale (q - ref).
  struct Way {
    std::string joint;
    const JointRecord* record;
    double scale = 1;
  };

  Way wayOf(const Values& v, const char* attribute, double scale = 1) {
    const JointRecord& joint = s_.joints[find(v, attribute, "joint", s_.joint)];
    if (joint.nq != 1) v.fail(v.described() + ": joint '" + v.text(attribute) + "' is neither a hinge nor a slide");
    return {v.text(attribute), &joint, scale};
  }

  /// <joint>: the way of one joint is a polynomial of that of the other, or constant.
  void couple(const Values& v) {
    const Way y = wayOf(v, "joint1");
    if (v.has("joint2")) {
      relate(v, y, wayOf(v, "joint2"), polynomialOf(v));
    } else {
      hold(v, y, polynomialOf(v)[0]);
    }
  }

  /// <tendon> of fixed tendons: their lengths are sums of ways of joints. One or two joints make a coupling.
  void coupleTendons(const Values& v) {
    const std::vector<Way> first = tendonOf(v, "tendon1"), second = v.has("tendon2") ? tendonOf(v, "tendon2") : std::vector<Way>{};
    const std::vector<double> a = polynomialOf(v);
    if (first.size() == 1 && second.size() == 1) {
      relate(v, first[0], second[0], a);
    } else if (first.size() == 2 && second.empty()) {
      relate(v, first[0], first[1], {a[0], -1, 0, 0, 0});
    } else if (first.size() == 1 && second.empty()) {
      hold(v, first[0], a[0]);
    } else {
      c_.notes.count("ignored: an equality of tendons of more than two joints, or of spatial tendons", c_.source.where(v.element()));
    }
  }

  /// Returns the joints of a fixed tendon; none for another tendon.
  std::vector<Way> tendonOf(const Values& v, const char* attribute) {
    const XMLElement& tendon = *find(v, attribute, "tendon", tendons_);
    std::vector<Way> out;
    if (!is(tendon, "fixed")) return out;
    used_.insert(&tendon);
    c_.source.forEach(tendon, [&](const XMLElement& e) {
      if (!is(e, "joint")) return;
      const Values joint(c_.source, e, nullptr);
      out.push_back(wayOf(joint, "joint", joint.number("coef", 1)));
      if (out.back().scale == 0) joint.fail("a joint of a tendon has coef=\"0\"");
    });
    return out;
  }

  /// Holds a joint where scale (y - y0) = constant.
  void hold(const Values& v, const Way& y, double constant) { add(v, lockJoint(y.joint, {y.record->ref + constant / y.scale})); }

  /// Couples two joints: scale_y (y - y0) = a0 + a1 s + ... + a4 s^4, where s = scale_x (x - x0).
  void relate(const Values& v, const Way& y, const Way& x, const std::vector<double>& a) {
    if (x.record == y.record) v.fail(v.described() + " couples a joint to itself");
    // Horner's rule for polynomials: c <- c scale_x (x - x0) + a_k.
    std::vector<long double> c{a[4]};
    for (std::size_t k = 4; k-- > 0;) {
      std::vector<long double> next(c.size() + 1, 0);
      for (std::size_t i = 0; i < c.size(); ++i) {
        const long double scaled = static_cast<long double>(x.scale) * c[i];
        next[i + 1] += scaled;
        next[i] -= static_cast<long double>(x.record->ref) * scaled;
      }
      next[0] += a[k];
      c = std::move(next);
    }
    std::vector<double> coefficients;
    for (const long double k : c) coefficients.push_back(static_cast<double>(k / static_cast<long double>(y.scale)));
    coefficients[0] = static_cast<double>(c[0] / static_cast<long double>(y.scale) + static_cast<long double>(y.record->ref));
    while (coefficients.size() > 2 && coefficients.back() == 0) coefficients.pop_back();
    Coupling coupling;
    coupling.type = "mimic";
    coupling.master = x.joint;
    coupling.parameters["coefficients"] = coefficients;
    add(v, coupleJoint(y.joint, coupling));
  }

  const Context& c_;
  Scene& s_;
  const Guard& guard_;
  const DefaultClass& main_;
  std::set<std::pair<std::size_t, std::size_t>> paired_;
  std::set<std::string> names_;
  std::unordered_map<std::string, const XMLElement*> tendons_;
  std::set<const XMLElement*> used_;  ///< tendons of equalities
  int unknown_ = 0;
};

}  // namespace

void readRelations(const Context& context, Scene& scene, const Guard& guard) { Relations(context, scene, guard).run(); }

}  // namespace dyn::mjcf
