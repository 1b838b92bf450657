// SPDX-License-Identifier: BSD-2-Clause
// The functions that are timed against each other.
#pragma once

#include <dyn/dyn.hpp>

#include <functional>
#include <string>
#include <vector>

namespace dyn::benchmark {

struct Contender {
  std::string algorithm;  ///< fk, rnea, crba, aba
  std::string dispatch;   ///< virtual_per_batch, virtual_per_joint, static_variant, monomorphic; variant_library
  int dispatches = 0;     ///< indirect calls or variant visits in one run
  std::function<void(const double* q, const double* v, const double* a)> run;
  const double* result = nullptr;  ///< poses, tau, M or ddq, valid after run
  int size = 0;
};

/// Contenders share the memory of their results and keep it alive. Read a result before the next contender runs.
struct Contest {
  std::vector<Contender> contenders;
  std::string missing;  ///< tells why contenders are missing; empty if none is
};

}  // namespace dyn::benchmark
