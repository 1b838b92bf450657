// SPDX-License-Identifier: BSD-2-Clause
// The states of a simulation over time, written as a table, as JSON or as a picture.
#pragma once

#include "states.hpp"

#include <string>
#include <vector>

namespace dyn::tool {

class Trajectory {
 public:
  explicit Trajectory(const CompactModel& model) : model_(model) {}

  void add(double t, const Eigen::VectorXd& q, const Eigen::VectorXd& v, double energy);
  bool empty() const { return times_.empty(); }
  double firstEnergy() const { return energies_.front(); }
  double lastEnergy() const { return energies_.back(); }
  /// Largest difference of the energy from the first one.
  double energyDrift() const;

  /// Writes the format of the file's ending: .csv (one line per state: t, q, v, energy) or .json. Throws Error(argument | file).
  void write(const std::string& path) const;
  /// Draws the coordinates over time, as SVG.
  void plot(const std::string& path) const;

 private:
  std::string csv() const;
  Json json() const;

  CompactModel model_;
  std::vector<double> times_, energies_;
  std::vector<Eigen::VectorXd> q_, v_;
};

}  // namespace dyn::tool
