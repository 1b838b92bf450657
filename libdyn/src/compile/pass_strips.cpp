#include "at.hpp"
#include "compile/compact_impl.hpp"
#include "joint/processor.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <map>
#include <set>
#include <utility>

namespace dyn {

PackMemory::PackMemory(std::size_t bytes) : bytes_(bytes + alignment), block_(new char[bytes + alignment]()) {
  const auto address = reinterpret_cast<std::uintptr_t>(block_.get());
  data_ = block_.get() + (alignment - address % alignment) % alignment;
}

namespace {

class Planner {
 public:
  explicit Planner(const CompactImpl& m) : m_(m), height_(at(m.bodies()), 1), leaves_(at(m.bodies()), 0) {
    plan_.strips.emplace_back();
    plan_.seats.resize(at(m.bodies()));
    plan_.seats[0].lanes = (1U << strip_lanes) - 1;
    for (int i = m.bodies() - 1; i > 0; --i) {
      if (leaves_[at(i)] == 0) leaves_[at(i)] = 1;
      leaves_[at(parentOf(i))] += leaves_[at(i)];
      height_[at(parentOf(i))] = std::max(height_[at(parentOf(i))], height_[at(i)] + 1);
    }
  }

  StripPlan seats() {
    seatAll();
    return std::move(plan_);
  }
  StripPlan run() {
    seatAll();
    plan_.count = static_cast<int>(plan_.strips.size()) - 1;
    ways();
    judge();
    if (!plan_.uses.rnea) {
      plan_.strips.clear();
      plan_.seats.clear();
      return std::move(plan_);
    }
    family();
    runs();
    batches();
    numbers();
    return std::move(plan_);
  }

 private:
  const BodyIndex& index(int body) const { return m_.index[at(body)]; }
  int parentOf(int body) const { return index(body).parent; }
  /// The longest way to a leaf comes first.
  using Rank = std::pair<int, int>;
  Rank rank(int body) const { return {-height_[at(body)], body}; }
  /// Type, and whether it hangs on the world: bodies that do have no parents to gather from, and are among themselves.
  using Kind = std::pair<int, bool>;
  Kind kindOf(int body) const { return {index(body).batch, parentOf(body) == 0}; }
  /// Strip and lane of the parent, and the type.
  std::array<int, 3> childrenOf(int body) const {
    const Seat& parent = plan_.seats[at(parentOf(body))];
    return {parent.strip, parent.lane, index(body).batch};
  }

  /// Strip after strip: where the last one goes on, and what has the longest way to its leaves first.
  void seatAll() {
    open(0);
    while (!waiting_.empty()) {
      const Strip strip = fill(leader());
      for (const int body : strip.body)
        if (body >= 0) close(body);
      add(strip);
      for (const int body : strip.body)
        if (body >= 0) open(body);
    }
  }

  /// The children of a body that has its seat wait for theirs.
  void open(int parent) {
    for (int i = parent + 1; i < m_.tree_end[at(parent)]; i = m_.tree_end[at(i)]) {
      children_[childrenOf(i)].insert(rank(i));
      waiting_[kindOf(i)].insert(rank(i));
    }
  }
  void close(int body) {
    const auto leave = [&](auto& sets, const auto& key) {
      const auto set = sets.find(key);
      set->second.erase(rank(body));
      if (set->second.empty()) sets.erase(set);
    };
    leave(children_, childrenOf(body));
    leave(waiting_, kindOf(body));
  }

  int leader() const {
    Rank best{0, 0};
    const int last = static_cast<int>(plan_.strips.size()) - 1;
    for (auto set = children_.lower_bound({last, 0, 0}); set != children_.end(); ++set) best = std::min(best, *set->second.begin());
    if (best.second == 0)
      for (const auto& [kind, bodies] : waiting_) best = std::min(best, *bodies.begin());
    return best.second;
  }

  /// A strip with this body and others of its kind: those in a lane of their parents, then any. Where lanes are left, bodies on which several
  /// limbs hang are mirrored in more of their parents' lanes.
  Strip fill(int leader) const {
    Strip strip;
    strip.batch = index(leader).batch;
    const int family = plan_.seats[at(parentOf(leader))].strip;
    const Strip& above = plan_.strips[at(family)];
    std::set<Rank> homeless;
    for (int lane = 0; lane < strip_lanes; ++lane) {
      const auto set = children_.find({family, lane, strip.batch});
      if (set == children_.end()) continue;
      auto body = set->second.begin();
      for (int l = 0; l < strip_lanes && body != set->second.end(); ++l)
        if (above.shown[l] == above.body[lane]) strip.body[l] = (body++)->second;
      for (int k = 0; k < strip_lanes && body != set->second.end(); ++k, ++body) homeless.insert(*body);
    }
    const auto sit = [&](int body) {
      int* seat = std::find(strip.body, strip.body + strip_lanes, -1);
      if (seat == strip.body + strip_lanes) return false;
      if (std::find(strip.body, strip.body + strip_lanes, body) == strip.body + strip_lanes) *seat = body;
      return true;
    };
    for (const std::set<Rank>* bodies : {&std::as_const(homeless), &waiting_.at(kindOf(leader))})
      for (const Rank& body : *bodies)
        if (!sit(body.second)) break;
    mirror(strip);
    return strip;
  }

  void mirror(Strip& strip) const {
    int limbs[strip_lanes] = {};
    for (int l = 0; l < strip_lanes; ++l) {
      strip.shown[l] = strip.body[l];
      if (strip.body[l] >= 0) limbs[l] = leaves_[at(strip.body[l])] - 1;
    }
    for (int l = 0; l < strip_lanes; ++l) {
      if (strip.body[l] >= 0) continue;
      int most = -1;
      for (int other = 0; other < strip_lanes; ++other)
        if (limbs[other] > 0 && (most < 0 || limbs[other] > limbs[most]) && hasLane(parentOf(strip.body[other]), l)) most = other;
      if (most < 0) continue;
      strip.shown[l] = strip.body[most];
      --limbs[most];
    }
  }
  /// The body is in this lane of its strip, or mirrored there.
  bool hasLane(int body, int lane) const { return (plan_.seats[at(body)].lanes >> lane & 1) != 0; }

  void add(Strip strip) {
    const TypeBatch& batch = m_.batches[at(strip.batch)];
    strip.shape = batch.shape;
    strip.nv = batch.nv;
    strip.dof = plan_.dofs;
    plan_.dofs += batch.nv;
    const int number = static_cast<int>(plan_.strips.size());
    for (int l = 0; l < strip_lanes; ++l) {
      const int body = strip.shown[l];
      if (body < 0) continue;
      const BodyIndex& x = index(body);
      const unsigned same = lanesOf(strip.shown, [&](int other) { return other == body; });
      if (strip.body[l] >= 0) {
        strip.depth = std::max(strip.depth, x.depth);
        plan_.seats[at(body)] = {number, l, same, strip.dof};
      }
      const Seat& parent = plan_.seats[at(x.parent)];
      const bool alone = lanesOf(strip.shown, [&](int other) { return other >= 0 && parentOf(other) == x.parent; }) == same;
      join(strip, {parent.strip, hasLane(x.parent, l) && (alone || parent.lanes != 1U << parent.lane) ? -1 : parent.lane, 1U << l});
    }
    strip.aligned = strip.parents_count == 1 && strip.parents[0].lane < 0;
    plan_.strips.push_back(strip);
  }
  template <class Lanes, class Test>
  static unsigned lanesOf(const Lanes& all, Test&& test) {
    unsigned lanes = 0;
    for (int l = 0; l < strip_lanes; ++l)
      if (test(all[static_cast<std::size_t>(l)])) lanes |= 1U << l;
    return lanes;
  }

  static void join(Strip& strip, const StripParents& parents) {
    for (int i = 0; i < strip.parents_count; ++i) {
      StripParents& known = strip.parents[i];
      if (known.strip != parents.strip || known.lane != parents.lane) continue;
      known.lanes |= parents.lanes;
      return;
    }
    strip.parents[strip.parents_count++] = parents;
  }

  void family() {
    for (std::size_t s = plan_.strips.size(); s-- > 1;) {
      Strip& strip = plan_.strips[s];
      int unions = 0;
      for (const int body : strip.body)
        if (body >= 0 && parts(body)) strip.united[unions++] = plan_.seats[at(body)].lanes;
      for (int p = 0; p < strip.parents_count; ++p) {
        StripParents& parents = strip.parents[p];
        for (int l = 0; l < strip_lanes; ++l) {
          if ((parents.lanes >> l & 1) == 0) continue;
          const int body = strip.shown[l], parent = parentOf(body);
          const bool along_trunk = !parts(parent) && plan_.seats[at(parent)].lanes == plan_.seats[at(body)].lanes;
          if (strip.body[l] >= 0 || along_trunk) parents.given |= 1U << l;
        }
        strip.gives_all = strip.gives_all && strip.aligned && parents.given == parents.lanes;
        bool& leaf = plan_.strips[at(parents.strip)].leaf;
        parents.first = leaf;
        leaf = false;
      }
      // Measured: two are chosen between faster than four are gathered.
      strip.apart = strip.parents_count > 2;
      for (int l = 0; l < strip_lanes; ++l)
        for (int p = strip.parents_count; p-- > 0;) {
          const StripParents& parents = strip.parents[p];
          // Lanes of nobody have someone's.
          if (p == 0 || (parents.lanes >> l & 1) != 0) {
            strip.lane_parents[l] = {parents.strip, parents.lane < 0 ? l : parents.lane, (parents.given >> l & 1) != 0};
            break;
          }
        }
    }
  }
  void ways() {
    // By strip and lane, the first of the lanes that go the same way.
    std::vector<std::array<int, strip_lanes>> first(plan_.strips.size());
    for (std::size_t s = 1; s < plan_.strips.size(); ++s) {
      Strip& strip = plan_.strips[s];
      strip.bodies = lanesOf(strip.body, [](int body) { return body >= 0; });
      const auto together = [&](int l, int other) {
        for (int p = 0; p < strip.parents_count; ++p) {
          const StripParents& parents = strip.parents[p];
          if ((parents.lanes >> l & 1) == 0 || (parents.lanes >> other & 1) == 0) continue;
          const auto& above = first[at(parents.strip)];
          return parents.strip == 0 || parents.lane >= 0 || above[at(l)] == above[at(other)];
        }
        return false;
      };
      int count = 0;
      for (int l = 0; l < strip_lanes; ++l) {
        first[s][at(l)] = l;
        for (int other = l; other-- > 0;)
          if (together(l, other)) first[s][at(l)] = other;
      }
      for (int l = 0; l < strip_lanes; ++l)
        if (const unsigned lanes = strip.bodies & lanesOf(first[s], [&](int other) { return other == l; })) strip.ways[count++] = lanes;
    }
  }
  /// What the algorithms take, measured with and without strips (CompileOptions::strips) on the legged and two-armed robots of ../shared/models, on a
  /// Zen 5: a strip and, for inverse dynamics, entering and leaving the lanes, in the time that one body takes. With the 16 registers of AVX2 what a
  /// strip has of four bodies goes to memory and back, which costs the algorithms of many numbers a body.
  void judge() {
    const double joints = m_.bodies() - 1;
    StripUses& uses = plan_.uses;
    uses.rnea = 1.3 * plan_.count + 2 < joints;
    if (!uses.rnea) return;
    const bool many_numbers = (instructionSet() == "avx512" ? 2.8 : 3.24) * plan_.count < joints;
    const auto varies = [](const TypeBatch& batch) { return batch.shape == Shape::dense; };
    uses.aba = uses.centroidal_map = many_numbers;
    uses.derivatives = many_numbers && std::none_of(m_.batches.begin(), m_.batches.end(), varies);
    // Its entries are one for each step of each joint's way up. Where limbs branch, as hands do, few lanes take a step together.
    uses.mass_matrix = lanesOnWays() > 3;
  }
  /// Joints that take a step up to the root together, on average.
  double lanesOnWays() const {
    std::int64_t alone = 0, together = 0;
    for (int i = 1; i < m_.bodies(); ++i) alone += index(i).depth;
    // Each step takes every lane of a way one body up: all of them have as many before them.
    for (int s = 1; s <= plan_.count; ++s)
      for (const unsigned lanes : plan_.strips[at(s)].ways)
        if (lanes != 0) together += index(plan_.strips[at(s)].body[std::countr_zero(lanes)]).depth;
    return static_cast<double>(alone) / static_cast<double>(together);
  }
  /// A mirrored body that has more below it than one that is mirrored in the same lanes.
  bool parts(int body) const {
    const Seat& seat = plan_.seats[at(body)];
    if (body == 0 || seat.lanes == 1U << seat.lane) return false;
    const int child = body + 1;
    return m_.tree_end[at(child)] != m_.tree_end[at(body)] || plan_.seats[at(child)].lanes != seat.lanes;
  }

  void runs() {
    for (int s = 1; s <= plan_.count; ++s) {
      const Strip& strip = plan_.strips[at(s)];
      const bool goes_on = !plan_.runs.empty() && plan_.runs.back().shape == strip.shape && plan_.runs.back().nv == strip.nv;
      if (!goes_on) plan_.runs.push_back({s, s, strip.shape, strip.nv});
      plan_.runs.back().end = s + 1;
    }
  }

  void batches() {
    plan_.batches.resize(m_.batches.size());
    for (std::size_t s = 1; s < plan_.strips.size(); ++s) {
      Strip& strip = plan_.strips[s];
      StripBatch& batch = plan_.batches[at(strip.batch)];
      strip.slot = batch.slots++;
      const int someone = *std::find_if(strip.body, strip.body + strip_lanes, [](int b) { return b >= 0; });
      for (const int body : strip.shown) batch.bodies.push_back(body >= 0 ? body : someone);
    }
    for (std::size_t b = 0; b < m_.batches.size(); ++b) {
      const TypeBatch& from = m_.batches[b];
      StripBatch& to = plan_.batches[b];
      for (const int body : to.bodies) {
        to.q_index.push_back(m_.index[at(body)].idx_q);
        to.v_index.push_back(m_.index[at(body)].idx_v);
        to.pose_index.push_back(m_.index[at(body)].slot);
      }
      for (int c = 0; c < std::max(from.constant_count, 1); ++c)
        for (const int body : to.bodies) to.constants.push_back(from.constants[at(c * from.count + m_.index[at(body)].slot)]);
    }
  }

  /// Constants of bodies and degrees of freedom, lane by lane.
  void numbers() {
    for (int i = 1; i < m_.bodies(); ++i)
      for (int k = 0; k < index(i).nv; ++k) plan_.dof_place.push_back((plan_.seats[at(i)].strip_dof + k) * strip_lanes + plan_.seats[at(i)].lane);
    constexpr int size = sizeof(BodyConstants<double>) / sizeof(double);
    plan_.constants = PackMemory(plan_.strips.size() * sizeof(BodyConstants<double>) * strip_lanes);
    auto* out = reinterpret_cast<double*>(plan_.constants.data());
    for (std::size_t s = 1; s < plan_.strips.size(); ++s) {
      const Strip& strip = plan_.strips[s];
      const StripBatch& batch = plan_.batches[at(strip.batch)];
      for (int l = 0; l < strip_lanes; ++l) {
        const int body = batch.bodies[at(strip.slot * strip_lanes + l)];
        BodyConstants<double> c = m_.constants[at(body)];
        if (strip.shown[l] < 0 || (strip.body[l] < 0 && parts(body))) c = {c.placement, 0, {}, {}, {}, {}};
        const auto* numbers = reinterpret_cast<const double*>(&c);
        for (int k = 0; k < size; ++k) out[(s * size + at(k)) * strip_lanes + at(l)] = numbers[k];
      }
      for (int k = 0; k < strip.nv; ++k)
        for (int l = 0; l < strip_lanes; ++l) {
          const int body = batch.bodies[at(strip.slot * strip_lanes + l)], v = m_.index[at(body)].idx_v + k;
          plan_.dof_index.push_back(v);
          plan_.dof_row.push_back(static_cast<std::int64_t>(v) * m_.nvx);
          plan_.armature.push_back(strip.shown[l] < 0 ? 1.0 : (m_.armature.empty() ? 0.0 : m_.armature[at(v)]));
        }
    }
    const auto isShared = [&](int dof) {
      const auto first = plan_.dof_index.begin() + strip_lanes * dof;
      return std::all_of(first, first + strip_lanes, [&](std::int64_t v) { return v == *first; });
    };
    while (plan_.shared_dofs < plan_.dofs && isShared(plan_.shared_dofs)) ++plan_.shared_dofs;
  }

  const CompactImpl& m_;
  StripPlan plan_;
  std::map<std::array<int, 3>, std::set<Rank>> children_;  ///< what has no seat yet and whose parent has one
  std::map<Kind, std::set<Rank>> waiting_;                 ///< the same bodies
  std::vector<int> height_;                                ///< bodies from this one down to its farthest leaf
  std::vector<int> leaves_;                                ///< below this one
};

}  // namespace

StripPlan seatStrips(const CompactImpl& m) { return Planner(m).seats(); }

StripPlan planStrips(const CompactImpl& m) {
  const bool packs = instructionSet() == "avx2" || instructionSet() == "avx512";
  if (!packs || !m.couplings.empty() || m.bodies() < 2) return {};
  for (const TypeBatch& batch : m.batches)
    if (batch.shape == Shape::dense_constant) return {};
  return Planner(m).run();
}

}  // namespace dyn
