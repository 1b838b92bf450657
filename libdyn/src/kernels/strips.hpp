// Recursions over strips: the kernels for bodies, with four joints in the lanes of a pack.
#pragma once

#include "kernels/aba.hpp"
#include "kernels/crba.hpp"
#include "kernels/evaluate.hpp"
#include "kernels/losses.hpp"
#include "kernels/rnea.hpp"
#include "kernels/scratch.hpp"
#include "kernels/strip_scratch.hpp"

#include <dyn_sdk/pack.hpp>

#include <algorithm>

namespace dyn::kernels {

/// Four numbers from where `index` says. Four loads are sooner done than the processor's own gathering.
template <class S>
S gathered(const double* from, const std::int64_t* index) {
  typedef double Four __attribute__((vector_size(32)));
  static_assert(sizeof(Four) == sizeof(S) && strip_lanes == 4);
  return typename S::Batch(Four{from[index[0]], from[index[1]], from[index[2]], from[index[3]]});
}

/// Each lane's numbers from the lane that `lanes` names.
template <class S, class T>
T gatheredLanes(const T& from, const std::int64_t* lanes) {
  const auto* numbers = reinterpret_cast<const double*>(&from);
  T out;
  S* to = reinterpret_cast<S*>(&out);
  // Limbs that hang on one body are the usual case.
  const bool one = lanes[1] == lanes[0] && lanes[2] == lanes[0] && lanes[3] == lanes[0];
  for (std::size_t k = 0; k < sizeof(T) / sizeof(S); ++k)
    to[k] = one ? S(numbers[strip_lanes * k + static_cast<std::size_t>(lanes[0])]) : gathered<S>(numbers + strip_lanes * k, lanes);
  return out;
}

template <class S>
struct Strips {
  const CompactImpl& m;
  Workspace<S>& w;

  const BodyConstants<S>& constants(int i) const { return reinterpret_cast<const BodyConstants<S>*>(m.strips.constants.data())[i]; }
  S mass(int i) const { return constants(i).mass; }
  S armature(int dof) const { return S::load(m.strips.armature.data() + strip_lanes * dof); }
  Vec3<S> gravity() const { return cast<S>(m.gravity); }
  bool isRoot(int i) const { return strip(i).parent == 0; }

  /// What the parents in other lanes have, in the lanes of their children.
  template <class T>
  T parent(const T* array, int i) const {
    const Strip& s = strip(i);
    return s.aligned ? array[s.parent] : gatheredLanes<S>(array[s.parent], s.parent_lane);
  }
  template <class T>
  void addToParent(T* array, int i, const T& value) const {
    const Strip& s = strip(i);
    if (s.aligned) {
      array[s.parent] += value;
      return;
    }
    const T copy = value;
    const auto* from = reinterpret_cast<const double*>(&copy);
    S* to = reinterpret_cast<S*>(array + s.parent);
    for (int l = 0; l < strip_lanes; ++l) {
      if (s.body[l] < 0) continue;
      const S here = only(static_cast<int>(s.parent_lane[l]));
      for (std::size_t k = 0; k < sizeof(T) / sizeof(S); ++k) to[k] += here * S(from[strip_lanes * static_cast<std::ptrdiff_t>(k) + l]);
    }
  }

  template <class T>
  void handOver(T* array, int i, const T& value) const {
    const Strip& s = strip(i);
    if (!s.last_child) return addToParent(array, i, value);
    if (s.aligned) {
      array[s.parent] = value;
    } else {
      array[s.parent] = T{};
      addToParent(array, i, value);
    }
  }
  bool isLeaf(int i) const { return strip(i).leaf; }

  using Entries = double;
  class Entry {
   public:
    Entry(const Strips& strips, double* M, int i, int iv) : strips_(strips.m.strips), n_(strips.m.nvx), strip_(&strips_.strips[index(i)]) {
      for (int l = 0; l < strip_lanes; ++l) {
        const std::ptrdiff_t dof = strips_.dof_index[index(strip_lanes * iv + l)];
        row_[l] = strip_->body[l] < 0 ? nullptr : M + dof;
        column_[l] = M + dof * n_;
      }
    }
    bool isRoot() const { return strip_->parent == 0; }
    void climb() {
      if (!strip_->aligned) {
        in_place_ = false;
        for (std::int64_t& lane : lanes_) lane = strip_->parent_lane[lane];
      }
      strip_ = &strips_.strips[index(strip_->parent)];
    }
    template <class T>
    T read(const T* array) const {
      return from(array[strip_ - strips_.strips.data()]);
    }
    int nv() const { return strip_->nv; }
    bool flyingRoot() const { return strip_->shape == Shape::free && isRoot(); }
    bool turnsOnly() const { return dyn::turnsOnly(strip_->shape); }
    Motion<S> column(const Workspace<S>& workspace, int l) const { return from(workspace.dof[strip_->dof + l].S_); }
    void enter(int k, int l, const S& value) const {
      const std::int64_t* other = strips_.dof_index.data() + strip_lanes * (strip_->dof + l);
      const auto* numbers = reinterpret_cast<const double*>(&value);
      for (int lane = 0; lane < strip_lanes; ++lane) {
        if (row_[lane] == nullptr) continue;
        const std::ptrdiff_t j = other[lanes_[lane]];
        column_[lane][k * n_ + j] = row_[lane][k + j * n_] = numbers[lane];
      }
    }

   private:
    static std::size_t index(int i) { return static_cast<std::size_t>(i); }
    /// In the lanes of the joint.
    template <class T>
    T from(const T& there) const {
      return in_place_ ? there : gatheredLanes<S>(there, lanes_);
    }
    const StripPlan& strips_;
    std::ptrdiff_t n_;
    const Strip* strip_;
    double *row_[strip_lanes], *column_[strip_lanes];  ///< of the joint's first degree of freedom; null rows: lanes without a body
    bool in_place_ = true;
    std::int64_t lanes_[strip_lanes] = {0, 1, 2, 3};  ///< where what was reached is, by the joint's lane
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
  /// One in a lane, zero in the others.
  static S only(int lane) {
    alignas(64) static constexpr double unit[2 * strip_lanes - 1] = {0, 0, 0, 1, 0, 0, 0};
    return S::load(unit + strip_lanes - 1 - lane);
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
      if (s.w.failed[l] != 0 && failed == 0) failed = m.strips.strips[static_cast<std::size_t>(s.w.failed[l])].body[l];
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
