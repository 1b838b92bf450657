// dyn bench: ns a call of each algorithm, median of repetitions over random states.
#include "commands.hpp"
#include "model_options.hpp"
#include "states.hpp"

#include <algorithm>
#include <chrono>
#include <functional>
#include <memory>

namespace dyn::tool {

namespace {

struct Algorithm {
  const char* name;
  std::function<void(const CompactModel&, Data&, const State&)> run;
};

const std::vector<Algorithm>& algorithms() {
  static const std::vector<Algorithm> all = {
      {"forward_kinematics", [](auto& m, auto& d, auto& s) { forwardKinematics(m, d, s.q); }},
      {"forward_kinematics_1", [](auto& m, auto& d, auto& s) { forwardKinematics(m, d, s.q, s.v); }},
      {"forward_kinematics_2", [](auto& m, auto& d, auto& s) { forwardKinematics(m, d, s.q, s.v, s.a); }},
      {"rnea", [](auto& m, auto& d, auto& s) { rnea(m, d, s.q, s.v, s.a); }},
      {"nle", [](auto& m, auto& d, auto& s) { nonLinearEffects(m, d, s.q, s.v); }},
      {"gravity", [](auto& m, auto& d, auto& s) { generalizedGravity(m, d, s.q); }},
      {"crba", [](auto& m, auto& d, auto& s) { crba(m, d, s.q); }},
      {"aba", [](auto& m, auto& d, auto& s) { aba(m, d, s.q, s.v, s.tau); }},
      {"make_data", [](auto& m, auto&, auto&) { const Data made(m); }},
      {"center_of_mass_jacobian", [](auto& m, auto& d, auto& s) { jacobianCenterOfMass(m, d, s.q); }},
  };
  return all;
}

struct Timing {
  double median, low, high;  ///< ns a call; quartiles
};

Timing measure(const Algorithm& algorithm, const CompactModel& model, Data& data, const std::vector<State>& states) {
  using Clock = std::chrono::steady_clock;
  constexpr int repetitions = 11;
  // Enough rounds over the states for each repetition to last about 2 ms.
  int rounds = 1;
  std::vector<double> times;
  for (int repetition = -1; repetition < repetitions; ++repetition) {
    const auto start = Clock::now();
    for (int round = 0; round < rounds; ++round)
      for (const State& s : states) algorithm.run(model, data, s);
    const double ns = std::chrono::duration<double, std::nano>(Clock::now() - start).count();
    if (repetition < 0) {
      rounds = std::clamp(static_cast<int>(2e6 / ns), 1, 1000);
      continue;
    }
    times.push_back(ns / (rounds * static_cast<double>(states.size())));
  }
  std::sort(times.begin(), times.end());
  return {times[times.size() / 2], times[times.size() / 4], times[3 * times.size() / 4]};
}

struct Options {
  ModelOptions model;
  bool json = false;
};

void run(const Options& o) {
  const CompactModel model = o.model.compile();
  const std::vector<State> states = randomStates(model, 256, 1);
  Data data(model, Need::mass_matrix);
  if (!o.json)
    std::printf("%s, %d degrees of freedom, 256 random states, median of 11\n%-26s %-8s %12s   %s\n", model.name().c_str(), model.nv(), "algorithm",
                "mode", "ns a call", "quartiles");
  for (const Algorithm& algorithm : algorithms()) {
    try {
      const Timing t = measure(algorithm, model, data, states);
      if (o.json) {
        const nlohmann::ordered_json line = {
            {"robot", model.name()}, {"algorithm", algorithm.name}, {"scalar", "double"}, {"mode", "single"}, {"ns", t.median}};
        std::printf("%s\n", line.dump().c_str());
      } else {
        std::printf("%-26s %-8s %12.1f   %.1f .. %.1f\n", algorithm.name, "single", t.median, t.low, t.high);
      }
    } catch (const Error& e) {
      if (e.code() != ErrorCode::singular) throw;
      std::fprintf(stderr, "dyn: %s: %s\n", algorithm.name, e.what());
    }
  }
}

}  // namespace

void addBench(CLI::App& app) {
  CLI::App* sub = app.add_subcommand("bench", "time of each algorithm on this machine");
  auto o = std::make_shared<Options>();
  o->model.add(*sub);
  sub->add_flag("--json", o->json, "one JSON object a line");
  sub->callback([o] { run(*o); });
}

}  // namespace dyn::tool
