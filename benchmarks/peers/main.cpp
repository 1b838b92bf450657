// SPDX-License-Identifier: BSD-2-Clause
// dyn_peers OUT_DIR FILE[:floating]...: gives every library the same tasks, robot by robot, in turn. It prints what each library is compiled for and
// a table, and writes a picture per task and peers.json, which also has the errors at rest. Robots with a fixed base also fall under gravity,
// simulated by each library's own integrators. Only libraries that are compiled for this processor count as the best peer of a task.
#include "peers/peers.hpp"
#include "report/bar_chart.hpp"
#include "report/quartiles.hpp"

#include <dyn/error.hpp>
#include <dyn/file.hpp>
#include <dyn/version.hpp>

#include <dlfcn.h>
#include <oracle.hpp>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <set>

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

namespace {

/// libdyn, and the libraries whose modules were built. A module that does not open is named.
std::vector<Library> libraries() {
  const Version own = version();
  std::vector<Library> out{
      {"libdyn", own.number, "any " DYN_PROCESSOR ", kernels for " + own.instruction_set + " chosen at run time", true, makeLibdyn}};
  struct Module {
    const char *name, *version, *build;
    bool for_this_processor;
    const char* file;
  };
  for (const Module& module : std::initializer_list<Module>{
#include "peers_found.inc"
       }) {
    void* const handle = dlopen(module.file, RTLD_NOW | RTLD_LOCAL);
    if (!handle) {
      std::fprintf(stderr, "%s is left out: %s\n", module.name, dlerror());
      continue;
    }
    const auto make = reinterpret_cast<decltype(&makePeer)>(dlsym(handle, "makePeer"));
    out.push_back({module.name, module.version, module.build, module.for_this_processor,
                   [make](const Robot& robot) { return std::unique_ptr<Peer>(make(robot)); }});
  }
  return out;
}

struct Contender {
  const Library* library;
  std::unique_ptr<Peer> peer;
};

/// By task, robot by robot: the name of the fastest peer among those that are compiled for this processor, and its time relative to libdyn's.
using BestPeers = std::vector<std::vector<std::pair<std::string, double>>>;

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

void compare(const Robot& robot, const std::vector<Library>& all, std::vector<BarChart>& charts, BestPeers& best, tool::Json& rows) {
  std::vector<Contender> contenders = contendersFor(robot, all);
  const std::vector<State> states = randomStates(robot, 256, false);
  const auto truths = truthsOf(robot);
  for (std::size_t t = 0; t < std::size(tasks); ++t) {
    const auto times = measure(contenders, tasks[t], states);
    std::pair<std::string, double> fastest("", INFINITY);
    for (std::size_t k = 0; k < contenders.size(); ++k) {
      if (times[k].empty()) continue;
      const Quartiles ns = quartiles(times[k]);
      const Library& library = *contenders[k].library;
      const double error = errorOf(*contenders[k].peer, tasks[t], robot, truths), ratio = ns.median / quartiles(times[0]).median;
      if (k > 0 && library.for_this_processor && ratio < fastest.second) fastest = {library.name, ratio};
      std::printf("%-14s %-16s %-10s %10.0f %9.0f .. %-9.0f %8.1f %10.1f\n", robot.name.c_str(), nameOf(tasks[t]), library.name.c_str(), ns.median,
                  ns.low, ns.high, ratio, error);
      rows.push_back({{"robot", robot.name},
                      {"task", nameOf(tasks[t])},
                      {"library", library.name},
                      {"version", library.version},
                      {"build", library.build},
                      {"for_this_processor", library.for_this_processor},
                      {"ns", ns.median},
                      {"ns_low", ns.low},
                      {"ns_high", ns.high},
                      {"error_u", error}});
      charts[t].add(robot.name, contenders[k].library->name, ns.median);
    }
    if (!fastest.first.empty()) best[t].push_back(fastest);
  }
}

/// Prints what each library is compiled for.
void printBuilds(const std::vector<Library>& all) {
  for (const Library& library : all)
    std::printf("%-10s %-8s %s%s\n", library.name.c_str(), library.version.c_str(), library.build.c_str(),
                library.for_this_processor ? "" : " (slower than for this processor)");
}

/// Prints how the best peer compares for each task: geometric means over the robots.
void printBest(const BestPeers& best) {
  std::printf("\nbest peer / libdyn, among the peers compiled for this processor\n");
  for (std::size_t t = 0; t < best.size(); ++t) {
    if (best[t].empty()) {
      std::printf("%-16s no peer that does this is compiled for this processor, so the best is not known\n", nameOf(tasks[t]));
      continue;
    }
    double sum = 0, least = INFINITY;
    std::set<std::string> names;
    for (const auto& [name, ratio] : best[t]) {
      sum += std::log(ratio);
      least = std::min(least, ratio);
      names.insert(name);
    }
    std::printf("%-16s %.2f, least %.2f (", nameOf(tasks[t]), std::exp(sum / static_cast<double>(best[t].size())), least);
    for (const std::string& name : names) std::printf("%s%s", name == *names.begin() ? "" : ", ", name.c_str());
    std::printf(")\n");
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
  printBuilds(all);
  std::printf("\n%-14s %-16s %-10s %10s %22s %8s %10s\n", "robot", "task", "library", "ns", "quartiles", "x libdyn", "error [u]");
  tool::Json rows{{"algorithms", tool::Json::array()}, {"motions", tool::Json::array()}};
  BestPeers best(std::size(tasks));
  std::vector<BarChart> charts;
  for (const Task task : tasks) charts.emplace_back(std::string(nameOf(task)) + ": ns a call, logarithmic", Scale::logarithmic);
  std::vector<Robot> robots;
  for (int i = 2; i < argc; ++i) {
    std::string file = argv[i];
    const std::size_t colon = file.rfind(":floating");
    if (colon != std::string::npos) file.resize(colon);
    try {
      robots.push_back(readRobot(file, colon != std::string::npos));
      compare(robots.back(), all, charts, best, rows["algorithms"]);
    } catch (const Error& e) {
      std::fprintf(stderr, "%s\n", e.what());
    }
  }
  printBest(best);
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
