// SPDX-License-Identifier: BSD-2-Clause
// Calls of traced and compiled functions with vectors, and a cache for code that a test compiles.
#pragma once

#include "support/catch.hpp"
#include "support/folder.hpp"
#include "support/random_model.hpp"

#include <dyn/codegen/native.hpp>
#include <dyn/dyn.hpp>

#include <array>
#include <string>
#include <vector>

namespace dyn::test {

/// A compiler cache in a temporary folder.
struct CompilerCache : Folder {
  NativeOptions options() const {
    NativeOptions o;
    o.cache = path.string();
    o.flags = {"-O1"};
    return o;
  }
};

/// The reason why a model cannot be traced; empty if it can.
inline std::string whyNotTraced(const CompactModel& model) {
  try {
    trace(model, "rnea");
    return "";
  } catch (const Error& e) {
    REQUIRE(e.code() == ErrorCode::joint_type);
    return e.what();
  }
}

/// A random state: q, v, and a or tau.
inline std::array<Eigen::VectorXd, 3> randomState(const CompactModel& model, std::uint64_t seed) {
  Random random(seed);
  return {integrate(model, neutral(model), random.vector(model.nv(), 1)), random.vector(model.nv(), 1), random.vector(model.nv(), 2)};
}

/// The largest difference relative to the largest entry of b.
inline double difference(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  REQUIRE(a.size() == b.size());
  return (a - b).cwiseAbs().maxCoeff() / std::max(b.cwiseAbs().maxCoeff(), 1e-300);
}

/// The outputs of a graph. `in` holds all inputs one after the other.
inline std::vector<Eigen::VectorXd> byGraph(const TracedFunction& f, const std::vector<double>& in) {
  const std::vector<double> out = replay<double>(f.graph, in);
  std::vector<Eigen::VectorXd> parts;
  std::ptrdiff_t at = 0;
  for (const ArgumentShape& shape : f.outputs) {
    parts.push_back(Eigen::Map<const Eigen::VectorXd>(out.data() + at, shape.size()));
    at += shape.size();
  }
  return parts;
}
/// The outputs of a graph with the arguments q, q and v, or q, v and a.
inline std::vector<Eigen::VectorXd> byGraph(const TracedFunction& f, const Eigen::VectorXd& q, const Eigen::VectorXd& v, const Eigen::VectorXd& a) {
  std::vector<double> in;
  for (std::size_t i = 0; i < f.inputs.size(); ++i) {
    const Eigen::VectorXd& x = i == 0 ? q : i == 1 ? v : a;
    in.insert(in.end(), x.begin(), x.end());
  }
  return byGraph(f, in);
}

/// The outputs of a compiled function.
inline std::vector<Eigen::VectorXd> byCode(const CompiledFunction& f, const Eigen::VectorXd& q, const Eigen::VectorXd& v, const Eigen::VectorXd& a) {
  std::vector<Eigen::VectorXd> parts;
  const void* in[] = {q.data(), v.data(), a.data()};
  void* out[4];
  for (const ArgumentShape& shape : f.outputs()) parts.emplace_back(shape.size());
  for (std::size_t i = 0; i < parts.size(); ++i) out[i] = parts[i].data();
  f.call(in, out);
  return parts;
}

}  // namespace dyn::test
