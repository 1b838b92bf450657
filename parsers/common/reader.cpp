// SPDX-License-Identifier: BSD-2-Clause
#include "reader.hpp"

#include "common/inertia.hpp"

#include <dyn/spatial/eigen.hpp>

#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace dyn::reader {

void Notes::add(const std::string& what, int line) {
  const auto [kind, is_new] = kinds_.try_emplace(what, Kind{0, line, kinds_.size()});
  ++kind->second.times;
}

std::vector<std::string> Notes::list() const {
  std::vector<std::string> out(kinds_.size());
  for (const auto& [what, kind] : kinds_) {
    std::string& note = out[kind.place];
    if (kind.times == 1 && kind.line > 0) note = "line " + std::to_string(kind.line) + ": ";
    note += what;
    if (kind.times > 1) note += ", " + std::to_string(kind.times) + " times";
    if (kind.times > 1 && kind.line > 0) note += ", first at line " + std::to_string(kind.line);
  }
  return out;
}

std::vector<int> depthFirst(const std::vector<int>& parent, const std::vector<std::string>& names, Order order) {
  const auto count = parent.size();
  std::vector<std::vector<int>> below(count + 1);  // [0] is the world
  for (std::size_t i = 0; i < count; ++i) below[static_cast<std::size_t>(parent[i] + 1)].push_back(static_cast<int>(i));
  std::vector<int> out, stack;
  const auto push = [&](std::vector<int>& siblings) {
    if (order == Order::name)
      std::stable_sort(siblings.begin(), siblings.end(),
                       [&](int a, int b) { return names[static_cast<std::size_t>(a)] < names[static_cast<std::size_t>(b)]; });
    stack.insert(stack.end(), siblings.rbegin(), siblings.rend());
  };
  push(below[0]);
  while (!stack.empty()) {
    const int body = stack.back();
    stack.pop_back();
    out.push_back(body);
    push(below[static_cast<std::size_t>(body + 1)]);
  }
  return out;
}

void judgeInertia(const Inertia<double>& Y, const std::string& body, Inertias inertias, const Where& where, Notes& notes) {
  const std::string whose = "body '" + body + "': ";
  if (!std::isfinite(Y.mass) || !std::isfinite(dot(Y.com, Y.com)) || !toEigen(Y.rotational).allFinite())
    throw Error(ErrorCode::model, whose + "its mass or inertia is not finite", where);
  if (Y.mass < 0) throw Error(ErrorCode::model, whose + "its mass is negative", where);
  const InertiaFaults faults = faultsOf(Y);
  if (faults.massless) notes.add(whose + massless_words, where.line);
  if (faults.point) notes.add(whose + point_words, where.line);
  if (faults.indefinite && inertias == Inertias::physical) throw Error(ErrorCode::model, whose + indefinite_words + anyway_words, where);
  if (faults.indefinite || faults.unreal) notes.add(whose + (faults.indefinite ? indefinite_words : unreal_words), where.line);
}

Mat3<double> nearestRotation(const Mat3<double>& M, const std::string& what, const Where& where) {
  using Matrix = Eigen::Matrix<long double, 3, 3>;
  Matrix R;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) R(i, j) = M(i, j);
  const long double off = (R * R.transpose() - Matrix::Identity()).cwiseAbs().maxCoeff();
  if (!(off < 1e-3L) || R.determinant() < 0)
    throw Error(ErrorCode::model, what + " is no rotation: its rows must be orthonormal and right-handed", where);
  if (off < 4e-16L) return M;
  // Newton's iteration for the orthogonal factor of the polar decomposition.
  for (int k = 0; k < 6; ++k) R = (R + R.inverse().transpose().eval()) / 2;
  Mat3<double> out;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) out(i, j) = static_cast<double>(R(i, j));
  return out;
}

std::string freeName(std::string name, std::set<std::string>& taken) {
  while (!taken.insert(name).second) name += '_';
  return name;
}

void refuseRoot(const std::string& root, const std::string& file, const char* why) {
  throw Error(ErrorCode::argument, std::string(why) + ", so that the root joint '" + root + "' does not apply", {file, 0, ""});
}

}  // namespace dyn::reader
