// SPDX-License-Identifier: BSD-2-Clause
// dyn_codegen_benchmark OUT_DIR ROBOT.urdf[:floating] ...: times RNEA, ABA and CRBA, interpreted and generated, for single states and batches.
// It prints a table and writes a picture like figure 3 of the Pinocchio paper (Carpentier et al., SII 2019).
#include <dyn/codegen/native.hpp>
#include <dyn/dyn.hpp>
#include <dyn/parsers/urdf.hpp>

#include <report/bar_chart.hpp>
#include <report/quartiles.hpp>

#include <chrono>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <functional>
#include <random>
#include <string>
#include <vector>

namespace {

using namespace dyn;
using benchmark::Quartiles;

constexpr int count = 256, rounds = 15, lanes = 8;

struct Robot {
  std::string name;
  CompactModel model;
};

Robot load(const std::string& argument, const JointRegistry& registry) {
  const std::size_t colon = argument.rfind(':');
  urdf::Options options;
  options.mimic = urdf::Mimic::independent;
  options.inertias = urdf::Inertias::any;
  if (colon != std::string::npos && argument.substr(colon) == ":floating") options.root = "free_flyer";
  const std::string path = argument.substr(0, options.root == "fixed" ? std::string::npos : colon);
  CompileOptions how;
  how.dissipation = false;
  return {std::filesystem::path(path).stem().string(), compile(urdf::load(path, options), registry, how)};
}

double nanoseconds(const std::function<void()>& run) {
  const auto start = std::chrono::steady_clock::now();
  run();
  return std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - start).count() / count;
}

struct Task {
  const char* name;
  int arguments;
  bool matrix;
  std::function<void(const CompactModel&, Data&, const Eigen::MatrixXd*, int)> single;
  std::function<void(const CompactModel&, BatchData&, const Eigen::MatrixXd*)> batch;
};

const std::vector<Task>& tasks() {
  static const std::vector<Task> all = {
      {"rnea", 3, false, [](auto& m, auto& d, auto* x, int k) { rnea(m, d, x[0].col(k), x[1].col(k), x[2].col(k)); },
       [](auto& m, auto& b, auto* x) { rnea(m, b, x[0], x[1], x[2]); }},
      {"aba", 3, false, [](auto& m, auto& d, auto* x, int k) { aba(m, d, x[0].col(k), x[1].col(k), x[2].col(k)); },
       [](auto& m, auto& b, auto* x) { aba(m, b, x[0], x[1], x[2]); }},
      {"crba", 1, true, [](auto& m, auto& d, auto* x, int k) { crba(m, d, x[0].col(k)); }, [](auto& m, auto& b, auto* x) { crba(m, b, x[0]); }}};
  return all;
}

void measure(const Robot& robot, benchmark::BarChart& chart) {
  const CompactModel& m = robot.model;
  Data data(m, Need::mass_matrix);
  BatchData batch(m, count, Need::mass_matrix);
  Eigen::MatrixXd x[3] = {Eigen::MatrixXd(m.nq(), count), Eigen::MatrixXd::Random(m.nv(), count), Eigen::MatrixXd::Random(m.nv(), count)};
  for (int k = 0; k < count; ++k) x[0].col(k) = randomConfiguration(m, static_cast<std::uint64_t>(k));
  // The states in groups of `lanes`; within a group, the values of one coordinate lie side by side.
  std::vector<std::vector<double>> grouped;
  for (const Eigen::MatrixXd& a : x) {
    std::vector<double> out(static_cast<std::size_t>(a.size()));
    for (Eigen::Index k = 0; k < count; ++k)
      for (Eigen::Index i = 0; i < a.rows(); ++i) out[static_cast<std::size_t>((k / lanes * a.rows() + i) * lanes + k % lanes)] = a(i, k);
    grouped.push_back(std::move(out));
  }
  for (const Task& task : tasks()) {
    NativeOptions wide;
    wide.lanes = lanes;
    const CompiledFunction one = compileNative(m, {task.name}).functions()[0], many = compileNative(m, {task.name}, wide).functions()[0];
    std::vector<double> out(static_cast<std::size_t>(one.outputs()[0].size() * lanes));
    const auto call = [&](const CompiledFunction& f, const auto& at) {
      const void* in[3];
      void* to[] = {out.data()};
      for (int i = 0; i < task.arguments; ++i) in[i] = at(i);
      f.call(in, to);
    };
    const std::pair<const char*, std::function<void()>> ways[] = {
        {"dynamic",
         [&] {
           for (int k = 0; k < count; ++k) task.single(m, data, x, k);
         }},
        {"generated",
         [&] {
           for (int k = 0; k < count; ++k) call(one, [&](int i) { return x[i].data() + k * x[i].rows(); });
         }},
        {"dynamic, batch", [&] { task.batch(m, batch, x); }},
        {"generated, batch", [&] {
           for (int k = 0; k < count; k += lanes) call(many, [&](int i) { return grouped[static_cast<std::size_t>(i)].data() + k * x[i].rows(); });
         }}};
    std::vector<double> times[4];
    for (int r = -2; r < rounds; ++r)
      for (int w = 0; w < 4; ++w) {
        const double t = nanoseconds(ways[w].second);
        if (r >= 0) times[w].push_back(t);
      }
    std::string line = "| " + robot.name + " | " + task.name;
    double median[4];
    for (int w = 0; w < 4; ++w) {
      const Quartiles t = benchmark::quartiles(times[w]);
      char cell[80];
      std::snprintf(cell, sizeof cell, " | %.0f [%.0f, %.0f]", t.median, t.low, t.high);
      line += cell;
      median[w] = t.median;
      chart.add(robot.name + " " + task.name, ways[w].first, t.median);
    }
    std::printf("%s | %.1f | %.1f |\n", line.c_str(), median[0] / median[1], median[2] / median[3]);
    std::fflush(stdout);
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: dyn_codegen_benchmark OUT_DIR ROBOT.urdf[:floating] ...\n");
    return 2;
  }
  try {
    const JointRegistry registry = JointRegistry::standard();
    benchmark::BarChart chart("Interpreted and generated, ns a state", benchmark::Scale::logarithmic);
    std::printf("ns a state, median [quartiles] of %d rounds over %d random states, all ways in turn\n\n", rounds, count);
    std::printf(
        "| robot | algorithm | dynamic | generated | dynamic, batch | generated, batch | ratio | ratio, batch "
        "|\n|---|---|---|---|---|---|---|---|\n");
    for (int i = 2; i < argc; ++i) measure(load(argv[i], registry), chart);
    chart.write(std::string(argv[1]) + "/codegen.svg");
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
}
