// SPDX-License-Identifier: BSD-2-Clause
// How the numbers of one quantity vary from sample to sample.
#pragma once

#include "random.hpp"
#include "study.hpp"

#include <functional>

namespace dyn::tool::sweep {

struct Distribution {
  enum class Kind { fixed, uniform, normal, list, grid };
  Kind kind = Kind::fixed;
  int size = 0;                           ///< numbers of one draw
  std::vector<std::vector<double>> rows;  ///< the value; lowest and highest; mean and deviation; the entries of a list; first and last of a grid
  std::vector<std::int64_t> counts;       ///< of a grid: points along each number

  /// Entries of a list or points of a grid; otherwise 1.
  std::int64_t cells() const;
  /// Writes the numbers of a sample to out. `first` is the index of the first one among the numbers of its quantity.
  void draw(const RandomNumbers& random, std::uint32_t first, std::int64_t cell, double* out) const;
};

/// Reads a number or a list of numbers, each finite; one number stands for `size` equal ones.
std::vector<double> readNumbers(const json::Value& value, int size);

/// Reads a constant, {"uniform": [low, high]}, {"normal": [mean, deviation]}, {"list": [...]} or {"grid": [first, last, count]}. `point` reads the
/// constant and the entries of a list. Throws Error(syntax).
Distribution readDistribution(const json::Value& value, int size, const std::function<std::vector<double>(const json::Value&)>& point = nullptr);

}  // namespace dyn::tool::sweep
