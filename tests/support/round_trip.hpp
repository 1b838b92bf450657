// SPDX-License-Identifier: BSD-2-Clause
// Compares a model with what a writer and a reader make of it: the same motion, by the names of joints and frames.
#pragma once

#include "support/random_model.hpp"
#include "support/registry.hpp"

#include <dyn/model/difference.hpp>
#include <dyn/spatial/eigen.hpp>

#include <string>
#include <vector>

namespace dyn::test {

/// A state of one model as that of another one, which has the same joints in any order. A joint may be several in the other model, called "joint/0",
/// "joint/1" and so on.
class Renumbering {
 public:
  Renumbering(const CompactModel& from, const CompactModel& to) : q_(static_cast<std::size_t>(to.nq())), v_(static_cast<std::size_t>(to.nv())) {
    REQUIRE(from.nq() == to.nq());
    REQUIRE(from.nv() == to.nv());
    for (std::size_t j = 1; j < from.joints().size(); ++j) {
      const JointRecord& x = from.joints()[j];
      if (x.nv == 0) continue;
      int nq = 0, nv = 0;
      for (int part = 0; nq < x.nq; ++part) {
        const bool whole = part == 0 && to.findJoint(x.name) >= 0;
        const JointRecord& y = to.joints()[static_cast<std::size_t>(to.jointId(whole ? x.name : x.name + "/" + std::to_string(part)))];
        for (int k = 0; k < y.nq; ++k) q_[static_cast<std::size_t>(y.idx_q + k)] = x.idx_q + nq++;
        for (int k = 0; k < y.nv; ++k) v_[static_cast<std::size_t>(y.idx_v + k)] = x.idx_v + nv++;
      }
      REQUIRE(nq == x.nq);
      REQUIRE(nv == x.nv);
    }
  }
  Eigen::VectorXd q(const Eigen::VectorXd& of) const { return of(q_); }
  Eigen::VectorXd v(const Eigen::VectorXd& of) const { return of(v_); }
  Eigen::MatrixXd M(const Eigen::MatrixXd& of) const { return of(v_, v_); }

 private:
  std::vector<int> q_, v_;
};

/// Checks that two models have the same poses, mass matrices and torques, by the names of their joints and frames. Returns the names of the first
/// model's frames that the second one lacks.
inline std::vector<std::string> checkSameMotion(const Model& a, const Model& b) {
  const CompactModel first = compile(a, registry()), second = compile(b, registry());
  const Renumbering renumbered(first, second);
  std::vector<std::string> missing;
  for (const FrameRecord& frame : first.frames())
    if (second.findFrame(frame.name) < 0) missing.push_back(frame.name);
  Data d1(first, Need::mass_matrix), d2(second, Need::mass_matrix);
  Random random(17);
  for (unsigned seed = 0; seed < 3; ++seed) {
    const Eigen::VectorXd q = randomConfiguration(first, seed), v = random.vector(first.nv(), 1), acceleration = random.vector(first.nv(), 1);
    const Eigen::MatrixXd M = renumbered.M(crba(first, d1, q)), N = crba(second, d2, renumbered.q(q));
    const double bound = 1e-13 * (1 + static_cast<double>(first.njoints()));
    if (M.size() > 0) CHECK((M - N).cwiseAbs().maxCoeff() <= bound * M.cwiseAbs().maxCoeff());
    const Eigen::VectorXd tau = renumbered.v(rnea(first, d1, q, v, acceleration));
    const Eigen::VectorXd other = rnea(second, d2, renumbered.q(q), renumbered.v(v), renumbered.v(acceleration));
    if (tau.size() > 0) CHECK((tau - other).cwiseAbs().maxCoeff() <= 10 * bound * (tau.cwiseAbs().maxCoeff() + M.cwiseAbs().maxCoeff()));
    forwardKinematics(first, d1, q);
    forwardKinematics(second, d2, renumbered.q(q));
    for (std::size_t f = 1; f < first.frames().size(); ++f) {
      const int own = second.findFrame(first.frames()[f].name);
      if (own < 0) continue;
      INFO(first.frames()[f].name);
      const SE3<double> X = framePlacement(first, d1, static_cast<int>(f)), Y = framePlacement(second, d2, own);
      CHECK((toEigen(X) - toEigen(Y)).cwiseAbs().maxCoeff() <= bound * (1 + toEigen(X.p).norm()));
    }
  }
  return missing;
}

inline std::string joined(const std::vector<std::string>& lines) {
  std::string out;
  for (const std::string& line : lines) out += line + "\n";
  return out;
}

inline std::string textOf(const std::vector<Difference>& found) {
  std::string out;
  for (const Difference& d : found) out += d.topic + " " + d.name + " " + d.what + ": " + d.a + " | " + d.b + "\n";
  return out;
}

}  // namespace dyn::test
