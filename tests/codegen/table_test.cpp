// SPDX-License-Identifier: BSD-2-Clause
// The documentation's table of functions that can be generated and differentiated. This test makes the table. With DYN_WRITE_TABLE=1 it writes the
// table into the documentation; otherwise it requires that the two agree.
#include "support/random_model.hpp"
#include "support/registry.hpp"

#include <dyn/codegen/differentiate.hpp>
#include <dyn/codegen/trace.hpp>

#include <cstdlib>
#include <fstream>
#include <sstream>

using namespace dyn;
using namespace dyn::test;

namespace {

const char* const documentation = DYN_SOURCE_DIR "/libdyn/README.md";
const std::string begin = "<!-- made by tests/codegen/table_test.cpp -->\n", end = "<!-- end -->\n";

/// Functions that cannot be traced, with the reason.
const std::pair<const char*, const char*> others[] = {
    {"`integrate`, `difference`, `interpolate`, `randomConfiguration`, `normalize`", "types' configuration functions are compiled for doubles only"},
    {"`cholesky::decompose`, `solve`, ...", "not traced; `minverse` and `aba` do without M"},
    {"`computeCoriolisMatrix`, regressors, `computeCenterOfMass*`, energies", "not traced yet"},
    {"`computeForwardKinematicsDerivatives`, `computeCentroidalDynamics*`, second derivatives",
     "not traced yet; differentiate the graphs of `rnea`, `frames`, `centroidal_map`"},
    {"constrained dynamics, impulses, friction", "rank decisions and iterations depend on values"},
    {"collision, distance", "searches depend on values"},
};

bool finite(const std::vector<double>& x) {
  for (const double e : x)
    if (!std::isfinite(e)) return false;
  return true;
}

std::string table() {
  const CompactModel model = compile(randomTree(registry(), 4, 3), registry());
  Random random(1);
  std::ostringstream out;
  out << "| function | generated | differentiated | remark |\n|---|---|---|---|\n";
  for (const std::string& name : traceableFunctions()) {
    const TracedFunction f = trace(model, name);
    const Eigen::VectorXd q = integrate(model, neutral(model), random.vector(model.nv(), 1));
    std::vector<double> in(q.begin(), q.end());
    while (static_cast<int>(in.size()) < f.graph.inputs) in.push_back(random.uniform());
    const bool generated = finite(replay<double>(f.graph, in));
    const bool differentiated = finite(replay<double>(differentiate(f.graph).graph, in));
    CHECK(generated);
    CHECK(differentiated);
    out << "| `" << name << "` | " << (generated ? "yes" : "no") << " | " << (differentiated ? "yes" : "no") << " | |\n";
  }
  for (const auto& [what, why] : others) out << "| " << what << " | no | no | " << why << " |\n";
  return out.str();
}

}  // namespace

TEST_CASE("the documentation's table of generated functions is true", "[codegen]") {
  std::ostringstream text;
  text << std::ifstream(documentation).rdbuf();
  std::string page = text.str();
  const std::size_t first = page.find(begin), last = page.find(end);
  REQUIRE(first != std::string::npos);
  REQUIRE(last != std::string::npos);
  const std::size_t from = first + begin.size();
  if (std::getenv("DYN_WRITE_TABLE")) {
    page.replace(from, last - from, table());
    std::ofstream(documentation) << page;
  } else {
    CHECK(page.substr(from, last - from) == table());
  }
}
