// SPDX-License-Identifier: BSD-2-Clause
// The work of one sample: simulation, functions of a state, collision queries, or a function of a Python file. Each thread has a task of its own.
#pragma once

#include "variation.hpp"

#include <memory>
#include <optional>
#include <span>

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

/// A function of a Python file.
struct PythonFunction {
  std::string file, file_sha256;
  std::string setup;  ///< the line with which a process begins
  std::vector<Field> fields;
};

/// All that tasks share. Nothing changes after its construction.
struct Setting {
  Study study;
  Model description;
  JointRegistry registry;
  CompactModel model;
  Variation variation;
  PythonFunction python;                  ///< of the task python; otherwise empty
  std::optional<GeometryModel> geometry;  ///< the volumes, if the task looks at them; they do not depend on the numbers that vary

  explicit Setting(Study given);
  /// Returns the model of a sample, and puts its values into the options. A model whose limits vary is compiled again; others take other numbers.
  CompactModel modelOf(const Inputs& inputs, MotionOptions& options) const;

 private:
  void countSamples();
};

class Task {
 public:
  virtual ~Task() = default;
  /// The results of each sample, in the order in which run() writes them.
  virtual const std::vector<Field>& fields() const = 0;
  /// Makes ready what samples need. Throws if no sample can be computed.
  virtual void prepare() {}
  /// Computes a sample. The same inputs give the same bytes, whatever ran before. Throws if the sample fails.
  virtual void run(const Inputs& inputs, double* row) = 0;
  /// The most samples that are faster together than one by one.
  virtual std::size_t together() const { return 1; }
  /// Computes several samples and returns why some of them failed. Each has the bytes of run().
  virtual std::vector<std::optional<std::string>> runAll(std::span<const Inputs> inputs, std::span<double* const> rows);
  /// Times of the trajectories that are kept; empty otherwise.
  virtual std::vector<double> times() const { return {}; }
  /// Names of pairs of volumes, to whose indices the results refer; empty otherwise.
  virtual Json pairs() const { return nullptr; }
  /// Draws the present sample's motion to a file, SVG. Throws Error(argument) for tasks without motion.
  virtual void plot(const Inputs& inputs, const std::string& path);
};

std::unique_ptr<Task> makeTask(const Setting& setting);
/// Computes samples until one has results, which fix their names and shapes. Throws Error for a function that cannot be called, or fails for the
/// first hundred samples.
PythonFunction findFunction(const Setting& setting);
/// The tasks of the four kinds.
/// @{
std::unique_ptr<Task> simulateTask(const Setting& setting);
std::unique_ptr<Task> computeTask(const Setting& setting);
std::unique_ptr<Task> collideTask(const Setting& setting);
std::unique_ptr<Task> pythonTask(const Setting& setting);
/// @}

}  // namespace dyn::tool::sweep
