// SPDX-License-Identifier: BSD-2-Clause
// Finds out why a pivot of the mass matrix vanished or is not finite. This runs only after a failure, so it need not be fast.
#include "algorithm/support/inputs.hpp"
#include "at.hpp"

#include <dyn/error.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <sstream>

namespace dyn {

namespace {

using Column = std::array<double, 6>;

double dotOf(const Column& a, const Column& b) {
  double sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += a[k] * b[k];
  return sum;
}

/// A joint's pose and motion subspace at q.
struct JointAt {
  std::array<double, 12> pose{};
  std::vector<Column> subspace;  ///< of dense joints; those of other joints never lose rank

  JointAt(const CompactImpl& m, int body, const double* q) {
    const BodyIndex& x = m.index[at(body)];
    const TypeBatch& batch = m.batches[at(x.batch)];
    double columns[6 * max_joint_nv] = {};
    JointBatch<double> call;
    call.count = 1;
    call.constants = batch.constants.data() + x.slot;
    call.constant_count = batch.constant_count;
    call.constants_stride = batch.count;
    call.q_stride = call.stride = 1;
    call.q = q + x.idx_q;
    call.pose = pose.data();
    const bool dense = batch.shape == Shape::dense;
    call.subspace = dense ? columns : nullptr;
    batch.type->kinematics(call);
    if (!dense) return;
    for (int k = 0; k < batch.nv; ++k) {
      Column column;
      std::copy_n(columns + 6 * k, 6, column.begin());
      subspace.push_back(column);
    }
  }
  bool finite() const {
    const auto finite = [](double x) { return std::isfinite(x); };
    return std::all_of(pose.begin(), pose.end(), finite) &&
           std::all_of(subspace.begin(), subspace.end(), [&](const Column& c) { return std::all_of(c.begin(), c.end(), finite); });
  }
  /// The number of linearly independent columns, to half of the digits of a double, because pivots are quadratic in the columns.
  int rank() const {
    std::vector<Column> left = subspace;
    std::vector<double> sizes;
    for (const Column& c : left) sizes.push_back(std::sqrt(dotOf(c, c)));
    int rank = 0;
    for (std::size_t step = 0; step < left.size(); ++step) {
      std::size_t best = left.size();
      double largest = 1e-7;
      for (std::size_t k = 0; k < left.size(); ++k) {
        const double share = sizes[k] > 0 ? std::sqrt(dotOf(left[k], left[k])) / sizes[k] : 0;
        if (share > largest) largest = share, best = k;
      }
      if (best == left.size()) break;
      ++rank;
      const Column pivot = left[best];
      for (Column& c : left) {
        const double along = dotOf(c, pivot) / dotOf(pivot, pivot);
        for (std::size_t r = 0; r < c.size(); ++r) c[r] -= along * pivot[r];
      }
      left[best] = {};
    }
    return rank;
  }
};

std::string listed(const double* q, int n) {
  std::ostringstream out;
  out.imbue(std::locale::classic());
  for (int k = 0; k < n; ++k) out << (k > 0 ? ", " : "") << q[k];
  return out.str();
}

const std::string& jointOf(const CompactImpl& m, int body) { return m.joints[at(m.index[at(body)].joint)].name; }

[[noreturn]] void refuse(const char* algorithm, const std::string& joint, const std::string& why) {
  throw Error(ErrorCode::singular, std::string(algorithm) + ": " + why, {"", 0, joint});
}

}  // namespace

void refuseSingular(const char* algorithm, const CompactImpl& m, int body, const double* q) {
  const BodyIndex& index = m.index[at(body)];
  // The pivot of a body depends on its whole subtree.
  double mass = 0, inertia = 0;
  for (int i = body; i < m.tree_end[at(body)]; ++i) {
    const BodyConstants<double>& c = m.constants[at(i)];
    mass += c.mass;
    inertia =
        std::max({inertia, std::sqrt(dot(c.rotational * Vec3<double>{1, 1, 1}, c.rotational * Vec3<double>{1, 1, 1})), c.mass * dot(c.com, c.com)});
    if (q == nullptr) continue;
    const BodyIndex& x = m.index[at(i)];
    if (!JointAt(m, i, q).finite())
      refuse(algorithm, jointOf(m, i),
             "the pose or the motion of this joint at q = (" + listed(q + x.idx_q, x.nq) + ") is not finite: that is what its type '" +
                 m.joints[at(x.joint)].type + "' gives there");
  }
  constexpr double far = 0x1p500;  // products of two such numbers come close to the largest double, 2^1024
  if (!(mass < far) || !(inertia < far))
    refuse(algorithm, jointOf(m, body),
           "what this joint moves has a mass of " + listed(&mass, 1) + " kg and inertias of " + listed(&inertia, 1) +
               " kg m^2, whose products are beyond the range of numbers; check the units of its bodies' inertias");
  if (q != nullptr) {
    const JointAt joint(m, body, q);
    const int freedom = static_cast<int>(joint.subspace.size()), rank = joint.rank();
    if (rank < freedom)
      refuse(algorithm, jointOf(m, body),
             "M is singular at q = (" + listed(q + index.idx_q, index.nq) + ") of this joint: the rank of its motion is " + std::to_string(rank) +
                 " there, of " + std::to_string(freedom) + (freedom > 1 ? " (gimbal lock)" : ", velocities do not move it") +
                 "; stay away from this configuration");
  }
  const std::string cure = "give its bodies mass, give the joint armature, or lock it";
  if (!(mass > 0) && !(inertia > 0))
    refuse(algorithm, jointOf(m, body), "the mass matrix is singular: what this joint moves has no inertia; " + cure);
  refuse(algorithm, jointOf(m, body),
         "the mass matrix is singular here: what this joint moves has no inertia along its motion (" + cure +
             "), or joints below it move it the same way at this q (axes that are aligned, gimbal lock: stay away from this configuration)");
}

}  // namespace dyn
