// SPDX-License-Identifier: BSD-2-Clause
// Errors of a robot that stands far from the origin.
#include "bench.hpp"
#include "interrupt.hpp"
#include "oracle.hpp"
#include "problems.hpp"
#include "progress.hpp"
#include "sections.hpp"

#include <cmath>

namespace dyn::tool {

Section distanceSection(const AccuracyOptions& options) {
  Section out;
  out.id = "distances";
  out.title = "Error against the distance of the base";
  out.text = {
      "An arm of seven joints on a body that floats so far from the origin. Quantities that are formed about the world's origin lose as many digits "
      "as the base is metres away; here each body's are formed at its own joint. Errors of rnea and aba are scaled by what their summands could be, "
      "the others relative to the largest entry.",
      "What limits each: rounding alone, at any distance."};
  out.table.columns = {"distance [m]", "algorithm", "error max [u]"};
  const Model description = append(body("free_flyer", 20, {0.05, 0, 0.1}, {0.5, 0.7, 0.6}, 9.81), chain(7), "body", {}, "arm/");
  const CompactModel model = compile(description, JointRegistry::standard());
  const Oracle oracle(description, model);
  benchmark::LineChart chart("Error against distance", {"distance of the base [m]", benchmark::Scale::logarithmic},
                             {"largest error [u]", benchmark::Scale::logarithmic});
  const int most = options.quick ? 3 : 9;
  Progress progress(most + 1, "distances");
  for (int decade = 0; decade <= most && !Interruption::pending(); ++decade) {
    progress.at(decade, "bases far away");
    const double distance = std::pow(10.0, decade);
    Subjects subjects(model, ConstraintSet(model, {}));
    for (State s : randomStates(model, options.quick ? 1 : 3, 11)) {
      for (int k = 0; k < 3; ++k) s.q[k] = distance / std::sqrt(3.0);
      subjects.truth.push_back(oracle.evaluate(s, true));
    }
    std::vector<Entry> entries;
    addSingle(subjects, entries);
    for (const Entry& entry : entries) {
      const double error = entry.error ? entry.error().most() : std::nan("");
      if (std::isnan(error)) continue;
      chart.add(entry.algorithm, distance, std::max(error, 0.01));
      out.table.rows.push_back({distance, entry.algorithm, error});
    }
  }
  chart.guide("u", 1, 1, 0);
  out.charts.push_back(std::move(chart));
  return out;
}

}  // namespace dyn::tool
