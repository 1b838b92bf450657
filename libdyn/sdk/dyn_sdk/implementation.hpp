// SPDX-License-Identifier: BSD-2-Clause
// Implements the virtual interface by an author's class: loops over the batch, the author's closed forms, and derived functions in place of others.
#pragma once

#include <dyn_sdk/configuration.hpp>
#include <dyn_sdk/joint_plugin.hpp>
#include <dyn_sdk/pack.hpp>

#include <algorithm>
#include <limits>

/// Inlines everything that an author's functions call into the loop over packs, except in sanitized builds, whose code would grow too much.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define DYN_INLINE_ALL
#else
#define DYN_INLINE_ALL [[gnu::flatten]]
#endif

namespace dyn::sdk {

/// The author wrote these members: pose, subspace, bias.
/// @{
template <class A>
concept HasPose = requires(const double* q, const Constants& c) { A::pose(q, c); };
template <class A>
concept HasSubspace = requires(const double* q, const Constants& c, Motion<double>* S) { A::subspace(q, c, S); };
template <class A>
concept HasBias = requires(const double* q, const double* v, const Constants& c) { A::bias(q, v, c); };
/// @}

/// Runs an author's functions, which must not throw, since the callers need their results. An exception is printed and ends the process.
template <class Call>
void neverThrowing(const char* type, const Call& call) noexcept {
  try {
    call();
  } catch (const std::exception& e) {
    std::fprintf(stderr, "joint type '%s': one of its functions threw: %s\n", type, e.what());
    std::terminate();
  } catch (...) {
    std::fprintf(stderr, "joint type '%s': one of its functions threw something that is no std::exception\n", type);
    std::terminate();
  }
}

/// Implements JointType by an author's class. Exceptions of functions that must not throw end the process.
template <class Author>
class JointTypeOf final : public JointType {
 public:
  static constexpr int nv = Author::nv,                            ///< degrees of freedom
      nq = Author::nq;                                             ///< coordinates
  static constexpr bool is_dense = Author::shape == Shape::dense;  ///< whether the subspace varies with q
  using Space = Configuration<Author>;                             ///< the configuration space
  static_assert(nq >= nv && nv >= 0 && nv <= max_joint_nv && nq <= max_joint_nq, "1 to 6 degrees of freedom, at most 7 coordinates");
  static_assert(!is_dense || !Space::curved || !Author::branch_free || HasRates<Author>,
                "branch_free with its own integrate: write rates(q, v, c, dq), dq/dt without branches, as integrate has some");

  /// Implements JointType.
  /// @{
  const JointTypeInfo& info() const noexcept override {
    static constexpr JointTypeInfo description{Author::name,
                                               Author::summary,
                                               Author::structure,
                                               (!is_dense || HasSubspace<Author> ? closed_subspace : 0u) |
                                                   (!is_dense || HasBias<Author> ? closed_bias : 0u) | (Space::own ? closed_configuration : 0u) |
                                                   (is_dense && Space::curved ? own_rates : 0u),
                                               Author::parameters.data(),
                                               static_cast<int>(Author::parameters.size())};
    return description;
  }

  bool prepare(const ParameterArgument* args, JointInstance& out, char* message, int size) const noexcept override {
    const Refusal refuse{message, size};
    return guarded(refuse, [&] {
      out.shape = Author::shape;
      out.nq = nq;
      out.nv = nv;
      out.constant_count = Author::constantCount(args);
      return Author::check(args, out, refuse) && tryConstants(out.constant_count, placeNumbers(Author::parameters, args, nullptr), refuse,
                                                              [&](double* trial) { Author::constants(args, trial); });
    });
  }
  void constants(const ParameterArgument* args, double* out) const noexcept override {
    // prepare() has refused parameters for which this throws, so memory has run out. NaNs show it.
    char reason[64];
    if (!guarded(Refusal{reason, sizeof reason}, [&] { return Author::constants(args, out), true; }))
      for (int k = 0; k < Author::constantCount(args); ++k) out[k] = std::numeric_limits<double>::quiet_NaN();
  }

  void kinematics(const JointBatch<double>& batch) const noexcept override {
    neverThrowing(Author::name, [&] { evaluate(batch); });
  }
  void kinematics(const JointBatch<float>& batch) const noexcept override {
    neverThrowing(Author::name, [&] { evaluate(batch); });
  }
  void kinematics(const JointBatch<Dual<double>>& batch) const noexcept override {
    neverThrowing(Author::name, [&] { evaluateEach<Dual<double>>(batch); });
  }
  void kinematics(const JointBatch<Dual<Dual<double>>>& batch) const noexcept override {
    neverThrowing(Author::name, [&] { evaluateEach<Dual<Dual<double>>>(batch); });
  }
  bool kinematics([[maybe_unused]] const JointBatch<Traced>& batch) const noexcept override {
    if constexpr (Author::branch_free) neverThrowing(Author::name, [&] { evaluateEach<Traced>(batch); });
    return Author::branch_free;
  }

  void neutral(const ConfigurationBatch<double>& b) const noexcept override {
    eachItem(b, [&](int i, const Constants& c) {
      double q[nq + 1] = {};
      Space::neutral(c, q);
      store<nq>(q, b.q_out, b.q_stride, i);
    });
  }

  void integrate(const ConfigurationBatch<double>& b) const noexcept override {
    eachItem(b, [&](int i, const Constants& c) {
      double q[nq + 1], v[nv + 1], out[nq + 1];
      load<nq>(b.q0, b.q_stride, i, q);
      load<nv>(b.v, b.v_stride, i, v);
      if (b.q_out) {
        Space::integrate(q, v, c, out);
        store<nq>(out, b.q_out, b.q_stride, i);
      }
      if (!b.J_q) return;
      double Jq[nv * nv + 1], Jv[nv * nv + 1];
      Space::dIntegrate(q, v, c, Jq, Jv);
      storeJacobians(Jq, Jv, b, i);
    });
  }

  void difference(const ConfigurationBatch<double>& b) const noexcept override {
    eachItem(b, [&](int i, const Constants& c) {
      double q0[nq + 1], q1[nq + 1], out[nv + 1];
      load<nq>(b.q0, b.q_stride, i, q0);
      load<nq>(b.q1, b.q_stride, i, q1);
      if (b.v_out) {
        Space::difference(q0, q1, c, out);
        store<nv>(out, b.v_out, b.v_stride, i);
      }
      if (!b.J_q) return;
      double J0[nv * nv + 1], J1[nv * nv + 1];
      Space::dDifference(q0, q1, c, J0, J1);
      storeJacobians(J0, J1, b, i);
    });
  }

  void normalize(const ConfigurationBatch<double>& b) const noexcept override {
    eachItem(b, [&](int i, const Constants& c) {
      double q[nq + 1];
      load<nq>(b.q0, b.q_stride, i, q);
      const double distance = Space::normalize(c, q);
      if (b.q_out) store<nq>(q, b.q_out, b.q_stride, i);
      if (b.v_out) b.v_out[i] = distance;
    });
  }

  void rates(const ConfigurationBatch<Dual<double>>& b) const noexcept override {
    neverThrowing(Author::name, [&] { evaluateRates(b); });
  }
  bool rates([[maybe_unused]] const ConfigurationBatch<Traced>& b) const noexcept override {
    if constexpr (Author::branch_free) neverThrowing(Author::name, [&] { evaluateRates(b); });
    return Author::branch_free;
  }
  /// @}

 private:
  // Items of a batch are read one by one as numbers, or as packs of neighbours. T is the type in the batch's arrays, S the type of the computation.
  template <class S, class T>
  static S read(const T* from) {
    if constexpr (lanes_of<S> > 1) {
      return S::load(from);
    } else {
      return static_cast<S>(*from);
    }
  }
  template <class S, class T>
  static void write(const S& value, T* to) {
    if constexpr (lanes_of<S> > 1) {
      value.store(to);
    } else {
      *to = static_cast<T>(value);
    }
  }
  template <int N, class S, class T>
  static void load(const T* base, std::ptrdiff_t stride, int i, S* out) {
    for (int k = 0; k < N; ++k) out[k] = read<S>(base + k * stride + i);
  }
  template <int N, class S, class T>
  static void store(const S* in, T* base, std::ptrdiff_t stride, int i) {
    for (int k = 0; k < N; ++k) write(in[k], base + k * stride + i);
  }

  template <class Each>
  static void eachItem(const ConfigurationBatch<double>& b, const Each& each) noexcept {
    neverThrowing(Author::name, [&] {
      for (int i = 0; i < b.count * b.lanes; ++i) each(i, constantsOf(b, i));
    });
  }
  static void storeJacobians(const double* first, const double* second, const ConfigurationBatch<double>& b, int i) {
    store<nv * nv>(first, b.J_q, b.j_stride, i);
    store<nv * nv>(second, b.J_v, b.j_stride, i);
  }

  template <class S>
  static void evaluateRates([[maybe_unused]] const ConfigurationBatch<S>& b) {
    if constexpr (is_dense)
      for (int i = 0; i < b.count * b.lanes; ++i) {
        S q[nq + 1], v[nv + 1], dq[nq + 1];
        load<nq>(b.q0, b.q_stride, i, q);
        load<nv>(b.v, b.v_stride, i, v);
        Space::rates(q, v, constantsOf(b, i), dq);
        store<nq>(dq, b.q_out, b.q_stride, i);
      }
  }

  /// Constants of item i, or of the joint whose lanes begin at item i.
  template <class Batch>
  static Constants constantsOf(const Batch& b, int i) {
    return {b.constants + i / b.lanes, b.constants_stride, b.constant_count};
  }

  template <class T>
  static void evaluate(const JointBatch<T>& b) {
    const int items = b.count * b.lanes;
#if DYN_HAS_PACKS
    if constexpr (Author::branch_free) {
      // The items of a pack are lanes of one joint, or neighbouring joints. Neighbours must have no constants, or functions that take packs of them.
      constexpr int width = Pack<T>::lanes;
      if (b.constant_count == 0 || (b.lanes == 1 && takes_pack_constants<T>)) {
        if (evaluateNeighbours<width>(b, items)) return;
      } else if (b.lanes % width == 0) {
        return evaluatePacks<Pack<T>>(b, items);
      }
    }
#endif
    evaluateEach<double>(b);
  }

  /// Computes number by number, in S.
  template <class S, class T>
  static void evaluateEach(const JointBatch<T>& b) {
    for (int i = 0; i < b.count * b.lanes; ++i) evaluateAt<S>(b, i, constantsOf(b, i));
  }

#if DYN_HAS_PACKS
  /// Whether the author's functions take constants that differ from lane to lane. Constants are doubles, so this needs packs of doubles.
  template <class T>
  static constexpr bool takes_pack_constants = [] {
    if constexpr (!std::is_same_v<T, double>) {
      return false;
    } else {
      using S = Pack<T>;
      using C = PackConstants<S>;
      const bool pose = !HasPose<Author> || requires(const S* q, const C& c) { Author::pose(q, c); };
      const bool subspace = !HasSubspace<Author> || requires(const S* q, const C& c, Motion<S>* m) { Author::subspace(q, c, m); };
      const bool bias = !HasBias<Author> || requires(const S* q, const C& c) { Author::bias(q, q, c); };
      const bool coordinates = HasPose<Author> || requires(const S* q, const C& c, S* p) { Author::coordinates(q, c, p); };
      const bool rates = !HasRates<Author> || requires(const S* q, const C& c, S* dq) { Author::rates(q, q, c, dq); };
      return pose && subspace && bias && coordinates && rates;
    }
  }();

  /// Computes at least as many items as fill one pack. A last pack that they do not fill also takes the items before them, which are computed again.
  template <class P, class T>
  static void evaluatePacks(const JointBatch<T>& b, int items) {
    if constexpr (takes_pack_constants<T>) {
      if (b.lanes == 1)
        return evaluatePacks<P>(b, items, [&](int i) { return PackConstants<P>(b.constants + i, b.constants_stride, b.constant_count); });
    }
    evaluatePacks<P>(b, items, [&](int i) { return constantsOf(b, i); });
  }
  template <class P, class T, class ConstantsAt>
  DYN_INLINE_ALL static void evaluatePacks(const JointBatch<T>& b, int items, ConstantsAt&& constants_at) {
    for (int next = 0; next < items; next += P::lanes) {
      const int i = std::min(next, items - P::lanes);
      evaluateAt<P>(b, i, constants_at(i));
    }
  }

  /// Computes in packs of `width` lanes, or of fewer if the items do not fill one. Returns false if they fill no pack.
  template <int width, class T>
  static bool evaluateNeighbours(const JointBatch<T>& b, int items) {
    if constexpr (width * sizeof(T) < narrowest_pack) {
      return false;
    } else {
      if (items < width) return evaluateNeighbours<width / 2>(b, items);
      evaluatePacks<SizedPack<T, width>>(b, items);
      return true;
    }
  }
#endif

  template <class S, class T, class C>
  static void evaluateAt(const JointBatch<T>& b, int i, const C& c) {
    S q[nq + 1];
    load<nq>(b.q, b.q_stride, i, q);
    if constexpr (is_dense && nv == 1 && !HasSubspace<Author> && !HasBias<Author>) {
      if (b.subspace) return derivedAlongOne(b, i, static_cast<const S*>(q), c);
    }
    if constexpr (HasPose<Author>) {
      storePose(Author::pose(static_cast<const S*>(q), c), b, i);
    } else {
      S pose[poseSize(Author::shape)];
      Author::coordinates(static_cast<const S*>(q), c, pose);
      store<poseSize(Author::shape)>(pose, b.pose, b.stride, i);
    }
    if constexpr (is_dense) dense(b, i, static_cast<const S*>(q), c);
  }

  template <class S, class T>
  static void storePose(const SE3<S>& X, const JointBatch<T>& b, int i) {
    store<9>(X.R.m, b.pose, b.stride, i);
    store<3>(&X.p.x, b.pose + 9 * b.stride, b.stride, i);
  }

  template <class S, class T, class C>
  static void derivedAlongOne(const JointBatch<T>& b, int i, const S* q, const C& c) {
    const S one(1);
    const PoseRates<S> along = derivedRates<Author>(q, &one, c);
    storePose(along.pose, b, i);
    storeMotion(along.velocity, b.subspace, b.stride, i);
    if (!b.v || !b.bias) return;
    const S v = read<S>(b.v + i);
    storeMotion((v * v) * along.bias, b.bias, b.stride, i);
  }

  template <class S, class T, class C>
  static void dense(const JointBatch<T>& b, int i, const S* q, const C& c) {
    if (b.subspace) {
      Motion<S> columns[nv];
      if constexpr (HasSubspace<Author>) {
        Author::subspace(q, c, columns);
      } else {
        for (int k = 0; k < nv; ++k) columns[k] = derivedColumn<Author>(q, c, k);
      }
      for (int k = 0; k < nv; ++k) storeMotion(columns[k], b.subspace + 6 * k * b.stride, b.stride, i);
    }
    if (b.v && b.bias) {
      S v[nv];
      load<nv>(b.v, b.v_stride, i, v);
      if constexpr (HasBias<Author>) {
        storeMotion(Author::bias(q, static_cast<const S*>(v), c), b.bias, b.stride, i);
      } else {
        storeMotion(derivedRates<Author>(q, static_cast<const S*>(v), c).bias, b.bias, b.stride, i);
      }
    }
  }

  template <class S, class T>
  static void storeMotion(const Motion<S>& m, T* base, std::ptrdiff_t stride, int i) {
    store<3>(&m.linear.x, base, stride, i);
    store<3>(&m.angular.x, base + 3 * stride, stride, i);
  }
};

/// Returns the only instance of a joint type in this plugin, as a JointType.
template <class Author>
const void* instance() {
  static constexpr JointTypeOf<Author> type;
  return static_cast<const JointType*>(&type);
}

}  // namespace dyn::sdk

/// Exports joint types. Use it once in a shared object.
#define DYN_EXPORT_JOINTS(...) DYN_EXPORT_PLUGIN(DYN_TYPES(__VA_ARGS__), DYN_TYPES())
/// A list of types for DYN_EXPORT_PLUGIN.
#define DYN_TYPES(...) ::dyn::sdk::TypeList<__VA_ARGS__>
/// Exports joint and coupling types, each a DYN_TYPES list. Use it once in a shared object.
#define DYN_EXPORT_PLUGIN(JOINTS, COUPLINGS)                                                                  \
  extern "C" __attribute__((visibility("default"))) const dyn_plugin_descriptor* dyn_plugin_descriptor_v1() { \
    return ::dyn::sdk::describe(JOINTS{}, COUPLINGS{});                                                       \
  }
