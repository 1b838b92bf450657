// SPDX-License-Identifier: BSD-2-Clause
// Jacobians of all joints at once and of many states, compared with Jacobians of one joint or frame and one state.
#include "support/catch.hpp"
#include "support/random_model.hpp"
#include "support/registry.hpp"

using namespace dyn;
using namespace dyn::test;

namespace {

constexpr ReferenceFrame references[] = {ReferenceFrame::LOCAL, ReferenceFrame::WORLD, ReferenceFrame::LOCAL_WORLD_ALIGNED};

Eigen::MatrixXd configurations(const CompactModel& model, int states) {
  Eigen::MatrixXd q(model.nq(), states);
  for (int k = 0; k < states; ++k) q.col(k) = randomConfiguration(model, static_cast<std::uint64_t>(k) + 1);
  return q;
}

template <class Column>
double off(const Column& column, const Eigen::MatrixXd& J) {
  return (column.template cast<double>() - J.reshaped()).cwiseAbs().maxCoeff() / (1 + J.cwiseAbs().maxCoeff());
}

}  // namespace

TEST_CASE("the Jacobians of all joints at once have the columns of each", "[jacobians]") {
  const auto seed = static_cast<std::uint64_t>(GENERATE(range(1, 6)));
  const CompactModel model = compile(randomTree(registry(), 25, seed), registry());
  Data data(model), other(model);
  const Eigen::VectorXd q = randomConfiguration(model, seed);
  const Eigen::MatrixXd all = computeJointJacobians(model, data, q);
  Eigen::MatrixXd J(6, model.nv()), again(6, model.nv());
  for (int j = 1; j < model.njoints(); ++j) {
    computeJointJacobian(model, other, q, j, ReferenceFrame::WORLD, J);
    for (int k = 0; k < model.nv(); ++k)
      if (!J.col(k).isZero(0)) CHECK((J.col(k) - all.col(k)).norm() < 1e-14 * (1 + all.col(k).norm()));
    // computeJointJacobians also computes the poses that getJointJacobian needs.
    getJointJacobian(model, data, j, ReferenceFrame::LOCAL, J);
    computeJointJacobian(model, other, q, j, ReferenceFrame::LOCAL, again);
    CHECK((J - again).norm() < 1e-14 * (1 + J.norm()));
  }
}

TEMPLATE_TEST_CASE("Jacobians of a batch are those of single states", "[jacobians]", double, float) {
  const double tolerance = std::is_same_v<TestType, double> ? 1e-13 : 1e-5;
  const CompactModel model = compile(randomTree(registry(), 14, 7), registry());
  constexpr int states = 19;
  const Eigen::MatrixXd q = configurations(model, states);
  Eigen::Matrix<TestType, Eigen::Dynamic, Eigen::Dynamic> Q(q.rows(), q.cols());
  Q = q.cast<TestType>();
  BasicBatchData<TestType> batch(model, states, Need::jacobians, 2);
  Data data(model);
  Eigen::MatrixXd J(6, model.nv());
  const auto all = computeJointJacobians(model, batch, Q);
  for (int k = 0; k < states; ++k) CHECK(off(all.col(k), computeJointJacobians(model, data, q.col(k))) < tolerance);
  for (const ReferenceFrame reference : references) {
    const int frame = model.frameId("tool"), joint = model.njoints() - 1;
    const auto of_frame = computeFrameJacobian(model, batch, Q, frame, reference);
    for (int k = 0; k < states; ++k) {
      computeFrameJacobian(model, data, q.col(k), frame, reference, J);
      CHECK(off(of_frame.col(k), J) < tolerance);
    }
    const auto of_joint = computeJointJacobian(model, batch, Q, joint, reference);
    for (int k = 0; k < states; ++k) {
      computeJointJacobian(model, data, q.col(k), joint, reference, J);
      CHECK(off(of_joint.col(k), J) < tolerance);
    }
  }
}

TEST_CASE("Jacobians of joints that follow others: one by one, also in batches", "[jacobians]") {
  Model description = randomTree(registry(), 22, 4);
  addDependent(description);
  const CompactModel model = compile(description, registry());
  const Eigen::MatrixXd q = configurations(model, 5);
  Data data(model);
  BatchData batch(model, 5, Need::jacobians, 2);
  const int joint = model.jointId("follower");
  const auto batched = computeJointJacobian(model, batch, q, joint, ReferenceFrame::LOCAL);
  Eigen::MatrixXd J(6, model.nv());
  for (int k = 0; k < 5; ++k) {
    computeJointJacobian(model, data, q.col(k), joint, ReferenceFrame::LOCAL, J);
    CHECK((batched.col(k) - J.reshaped()).cwiseAbs().maxCoeff() < 1e-14);
  }
  CHECK_THROWS_WITH(computeJointJacobians(model, data, q.col(0)), containing("follow"));
  CHECK_THROWS_WITH(computeJointJacobians(model, batch, q), containing("follow"));
}

TEST_CASE("what is wrong with a batch of poses is said with the state", "[jacobians]") {
  const CompactModel model = compile(randomTree(registry(), 20, 7), registry());
  Eigen::MatrixXd q = configurations(model, 19);
  BatchData batch(model, 19, Need::jacobians | Need::kinematics);
  for (const JointRecord& r : model.joints()) {
    if (r.type != "spherical") continue;
    q.col(13).segment(r.idx_q, 4).setZero();
    CHECK_THROWS_WITH(computeJointJacobians(model, batch, q), containing("state 13") && containing(r.name));
    CHECK_THROWS_WITH(forwardKinematics(model, batch, q), containing("state 13") && containing(r.name));
    break;
  }
  BatchData without(model, 19);
  CHECK_THROWS_WITH(computeJointJacobians(model, without, q), containing("Need::jacobians"));
  CHECK_THROWS_WITH(computeFrameJacobian(model, batch, q, 1 << 20, ReferenceFrame::LOCAL), containing("does not exist"));
  CHECK_THROWS_WITH(computeJointJacobian(model, batch, q, -1, ReferenceFrame::LOCAL), containing("joint -1 does not exist"));
}
