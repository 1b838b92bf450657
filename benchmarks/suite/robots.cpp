// SPDX-License-Identifier: BSD-2-Clause
// For every URDF in models/ and in the shared test data: algorithms, the variant library for comparison, loading, compiling, memory.
#include "suite/suite.hpp"

#include <dyn/error.hpp>
#include <dyn/parsers/urdf.hpp>

#include <pattern/library.hpp>

#include <algorithm>
#include <filesystem>
#include <set>

namespace dyn::suite {

using ::benchmark::RegisterBenchmark;

namespace {

/// Robots with a floating base. All other robots are fixed to the world.
const std::set<std::string>& floating() {
  static const std::set<std::string> names = {"anymal_c", "atlas", "biped", "go2",    "human", "hyq",       "icub",
                                              "nao",      "poppy", "romeo", "solo12", "talos", "talos_full"};
  return names;
}

std::vector<std::filesystem::path> robots() {
  std::vector<std::filesystem::path> files;
  for (const std::string& folder : {std::string(DYN_SOURCE_DIR "/models"), sharedModels()}) {
    std::error_code missing;
    for (const auto& entry : std::filesystem::directory_iterator(folder, missing))
      if (entry.path().extension() == ".urdf") files.push_back(entry.path());
    if (missing) ::benchmark::AddCustomContext("without", folder);
  }
  std::sort(files.begin(), files.end());
  return files;
}

void addVariantLibrary(const std::string& name, const SubjectPtr& subject) {
  std::shared_ptr<dyn::benchmark::Contest> contest;
  try {
    contest = std::make_shared<dyn::benchmark::Contest>(dyn::benchmark::patternContest(subject->model));
  } catch (const Error&) {
    return;  // the variant library lacks one of the robot's joint types
  }
  for (const dyn::benchmark::Contender& c : contest->contenders)
    RegisterBenchmark((c.algorithm + "/" + name + "/variant_library/double").c_str(), [subject, contest, &c](::benchmark::State& state) {
      Eigen::Index k = 0;
      for (auto _ : state) {
        c.run(subject->q.col(k).data(), subject->v.col(k).data(), subject->a.col(k).data());
        k = (k + 1) % subject->q.cols();
      }
      report(state, *subject, 1);
    });
}

void addRobot(const std::filesystem::path& file) {
  const std::string name = file.stem();
  urdf::Options options;
  options.mimic = urdf::Mimic::independent;
  options.inertias = urdf::Inertias::any;
  options.root = floating().count(name) ? "free_flyer" : "fixed";
  const JointRegistry registry = JointRegistry::standard();
  const Model description = urdf::load(file, options);
  const auto subject = std::make_shared<const Subject>(compile(description, registry));
  addSingle(name, subject, true);
  addVariantLibrary(name, subject);
  addBatch(name, std::make_shared<const Subject>(subject->model, 256));
  RegisterBenchmark(("load/" + name).c_str(), [file, options](::benchmark::State& state) {
    for (auto _ : state) ::benchmark::DoNotOptimize(urdf::load(file, options));
  })->Unit(::benchmark::kMicrosecond);
  RegisterBenchmark(("compile/" + name).c_str(), [description, registry, subject](::benchmark::State& state) {
    for (auto _ : state) ::benchmark::DoNotOptimize(compile(description, registry));
    state.counters["model_bytes_per_joint"] = static_cast<double>(subject->model.bytes()) / subject->joints();
    state.counters["data_bytes_per_joint"] = static_cast<double>(Data(subject->model).bytes()) / subject->joints();
  })->Unit(::benchmark::kMicrosecond);
}

}  // namespace

void addRobots() {
  for (const std::filesystem::path& file : robots()) addRobot(file);
}

}  // namespace dyn::suite
