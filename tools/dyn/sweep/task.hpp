// SPDX-License-Identifier: BSD-2-Clause
// The work of one sample: simulation, functions of a state, or collision queries. Each thread has a task of its own.
#pragma once

#include "variation.hpp"

#include <memory>

namespace dyn::tool::sweep {

/// One result: some numbers of each sample.
struct Field {
  std::string name;
  std::vector<std::int64_t> shape;  ///< of one sample; empty for one number
  bool flag = false;                ///< 0 or 1, stored in a byte

  std::size_t size() const;
};

/// Returns the number of numbers of one sample.
std::size_t numbersOf(const std::vector<Field>& fields);

/// All that tasks share. Nothing changes after its construction.
struct Setting {
  Study study;
  Model description;
  JointRegistry registry;
  CompactModel model;
  Variation variation;

  explicit Setting(Study given);
};

class Task {
 public:
  virtual ~Task() = default;
  /// The results of each sample, in the order in which run() writes them.
  virtual const std::vector<Field>& fields() const = 0;
  /// Computes a sample. The same inputs give the same bytes, whatever ran before. Throws if the sample fails.
  virtual void run(const Inputs& inputs, double* row) = 0;
  /// Times of the trajectories that are kept; empty otherwise.
  virtual std::vector<double> times() const { return {}; }
  /// Names of pairs of volumes, to whose indices the results refer; empty otherwise.
  virtual Json pairs() const { return nullptr; }
  /// Draws the present sample's motion to a file, SVG. Throws Error(argument) for tasks without motion.
  virtual void plot(const Inputs& inputs, const std::string& path);
};

std::unique_ptr<Task> makeTask(const Setting& setting);
/// The tasks of the three kinds.
/// @{
std::unique_ptr<Task> simulateTask(const Setting& setting);
std::unique_ptr<Task> computeTask(const Setting& setting);
std::unique_ptr<Task> collideTask(const Setting& setting);
/// @}

}  // namespace dyn::tool::sweep
