// SPDX-License-Identifier: BSD-2-Clause
// Benchmarks of all algorithms for robots, chains, stars and binary trees: `dyn_benchmarks --benchmark_filter=rnea/talos`.
#include "suite/suite.hpp"

#include <cstdio>

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  try {
    dyn::suite::addRobots();
    dyn::suite::addShapes();
    dyn::suite::addPluginJoint();
  } catch (const dyn::Error& e) {
    std::fprintf(stderr, "dyn_benchmarks: %s\n", e.what());
    return 1;
  }
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
