// Recursions over strips: the kernels for bodies, with four joints in the lanes of a pack.
#pragma once

#include "kernels/aba.hpp"
#include "kernels/columns.hpp"
#include "kernels/crba.hpp"
#include "kernels/evaluate.hpp"
#include "kernels/losses.hpp"
#include "kernels/rnea.hpp"
#include "kernels/scratch.hpp"
#include "kernels/strip_scratch.hpp"

#include <dyn_sdk/pack.hpp>

#include <algorithm>
#include <array>
#include <utility>

namespace dyn::kernels {

typedef double Four __attribute__((vector_size(32)));  // gcc 12 forgets the attribute of an alias

/// Four numbers from where `index` says. Four loads are sooner done than the processor's own gathering.
template <class S>
S gathered(const double* from, const std::int64_t* index) {
  static_assert(sizeof(Four) == sizeof(S) && strip_lanes == 4);
  return typename S::Batch(Four{from[index[0]], from[index[1]], from[index[2]], from[index[3]]});
}

template <class S>
S sumInAll(const S& a) {
  const auto lanes = static_cast<Four>(a.x);
  const Four halves = lanes + __builtin_shufflevector(lanes, lanes, 2, 3, 0, 1);
  return typename S::Batch(halves + __builtin_shufflevector(halves, halves, 1, 0, 3, 2));
}

/// Struct T as the packs it is made of.
template <class S, class T>
constexpr std::size_t packs_in = sizeof(T) / sizeof(S);
template <class S, class T>
S* packsOf(T& x) {
  return reinterpret_cast<S*>(&x);
}
template <class S, class T>
const S* packsOf(const T& x) {
  return reinterpret_cast<const S*>(&x);
}

/// Each lane's numbers of a struct of its own, in a lane of its own: from[l] is the first of them.
template <class S, class T>
T gatheredLanes(const double* const* from) {
  T out;
  for (std::size_t k = 0; k < packs_in<S, T>; ++k) {
    const std::size_t at = strip_lanes * k;
    packsOf<S>(out)[k] = typename S::Batch(Four{from[0][at], from[1][at], from[2][at], from[3][at]});
  }
  return out;
}

/// Those of `bits`.
template <class S>
typename S::Mask lanes(unsigned bits) {
  alignas(64) static constexpr auto masks = [] {
    std::array<double, strip_lanes << strip_lanes> numbers{};
    for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = (i / strip_lanes) >> (i % strip_lanes) & 1 ? 1.0 : 0.0;
    return numbers;
  }();
  return S::load(masks.data() + strip_lanes * bits) > S(0);
}

template <class S>
struct Strips {
  const CompactImpl& m;
  Workspace<S>& w;

  const BodyConstants<S>& constants(int i) const { return reinterpret_cast<const BodyConstants<S>*>(m.strips.constants.data())[i]; }
  S mass(int i) const { return constants(i).mass; }
  S armature(int dof) const { return S::load(m.strips.armature.data() + strip_lanes * dof); }
  Vec3<S> gravity() const { return cast<S>(m.gravity); }
  bool isRoot(int i) const { return strip(i).depth == 1; }

  /// What the parents have, in the lanes of their children.
  template <class T>
  T parent(const T* array, int i) const {
    const Strip& s = strip(i);
    if (s.aligned) return array[s.parents[0].strip];
    T out = of(s.parents[0], array);
    for (int p = 1; p < s.parents_count; ++p) {
      const auto here = lanes<S>(s.parents[p].lanes);
      const T more = of(s.parents[p], array);
      for (std::size_t k = 0; k < packs_in<S, T>; ++k) packsOf<S>(out)[k] = select(here, packsOf<S>(more)[k], packsOf<S>(out)[k]);
    }
    return out;
  }
  template <class T>
  void addToParent(T* array, int i, const T& value) const {
    const Strip& s = strip(i);
    if (s.gives_all) {
      array[s.parents[0].strip] += value;
    } else {
      for (int p = 0; p < s.parents_count; ++p) give(s.parents[p], array, value);
    }
  }
  /// The same where the first child writes. Leaves keep what they had.
  template <class T>
  void handOver(T* array, int i, const T& value) const {
    const Strip& s = strip(i);
    if (s.gives_all && s.parents[0].first) {
      array[s.parents[0].strip] = value;
      return;
    }
    for (int p = 0; p < s.parents_count; ++p)
      if (s.parents[p].first) array[s.parents[p].strip] = T{};
    addToParent(array, i, value);
  }
  bool isLeaf(int i) const { return strip(i).leaf; }
  /// What is in several lanes of one body: its sum, in each of them.
  template <class T>
  void unite(int i, T& value) const {
    const Strip& s = strip(i);
    for (const unsigned united : s.united) {
      if (united == 0) return;
      const auto here = lanes<S>(united);
      for (std::size_t k = 0; k < packs_in<S, T>; ++k) {
        S& x = packsOf<S>(value)[k];
        x = select(here, sumInAll(select(here, x, S(0))), x);
      }
    }
  }

  using Entries = double;
  /// Four joints' rows of the mass matrix, and their ways up to the root.
  class Entry {
   public:
    Entry(const Strips& strips, double* M, int i, int iv) : plan_(strips.m.strips), n_(strips.m.nvx), strip_(&plan_.strips[index(i)]) {
      for (int l = 0; l < strip_lanes; ++l) {
        const std::ptrdiff_t dof = plan_.dof_index[index(strip_lanes * iv + l)];
        row_[l] = strip_->body[l] < 0 ? nullptr : M + dof;
        column_[l] = M + dof * n_;
      }
    }
    void enter(int k, int l, const S& value) const { Together{*this, strip_, strip_}.enter(k, l, value); }
    /// Strip by strip while lanes go on as they are, else body by body.
    template <class Use>
    void climb(Use&& use) const {
      const Strip* from = strip_;
      while (from->aligned && from->depth > 1) {
        const Strip* to = &plan_.strips[index(from->parents[0].strip)];
        use(Together{*this, from, to});
        from = to;
      }
      if (from->depth > 1)
        for (Apart lanes(*this, *from); lanes.climb();) use(std::as_const(lanes));
    }

   private:
    static std::size_t index(int i) { return static_cast<std::size_t>(i); }
    void put(int lane, int k, std::ptrdiff_t j, double number) const { column_[lane][k * n_ + j] = row_[lane][k + j * n_] = number; }
    /// Above the diagonal, where six numbers follow one another. dofOf(lane): the root's first, negative where nothing is to be entered.
    template <class DofOf>
    void putFlying(int k, const Force<S>& f, DofOf&& dofOf) const {
      Square<double, strip_lanes> first, last;
      for (int c = 0; c < strip_lanes; ++c) {
        first.read(c, packsOf<S>(f)[c].begin());
        last.read(c, packsOf<S>(f)[c + 2].begin());
      }
      first.transpose();
      last.transpose();
      for (int lane = 0; lane < strip_lanes; ++lane) {
        const std::ptrdiff_t dof = dofOf(lane);
        if (dof < 0) continue;
        double* to = column_[lane] + k * n_ + dof;
        first.write(lane, to);
        last.write(lane, to + 2);
      }
    }

    class Together {
     public:
      Together(const Entry& entry, const Strip* from, const Strip* to) : entry_(entry), from_(from), to_(to) {}
      template <class T>
      const T& lever(const T* r) const {
        return r[from_ - entry_.plan_.strips.data()];
      }
      int nv() const { return to_->nv; }
      bool flyingRoot() const { return to_->flying_root; }
      bool turnsOnly() const { return to_->turns_only; }
      const Motion<S>& column(const Workspace<S>& workspace, int l) const { return workspace.dof[to_->dof + l].S_; }
      void enter(int k, int l, const S& value) const {
        const std::int64_t* other = entry_.plan_.dof_index.data() + strip_lanes * (to_->dof + l);
        for (int lane = 0; lane < strip_lanes; ++lane)
          if (entry_.row_[lane] != nullptr) entry_.put(lane, k, other[lane], value.begin()[lane]);
      }
      void enterFlying(int k, const Force<S>& f) const {
        const std::int64_t* other = entry_.plan_.dof_index.data() + strip_lanes * to_->dof;
        entry_.putFlying(k, f, [&](int lane) { return entry_.row_[lane] == nullptr ? -1 : other[lane]; });
      }

     private:
      const Entry& entry_;
      const Strip *from_, *to_;
    };

    /// Each lane from body to body, the deepest first, so that all are at the root at once.
    class Apart {
     public:
      Apart(const Entry& entry, const Strip& strip) : entry_(entry), seats_(entry.plan_.seats.data()), depth_(strip.depth) {
        for (int l = 0; l < strip_lanes; ++l) to_[l] = seats_ + std::max(strip.shown[l], 0);
      }
      bool climb() {
        if (depth_ == 1) return false;
        for (int l = 0; l < strip_lanes; ++l) {
          const bool climbs = to_[l]->depth == depth_;
          from_[l] = climbs ? to_[l] : seats_;
          to_[l] = climbs ? seats_ + to_[l]->parent : to_[l];
          entries_[l] = climbs && entry_.row_[l] != nullptr ? to_[l]->nv : 0;
        }
        --depth_;
        return true;
      }
      /// Zero in lanes that stay where they are.
      template <class T>
      T lever(const T* r) const {
        return gather<T>([&](int l) { return laneOf(r[from_[l]->strip], *from_[l]); });
      }
      int nv() const { return std::max(std::max(entries_[0], entries_[1]), std::max(entries_[2], entries_[3])); }
      bool flyingRoot() const {
        return all([](const Seat& seat) { return seat.flying_root; });
      }
      bool turnsOnly() const {
        return all([](const Seat& seat) { return seat.turns_only; });
      }
      Motion<S> column(const Workspace<S>& workspace, int l) const {
        return gather<Motion<S>>(
            [&](int lane) { return laneOf(workspace.dof[to_[lane]->strip_dof + std::min(l, to_[lane]->nv - 1)].S_, *to_[lane]); });
      }
      void enter(int k, int l, const S& value) const {
        for (int lane = 0; lane < strip_lanes; ++lane)
          if (l < entries_[lane]) entry_.put(lane, k, to_[lane]->dof + l, value.begin()[lane]);
      }
      void enterFlying(int k, const Force<S>& f) const {
        entry_.putFlying(k, f, [&](int lane) { return entries_[lane] == 0 ? -1 : to_[lane]->dof; });
      }

     private:
      template <class T>
      static const double* laneOf(const T& packs, const Seat& seat) {
        return reinterpret_cast<const double*>(&packs) + seat.lane;
      }
      template <class T, class From>
      static T gather(From&& from) {
        const double* const first[strip_lanes] = {from(0), from(1), from(2), from(3)};
        return gatheredLanes<S, T>(first);
      }
      template <class Test>
      bool all(Test&& test) const {
        bool holds = true;
        for (int l = 0; l < strip_lanes; ++l) holds = holds && (entries_[l] == 0 || test(*to_[l]));
        return holds;
      }
      const Entry& entry_;
      const Seat* seats_;
      int depth_;
      const Seat *from_[strip_lanes], *to_[strip_lanes];
      int entries_[strip_lanes];  ///< degrees of freedom of the body that the lane has come to; zero if it has no row or has not moved
    };

    const StripPlan& plan_;
    std::ptrdiff_t n_;
    const Strip* strip_;
    double *row_[strip_lanes], *column_[strip_lanes];  ///< of the joint's first degree of freedom; null rows: lanes without a body
  };
  Entry entry(double* M, int i, int iv) const { return {*this, M, i, iv}; }

  template <class Body>
  void forward(Body&& body) const {
    const int n = static_cast<int>(m.strips.strips.size());
    for (int first = 1, end; first < n; first = end) {
      for (end = first; end < n && alike(first, end);) ++end;
      withShape<S, false>(strip(first).shape, strip(first).nv, [&]<class Joint>() DYN_RUN_LOOP {
        for (int i = first; i < end; ++i) {
          const Slot<S> slot = slotOf(i);
          body(Joint(slot), i, strip(i).dof);
        }
      });
    }
  }
  template <class Body>
  void backward(Body&& body) const {
    for (int end = static_cast<int>(m.strips.strips.size()), first; end > 1; end = first) {
      for (first = end - 1; first > 1 && alike(first - 1, end - 1);) --first;
      withShape<S, false>(strip(first).shape, strip(first).nv, [&]<class Joint>() DYN_RUN_LOOP {
        for (int i = end - 1; i >= first; --i) {
          const Slot<S> slot = slotOf(i);
          body(Joint(slot), i, strip(i).dof);
        }
      });
    }
  }

 private:
  const Strip& strip(int i) const { return m.strips.strips[static_cast<std::size_t>(i)]; }
  bool alike(int i, int j) const { return strip(i).shape == strip(j).shape && strip(i).nv == strip(j).nv; }
  Slot<S> slotOf(int i) const {
    const Strip& s = strip(i);
    const JointMemory<S>& b = w.joints[s.batch];
    return {b.pose + s.slot, b.subspace ? b.subspace + s.slot : nullptr, b.stride, nullptr, b.bias ? b.bias + s.slot : nullptr, b.stride};
  }
  template <class T>
  static T of(const StripParents& parents, const T* array) {
    const T& all = array[parents.strip];
    if (parents.lane < 0) return all;
    T out;
    const auto* numbers = reinterpret_cast<const double*>(&all) + parents.lane;
    for (std::size_t k = 0; k < packs_in<S, T>; ++k) packsOf<S>(out)[k] = S(numbers[strip_lanes * k]);
    return out;
  }
  template <class T>
  static void give(const StripParents& parents, T* array, const T& value) {
    S* to = packsOf<S>(array[parents.strip]);
    const auto given = lanes<S>(parents.given);
    const auto there = lanes<S>(1U << std::max(parents.lane, 0));
    for (std::size_t k = 0; k < packs_in<S, T>; ++k) {
      const S part = select(given, packsOf<S>(value)[k], S(0));
      to[k] += parents.lane < 0 ? part : select(there, sumInAll(part), S(0));
    }
  }
};

/// The only joint of its type, which is most often a flying root: asked once, and given to all lanes.
template <class S>
void evaluateAlone(const TypeBatch& batch, const StripBatch& strips, const JointMemory<S>& memory, const double* q, const double* v) {
  double pose[12], subspace[6 * max_joint_nv], bias[6];
  JointBatch<double> call;
  call.count = 1;
  call.constants = strips.constants.data();
  call.constant_count = batch.constant_count;
  call.constants_stride = strip_lanes;
  call.stride = call.q_stride = call.v_stride = 1;
  call.q = q;
  call.pose = pose;
  if (memory.subspace) call.subspace = subspace;
  if (memory.subspace && v) {
    call.v = v;
    call.bias = bias;
  }
  batch.fast->kinematics(call);
  const auto spread = [](const double* from, int count, S* to) {
    for (int k = 0; k < count; ++k) to[k] = S(from[k]);
  };
  spread(pose, poseSize(batch.shape), memory.pose);
  if (call.subspace) spread(subspace, 6 * batch.nv, memory.subspace);
  if (call.bias) spread(bias, 6, memory.bias);
}

/// Poses, subspaces and (with v) biases of all joints, strip by strip in the lanes. False if a type that normalises coordinates, as
/// quaternions are, gave a pose that is not finite.
template <class S>
bool evaluateStrips(const CompactImpl& m, Workspace<S>& w, const double* q, const double* v) {
  bool finite = true;
  for (std::size_t b = 0; b < m.batches.size(); ++b) {
    const TypeBatch& batch = m.batches[b];
    const StripBatch& strips = m.strips.batches[b];
    const JointMemory<S>& memory = w.joints[b];
    const int items = strips.slots * strip_lanes;
    const auto check = [&] { finite = finite && posesFinite(batch, memory); };
    if (batch.count == 1) {
      evaluateAlone(batch, strips, memory, q + strips.q_index[0], v ? v + strips.v_index[0] : nullptr);
      check();
      continue;
    }
    // Component c of all items, four at a time.
    const auto gather = [&](const double* from, const std::vector<std::int64_t>& index, int size, S* to) {
      for (int c = 0; c < size; ++c)
        for (int k = 0; k < strips.slots; ++k) to[c * strips.slots + k] = gathered<S>(from + c, index.data() + strip_lanes * k);
    };
    JointBatch<double> call;
    call.count = items;
    call.constants = strips.constants.data();
    call.constant_count = batch.constant_count;
    call.constants_stride = call.stride = call.q_stride = call.v_stride = items;
    gather(q, strips.q_index, batch.nq, memory.q);
    call.q = reinterpret_cast<const double*>(memory.q);
    if (memory.v && v) {
      gather(v, strips.v_index, batch.nv, memory.v);
      call.v = reinterpret_cast<const double*>(memory.v);
      call.bias = reinterpret_cast<double*>(memory.bias);
    }
    call.pose = reinterpret_cast<double*>(memory.pose);
    call.subspace = reinterpret_cast<double*>(memory.subspace);
    batch.fast->kinematics(call);
    check();
  }
  return finite;
}

template <class S>
void gatherDofs(const StripPlan& plan, const double* from, S* to) {
  for (int k = 0; k < plan.dofs; ++k) to[k] = gathered<S>(from, plan.dof_index.data() + strip_lanes * k);
}

/// Lanes without a body repeat another's degree of freedom; that one's own lane is written last, or is the only one.
template <class S>
void scatterDofs(const StripPlan& plan, const S* from, double* to) {
  const auto* numbers = reinterpret_cast<const double*>(from);
  for (std::size_t s = 1; s < plan.strips.size(); ++s) {
    const Strip& strip = plan.strips[s];
    for (int l = 0; l < strip_lanes; ++l) {
      if (strip.body[l] < 0) continue;
      for (int k = 0; k < strip.nv; ++k) {
        const std::ptrdiff_t i = static_cast<std::ptrdiff_t>(strip.dof + k) * strip_lanes + l;
        to[plan.dof_index[static_cast<std::size_t>(i)]] = numbers[i];
      }
    }
  }
}

/// Of flying roots the half below the diagonal, from what putFlying wrote.
inline void mirrorFlyingRoots(const CompactImpl& m, double* M) {
  const std::ptrdiff_t n = m.nvx;
  for (int i = 1; i < m.bodies(); i = m.tree_end[static_cast<std::size_t>(i)]) {
    const BodyIndex& root = m.index[static_cast<std::size_t>(i)];
    if (!root.flying_root) continue;
    const std::ptrdiff_t v = root.idx_v, end = m.dof_end[static_cast<std::size_t>(v)];
    std::ptrdiff_t j = v + 6;
    for (; j + strip_lanes <= end; j += strip_lanes)
      for (const int c : {0, 2}) {
        Square<double, strip_lanes> square;
        square.read(M + j * n + v + c, n);
        square.transpose();
        square.write(M + (v + c) * n + j, n);
      }
    for (; j < end; ++j)
      for (int c = 0; c < 6; ++c) M[(v + c) * n + j] = M[j * n + v + c];
  }
}

template <class S>
PackedKernels stripKernels() {
  PackedKernels k;
  k.bytes = [](const CompactImpl& m) { return scratchBytes<StripScratch<S>>(m); };
  k.prepare = [](const CompactImpl& m, char* scratch) { makeScratch<StripScratch<S>>(scratch, m).w.R[0] = Mat3<S>::identity(); };
  k.rnea = [](const CompactImpl& m, char* scratch, const double* q, const double* v, const double* a, double* tau) {
    auto& s = *reinterpret_cast<StripScratch<S>*>(scratch);
    const Strips<S> strips{m, s.w};
    const bool finite = evaluateStrips(m, s.w, q, v);
    gatherDofs(m.strips, v, s.v);
    gatherDofs(m.strips, a, s.a);
    rneaOutward(strips, s.w, s.v, s.a, static_cast<const Force<S>*>(nullptr));
    rneaInward(strips, s.w, s.result);
    scatterDofs(m.strips, s.result, tau);
    addArmature(m, a, tau);
    addLosses(m, 1.0, v, tau);
    return finite;
  };
  k.massMatrix = [](const CompactImpl& m, char* scratch, const double* q, double* M) {
    auto& s = *reinterpret_cast<StripScratch<S>*>(scratch);
    const bool finite = evaluateStrips(m, s.w, q, nullptr);
    kernels::massMatrix(Strips<S>{m, s.w}, s.w, M);
    mirrorFlyingRoots(m, M);
    return finite;
  };
  k.articulate = [](const CompactImpl& m, char* scratch, const double* q, const double* v, const double* tau, int& failed) {
    auto& s = *reinterpret_cast<StripScratch<S>*>(scratch);
    const Strips<S> strips{m, s.w};
    const bool finite = evaluateStrips(m, s.w, q, v);
    gatherDofs(m.strips, v, s.v);
    gatherDofs(m.strips, tau, s.a);
    abaOutward(strips, s.w, s.v, static_cast<const Force<S>*>(nullptr));
    abaInward(strips, s.w, s.a);
    failed = 0;
    for (int l = 0; l < strip_lanes; ++l)
      if (s.w.failed[l] != 0 && failed == 0) failed = m.strips.strips[static_cast<std::size_t>(s.w.failed[l])].shown[l];
    return finite;
  };
  k.accelerate = [](const CompactImpl& m, char* scratch, const Vec3<double>& gravity, double* ddq) {
    auto& s = *reinterpret_cast<StripScratch<S>*>(scratch);
    abaSolve(Strips<S>{m, s.w}, s.w, cast<S>(gravity), s.result);
    scatterDofs(m.strips, s.result, ddq);
  };
  return k;
}

}  // namespace dyn::kernels
