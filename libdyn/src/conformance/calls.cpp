// SPDX-License-Identifier: BSD-2-Clause
// Checks how a type implements the interface's calls, whatever the numbers mean.
#include "conformance/checks.hpp"
#include "floating_point.hpp"

#include <cstring>
#include <thread>

namespace dyn::conformance {

namespace {

constexpr double sentinel = 0x1.23456789abcdep+77;  // a number that no joint computes

std::size_t size(std::ptrdiff_t n) { return static_cast<std::size_t>(n); }

/// Component c of item i is at [c * stride + i]. There are two items and one component more than the batch has, which the type must not write.
template <class S>
struct Array {
  Array(int count, int components) : stride(count + 2), data(size(stride * (components + 1)), S(sentinel)), count_(count), components_(components) {}
  S& at(int component, int i) { return data[size(component * stride + i)]; }
  bool guardsIntact() const {
    for (std::ptrdiff_t k = 0; k < static_cast<std::ptrdiff_t>(data.size()); ++k)
      if ((k / stride >= components_ || k % stride >= count_) && valueOf(data[size(k)]) != valueOf(S(sentinel))) return false;
    return true;
  }
  bool sameBits(const Array& other) const { return std::memcmp(data.data(), other.data.data(), data.size() * sizeof(S)) == 0; }

  std::ptrdiff_t stride;
  std::vector<S> data;

 private:
  int count_, components_;
};

/// Makes all calls of the interface on one batch, with all memory allocated beforehand.
class BatchCalls {
 public:
  static constexpr int count = 16;  // as many lanes as the widest packs have, so that types with constants use packs, too

  /// `shared`: the items are states of one joint, with the same constants. Else they are joints, each with constants of its own.
  BatchCalls(const JointProbe& joint, bool shared, std::uint64_t seed)
      : joint_(joint), shared_(shared), nq_(joint.nq()), nv_(joint.nv()), constants_(count, joint.instance().constant_count) {
    Random random(seed);
    for (int i = 0; i < count; ++i) {
      samples.push_back(randomConfiguration(joint, random));
      velocities.push_back(random.vector(nv_, 1));
      for (int k = 0; k < nq_; ++k) {
        q_.at(k, i) = samples.back()[k];
        float_q_.at(k, i) = static_cast<float>(samples.back()[k]);
        dual_q_.at(k, i) = Dual<double>(samples.back()[k], k == 0 ? 1.0 : 0.5);
      }
      for (int k = 0; k < nv_; ++k) {
        v_.at(k, i) = velocities.back()[k];
        float_v_.at(k, i) = static_cast<float>(velocities.back()[k]);
        dual_v_.at(k, i) = Dual<double>(velocities.back()[k], 0.25);
      }
      for (int k = 0; k < joint.instance().constant_count; ++k) constants_.at(k, i) = joint.constants()[size(k)];
    }
  }

  void run() {
    kinematics(q_, v_, pose_, subspace_, bias_);
    kinematics(float_q_, float_v_, float_pose_, float_subspace_, float_bias_);
    kinematics(dual_q_, dual_v_, dual_pose_, dual_subspace_, dual_bias_);
    ConfigurationBatch<double> b;
    b.count = count;
    b.constants = constants_.data.data();
    b.constants_stride = constants_.stride;
    b.q_stride = b.v_stride = b.j_stride = q_.stride;
    b.q_out = neutral_.data.data();
    joint_.type().neutral(b);
    b.q0 = q_.data.data();
    b.v = v_.data.data();
    b.q_out = end_.data.data();
    b.J_q = J_q_.data.data();
    b.J_v = J_v_.data.data();
    joint_.type().integrate(b);
    b.q1 = end_.data.data();
    b.v_out = difference_.data.data();
    b.J_q = J_0_.data.data();
    b.J_v = J_1_.data.data();
    joint_.type().difference(b);
    b.q_out = normal_.data.data();
    b.v_out = distance_.data.data();
    joint_.type().normalize(b);
  }

  bool guardsIntact() const {
    bool ok = true;
    for (const Array<double>* a : plain()) ok = ok && a->guardsIntact();
    for (const Array<Dual<double>>* a : duals()) ok = ok && a->guardsIntact();
    for (const Array<float>* a : {&float_pose_, &float_subspace_, &float_bias_}) ok = ok && a->guardsIntact();
    return ok;
  }
  bool sameBits(const BatchCalls& other) const {
    bool same = true;
    for (std::size_t i = 0; i < plain().size(); ++i) same = same && plain()[i]->sameBits(*other.plain()[i]);
    for (std::size_t i = 0; i < duals().size(); ++i) same = same && duals()[i]->sameBits(*other.duals()[i]);
    return same;
  }
  /// Compares the results with those of calls on one joint in one state.
  void compareWithSingles(Worst& worst) {
    for (int i = 0; i < count; ++i) {
      const Eigen::VectorXd &q = samples[size(i)], &v = velocities[size(i)];
      const std::string where = "item " + std::to_string(i) + (shared_ ? " of a batch of states" : "") + ", " + show("q", q);
      const JointMotion<double> alone = joint_.motion(q.data(), v.data());
      double pose[12];
      for (int k = 0; k < poseSize(joint_.instance().shape); ++k) pose[k] = pose_.at(k, i);
      const SE3<double> X = poseFromComponents(joint_.instance().shape, pose);
      for (int r = 0; r < 3; ++r) {
        worst.add(std::fabs(X.p[r] - alone.pose.p[r]), where);
        for (int c = 0; c < 3; ++c) worst.add(std::fabs(X.R(r, c) - alone.pose.R(r, c)), where);
      }
      if (joint_.instance().shape == Shape::dense)
        for (int r = 0; r < 3; ++r) {
          for (int k = 0; k < nv_; ++k) {
            worst.add(std::fabs(subspace_.at(6 * k + r, i) - alone.columns[k].linear[r]), where);
            worst.add(std::fabs(subspace_.at(6 * k + 3 + r, i) - alone.columns[k].angular[r]), where);
          }
          worst.add(std::fabs(bias_.at(r, i) - alone.bias.linear[r]), where);
          worst.add(std::fabs(bias_.at(3 + r, i) - alone.bias.angular[r]), where);
        }
      const Eigen::VectorXd end = joint_.integrate(q, v), zero = joint_.neutral(), back = joint_.difference(q, end);
      for (int k = 0; k < nq_; ++k) worst.add(std::max(std::fabs(end_.at(k, i) - end[k]), std::fabs(neutral_.at(k, i) - zero[k])), where);
      for (int k = 0; k < nv_; ++k) worst.add(std::fabs(difference_.at(k, i) - back[k]), where);
    }
  }
  /// Compares floats with doubles, relative to the item's largest entry of the same kind and at least to 1.
  void compareFloats(Worst& worst) {
    const auto compare = [&](Array<float>& a, Array<double>& b, int components) {
      for (int i = 0; i < count; ++i) {
        double size = 1;
        for (int k = 0; k < components; ++k) size = std::max(size, std::fabs(b.at(k, i)));
        for (int k = 0; k < components; ++k)
          worst.add(std::fabs(static_cast<double>(a.at(k, i)) - b.at(k, i)) / size,
                    "item " + std::to_string(i) + ", " + show("q", samples[static_cast<std::size_t>(i)]));
      }
    };
    compare(float_pose_, pose_, poseSize(joint_.instance().shape));
    if (joint_.instance().shape != Shape::dense) return;
    compare(float_subspace_, subspace_, 6 * nv_);
    compare(float_bias_, bias_, 6);
  }
  /// Sets the q of item i to NaN; the others' results must not change.
  void poison(int i) {
    for (int k = 0; k < nq_; ++k) q_.at(k, i) = std::numeric_limits<double>::quiet_NaN();
  }
  bool samePoseExcept(int skipped, const BatchCalls& other) {
    for (int i = 0; i < count; ++i)
      for (int k = 0; i != skipped && k < poseSize(joint_.instance().shape); ++k)
        if (pose_.at(k, i) != other.pose_.data[size(k * pose_.stride + i)]) return false;
    return true;
  }

 private:
  template <class S>
  void kinematics(Array<S>& q, Array<S>& v, Array<S>& pose, Array<S>& subspace, Array<S>& bias) {
    const bool dense = joint_.instance().shape == Shape::dense;
    JointBatch<S> b;
    b.count = shared_ ? 1 : count;
    b.lanes = shared_ ? count : 1;
    b.constants = constants_.data.data();
    b.constant_count = joint_.instance().constant_count;
    b.constants_stride = constants_.stride;
    b.q = q.data.data();
    b.v = v.data.data();
    b.q_stride = b.v_stride = b.stride = q.stride;
    b.pose = pose.data.data();
    b.subspace = dense ? subspace.data.data() : nullptr;
    b.bias = dense ? bias.data.data() : nullptr;
    joint_.type().kinematics(b);
  }
  std::array<const Array<double>*, 14> plain() const {
    return {&q_, &v_, &pose_, &subspace_, &bias_, &neutral_, &end_, &difference_, &normal_, &distance_, &J_q_, &J_v_, &J_0_, &J_1_};
  }
  std::array<const Array<Dual<double>>*, 5> duals() const { return {&dual_q_, &dual_v_, &dual_pose_, &dual_subspace_, &dual_bias_}; }

  const JointProbe& joint_;
  bool shared_;
  int nq_, nv_;
  Array<double> constants_;
  Array<double> q_{count, nq_}, v_{count, nv_}, pose_{count, poseSize(joint_.instance().shape)}, subspace_{count, 6 * nv_}, bias_{count, 6};
  Array<Dual<double>> dual_q_{count, nq_}, dual_v_{count, nv_}, dual_pose_{count, poseSize(joint_.instance().shape)}, dual_subspace_{count, 6 * nv_},
      dual_bias_{count, 6};
  Array<float> float_q_{count, nq_}, float_v_{count, nv_}, float_pose_{count, poseSize(joint_.instance().shape)}, float_subspace_{count, 6 * nv_},
      float_bias_{count, 6};
  Array<double> neutral_{count, nq_}, end_{count, nq_}, difference_{count, nv_}, normal_{count, nq_}, distance_{count, 1};
  Array<double> J_q_{count, nv_* nv_}, J_v_{count, nv_* nv_}, J_0_{count, nv_* nv_}, J_1_{count, nv_* nv_};

 public:
  std::vector<Eigen::VectorXd> samples, velocities;
};

void verdict(const char* check, bool passed, const std::string& detail, Findings& findings) {
  findings.push_back({check, passed, passed ? 0.0 : 1.0, 0, passed ? "" : detail});
}

void checkThreads(const JointProbe& joint, std::uint64_t seed, const BatchCalls& reference, Findings& findings) {
  BatchCalls first(joint, false, seed), second(joint, false, seed);
  // This many rounds make sure that the two threads overlap.
  const auto work = [](BatchCalls& calls, const BatchCalls& expected, bool& same) {
    for (int i = 0; i < 200; ++i) {
      calls.run();
      same = same && calls.sameBits(expected);
    }
  };
  bool first_same = true, second_same = true;
  std::thread other(work, std::ref(second), std::cref(reference), std::ref(second_same));
  work(first, reference, first_same);
  other.join();
  verdict("two threads at once get the same bits as one", first_same && second_same, "results changed: the type keeps state", findings);
}

void checkConstants(const JointProbe& joint, Findings& findings) {
  std::vector<double> again(joint.constants().size() + 1, sentinel);
  joint.type().constants(joint.arguments().data(), again.data());
  const bool within = again.back() == sentinel;
  again.pop_back();
  bool finite = true;
  for (const double c : again) finite = finite && std::isfinite(c);
  const bool same = finite && again == joint.constants();
  verdict("constants: as many as declared, finite, the same each time", within && same,
          within ? "not finite, or other numbers the second time" : "more are written than prepare() declares", findings);
}

}  // namespace

void checkCalls(const JointProbe& joint, std::uint64_t seed, const AllocationCount& allocations, Findings& findings) {
  const FloatingPointEnvironment kept;
  checkConstants(joint, findings);
  BatchCalls own(joint, false, seed), shared(joint, true, seed), poisoned(joint, false, seed);
  own.run();
  shared.run();
  Worst batch("a batch gives what single joints give", 1e-13);
  own.compareWithSingles(batch);
  shared.compareWithSingles(batch);
  batch.into(findings);
  Worst floats("floats have the digits of floats", 1e-4);
  own.compareFloats(floats);
  shared.compareFloats(floats);
  floats.into(findings);
  verdict("nothing is written outside the batch", own.guardsIntact() && shared.guardsIntact(), "an entry beyond count or nq, nv changed", findings);
  if (joint.nq() > 0) {
    poisoned.poison(2);
    poisoned.run();
    verdict("NaN in one joint of a batch leaves the others alone", poisoned.samePoseExcept(2, own), "another joint's pose changed", findings);
  }
  verdict("the floating-point environment stays as it is", keepsSmallNumbers() && std::fegetround() == FE_TONEAREST,
          "a call changed how numbers are rounded, or has small ones flushed to zero", findings);
  checkThreads(joint, seed, own, findings);
  if (!allocations) return;
  const long before = allocations();
  own.run();
  const long made = allocations() - before;
  findings.push_back({"no allocation", made == 0, static_cast<double>(made), 0, made == 0 ? "" : "heap allocations in one round of calls"});
}

}  // namespace dyn::conformance
