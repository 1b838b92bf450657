// The recursions over bodies, or strips, that derivatives are made of: in what order, what they write, and where others find it.
#pragma once

#include "kernels/derivatives.hpp"
#include "kernels/strip_scratch.hpp"
#include "kernels/strips.hpp"

#include <algorithm>

namespace dyn::kernels {

/// What recursions over bodies, in S, have left of them and of their degrees of freedom.
template <class S>
struct LeftByBodies {
  using Scalar = S;
  const Workspace<S>& w;
  const DerivativeWorkspace<S>& d;

  const Vec3<S>& lever(int i) const { return w.r[i]; }  ///< of body i's origin, from its parent's
  const Vec3<S>& leverRate(int i) const { return d.shift_rate[i]; }
  const Vec3<S>& turning(int i) const { return w.w[i]; }  ///< angular velocity
  const Motion<S>& acceleration(int i) const { return w.acc[i]; }
  const Motion<S>& column(int dof) const { return w.dof[dof].S_; }
  const DofVariation<S>& variation(int dof) const { return d.dof[dof]; }
};

/// The same of recursions over strips: lane by lane.
struct LeftByStrips {
  using Scalar = Seated;
  const StripPlan& plan;
  const StripArrays& arrays;

  Vec3<Seated> lever(int i) const { return {place<Vec3>(arrays.levers, i)}; }
  Vec3<Seated> leverRate(int i) const { return {place<Vec3>(arrays.lever_rates, i)}; }
  Vec3<Seated> turning(int i) const { return {place<Vec3>(arrays.turnings, i)}; }
  Motion<Seated> acceleration(int i) const { return motion(place<Motion>(arrays.accelerations, i)); }
  Motion<Seated> column(int dof) const { return motion(dofPlace<DofFactor>(arrays.dofs, dof)); }
  DofVariation<Seated> variation(int dof) const {
    constexpr int size = strip_lanes * numbersIn<Motion>;
    const double* first = dofPlace<DofVariation>(arrays.variations, dof);
    return {motion(first), motion(first + size), motion(first + 2 * size)};
  }

 private:
  template <template <class> class T>
  static constexpr int numbersIn = sizeof(T<double>) / sizeof(double);
  template <template <class> class T>
  const double* place(const double* array, int body) const {
    const Seat& seat = plan.seats[static_cast<std::size_t>(body)];
    return array + strip_lanes * numbersIn<T> * seat.strip + seat.lane;
  }
  template <template <class> class T>
  const double* dofPlace(const double* array, int dof) const {
    const auto number = static_cast<std::size_t>(plan.dof_place[static_cast<std::size_t>(dof)]);
    return array + strip_lanes * numbersIn<T> * (number / strip_lanes) + number % strip_lanes;
  }
  static Motion<Seated> motion(const double* first) { return {{first}, {first + strip_lanes * numbersIn<Vec3>}}; }
};

/// One over the bodies. Numbers of S are as many numbers of T in memory.
template <class Order, class S, class T>
struct BodyRecursion {
  using Scalar = S;
  static constexpr bool over_strips = false;
  Order order;
  DerivativeWorkspace<S>& d;

  /// Numbers of the degrees of freedom, as it reads them.
  const S* in(const T* numbers) const { return reinterpret_cast<const S*>(numbers); }
  const S* velocities(const T* v) const { return in(v); }
  const S* accelerations(const T* a) const { return in(a); }
  const Force<T>* external(const Force<T>* fext) const { return fext; }
  /// As it writes them.
  S* out(T* numbers) const { return reinterpret_cast<S*>(numbers); }
  /// By lane the first body whose pivot vanished, or 0.
  void failures(int* to) const { std::copy(std::begin(order.w.failed), std::end(order.w.failed), to); }
};

/// How bodies are walked one after the other.
template <class S>
struct OrderOf {
  using type = Bodies<S>;
  static type over(const CompactImpl& m, Workspace<S>& w) { return {m, w}; }
};

/// Of the joints that have been asked into w.
template <class S>
auto recursion(const CompactImpl& m, Workspace<S>& w, DerivativeWorkspace<S>& d) {
  if constexpr (abreast<S> == 1) {
    return BodyRecursion<typename OrderOf<S>::type, S, S>{OrderOf<S>::over(m, w), d};
  } else {
    d.bodies.joints = reinterpret_cast<JointMemory<Vectored>*>(w.joints);
    d.bodies.R[0] = d.bodies.product[0] = Mat3<Vectored>::identity();
    return BodyRecursion<AlignedBodies, Vectored, S>{{{{m, d.bodies}}}, *d.vectored};
  }
}

/// What recursions over strips write, and what they read in lanes.
template <class S>
struct StripDerivatives : StripScratch<S> {
  DerivativeWorkspace<S> d;
  Force<S>* fext;

  static std::size_t carve(StripDerivatives& s, const CompactImpl& m, char* base) {
    Arena arena(base);
    StripScratch<S>::carve(s, m, arena);
    s.d = {};
    carveRecursions(s.d, m.strips.strips.size(), static_cast<std::size_t>(m.strips.dofs), arena);
    arena.take(s.fext, m.strips.strips.size());
    return arena.used();
  }
  StripArrays arrays() const {
    const auto numbers = [](const auto* x) { return reinterpret_cast<const double*>(x); };
    const Workspace<S>& own = this->w;
    return {numbers(own.r), numbers(d.shift_rate), numbers(own.w), numbers(own.acc), numbers(own.dof), numbers(d.dof)};
  }
};

/// One over strips, of a model without joints whose subspace varies with q.
template <class S>
struct StripRecursion {
  using Scalar = S;
  static constexpr bool over_strips = true;
  Strips<S, false> order;
  DerivativeWorkspace<S>& d;
  StripDerivatives<S>& s;

  const S* velocities(const double* v) const { return gatherDofs(order.m.strips, v, s.v); }
  const S* accelerations(const double* a) const { return gatherDofs(order.m.strips, a, s.a); }
  const Force<S>* external(const Force<double>* fext) const {
    if (fext == nullptr) return nullptr;
    static constexpr double none[sizeof(Force<double>) / sizeof(double)] = {};
    const StripPlan& plan = order.m.strips;
    for (std::size_t i = 1; i < plan.strips.size(); ++i) {
      const double* from[strip_lanes];
      for (int l = 0; l < strip_lanes; ++l) {
        const int body = plan.strips[i].body[l];
        from[l] = body < 0 ? none : reinterpret_cast<const double*>(fext + body);
      }
      s.fext[i] = gatheredLanes<S, Force<S>, 1>(from);
    }
    return s.fext;
  }
  /// Numbers of the degrees of freedom in lanes, and from there to where they belong.
  S* out(double*) const { return s.result; }
  void put(const S* numbers, double* to) const { scatterDofs(order.m.strips, numbers, to); }
  void failures(int* to) const { *to = firstFailure(order.m, order.w); }
};

/// Poses of joints that have been asked one after the other.
template <class S>
void seatPoses(const CompactImpl& m, const JointMemory<double>* from, const JointMemory<S>* to) {
  for (std::size_t b = 0; b < m.batches.size(); ++b) {
    const StripBatch& strips = m.strips.batches[b];
    const int size = poseSize(m.batches[b].shape);
    if (m.batches[b].count == 1) {
      for (int c = 0; c < size; ++c) to[b].pose[c] = S(from[b].pose[c]);
      continue;
    }
    for (int c = 0; c < size; ++c)
      for (int k = 0; k < strips.slots; ++k)
        to[b].pose[c * strips.slots + k] = gathered<S>(from[b].pose + c * from[b].stride, strips.pose_index.data() + strip_lanes * k);
  }
}

/// Calls use(recursion): over strips, in the lanes of Quad, if wanted and where d has memory for them.
template <class Quad, class S, class Use>
decltype(auto) withRecursion(const CompactImpl& m, Workspace<S>& w, DerivativeWorkspace<S>& d, bool wanted, Use&& use) {
  if constexpr (std::is_same_v<S, double> && lanes_of<Quad> == strip_lanes) {
    if (wanted && d.strips) {
      auto& s = *reinterpret_cast<StripDerivatives<Quad>*>(d.strips);
      seatPoses(m, w.joints, s.w.joints);
      return use(StripRecursion<Quad>{{m, s.w}, s.d, s});
    }
  }
  return use(recursion(m, w, d));
}

}  // namespace dyn::kernels
