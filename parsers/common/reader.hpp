// SPDX-License-Identifier: BSD-2-Clause
// Rules that readers of several formats share: the order of bodies, inertias that no body has, rotations, and notes that are given once each.
#pragma once

#include <dyn/model/model.hpp>
#include <dyn/parsers/options.hpp>

#include <map>
#include <set>
#include <string>
#include <vector>

namespace dyn::reader {

/// Notes, each kind once, with how often it occurred and where first.
class Notes {
 public:
  /// Counts one occurrence. `line` is 0 where it is unknown.
  void add(const std::string& what, int line = 0);
  /// Returns one text for each kind, in the order of their first occurrence.
  std::vector<std::string> list() const;

 private:
  struct Kind {
    int times = 0, line = 0;
    std::size_t place = 0;
  };
  std::map<std::string, Kind> kinds_;
};

/// Returns the numbers of n bodies depth first. `parent` has the number of each body's parent, or -1 for the world. Siblings are sorted by name, or
/// stay in their order. Bodies on a circle of parents are left out. O(n log n).
std::vector<int> depthFirst(const std::vector<int>& parent, const std::vector<std::string>& names, Order order);

/// Judges the inertia of a body. Throws Error(model) for numbers that are not finite, a negative mass, and an inertia that is not positive
/// semi-definite (with Inertias::any this is a note). Notes an inertia that violates the triangle inequality, a mass without inertia, and an inertia
/// without mass. Numbers written with six digits pass.
void judgeInertia(const Inertia<double>& Y, const std::string& body, Inertias inertias, const Where& where, Notes& notes);

/// Returns the rotation nearest to a matrix, which is the matrix itself if it is orthonormal to rounding. Throws Error(model) that begins with `what`
/// if an entry of M M^T differs from the identity by more than 1e-3, or if M mirrors.
Mat3<double> nearestRotation(const Mat3<double>& M, const std::string& what, const Where& where);

/// Returns a name that is not in `taken`, made from `name` by appending "_", and adds it.
std::string freeName(std::string name, std::set<std::string>& taken);

/// Throws Error(argument) that says why the robot in `file` takes no root joint.
[[noreturn]] void refuseRoot(const std::string& root, const std::string& file, const char* why = "has its own joint between world and robot");

}  // namespace dyn::reader
