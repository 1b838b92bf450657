// SPDX-License-Identifier: BSD-2-Clause
// Expression graphs: simplification, replay and differentiation.
#include "support/random_model.hpp"

#include <dyn/codegen/differentiate.hpp>

using namespace dyn;
using namespace dyn::test;

namespace {

/// A function that uses every operation at least once.
template <class S>
void sample(const S* x, S* y) {
  using std::sqrt, std::sin, std::cos, std::tan, std::exp, std::log, std::atan2, std::abs;
  const S a = x[0] * x[1] + sin(x[2]), b = cos(x[2]) / (S(2) + x[1] * x[1]);
  y[0] = a - b * sqrt(S(1) + x[0] * x[0]);
  y[1] = exp(-x[1]) * log(S(3) + abs(x[0])) + tan(S(0.3) * x[2]);
  y[2] = atan2(a, b) - x[3];
  y[3] = select(x[0] < x[1], a * x[3], b - x[3]) + select((x[2] > S(0)) | (x[3] >= S(0.5)), S(1), x[2]);
  y[4] = S(7);
}
constexpr int ins = 4, outs = 5;

Graph sampleGraph() {
  return traceFunction(ins, outs, [](const Traced* in, Traced* out) { sample(in, out); });
}

std::vector<double> randomPoint(Random& random) { return {random.uniform(), random.uniform(), random.uniform(), random.uniform()}; }

}  // namespace

TEST_CASE("a graph replayed is the function", "[codegen]") {
  const Graph graph = sampleGraph();
  Random random(1);
  for (int k = 0; k < 50; ++k) {
    const std::vector<double> x = randomPoint(random);
    double y[outs];
    sample(x.data(), y);
    const std::vector<double> found = replay<double>(graph, x);
    for (int i = 0; i < outs; ++i) CHECK(found[static_cast<std::size_t>(i)] == approx(y[i]).epsilon(1e-15));
  }
}

TEST_CASE("what is known, zero, one, or there already costs nothing", "[codegen]") {
  const auto operations = [](const std::function<Traced(const Traced*)>& f) {
    return traceFunction(2, 1, [&](const Traced* in, Traced* out) { out[0] = f(in); }).count().total();
  };
  CHECK(operations([](const Traced* x) { return x[0] * 0 + Traced(2) * Traced(3); }) == 0);
  CHECK(operations([](const Traced* x) { return x[0] * 1 + 0; }) == 0);
  CHECK(operations([](const Traced* x) { return x[0] - x[0]; }) == 0);
  CHECK(operations([](const Traced* x) { return -(-x[0]); }) == 0);
  CHECK(operations([](const Traced* x) { return x[0] / x[0]; }) == 0);
  CHECK(operations([](const Traced* x) { return x[0] + (-x[1]); }) == 1);
  CHECK(operations([](const Traced* x) { return (x[0] * x[1]) * (x[1] * x[0]); }) == 2);
  CHECK(operations([](const Traced* x) { return (x[0] - x[1]) * (x[1] - x[0]); }) == 3);  // one difference, its square, a sign
  CHECK(operations([](const Traced* x) { return Traced(2) * (Traced(3) * x[0]); }) == 1);
  CHECK(operations([](const Traced* x) { return select(x[0] < x[1], x[0], x[0]); }) == 0);
  CHECK(operations([](const Traced* x) { return sin(-x[0]) + sin(x[0]); }) <= 2);
  CHECK(operations([](const Traced* x) {
          [[maybe_unused]] const Traced unused = exp(x[0]) * x[1];
          return x[1];
        }) == 0);
}

TEST_CASE("a graph that grows beyond its bound is given up", "[codegen]") {
  GraphBuilder builder(100);
  Traced x = builder.input(), sum = x;
  for (int i = 0; i < 1000; ++i) sum = sum * x + Traced(i + 2);
  CHECK_THROWS_WITH(builder.finish({&sum, 1}), containing("more than 100 operations"));
}

TEST_CASE("derivatives as graphs are those of dual numbers, forward and in reverse", "[codegen]") {
  const Graph graph = sampleGraph();
  const JacobianGraph forward = differentiate(graph, Mode::forward), reverse = differentiate(graph, Mode::reverse);
  const Graph along = directional(graph), weighted = gradient(graph);
  CHECK(forward.sparsity.row == reverse.sparsity.row);
  CHECK(forward.sparsity.column == reverse.sparsity.column);
  CHECK(forward.sparsity.rows == outs);
  CHECK(forward.sparsity.columns == ins);
  Random random(2);
  for (int k = 0; k < 50; ++k) {
    const std::vector<double> x = randomPoint(random);
    Eigen::MatrixXd J(outs, ins);
    for (int j = 0; j < ins; ++j) {
      std::vector<Dual<double>> in;
      in.reserve(ins);
      for (int i = 0; i < ins; ++i) in.push_back({x[static_cast<std::size_t>(i)], i == j ? 1.0 : 0.0});
      const std::vector<Dual<double>> out = replay<Dual<double>>(graph, in);
      for (int i = 0; i < outs; ++i) J(i, j) = out[static_cast<std::size_t>(i)].d;
    }
    for (const JacobianGraph* which : {&forward, &reverse}) {
      const std::vector<double> entries = replay<double>(which->graph, x);
      Eigen::MatrixXd found = Eigen::MatrixXd::Zero(outs, ins);
      for (std::size_t e = 0; e < entries.size(); ++e) found(which->sparsity.row[e], which->sparsity.column[e]) = entries[e];
      CHECK((found - J).cwiseAbs().maxCoeff() <= 1e-14 * J.cwiseAbs().maxCoeff());
    }
    const Eigen::VectorXd direction = random.vector(ins, 1), weights = random.vector(outs, 1);
    std::vector<double> in = x;
    in.insert(in.end(), direction.begin(), direction.end());
    const std::vector<double> change = replay<double>(along, in);
    CHECK((Eigen::Map<const Eigen::VectorXd>(change.data(), outs) - J * direction).norm() <= 1e-13);
    in = x;
    in.insert(in.end(), weights.begin(), weights.end());
    const std::vector<double> slope = replay<double>(weighted, in);
    CHECK((Eigen::Map<const Eigen::VectorXd>(slope.data(), ins) - J.transpose() * weights).norm() <= 1e-13);
  }
}
