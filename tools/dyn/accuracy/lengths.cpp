// SPDX-License-Identifier: BSD-2-Clause
#include "bench.hpp"
#include "errors.hpp"
#include "interrupt.hpp"
#include "oracle.hpp"
#include "problems.hpp"
#include "progress.hpp"
#include "sections.hpp"

#include <iterator>
#include <optional>

namespace dyn::tool {

Section lengthSection(const AccuracyOptions& options) {
  Section out;
  out.id = "lengths";
  out.title = "Growth with the length of a chain";
  out.text = {
      "Chains of links whose axes turn from one to the next. Errors relative to the largest entry: those of aba grow with the length, those of a "
      "solution with M with the condition of M, which grows like the fourth power (Featherstone 2004). Times a call are proportional to the length "
      "but "
      "for M and its factors, which have n^2 numbers."};
  out.table.columns = {"links", "quantity", "error relative [u]", "ns a call"};
  benchmark::LineChart errors("Error against length", {"links", benchmark::Scale::logarithmic},
                              {"relative error [u]", benchmark::Scale::logarithmic});
  benchmark::LineChart times("Time against length", {"links", benchmark::Scale::logarithmic}, {"ns a call", benchmark::Scale::logarithmic});
  const JointRegistry registry = JointRegistry::standard();
  const int longest = options.quick ? 20 : 160;
  constexpr int lengths[] = {2, 5, 10, 20, 40, 80, 160, 320, 1000, 3000, 10000};
  Progress progress(static_cast<double>(std::size(lengths)), "chains");
  double done = 0;
  for (const int n : lengths) {
    if (options.quick && n > 1000) break;
    if (Interruption::pending()) break;
    progress.at(done++, "chain of " + std::to_string(n) + " links");
    const Model description = chain(n);
    const CompactModel model = compile(description, registry);
    const bool small = n <= longest;
    Data data(model, n <= 1000 ? Need::derivatives : Need::state);
    const State s = randomStates(model, 1, 3)[0];
    const std::optional<TruthSample> truth = small ? std::optional(Oracle(description, model).evaluate(s, false)) : std::nullopt;
    const auto add = [&](const char* name, const char* key, auto run) {
      const Eigen::VectorXd result = run();
      const int calls = std::max(1, 1000 / n);
      const auto round = [&] {
        for (int k = 0; k < calls; ++k) run();
      };
      const double ns = measure(round, static_cast<std::size_t>(calls)).median;
      times.add(name, n, ns);
      double error = std::nan("");
      if (truth) {
        error = relativeError({result.begin(), result.end()}, truth->truth.at(key));
        errors.add(name, n, std::max(error, 0.01));
      }
      out.table.rows.push_back({n, name, std::isnan(error) ? Json(nullptr) : Json(error), ns});
    };
    add("rnea", "rnea", [&] { return rnea(model, data, s.q, s.v, s.a); });
    add("aba", "aba", [&] { return aba(model, data, s.q, s.v, s.tau); });
    if (n <= 1000) add("forward dynamics by Cholesky", "aba", [&] { return forwardDynamics(model, data, s.q, s.v, s.tau); });
  }
  errors.guide("n^2", 10, 10, 2);
  errors.guide("n^4", 10, 10, 4);
  times.guide("n", 10, 1000, 1);
  out.charts.push_back(std::move(errors));
  out.charts.push_back(std::move(times));
  return out;
}

}  // namespace dyn::tool
