// SPDX-License-Identifier: BSD-2-Clause
// Computes the chunks that are missing, in the threads of all ranks. Rank 0 hands them out as workers ask for them, and computes as well.
#pragma once

#include "ranks/ranks.hpp"
#include "worker.hpp"

namespace dyn::tool::sweep {

struct Work {
  const Setting& setting;
  const Store& store;
  const Manifest& manifest;
  const Ranks& ranks;
  int threads;
  bool json_lines;  ///< progress as JSON lines on standard output
};

/// Returns the number of samples whose chunk takes a tenth of a second to half a second, found by computing a few, so that there are at most a
/// million chunks and none takes more than 64 MB.
std::int64_t chooseChunk(const Setting& setting, int workers);

/// Computes these chunks on rank 0 and hands them to the other ranks. Throws the first error that is none of a sample. A signal ends it early.
void computeChunks(const Work& work, const std::vector<std::int64_t>& missing);
/// Does what rank 0 hands out, on the other ranks. Then waits for a message of rank 0 that says that the sweep is over.
void serveRank(const Work& work);

}  // namespace dyn::tool::sweep
