// SPDX-License-Identifier: BSD-2-Clause
// A joint type with select(). Dual numbers, packs and generated code take the selected branch and no NaN from the other one.
#include "support/catch.hpp"
#include "support/registry.hpp"

#include <dyn/codegen/differentiate.hpp>
#include <dyn/codegen/trace.hpp>
#include <dyn/conformance/conformance.hpp>
#include <dyn/dyn.hpp>
#include <dyn/lie/so3.hpp>

using namespace dyn;
using namespace dyn::test;

namespace {

const JointRegistry& withCam() {
  static const JointRegistry all = [] {
    JointRegistry r = JointRegistry::standard();
    r.load(DYN_BINARY_DIR "/test_plugins/dwelling_cam.so");
    return r;
  }();
  return all;
}

/// Two cams, one on the other, and an arm on top.
CompactModel tower() {
  Model m;
  const Inertia<double> Y{1.5, {0.1, 0.2, 0}, {0.1, 0, 0, 0.2, 0, 0.3}};
  for (int k = 0; k < 3; ++k) {
    JointDescription joint;
    joint.name = "j" + std::to_string(k);
    joint.type = k < 2 ? "dwelling_cam" : "revolute";
    if (k == 2) joint.parameters["axis"] = std::vector<double>{1, 0, 0};
    joint.placement = {exp3(Vec3<double>{0.2, -0.3, 0.1}), {0.1, 0.3, 0.2}};
    m.addBody("b" + std::to_string(k), k, joint, Y);
  }
  return compile(m, withCam());
}

std::vector<double> valuesOf(const Graph& graph, const std::vector<double>& in) { return replay<double>(graph, in); }

}  // namespace

TEST_CASE("a type with a selection passes the conformance checks", "[select]") {
  for (const ConformanceFinding& f : checkJointType(withCam().jointType("dwelling_cam"), {}, withCam(), 5)) {
    INFO(f.check << ": " << f.error << " > " << f.bound << ", " << f.detail);
    CHECK(f.passed);
  }
}

TEST_CASE("derivatives of a graph with selections are those of the branch that is taken", "[select]") {
  const CompactModel model = tower();
  Data data(model, Need::derivatives);
  const Eigen::Vector3d v(0.4, -0.7, 0.3), a(0.2, 0.1, -0.5);
  const TracedFunction traced = trace(model, "rnea");
  for (const Eigen::Vector3d& q : {Eigen::Vector3d(-0.4, 0.1, 0.2), Eigen::Vector3d(-1.3, 0.9, 0.2), Eigen::Vector3d(0.8, 0.7, -0.2)}) {
    CAPTURE(q.transpose());
    std::vector<double> in;
    for (const Eigen::Vector3d& x : {Eigen::Vector3d(q), v, a}) in.insert(in.end(), x.begin(), x.end());
    const RNEADerivatives x = computeRNEADerivatives(model, data, q, v, a);
    Eigen::MatrixXd expected(3, 9);
    expected << x.dtau_dq, x.dtau_dv, x.dtau_da;
    REQUIRE(expected.allFinite());
    for (const Mode mode : {Mode::forward, Mode::reverse}) {
      const JacobianGraph by = differentiate(traced.graph, mode);
      const std::vector<double> entries = valuesOf(by.graph, in);
      Eigen::MatrixXd found = Eigen::MatrixXd::Zero(3, 9);
      for (std::size_t k = 0; k < entries.size(); ++k) found(by.sparsity.row[k], by.sparsity.column[k]) = entries[k];
      CHECK((found - expected).cwiseAbs().maxCoeff() < 1e-11);
    }
    std::vector<double> seeded = in;
    seeded.insert(seeded.end(), {1, -2, 0.5});
    const std::vector<double> back = valuesOf(gradient(traced.graph), seeded);
    const Eigen::RowVectorXd wanted = Eigen::RowVector3d(1, -2, 0.5) * expected;
    CHECK((Eigen::Map<const Eigen::RowVectorXd>(back.data(), 9) - wanted).cwiseAbs().maxCoeff() < 1e-11);
    seeded = in;
    for (int k = 0; k < 9; ++k) seeded.push_back(0.1 * k - 0.3);
    const std::vector<double> along = valuesOf(directional(traced.graph), seeded);
    const Eigen::VectorXd direction = Eigen::Map<const Eigen::VectorXd>(seeded.data() + 9, 9);
    CHECK((Eigen::Map<const Eigen::VectorXd>(along.data(), 3) - expected * direction).cwiseAbs().maxCoeff() < 1e-11);
    for (const char* name : {"rnea_derivatives", "aba_derivatives"}) {
      const std::vector<double> generated = valuesOf(trace(model, name).graph, in);
      CHECK(std::all_of(generated.begin(), generated.end(), [](double y) { return std::isfinite(y); }));
    }
  }
}

TEST_CASE("selections within selections hide what is singular in either", "[select]") {
  // x log x is selected only for x > 0, where it is finite, and 1 / (x - 1) within it only for x < 1.
  const Graph graph = traceFunction(1, 1, [](const Traced* x, Traced* y) {
    const Traced inner = select(x[0] < Traced(1), 1 / (x[0] - 1), x[0] * 5);
    y[0] = select(x[0] > Traced(0), x[0] * log(x[0]) + inner, 3 * x[0]) + x[0];
  });
  for (const auto& [x, slope] : {std::pair{-2.0, 4.0}, {0.0, 4.0}, {1.0, 7.0}, {0.5, std::log(0.5) + 2 - 4}})
    for (const Mode mode : {Mode::forward, Mode::reverse}) {
      const JacobianGraph by = differentiate(graph, mode);
      const std::vector<double> found = valuesOf(by.graph, {x});
      REQUIRE(found.size() == 1);
      CHECK(found[0] == approx(slope).epsilon(1e-14));
    }
}
