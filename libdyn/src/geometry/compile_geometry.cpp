// SPDX-License-Identifier: BSD-2-Clause
// Compiles described geometries: chooses the pairs that are checked, and loads only the volumes that these pairs need.
#include "at.hpp"
#include "geometry/load.hpp"
#include "geometry/queries.hpp"

#include <algorithm>
#include <set>
#include <unordered_set>

namespace dyn {

namespace {

constexpr std::size_t most_pairs = std::size_t{1} << 24;
/// From these numbers of static boxes and of pairs that both move, a search in FCL's tree is faster (measured: benchmarks/README.md).
constexpr int still_for_tree = 512;
constexpr std::size_t moving_pairs_for_tree = 32768;

/// A collision geometry that is kept if a pair needs it.
struct Candidate {
  const GeometryDescription* description;
  int joint;
  SE3<double> placement;  ///< in the joint's frame
};

class Compiler {
 public:
  Compiler(const CompactModel& model, const Model& description, const GeometryOptions& options)
      : model_(model), description_(description), options_(options), loader_(options.packages) {}

  std::shared_ptr<const GeometryImpl> run() {
    collect();
    groupBodies();
    choosePairs();
    applyNames();
    leaveOutMissing();
    keepNeeded();
    chooseNarrow();
    chooseTrees();
    say();
    return std::move(out_);
  }

 private:
  void collect() {
    out_->report.described = static_cast<int>(description_.geometries.size());
    out_->model = std::make_shared<const CompactModel>(model_);
    out_->nv = model_.nv();
    std::unordered_set<std::string> names;
    for (const GeometryDescription& g : description_.geometries) {
      if (g.role != GeometryDescription::Role::collision) continue;
      if (!names.insert(g.name).second) throw Error(ErrorCode::model, "two geometries are called '" + g.name + "'", g.where);
      if (g.body < 0 || g.body >= static_cast<int>(description_.bodies.size()))
        throw Error(ErrorCode::model, "geometry '" + g.name + "' is on body " + std::to_string(g.body) + ", which does not exist", g.where);
      Candidate c{&g, 0, g.placement};
      if (g.body > 0) {
        const std::string& body = bodyOf(g);
        const int frame = model_.findFrame(body);
        if (frame < 0)
          throw Error(ErrorCode::model,
                      "geometry '" + g.name + "': the compiled model has no body '" + body + "'; it was made from another description", g.where);
        const FrameRecord& f = model_.frames()[at(frame)];
        c.joint = f.joint;
        c.placement = f.placement * g.placement;
      }
      candidates_.push_back(c);
    }
  }

  const std::string& bodyOf(const GeometryDescription& g) const { return description_.bodies[at(g.body)].name; }

  void choosePairs() {
    if (options_.pairs == GeometryOptions::Pairs::none) return;
    std::set<std::pair<int, int>> disabled;
    for (const DisabledCollision& d : description_.disabled_collisions) {
      const std::vector<int> first = disabledBy(d.body), second = disabledBy(d.other);
      for (const int a : first)
        for (const int b : second) disabled.insert(std::minmax(a, b));
    }
    GeometryReport& report = out_->report;
    const int n = static_cast<int>(candidates_.size());
    for (int a = 0; a < n; ++a) {
      for (int b = a + 1; b < n; ++b) {
        const Candidate &ca = candidates_[at(a)], &cb = candidates_[at(b)];
        const int body_a = ca.description->body, body_b = cb.description->body;
        if (group_[at(body_a)] == group_[at(body_b)]) {
          ++report.rigid;
        } else if (neighbours(body_a, body_b) || neighbours(body_b, body_a)) {
          ++report.adjacent;
        } else if (disabled.count({a, b})) {
          ++report.disabled;
        } else {
          addPair({a, b});
        }
      }
    }
  }

  void addPair(std::pair<int, int> x) {
    if (pairs_.size() == most_pairs)
      throw Error(ErrorCode::model, std::to_string(candidates_.size()) + " collision geometries make more than " + std::to_string(most_pairs) +
                                        " pairs; merge obstacles into voxels or meshes, or name the pairs to be checked");
    pairs_.push_back(x);
  }

  /// True if a joint connects the rigid body of `carrier` with the rigid body of `carried`. Among the bodies that are fixed to the world only the
  /// body that carries the joint is a neighbour: a table fixed to the world is not part of a robot's base fixed there too. The world itself (body
  /// 0) is no neighbour.
  bool neighbours(int carrier, int carried) const {
    const int joint_of = group_[at(carried)];
    if (joint_of == 0) return false;
    const int parent = description_.bodies[at(joint_of)].parent;
    return group_[at(carrier)] == 0 ? carrier == parent && carrier != 0 : group_[at(carrier)] == group_[at(parent)];
  }

  /// Sets group_ of each described body to the first body that it is welded to by joints without freedom; 0 is the world. Held joints count as
  /// joints with freedom, so the checked pairs do not depend on which joints are held.
  void groupBodies() {
    const std::vector<BodyDescription>& bodies = description_.bodies;
    group_.assign(bodies.size(), 0);
    const std::unordered_set<std::string> held(model_.report().held.begin(), model_.report().held.end());
    const auto jointOf = [&](std::size_t body) {
      const int frame = model_.findFrame(bodies[body].name);
      return frame < 0 ? -1 : model_.frames()[at(frame)].joint;
    };
    for (std::size_t i = 1; i < bodies.size(); ++i) {
      const auto p = at(bodies[i].parent);
      const bool welded = jointOf(i) == (p == 0 ? 0 : jointOf(p)) && !held.count(bodies[i].name);
      group_[i] = welded ? group_[p] : static_cast<int>(i);
    }
  }
  /// True if the geometry moves in the description. Held joints may keep it still in the compiled model.
  bool moves(const Candidate& c) const { return group_[at(c.description->body)] != 0; }

  /// Candidates on the body of this name. If there is no such body: the candidates with this name.
  std::vector<int> disabledBy(const std::string& name) const {
    const int body = description_.findBody(name);
    std::vector<int> found;
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
      const GeometryDescription& g = *candidates_[i].description;
      if (body >= 0 ? g.body == body : g.name == name) found.push_back(static_cast<int>(i));
    }
    return found;
  }

  std::vector<int> named(const std::string& name) const {
    std::vector<int> found;
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
      const GeometryDescription& g = *candidates_[i].description;
      if (g.name == name || bodyOf(g) == name) found.push_back(static_cast<int>(i));
    }
    if (found.empty() && description_.findBody(name) < 0)
      throw Error(ErrorCode::argument, "there is no collision geometry and no body '" + name + "' to make a pair of");
    return found;
  }

  void applyNames() {
    const auto each = [&](const PairName& p, const auto& apply) {
      const std::vector<int> first = named(p.a), second = named(p.b);
      for (const int a : first)
        for (const int b : second)
          if (a != b) apply(std::minmax(a, b));
    };
    for (const PairName& p : options_.add) each(p, [&](std::pair<int, int> x) { addPair(x); });
    std::sort(pairs_.begin(), pairs_.end());
    pairs_.erase(std::unique(pairs_.begin(), pairs_.end()), pairs_.end());
    std::set<std::pair<int, int>> removed;
    for (const PairName& p : options_.remove) each(p, [&](std::pair<int, int> x) { removed.insert(x); });
    out_->report.removed = static_cast<int>(std::erase_if(pairs_, [&](const auto& x) { return removed.count(x) > 0; }));
  }

  std::vector<bool> needed() const {
    std::vector<bool> needed(candidates_.size());
    for (const auto& [a, b] : pairs_) needed[at(a)] = needed[at(b)] = true;
    return needed;
  }

  void leaveOutMissing() {
    const std::vector<bool> need = needed();
    std::string all;
    const GeometryDescription* first = nullptr;
    std::vector<bool> missing(candidates_.size());
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
      const GeometryDescription& g = *candidates_[i].description;
      if (!need[i] || loader_.available(g)) continue;
      missing[i] = true;
      out_->report.missing.push_back("'" + g.name + "': " + uriOf(g));
      if (!first) first = &g;
      all += (all.empty() ? "" : ", ") + out_->report.missing.back();
    }
    if (all.empty()) return;
    if (options_.missing == GeometryOptions::Missing::refuse)
      throw Error(ErrorCode::file,
                  std::to_string(out_->report.missing.size()) + " geometries have files that are not there: " + all +
                      "; name the packages' folders (GeometryOptions::packages, --package, ROS_PACKAGE_PATH), or skip what is missing",
                  first->where);
    std::erase_if(pairs_, [&](const auto& x) { return missing[at(x.first)] || missing[at(x.second)]; });
  }

  void keepNeeded() {
    const std::vector<bool> need = needed();
    std::vector<int> kept(candidates_.size(), -1);
    std::set<std::string> unread;
    for (const GeometryDescription& g : description_.geometries)
      if (!uriOf(g).empty()) unread.insert(uriOf(g));
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
      if (!need[i]) continue;
      const Candidate& c = candidates_[i];
      kept[i] = static_cast<int>(out_->records.size());
      out_->index[c.description->name] = kept[i];
      out_->records.push_back({c.description->name, bodyOf(*c.description), c.joint, c.placement});
      out_->volumes.push_back(loader_.load(*c.description));
      if (moves(c)) out_->moving.push_back(kept[i]);
      unread.erase(uriOf(*c.description));
    }
    for (const auto& [a, b] : pairs_) out_->pairs.push_back({kept[at(a)], kept[at(b)]});
    out_->pairs_of.assign(out_->records.size() + 1, 0);
    for (const CollisionPair& p : out_->pairs) ++out_->pairs_of[at(p.a) + 1];
    for (std::size_t i = 1; i < out_->pairs_of.size(); ++i) out_->pairs_of[i] += out_->pairs_of[i - 1];
    out_->report.kept = static_cast<int>(out_->records.size());
    out_->report.pairs = static_cast<int>(out_->pairs.size());
    out_->report.files_read = loader_.filesRead();
    out_->report.files_not_needed = static_cast<int>(unread.size());
  }

  void chooseNarrow() {
    out_->narrow = {options_.narrow, options_.fcl_tolerance};
    if (options_.narrow == GeometryOptions::Narrow::own) return;
    if (!(options_.fcl_tolerance > 0) || !std::isfinite(options_.fcl_tolerance))
      throw Error(ErrorCode::argument, "GeometryOptions::fcl_tolerance is " + number(options_.fcl_tolerance) + "; it is a positive number");
    for (std::size_t p = 0; p < out_->pairs.size(); ++p) {
      const auto [a, b] = out_->pairs[p];
      if (!out_->volumes[at(a)]->bounded() || !out_->volumes[at(b)]->bounded())
        refuseByFcl(*out_, static_cast<int>(p), "it has no distance to a half-space", "describe a large box instead, leave out the pair");
    }
  }

  void chooseTrees() {
    std::vector<bool> asked(out_->records.size());  // static geometries whose boxes are searched
    for (std::size_t p = 0; p < out_->pairs.size(); ++p) {
      const auto [a, b] = out_->pairs[p];
      const bool moves_a = out_->moves(a), moves_b = out_->moves(b);
      if (!out_->volumes[at(a)]->bounded() || !out_->volumes[at(b)]->bounded() || (!moves_a && !moves_b)) {
        out_->unbounded.push_back(static_cast<int>(p));
      } else if (moves_a && moves_b) {
        out_->listed.push_back(static_cast<int>(p));
      } else {
        asked[at(moves_a ? b : a)] = true;
      }
    }
    std::vector<int> still;
    for (std::size_t g = 0; g < asked.size(); ++g)
      if (asked[g] && !out_->volumes[g]->empty()) still.push_back(static_cast<int>(g));
    const auto boxOf = [&](int g) { return moved(out_->volumes[at(g)]->bounds(), out_->records[at(g)].placement); };
    if (static_cast<int>(still.size()) < still_for_tree) {
      for (const int g : still) out_->still_boxes.add(g, boxOf(g));
    } else {
      auto tree = std::make_unique<Broadphase>(static_cast<int>(out_->records.size()));
      for (const int g : still) tree->place(g, boxOf(g));
      tree->update();
      out_->still_tree = std::move(tree);
    }
    out_->tree_of_moving = out_->listed.size() >= moving_pairs_for_tree;
    if (out_->tree_of_moving) out_->listed.clear();
  }

  void say() {
    GeometryReport& r = out_->report;
    const auto line = [&](const std::string& text) { r.lines.push_back(text); };
    line("geometries: " + std::to_string(r.kept) + " of " + std::to_string(r.described) + " described are in a pair, " +
         std::to_string(r.described - static_cast<int>(candidates_.size())) + " are only to be looked at");
    line("pairs: " + std::to_string(r.pairs) + "; left out " + std::to_string(r.rigid) + " of one rigid body, " + std::to_string(r.adjacent) +
         " of neighbours, " + std::to_string(r.disabled) + " disabled by the description, " + std::to_string(r.removed) + " by name");
    line("files: " + std::to_string(r.files_read) + " read, " + std::to_string(r.files_not_needed) + " not needed");
    line(std::string("broadphase: ") +
         (out_->still_tree ? "a tree of what stands still" : std::to_string(out_->still_boxes.size()) + " boxes that stand still side by side") +
         ", " + (out_->tree_of_moving ? "a tree of what moves" : std::to_string(out_->listed.size()) + " pairs that move one by one") + ", " +
         std::to_string(out_->unbounded.size()) + " pairs always asked");
    if (options_.narrow == GeometryOptions::Narrow::fcl) line("narrow phase: FCL's, to " + number(options_.fcl_tolerance) + " m");
    for (const std::string& m : r.missing) line("missing: " + m);
  }

  const CompactModel& model_;
  const Model& description_;
  const GeometryOptions& options_;
  VolumeLoader loader_;
  std::vector<int> group_;  ///< by described body
  std::vector<Candidate> candidates_;
  std::vector<std::pair<int, int>> pairs_;  ///< ascending
  std::shared_ptr<GeometryImpl> out_ = std::make_shared<GeometryImpl>();
};

}  // namespace

int GeometryImpl::pairOf(int a, int b) const {
  if (a > b) std::swap(a, b);
  const auto first = pairs.begin() + pairs_of[at(a)], last = pairs.begin() + pairs_of[at(a) + 1];
  const auto found = std::lower_bound(first, last, b, [](const CollisionPair& p, int x) { return p.b < x; });
  return found != last && found->b == b ? static_cast<int>(found - pairs.begin()) : -1;
}

GeometryModel::GeometryModel(std::shared_ptr<const GeometryImpl> impl) : impl_(std::move(impl)) {}
const std::vector<GeometryRecord>& GeometryModel::geometries() const { return impl_->records; }
const std::vector<CollisionPair>& GeometryModel::pairs() const { return impl_->pairs; }
const GeometryReport& GeometryModel::report() const { return impl_->report; }
int GeometryModel::geometryId(const std::string& name) const {
  const auto found = impl_->index.find(name);
  return found == impl_->index.end() ? -1 : found->second;
}
int GeometryModel::pairId(const std::string& a, const std::string& b) const {
  const int i = geometryId(a), j = geometryId(b);
  return i < 0 || j < 0 || i == j ? -1 : impl_->pairOf(i, j);
}

GeometryModel compileGeometry(const CompactModel& model, const Model& description, const GeometryOptions& options) {
  return GeometryModel(Compiler(model, description, options).run());
}

}  // namespace dyn
