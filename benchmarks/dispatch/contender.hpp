// What is timed against each other.
#pragma once

#include <dyn/dyn.hpp>

#include <functional>
#include <string>
#include <vector>

namespace dyn::benchmark {

struct Contender {
  std::string algorithm;  ///< fk, rnea, crba, aba
  std::string dispatch;   ///< virtual_per_batch, virtual_per_joint, static_variant, monomorphic; variant_library
  int dispatches = 0;     ///< indirect calls or visits an evaluation
  std::function<void(const double* q, const double* v, const double* a)> run;
  const double* result = nullptr;  ///< after run: poses, tau, M or ddq
  int size = 0;
};

/// Contenders share results' memory, and keep it: read one's before the next runs.
struct Contest {
  std::vector<Contender> contenders;
  std::string missing;  ///< why some are not there; empty if all are
};

}  // namespace dyn::benchmark
