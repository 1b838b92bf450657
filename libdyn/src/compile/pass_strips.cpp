#include "compile/compact_impl.hpp"
#include "joint/processor.hpp"

#include <algorithm>
#include <cstdint>
#include <map>

namespace dyn {

PackMemory::PackMemory(std::size_t bytes) : bytes_(bytes + alignment), block_(new char[bytes + alignment]()) {
  const auto address = reinterpret_cast<std::uintptr_t>(block_.get());
  data_ = block_.get() + (alignment - address % alignment) % alignment;
}

namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// Where a body went.
struct Seat {
  int strip = 0, lane = 0;
};

class Planner {
 public:
  explicit Planner(const CompactImpl& m) : m_(m), seats_(at(m.bodies())) { plan_.strips.emplace_back(); }

  StripPlan run() {
    int depths = 0;
    for (const BodyIndex& x : m_.index) depths = std::max(depths, x.depth);
    std::vector<std::vector<int>> levels(at(depths) + 1);
    for (int i = 1; i < m_.bodies(); ++i) levels[at(m_.index[at(i)].depth)].push_back(i);
    for (const std::vector<int>& level : levels) seatLevel(level);
    // Measured (dyn bench on the robots of ../shared/models): a strip takes about 1.3 times one body's time, and entering and leaving the
    // lanes that of two bodies.
    plan_.count = static_cast<int>(plan_.strips.size()) - 1;
    plan_.used = 1.3 * plan_.count + 2 < static_cast<double>(m_.bodies() - 1);
    if (!plan_.used) {
      plan_.strips.clear();
      return std::move(plan_);
    }
    family();
    batches();
    numbers();
    return std::move(plan_);
  }

 private:
  /// Bodies of one depth: first those that can keep their parent's lane, then the others in what is free.
  void seatLevel(const std::vector<int>& level) {
    std::map<std::pair<int, int>, std::vector<int>> groups;  // (batch, parent strip) -> bodies; all of one shape
    for (const int body : level) groups[{m_.index[at(body)].batch, seats_[at(m_.index[at(body)].parent)].strip}].push_back(body);
    for (const auto& [key, bodies] : groups) {
      std::vector<int> left = bodies;
      while (!left.empty()) {
        Strip strip;
        strip.batch = key.first;
        strip.parent = key.second;
        std::vector<int> homeless, next;
        for (const int body : left) {
          int& seat = strip.body[seats_[at(m_.index[at(body)].parent)].lane];
          if (key.second != 0 && seat < 0) {
            seat = body;
          } else {
            homeless.push_back(body);
          }
        }
        for (const int body : homeless) {
          int* seat = std::find(strip.body, strip.body + strip_lanes, -1);
          if (seat == strip.body + strip_lanes) {
            next.push_back(body);
          } else {
            *seat = body;
          }
        }
        add(strip);
        left = std::move(next);
      }
    }
  }

  void add(Strip strip) {
    const TypeBatch& batch = m_.batches[at(strip.batch)];
    strip.shape = batch.shape;
    strip.nv = batch.nv;
    strip.dof = plan_.dofs;
    plan_.dofs += batch.nv;
    const int index = static_cast<int>(plan_.strips.size());
    for (int l = 0; l < strip_lanes; ++l) {
      if (strip.body[l] < 0) continue;
      const BodyIndex& x = m_.index[at(strip.body[l])];
      strip.parent_lane[l] = seats_[at(x.parent)].lane;
      strip.aligned = strip.aligned && (strip.parent == 0 || strip.parent_lane[l] == l);
      seats_[at(strip.body[l])] = {index, l};
    }
    // Lanes without a body follow one that has, so that all lanes may read from one.
    if (!strip.aligned) {
      std::int64_t lane = 0;
      for (int l = strip_lanes - 1; l >= 0; --l)
        if (strip.body[l] >= 0) lane = strip.parent_lane[l];
      for (int l = 0; l < strip_lanes; ++l)
        if (strip.body[l] < 0) strip.parent_lane[l] = lane;
    }
    plan_.strips.push_back(strip);
  }

  void family() {
    for (std::size_t s = plan_.strips.size(); s-- > 1;) {
      Strip &strip = plan_.strips[s], &parent = plan_.strips[at(strip.parent)];
      strip.last_child = parent.leaf;
      parent.leaf = false;
    }
  }

  void batches() {
    plan_.batches.resize(m_.batches.size());
    for (std::size_t s = 1; s < plan_.strips.size(); ++s) {
      Strip& strip = plan_.strips[s];
      StripBatch& batch = plan_.batches[at(strip.batch)];
      strip.slot = batch.slots++;
      const int someone = *std::find_if(strip.body, strip.body + strip_lanes, [](int b) { return b >= 0; });
      for (const int body : strip.body) batch.bodies.push_back(body >= 0 ? body : someone);
    }
    for (std::size_t b = 0; b < m_.batches.size(); ++b) {
      const TypeBatch& from = m_.batches[b];
      StripBatch& to = plan_.batches[b];
      for (const int body : to.bodies) {
        to.q_index.push_back(m_.index[at(body)].idx_q);
        to.v_index.push_back(m_.index[at(body)].idx_v);
      }
      for (int c = 0; c < from.constant_count; ++c)
        for (const int body : to.bodies) to.constants.push_back(from.constants[at(c * from.count + m_.index[at(body)].slot)]);
    }
  }

  /// Constants of bodies and degrees of freedom, lane by lane.
  void numbers() {
    constexpr int size = sizeof(BodyConstants<double>) / sizeof(double);
    plan_.constants = PackMemory(plan_.strips.size() * sizeof(BodyConstants<double>) * strip_lanes);
    auto* out = reinterpret_cast<double*>(plan_.constants.data());
    for (std::size_t s = 1; s < plan_.strips.size(); ++s) {
      const Strip& strip = plan_.strips[s];
      const StripBatch& batch = plan_.batches[at(strip.batch)];
      for (int l = 0; l < strip_lanes; ++l) {
        const int body = batch.bodies[at(strip.slot * strip_lanes + l)];
        BodyConstants<double> c = m_.constants[at(body)];
        if (strip.body[l] < 0) c = {c.placement, 0, {}, {}, {}, {}};
        const auto* numbers = reinterpret_cast<const double*>(&c);
        for (int k = 0; k < size; ++k) out[(s * size + at(k)) * strip_lanes + at(l)] = numbers[k];
      }
      for (int k = 0; k < strip.nv; ++k)
        for (int l = 0; l < strip_lanes; ++l) {
          const int body = batch.bodies[at(strip.slot * strip_lanes + l)], v = m_.index[at(body)].idx_v + k;
          plan_.dof_index.push_back(v);
          plan_.armature.push_back(strip.body[l] < 0 ? 1.0 : (m_.armature.empty() ? 0.0 : m_.armature[at(v)]));
        }
    }
  }

  const CompactImpl& m_;
  StripPlan plan_;
  std::vector<Seat> seats_;
};

}  // namespace

StripPlan planStrips(const CompactImpl& m) {
  const bool packs = instructionSet().name == "avx2" || instructionSet().name == "avx512";
  if (!packs || !m.couplings.empty() || m.bodies() < 2) return {};
  for (const TypeBatch& batch : m.batches)
    if (batch.shape == Shape::dense_constant) return {};
  return Planner(m).run();
}

}  // namespace dyn
