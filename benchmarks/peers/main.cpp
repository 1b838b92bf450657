// SPDX-License-Identifier: BSD-2-Clause
// dyn_peers OUT_DIR FILE[:floating]...: gives every library the same tasks, robot by robot, in turn. It prints a table and writes a picture per task
// and peers.json, which also has the errors at rest. Robots with a fixed base also fall under gravity, simulated by each library's own integrators.
#include "peers/peers.hpp"
#include "report/bar_chart.hpp"
#include "report/quartiles.hpp"

#include <dyn/error.hpp>
#include <dyn/file.hpp>

#include <oracle.hpp>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>

namespace dyn::benchmark::peers {

const char* nameOf(Task task) {
  switch (task) {
    case Task::rnea:
      return "rnea";
    case Task::crba:
      return "crba";
    case Task::aba:
      return "aba";
    case Task::minverse:
      return "minverse";
    case Task::rnea_derivatives:
      return "rnea_derivatives";
    default:
      return "aba_derivatives";
  }
}

std::vector<Library> libraries() {
  return {
      {"libdyn", "", makeLibdyn},
#ifdef DYN_WITH_PINOCCHIO
      {"Pinocchio", DYN_WITH_PINOCCHIO, makePinocchio},
#endif
#ifdef DYN_WITH_RBDL
      {"RBDL", DYN_WITH_RBDL, makeRbdl},
#endif
#ifdef DYN_WITH_MUJOCO
      {"MuJoCo", DYN_WITH_MUJOCO, makeMujoco},
#endif
#ifdef DYN_WITH_DART
      {"DART", DYN_WITH_DART, makeDart},
#endif
#ifdef DYN_WITH_KDL
      {"KDL", DYN_WITH_KDL, makeKdl},
#endif
#ifdef DYN_WITH_BULLET
      {"Bullet", DYN_WITH_BULLET, makeBullet},
#endif
#ifdef DYN_WITH_SIMBODY
      {"Simbody", DYN_WITH_SIMBODY, makeSimbody},
#endif
  };
}

namespace {

struct Contender {
  const Library* library;
  std::unique_ptr<Peer> peer;
};

/// Largest difference, relative to the largest entry of the reference. The state is at rest, so only gravity and inertia act, and the libraries'
/// different conventions for the velocity of a floating base do not matter.
double difference(Peer& peer, Peer& reference, Task task, const State& still) {
  peer.run(task, still);
  reference.run(task, still);
  const std::vector<double> x = peer.result(task), y = reference.result(task);
  if (x.size() != y.size()) return INFINITY;
  double off = 0, most = 1e-300;
  for (std::size_t i = 0; i < x.size(); ++i) {
    off = std::max(off, std::isnan(x[i]) ? INFINITY : std::fabs(x[i] - y[i]));
    most = std::max(most, std::fabs(y[i]));
  }
  return off / most;
}

std::vector<Contender> contendersFor(const Robot& robot, const std::vector<Library>& all) {
  std::vector<Contender> contenders;
  const State still = randomStates(robot, 1, true).front();
  for (const Library& library : all) {
    try {
      std::unique_ptr<Peer> peer = library.make(robot);
      if (!peer) continue;
      bool right = true;
      for (const Task task : tasks) {
        if (!peer->can(task) || contenders.empty()) continue;
        const double off = difference(*peer, *contenders.front().peer, task, still);
        right = right && off < 1e-6;
        if (!(off < 1e-6))
          std::fprintf(stderr, "%s, %s: %s differs from libdyn by %.1e relative and is left out\n", robot.name.c_str(), library.name.c_str(),
                       nameOf(task), off);
      }
      if (right) contenders.push_back({&library, std::move(peer)});
    } catch (const std::exception& e) {
      std::fprintf(stderr, "%s, %s: %s\n", robot.name.c_str(), library.name.c_str(), e.what());
    }
  }
  return contenders;
}

/// States at rest, with the true results computed with fifty digits.
std::vector<std::pair<State, tool::TruthSample>> truthsOf(const Robot& robot) {
  const auto& model = *static_cast<const CompactModel*>(robot.compact.get());
  const tool::Oracle oracle(*static_cast<const Model*>(robot.description.get()), model);
  std::vector<std::pair<State, tool::TruthSample>> out;
  for (const State& still : randomStates(robot, 4, true)) {
    tool::State s;
    const auto joined = [&](const double* base, int n, const std::vector<double>& joints) {
      Eigen::VectorXd x(static_cast<Eigen::Index>(joints.size()) + (robot.floating ? n : 0));
      if (robot.floating) std::copy_n(base, n, x.begin());
      std::copy(joints.begin(), joints.end(), x.end() - static_cast<Eigen::Index>(joints.size()));
      return x;
    };
    s.q = joined(still.base_q, 7, still.q);
    s.v = joined(still.base_v, 6, still.v);
    s.a = s.tau = joined(still.base_a, 6, still.a);
    out.emplace_back(still, oracle.evaluate(s, true));
  }
  return out;
}

/// Largest error of the entries of one-axis joints, relative to the largest of these entries, in units of 2^-53.
double errorOf(Peer& peer, Task task, const Robot& robot, const std::vector<std::pair<State, tool::TruthSample>>& truths) {
  double worst = 0;
  for (const auto& [state, truth] : truths) {
    peer.run(task, state);
    const std::vector<double> x = peer.result(task);
    const std::vector<long double>& all = truth.truth.at(tool::truthKey(nameOf(task)));
    const auto joints = static_cast<std::size_t>(robot.joints), n = truth.truth.at("rnea").size(), skipped = n - joints;
    long double off = 0, most = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      const long double right = isMatrix(task) ? all[(skipped + i / joints) * n + skipped + i % joints] : all[skipped + i];
      off = std::max(off, std::abs(static_cast<long double>(x[i]) - right));
      most = std::max(most, std::abs(right));
    }
    worst = std::max(worst, static_cast<double>(off / most / 0x1p-53L));
  }
  return worst;
}

/// Returns ns a call for each contender and repetition. Contenders run in turn, so that other load on the machine affects all of them alike.
std::vector<std::vector<double>> measure(std::vector<Contender>& contenders, Task task, const std::vector<State>& states) {
  using Clock = std::chrono::steady_clock;
  std::vector<std::vector<double>> times(contenders.size());
  for (int repetition = -1; repetition < 15; ++repetition)
    for (std::size_t k = 0; k < contenders.size(); ++k) {
      Peer& peer = *contenders[k].peer;
      if (!peer.can(task)) continue;
      const auto start = Clock::now();
      for (const State& s : states) peer.run(task, s);
      const double ns = std::chrono::duration<double, std::nano>(Clock::now() - start).count();
      if (repetition >= 0) times[k].push_back(ns / static_cast<double>(states.size()));
    }
  return times;
}

void compare(const Robot& robot, const std::vector<Library>& all, std::vector<BarChart>& charts, tool::Json& rows) {
  std::vector<Contender> contenders = contendersFor(robot, all);
  const std::vector<State> states = randomStates(robot, 256, false);
  const auto truths = truthsOf(robot);
  for (std::size_t t = 0; t < std::size(tasks); ++t) {
    const auto times = measure(contenders, tasks[t], states);
    for (std::size_t k = 0; k < contenders.size(); ++k) {
      if (times[k].empty()) continue;
      const Quartiles ns = quartiles(times[k]);
      const Library& library = *contenders[k].library;
      const double error = errorOf(*contenders[k].peer, tasks[t], robot, truths);
      std::printf("%-14s %-16s %-10s %10.0f %9.0f .. %-9.0f %8.1f %10.1f\n", robot.name.c_str(), nameOf(tasks[t]), library.name.c_str(), ns.median,
                  ns.low, ns.high, ns.median / quartiles(times[0]).median, error);
      rows.push_back({{"robot", robot.name},
                      {"task", nameOf(tasks[t])},
                      {"library", library.name},
                      {"version", library.version},
                      {"ns", ns.median},
                      {"ns_low", ns.low},
                      {"ns_high", ns.high},
                      {"error_u", error}});
      charts[t].add(robot.name, contenders[k].library->name, ns.median);
    }
  }
}

/// Simulates a fall from rest at q = 0.3 with each library's own integrators: time, and error of the final q against the fifty-digit reference.
void compareMotions(const Robot& robot, const std::vector<Library>& all, tool::Json& rows) {
  constexpr double time = 0.5;
  const auto& model = *static_cast<const CompactModel*>(robot.compact.get());
  tool::State start;
  start.q = Eigen::VectorXd::Constant(model.nq(), 0.3);
  start.v = Eigen::VectorXd::Zero(model.nv());
  const Eigen::VectorXd end = tool::Oracle(*static_cast<const Model*>(robot.description.get()), model).move(start, time, 100).q;
  std::vector<Contender> contenders = contendersFor(robot, all);
  std::printf("\n%s falls for %g s\n%-12s %-20s %8s %12s %12s\n", robot.name.c_str(), time, "library", "integrator", "steps", "ms", "error");
  for (const Contender& contender : contenders)
    for (const std::string& integrator : contender.peer->integrators())
      for (int steps = 64; steps <= 16384; steps *= 4) {
        std::vector<double> q, seconds;
        for (int repetition = 0; repetition < 5; ++repetition) {
          const auto begin = std::chrono::steady_clock::now();
          q = contender.peer->move(integrator, {start.q.begin(), start.q.end()}, time, steps);
          seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
        }
        const double error = (Eigen::Map<const Eigen::VectorXd>(q.data(), end.size()) - end).cwiseAbs().maxCoeff();
        const Quartiles t = quartiles(seconds);
        std::printf("%-12s %-20s %8d %12.4f %12.2e\n", contender.library->name.c_str(), integrator.c_str(), steps, 1e3 * t.median, error);
        if (!std::isfinite(error)) continue;
        rows.push_back({{"robot", robot.name},
                        {"library", contender.library->name},
                        {"version", contender.library->version},
                        {"integrator", integrator},
                        {"steps", steps},
                        {"seconds", t.median},
                        {"error", error}});
      }
}

int run(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: dyn_peers OUT_DIR FILE[:floating]...\n");
    return 2;
  }
  const std::vector<Library> all = libraries();
  for (const Library& library : all) std::printf("%s %s\n", library.name.c_str(), library.version.c_str());
  std::printf("\n%-14s %-16s %-10s %10s %22s %8s %10s\n", "robot", "task", "library", "ns", "quartiles", "x libdyn", "error [u]");
  tool::Json rows{{"algorithms", tool::Json::array()}, {"motions", tool::Json::array()}};
  std::vector<BarChart> charts;
  for (const Task task : tasks) charts.emplace_back(std::string(nameOf(task)) + ": ns a call, logarithmic", Scale::logarithmic);
  std::vector<Robot> robots;
  for (int i = 2; i < argc; ++i) {
    std::string file = argv[i];
    const std::size_t colon = file.rfind(":floating");
    if (colon != std::string::npos) file.resize(colon);
    try {
      robots.push_back(readRobot(file, colon != std::string::npos));
      compare(robots.back(), all, charts, rows["algorithms"]);
    } catch (const Error& e) {
      std::fprintf(stderr, "%s\n", e.what());
    }
  }
  for (const Robot& robot : robots) {
    if (robot.floating) continue;
    try {
      compareMotions(robot, all, rows["motions"]);
    } catch (const Error& e) {
      std::fprintf(stderr, "%s\n", e.what());
    }
  }
  replaceFile(std::string(argv[1]) + "/peers.json", rows.dump(1) + '\n');
  for (std::size_t t = 0; t < charts.size(); ++t) {
    const std::string path = std::string(argv[1]) + "/" + nameOf(tasks[t]) + ".svg";
    charts[t].write(path);
    std::printf("%s\n", path.c_str());
  }
  return 0;
}

}  // namespace

}  // namespace dyn::benchmark::peers

int main(int argc, char** argv) {
  try {
    return dyn::benchmark::peers::run(argc, argv);
  } catch (const dyn::Error& e) {
    std::fprintf(stderr, "dyn_peers: %s\n", e.what());
    return 1;
  }
}
