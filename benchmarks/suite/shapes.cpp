// SPDX-License-Identifier: BSD-2-Clause
// Chains, stars and binary trees of 2^3 to 2^14 joints. The time per joint must stay constant if the algorithm is O(n).
#include "suite/suite.hpp"

#include <dyn/model/model.hpp>

namespace dyn::suite {

using ::benchmark::RegisterBenchmark;

namespace {

template <class Parent>
Model tree(const std::string& name, int joints, Parent parent) {
  Model model;
  model.name = name;
  for (int i = 0; i < joints; ++i) {
    JointDescription joint;
    joint.name = "joint" + std::to_string(i);
    joint.type = "revolute";
    joint.parameters["axis"] = std::vector<double>{i % 3 == 0 ? 1.0 : 0.0, i % 3 == 1 ? 1.0 : 0.0, i % 3 == 2 ? 1.0 : 0.0};
    joint.placement.p = {0.1, 0.02, 0.3};
    model.addBody("body" + std::to_string(i), parent(i + 1), joint, {1, {0.01, 0.02, 0.1}, {0.02, 0, 0, 0.02, 0, 0.01}});
  }
  return model;
}

void addShape(const Model& description, int joints) {
  constexpr int quadratic_up_to = 512;  // the mass matrix grows quadratically
  const std::string name = description.name + "/" + std::to_string(joints);
  const JointRegistry registry = JointRegistry::standard();
  const auto subject = std::make_shared<const Subject>(compile(description, registry), joints > 1000 ? 4 : 64);
  addSingle(name, subject, joints <= quadratic_up_to);
  RegisterBenchmark(("compile/" + name).c_str(), [description, registry, subject](::benchmark::State& state) {
    for (auto _ : state) ::benchmark::DoNotOptimize(compile(description, registry));
    report(state, *subject, 1);
    state.counters["model_bytes_per_joint"] = static_cast<double>(subject->model.bytes()) / subject->joints();
    state.counters["data_bytes_per_joint"] = static_cast<double>(Data(subject->model).bytes()) / subject->joints();
  })->Unit(::benchmark::kMicrosecond);
}

}  // namespace

void addShapes() {
  for (int joints = 8; joints <= 16384; joints *= 2) {
    addShape(tree("chain", joints, [](int i) { return i - 1; }), joints);
    addShape(tree("star", joints, [](int) { return 0; }), joints);
    addShape(tree("binary_tree", joints, [](int i) { return i / 2; }), joints);
  }
}

}  // namespace dyn::suite
