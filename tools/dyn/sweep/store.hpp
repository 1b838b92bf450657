// SPDX-License-Identifier: BSD-2-Clause
// The folder of a sweep: the manifest, the lock, the chunks that are finished, and the results.
#pragma once

#include "states.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace dyn::tool::sweep {

/// A sample that failed, and why.
struct Failure {
  std::int64_t sample = 0;
  std::string reason;
};

/// The results of consecutive samples, written as one file.
struct Chunk {
  std::int64_t first = 0, count = 0;
  std::vector<Failure> failures;
  std::vector<double> numbers;  ///< field after field; in each field sample after sample
};

/// The description of a sweep. A sweep goes on only with the same manifest.
struct Manifest {
  std::string version, instruction_set, model_sha256, host;
  std::string study_name, study_folder;
  nlohmann::json study;
  std::int64_t samples = 0, chunk = 0;
  std::uint64_t seed = 0;
  Json fields, pairs;
  std::string file_sha256{};  ///< of the Python file; empty for tasks without one

  std::int64_t chunks() const { return (samples + chunk - 1) / chunk; }
  std::int64_t first(std::int64_t number) const { return number * chunk; }
  std::int64_t count(std::int64_t number) const { return std::min(chunk, samples - first(number)); }
  std::string text() const;
};

/// Holds the right to write into a folder. Throws Error(file) if another sweep, which may run on another machine, has it.
class FolderLock {
 public:
  explicit FolderLock(const std::string& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;
  /// Whether a sweep runs in that folder.
  static bool held(const std::string& folder);

 private:
  int file_;
};

class Store {
 public:
  explicit Store(std::string folder) : folder_(std::move(folder)) {}

  std::string path(const std::string& name) const { return folder_ + "/" + name; }
  std::string results() const { return path("results.h5"); }
  std::string failures() const { return path("failures.jsonl"); }
  bool begun() const;
  bool finished() const;
  /// Makes the folder and writes the manifest. Throws Error(file), also for a folder that has other files.
  void begin(const Manifest& manifest) const;
  /// Throws Error(file | syntax).
  Manifest manifest() const;
  /// The numbers of the chunks that are not yet there. Chunks that are damaged are removed, with a warning.
  std::vector<std::int64_t> missing(const Manifest& manifest, std::size_t numbers_a_sample) const;
  void write(const Manifest& manifest, std::int64_t number, const Chunk& chunk) const;
  /// Reads a chunk. Throws Error(file | syntax) if it is damaged.
  Chunk read(const Manifest& manifest, std::int64_t number, std::size_t numbers_a_sample) const;
  void removeChunks() const;
  /// Returns the output of `dyn sweep --status`.
  Json status() const;

 private:
  std::string chunkPath(std::int64_t number) const;
  std::string folder_;
};

}  // namespace dyn::tool::sweep
