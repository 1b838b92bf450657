// SPDX-License-Identifier: BSD-2-Clause
// The pack pass for types whose joints differ in size.
#include "support/catch.hpp"

#include <dyn/dyn.hpp>

#include <algorithm>

using namespace dyn;

namespace {

/// A joint that slides along its first n axes. All joints of this type have the same shape and one constant, but nq and nv vary.
class Rails final : public JointType {
 public:
  const JointTypeInfo& info() const noexcept override {
    static constexpr ParameterSpec axes{"axes", ParameterKind::number, true, "1", "how many", "2"};
    static constexpr JointTypeInfo description{"rails", "for tests", Structure::joint, closed_subspace | closed_bias, &axes, 1};
    return description;
  }
  bool prepare(const ParameterArgument* a, JointInstance& out, char*, int) const noexcept override {
    out.nq = out.nv = static_cast<int>(a[0].numbers[0]);
    out.constant_count = 1;
    return true;
  }
  void constants(const ParameterArgument* a, double* out) const noexcept override { *out = a[0].numbers[0]; }
  void kinematics(const JointBatch<double>& b) const noexcept override { slide(b); }
  void kinematics(const JointBatch<float>& b) const noexcept override { slide(b); }
  void kinematics(const JointBatch<Dual<double>>& b) const noexcept override { slide(b); }
  void kinematics(const JointBatch<Dual<Dual<double>>>& b) const noexcept override { slide(b); }
  bool kinematics(const JointBatch<Traced>&) const noexcept override { return false; }
  void neutral(const ConfigurationBatch<double>& b) const noexcept override {
    for (int i = 0; i < b.count; ++i)
      for (int k = 0; k < static_cast<int>(b.constants[i]); ++k) b.q_out[k * b.q_stride + i] = 0;
  }
  void integrate(const ConfigurationBatch<double>&) const noexcept override {}
  void difference(const ConfigurationBatch<double>&) const noexcept override {}
  void normalize(const ConfigurationBatch<double>&) const noexcept override {}
  void rates(const ConfigurationBatch<Dual<double>>&) const noexcept override {}
  bool rates(const ConfigurationBatch<Traced>&) const noexcept override { return false; }

 private:
  template <class S>
  static void slide(const JointBatch<S>& b) {
    for (int i = 0; i < b.count * b.lanes; ++i) {
      const int n = static_cast<int>(b.constants[i / b.lanes]);
      for (int c = 0; c < 9; ++c) b.pose[c * b.stride + i] = S(c % 4 == 0);
      for (int k = 0; k < 3; ++k) b.pose[(9 + k) * b.stride + i] = k < n ? b.q[k * b.q_stride + i] : S(0);
      for (int c = 0; c < 6 * n; ++c) b.subspace[c * b.stride + i] = S(c % 7 == 0);
      for (int c = 0; b.bias && c < 6; ++c) b.bias[c * b.stride + i] = S(0);
    }
  }
};

}  // namespace

TEST_CASE("pack: joints of one type that differ in their sizes have a batch each", "[compile]") {
  const Rails rails;
  JointRegistry registry;
  registry.add(rails);
  Model model;
  for (const int n : {1, 3, 2, 1}) {
    JointDescription joint;
    joint.name = "j" + std::to_string(model.bodies.size());
    joint.type = "rails";
    joint.parameters["axes"] = std::vector<double>{static_cast<double>(n)};
    model.addBody("b" + std::to_string(model.bodies.size()), 0, joint, {1, {}, {1, 0, 0, 1, 0, 1}});
  }
  model.gravity = {};
  const CompactModel compact = compile(model, registry);
  const std::vector<std::string>& passes = compact.report().passes;
  CHECK(std::any_of(passes.begin(), passes.end(), [](const std::string& line) { return line.find("3 type batches") != std::string::npos; }));
  Data data(compact);
  const Eigen::VectorXd q = Eigen::VectorXd::LinSpaced(7, 1, 7), zero = Eigen::VectorXd::Zero(7);
  CHECK(rnea(compact, data, q, zero, q) == q);
  forwardKinematics(compact, data, q);
  CHECK(jointPlacement(compact, data, 2).p.z == 4);
  CHECK(jointPlacement(compact, data, 3).p.y == 6);
  CHECK(jointPlacement(compact, data, 4).p.x == 7);
}
