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

/// One line: how long `round` takes for each of the states that it goes through.
struct Entry {
  const char *algorithm, *scalar, *mode;
  std::function<void()> round;
};

struct Timing {
  double median, low, high;  ///< ns a state; quartiles
};

constexpr int state_count = 256;

Timing measure(const std::function<void()>& round) {
  using Clock = std::chrono::steady_clock;
  constexpr int repetitions = 11;
  // Enough rounds for each repetition to last about 2 ms.
  int rounds = 1;
  std::vector<double> times;
  for (int repetition = -1; repetition < repetitions; ++repetition) {
    const auto start = Clock::now();
    for (int i = 0; i < rounds; ++i) round();
    const double ns = std::chrono::duration<double, std::nano>(Clock::now() - start).count();
    if (repetition < 0) {
      rounds = std::clamp(static_cast<int>(2e6 / ns), 1, 1000);
      continue;
    }
    times.push_back(ns / (rounds * static_cast<double>(state_count)));
  }
  std::sort(times.begin(), times.end());
  return {times[times.size() / 2], times[times.size() / 4], times[3 * times.size() / 4]};
}

/// Everything that is measured lives here.
struct Subjects {
  explicit Subjects(const CompactModel& m) : model(m), states(randomStates(m, state_count, 1)), data(m, Need::mass_matrix) {}
  const CompactModel& model;
  std::vector<State> states;
  Data data;
};

void addSingle(Subjects& x, std::vector<Entry>& entries) {
  const auto add = [&](const char* name, auto run) {
    entries.push_back({name, "double", "single", [&x, run] {
                         for (const State& s : x.states) run(x.model, x.data, s);
                       }});
  };
  add("forward_kinematics", [](auto& m, auto& d, auto& s) { forwardKinematics(m, d, s.q); });
  add("forward_kinematics_1", [](auto& m, auto& d, auto& s) { forwardKinematics(m, d, s.q, s.v); });
  add("forward_kinematics_2", [](auto& m, auto& d, auto& s) { forwardKinematics(m, d, s.q, s.v, s.a); });
  add("rnea", [](auto& m, auto& d, auto& s) { rnea(m, d, s.q, s.v, s.a); });
  add("nle", [](auto& m, auto& d, auto& s) { nonLinearEffects(m, d, s.q, s.v); });
  add("gravity", [](auto& m, auto& d, auto& s) { generalizedGravity(m, d, s.q); });
  add("crba", [](auto& m, auto& d, auto& s) { crba(m, d, s.q); });
  add("aba", [](auto& m, auto& d, auto& s) { aba(m, d, s.q, s.v, s.tau); });
  add("joint_jacobians", [](auto& m, auto& d, auto& s) { computeJointJacobians(m, d, s.q); });
  add("center_of_mass_jacobian", [](auto& m, auto& d, auto& s) { jacobianCenterOfMass(m, d, s.q); });
  add("make_data", [](auto& m, auto&, auto&) { const Data made(m); });
}

template <class T>
void addBatch(Subjects& x, const char* scalar, int threads, std::vector<Entry>& entries) {
  using Matrix = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>;
  struct Memory {
    BasicBatchData<T> batch;
    Matrix q, v, a, tau;
  };
  const Need needs = Need::mass_matrix | Need::kinematics | Need::jacobians;
  auto memory =
      std::make_shared<Memory>(Memory{BasicBatchData<T>(x.model, state_count, needs, threads), Matrix(x.model.nq(), state_count),
                                      Matrix(x.model.nv(), state_count), Matrix(x.model.nv(), state_count), Matrix(x.model.nv(), state_count)});
  for (int k = 0; k < state_count; ++k) {
    const State& s = x.states[static_cast<std::size_t>(k)];
    memory->q.col(k) = s.q.template cast<T>();
    memory->v.col(k) = s.v.template cast<T>();
    memory->a.col(k) = s.a.template cast<T>();
    memory->tau.col(k) = s.tau.template cast<T>();
  }
  const auto add = [&](const char* name, auto run) { entries.push_back({name, scalar, "batch", [&x, memory, run] { run(x.model, *memory); }}); };
  add("forward_kinematics", [](auto& m, auto& d) { forwardKinematics(m, d.batch, d.q); });
  add("forward_kinematics_1", [](auto& m, auto& d) { forwardKinematics(m, d.batch, d.q, d.v); });
  add("forward_kinematics_2", [](auto& m, auto& d) { forwardKinematics(m, d.batch, d.q, d.v, d.a); });
  add("rnea", [](auto& m, auto& d) { rnea(m, d.batch, d.q, d.v, d.a); });
  add("nle", [](auto& m, auto& d) { nonLinearEffects(m, d.batch, d.q, d.v); });
  add("gravity", [](auto& m, auto& d) { generalizedGravity(m, d.batch, d.q); });
  add("crba", [](auto& m, auto& d) { crba(m, d.batch, d.q); });
  add("aba", [](auto& m, auto& d) { aba(m, d.batch, d.q, d.v, d.tau); });
  add("joint_jacobians", [](auto& m, auto& d) { computeJointJacobians(m, d.batch, d.q); });
}

struct Options {
  ModelOptions model;
  bool json = false;
  int threads = 1;
};

void run(const Options& o) {
  const CompactModel model = o.model.compile();
  Subjects subjects(model);
  std::vector<Entry> entries;
  addSingle(subjects, entries);
  addBatch<double>(subjects, "double", o.threads, entries);
  addBatch<float>(subjects, "float", o.threads, entries);
  if (!o.json)
    std::printf("%s, %d degrees of freedom, %d random states, median of 11\n%-26s %-8s %-8s %12s   %s\n", model.name().c_str(), model.nv(),
                state_count, "algorithm", "scalar", "mode", "ns a state", "quartiles");
  for (const Entry& entry : entries) {
    try {
      const Timing t = measure(entry.round);
      if (o.json) {
        const nlohmann::ordered_json line = {
            {"robot", model.name()}, {"algorithm", entry.algorithm}, {"scalar", entry.scalar}, {"mode", entry.mode}, {"ns", t.median}};
        std::printf("%s\n", line.dump().c_str());
      } else {
        std::printf("%-26s %-8s %-8s %12.1f   %.1f .. %.1f\n", entry.algorithm, entry.scalar, entry.mode, t.median, t.low, t.high);
      }
    } catch (const Error& e) {
      if (e.code() != ErrorCode::singular && e.code() != ErrorCode::argument) throw;
      std::fprintf(stderr, "dyn: %s, %s, %s: %s\n", entry.algorithm, entry.scalar, entry.mode, e.what());
    }
  }
}

}  // namespace

void addBench(CLI::App& app) {
  CLI::App* sub = app.add_subcommand("bench", "time of each algorithm on this machine, state by state and in batches");
  auto o = std::make_shared<Options>();
  o->model.add(*sub);
  sub->add_flag("--json", o->json, "one JSON object a line");
  sub->add_option("--threads", o->threads, "of batches")->capture_default_str()->check(CLI::Range(1, 256));
  sub->callback([o] { run(*o); });
}

}  // namespace dyn::tool
