// SPDX-License-Identifier: BSD-2-Clause
// A graph replayed with a scalar type that libdyn does not know: ADOL-C's adouble.
#include "support/random_model.hpp"
#include "support/registry.hpp"

#include <dyn/codegen/differentiate.hpp>
#include <dyn/codegen/trace.hpp>
#include <dyn/parsers/urdf.hpp>

#include <adolc/adouble.h>
#include <adolc/drivers/drivers.h>
#include <adolc/taping.h>

// These functions are in adouble's namespace, so that replay() finds them.
inline adouble abs(const adouble& x) { return fabs(x); }
inline adouble selectLess(const adouble& a, const adouble& b, const adouble& x, const adouble& y) {
  adouble out;
  condassign(out, b - a, x, y);
  return out;
}

using namespace dyn;
using namespace dyn::test;

TEST_CASE("derivatives by ADOL-C's tape of a replayed graph are those of the graph's own", "[codegen]") {
  const CompactModel model = compile(urdf::load(DYN_SOURCE_DIR "/models/arm.urdf"), registry());
  Random random(1);
  for (const std::string name : {"rnea", "aba"}) {
    const TracedFunction f = trace(model, name);
    const auto n = static_cast<std::size_t>(f.graph.inputs), m = f.graph.outputs.size();
    const Eigen::VectorXd x = random.vector(static_cast<Eigen::Index>(n), 1);
    trace_on(1);
    std::vector<adouble> in(n);
    for (std::size_t i = 0; i < n; ++i) in[i] <<= x[static_cast<Eigen::Index>(i)];
    std::vector<adouble> out = replay<adouble>(f.graph, in);
    std::vector<double> y(m);
    for (std::size_t i = 0; i < m; ++i) out[i] >>= y[i];
    trace_off();
    std::vector<double> numbers(n * m);
    std::vector<double*> rows;
    for (std::size_t i = 0; i < m; ++i) rows.push_back(numbers.data() + n * i);
    REQUIRE(jacobian(1, static_cast<int>(m), static_cast<int>(n), x.data(), rows.data()) >= 0);
    const JacobianGraph J = differentiate(f.graph);
    const std::vector<double> entries = replay<double>(J.graph, std::vector<double>(x.begin(), x.end()));
    std::vector<double> own(n * m, 0.0);
    for (std::size_t e = 0; e < entries.size(); ++e)
      own[n * static_cast<std::size_t>(J.sparsity.row[e]) + static_cast<std::size_t>(J.sparsity.column[e])] = entries[e];
    double worst = 0, largest = 0;
    for (std::size_t i = 0; i < own.size(); ++i) {
      worst = std::max(worst, std::fabs(own[i] - numbers[i]));
      largest = std::max(largest, std::fabs(own[i]));
    }
    CHECK(worst <= 1e-12 * largest);
  }
}
