// SPDX-License-Identifier: BSD-2-Clause
// dyn profile: the price of finding the code of a joint's type, for four ways of dispatch, interleaved in one process.
#include "commands.hpp"
#include "counters.hpp"
#include "interrupt.hpp"
#include "messages.hpp"
#include "model_options.hpp"
#include "options.hpp"
#include "progress.hpp"
#include "states.hpp"

#include <dyn/file.hpp>

#include <dispatch/dispatch.hpp>
#include <report/bar_chart.hpp>
#include <report/quartiles.hpp>

#include <algorithm>
#include <chrono>
#include <memory>

namespace dyn::tool {

namespace {

constexpr int repetitions = 21, state_count = 256;

struct Line {
  benchmark::Contender contender;
  std::vector<double> times;  ///< ns per call, one entry per repetition
  Counters::Reading counted;  ///< per call
  benchmark::Quartiles ns;
  int rounds = 1;  ///< passes through all states in one repetition
};

/// Adds the public functions of libdyn, under the name "library". An algorithm that throws at one of the states is left out; the error is printed.
void addLibrary(const CompactModel& model, const std::shared_ptr<Data>& data, const std::vector<State>& states, std::vector<Line>& lines) {
  const auto add = [&](const char* algorithm, auto run) {
    benchmark::Contender c;
    c.algorithm = algorithm;
    c.dispatch = "library";
    c.run = [&model, data, run](const double* q, const double* v, const double* a) {
      run(model, *data, VectorArg(q, model.nq()), VectorArg(v, model.nv()), VectorArg(a, model.nv()));
    };
    try {
      for (const State& s : states) c.run(s.q.data(), s.v.data(), s.a.data());
      lines.push_back({c, {}, {}, {}});
    } catch (const Error& e) {
      warning(e.what());
    }
  };
  add("fk", [](auto& m, auto& d, const auto& q, const auto&, const auto&) { forwardKinematics(m, d, q); });
  add("rnea", [](auto& m, auto& d, const auto& q, const auto& v, const auto& a) { rnea(m, d, q, v, a); });
  add("crba", [](auto& m, auto& d, const auto& q, const auto&, const auto&) { crba(m, d, q); });
  add("aba", [](auto& m, auto& d, const auto& q, const auto& v, const auto& a) { aba(m, d, q, v, a); });
}

/// Measures the lines in turn, again and again. Each repetition begins with another line, so that disturbances of the machine affect all lines alike.
/// A signal ends the measurement; lines without a time are then removed.
void measure(std::vector<Line>& lines, const std::vector<State>& states, Counters& counters, const Interruption& interruption) {
  using Clock = std::chrono::steady_clock;
  const std::size_t n = lines.size();
  Progress progress(static_cast<double>(repetitions + 1) * static_cast<double>(n), "measurements");
  for (int repetition = -1; repetition < repetitions; ++repetition)
    for (std::size_t k = 0; k < n && !interruption; ++k) {
      progress.at(static_cast<double>(repetition + 1) * static_cast<double>(n) + static_cast<double>(k));
      Line& line = lines[(k + static_cast<std::size_t>(repetition + 1)) % n];
      const auto once = [&] {
        for (const State& s : states) line.contender.run(s.q.data(), s.v.data(), s.a.data());
      };
      once();  // warm-up: the previous line used other code and memory
      const auto start = Clock::now();
      for (int round = 0; round < line.rounds; ++round) once();
      const double ns = std::chrono::duration<double, std::nano>(Clock::now() - start).count();
      if (repetition < 0) {
        line.rounds = benchmark::roundsInSample(ns);
        continue;
      }
      line.times.push_back(ns / (line.rounds * state_count));
      if (repetition != 0) continue;
      counters.start();
      once();
      line.counted = counters.stop();
      line.counted.instructions /= state_count;
      line.counted.branch_misses /= state_count;
    }
  std::erase_if(lines, [](const Line& line) { return line.times.empty(); });
  for (Line& line : lines) line.ns = benchmark::quartiles(line.times);
}

const Line* find(const std::vector<Line>& lines, const std::string& algorithm, const std::string& dispatch) {
  for (const Line& line : lines)
    if (line.contender.algorithm == algorithm && line.contender.dispatch == dispatch) return &line;
  return nullptr;
}

/// The number of times that each line has; after a signal, some lines may have one more.
std::size_t timesOf(const std::vector<Line>& lines) {
  std::size_t least = static_cast<std::size_t>(repetitions);
  for (const Line& line : lines) least = std::min(least, line.times.size());
  return least;
}

void plot(const std::string& path, const CompactModel& model, const std::vector<Line>& lines) {
  benchmark::BarChart chart(model.name() + ": ns a call by way of dispatch, median of " + std::to_string(timesOf(lines)), benchmark::Scale::linear);
  for (const Line& line : lines) chart.add(line.contender.algorithm, line.contender.dispatch, line.ns);
  chart.write(path);
}

struct Options {
  ModelOptions model;
  bool json = false;
  std::string plot;
};

void print(const CompactModel& model, const std::vector<Line>& lines, const Counters& counters) {
  const int joints = model.njoints() - 1;
  std::printf("%s: %d joints, %d degrees of freedom; ns a call, median of %zu over %d states, all ways in turn\n", model.name().c_str(), joints,
              model.nv(), timesOf(lines), state_count);
  char columns[160];
  std::snprintf(columns, sizeof columns, "%-6s %-18s %10s %19s %12s %16s %12s%s", "", "dispatch", "ns", "quartiles", "ns a joint", "against variant",
                "dispatches", counters.problem().empty() ? "  instructions  branch misses" : "");
  std::printf("%s\n", heading(columns).c_str());
  for (const Line& line : lines) {
    const Line* variant = find(lines, line.contender.algorithm, "static_variant");
    char range[32];
    std::snprintf(range, sizeof range, "%.0f .. %.0f", line.ns.low, line.ns.high);
    char against[24] = "";
    if (variant) std::snprintf(against, sizeof against, "%+.1f %%", 100 * (line.ns.median / variant->ns.median - 1));
    std::printf("%-6s %-18s %10.1f %19s %12.2f %16s ", line.contender.algorithm.c_str(), line.contender.dispatch.c_str(), line.ns.median, range,
                line.ns.median / joints, against);
    if (line.contender.dispatch == "library") {
      std::printf("%12s", "");
    } else {
      std::printf("%12d", line.contender.dispatches);
    }
    if (counters.problem().empty()) std::printf(" %13.0f %14.2f", line.counted.instructions, line.counted.branch_misses);
    std::printf("\n");
  }
  if (!counters.problem().empty()) std::printf("no instructions and branch misses: %s\n", counters.problem().c_str());
}

void run(const Options& o) {
  if (!o.plot.empty()) checkReplaceable(o.plot);
  const CompactModel model = o.model.compile();
  const benchmark::Contest contest = benchmark::dispatchContest(model);
  std::vector<Line> lines;
  for (const benchmark::Contender& c : contest.contenders) lines.push_back({c, {}, {}, {}});
  const std::vector<State> states = randomStates(model, state_count, 1);
  if (!o.json) addLibrary(model, std::make_shared<Data>(model, Need::mass_matrix), states, lines);
  std::stable_sort(lines.begin(), lines.end(), [](const Line& a, const Line& b) {
    const std::string order = "fk rnea crba aba";
    return order.find(a.contender.algorithm) < order.find(b.contender.algorithm);
  });
  Counters counters;
  const Interruption interruption;
  measure(lines, states, counters, interruption);
  if (lines.empty()) interruption.end();  // there is nothing to print
  if (o.json) {
    for (const Line& line : lines) {
      const nlohmann::ordered_json object = {{"robot", model.name()},
                                             {"algorithm", line.contender.algorithm},
                                             {"dispatch", line.contender.dispatch},
                                             {"ns", line.ns.median},
                                             {"dispatches", line.contender.dispatches}};
      std::printf("%s\n", object.dump().c_str());
    }
  } else {
    print(model, lines, counters);
    if (!contest.missing.empty()) std::printf("%s\n", contest.missing.c_str());
  }
  if (!o.plot.empty()) timed("wrote " + o.plot, [&] { plot(o.plot, model, lines); });
  interruption.end();
}

}  // namespace

void addProfile(CLI::App& app) {
  CLI::App* sub = addCommand(app, "profile", "the price of dispatch: batched, per joint, by a static variant, and none");
  auto o = std::make_shared<Options>();
  o->model.add(*sub);
  sub->add_flag("--json", o->json, "one JSON object a line");
  sub->add_option("--plot", o->plot, "draw the result into this SVG file")->type_name("FILE")->check(fileName({".svg"}, "pictures"));
  sub->callback([o] { run(*o); });
}

}  // namespace dyn::tool
