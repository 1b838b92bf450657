// SPDX-License-Identifier: BSD-2-Clause
// Results of forwardKinematics are read only with their own model, and stay until the next forwardKinematics.
#include "support/catch.hpp"
#include "support/random_model.hpp"
#include "support/registry.hpp"

using namespace dyn;
using namespace dyn::test;

namespace {

/// Velocities, accelerations and classical accelerations of all frames, three columns of 6 for each frame.
Eigen::MatrixXd motions(const CompactModel& model, const Data& data) {
  const auto frames = static_cast<Eigen::Index>(model.frames().size());
  Eigen::MatrixXd out(6, 3 * frames);
  for (Eigen::Index f = 0; f < frames; ++f) {
    out.col(3 * f) = toEigen(frameVelocity(model, data, static_cast<int>(f), ReferenceFrame::LOCAL));
    out.col(3 * f + 1) = toEigen(frameAcceleration(model, data, static_cast<int>(f), ReferenceFrame::LOCAL_WORLD_ALIGNED));
    out.col(3 * f + 2) = toEigen(frameClassicalAcceleration(model, data, static_cast<int>(f), ReferenceFrame::LOCAL));
  }
  return out;
}

}  // namespace

TEST_CASE("what forwardKinematics found stays while forces are computed", "[kinematics]") {
  const auto seed = static_cast<std::uint64_t>(GENERATE(range(1, 5)));
  const bool coupled = seed == 4;
  Model description = randomTree(registry(), coupled ? 22 : 15, seed, true);
  if (coupled) addDependent(description);
  const CompactModel model = compile(description, registry());
  Random random(seed);
  const Eigen::VectorXd q = integrate(model, neutral(model), random.vector(model.nv(), 0.8)), v = random.vector(model.nv(), 1),
                        a = random.vector(model.nv(), 2), other_v = random.vector(model.nv(), 1), other_a = random.vector(model.nv(), 2);
  std::vector<Force<double>> forces(static_cast<std::size_t>(model.njoints()));
  for (Force<double>& f : forces) f = {random.vector(3), random.vector(3)};
  Data data(model, Need::derivatives);
  forwardKinematics(model, data, q, v, a);
  const Eigen::MatrixXd found = motions(model, data);
  rnea(model, data, q, other_v, other_a);
  CHECK(motions(model, data) == found);
  rnea(model, data, q, other_v, other_a, forces);
  CHECK(motions(model, data) == found);
  nonLinearEffects(model, data, q, other_v);
  CHECK(motions(model, data) == found);
  generalizedGravity(model, data, q);
  CHECK(motions(model, data) == found);
  if (coupled) return;  // forwardDynamics does not support dependent joints: the factors of their M do not follow the tree
  forwardDynamics(model, data, q, other_v, other_a);
  CHECK(motions(model, data) == found);
}

TEST_CASE("accelerations and forces that are computed together are those of each alone", "[kinematics]") {
  const auto seed = static_cast<std::uint64_t>(GENERATE(range(1, 5)));
  const bool coupled = seed == 4;
  Model description = randomTree(registry(), coupled ? 22 : 15, seed, true);
  if (coupled) addDependent(description);
  const CompactModel model = compile(description, registry());
  Random random(seed);
  const Eigen::VectorXd q = integrate(model, neutral(model), random.vector(model.nv(), 0.8)), v = random.vector(model.nv(), 1),
                        a = random.vector(model.nv(), 2);
  Data data(model);
  forwardKinematics(model, data, q, v, a);
  const Eigen::MatrixXd alone = motions(model, data);
  for (const Quantity forces :
       {Quantity(Quantity::rnea), Quantity(Quantity::nle), Quantity(Quantity::gravity), Quantity::rnea | Quantity::nle | Quantity::gravity}) {
    compute(model, data, Quantity::accelerations | forces, q, v, a);
    CHECK(motions(model, data) == alone);
  }
}

TEST_CASE("poses, velocities and accelerations are not read out of another model's data", "[kinematics][error]") {
  const CompactModel model = compile(randomTree(registry(), 300, 1), registry()), small = compile(randomTree(registry(), 2, 1), registry());
  Data data(small);
  forwardKinematics(small, data, neutral(small));
  const int joint = model.njoints() - 1, frame = static_cast<int>(model.frames().size()) - 1;
  const auto of = [](const char* function) { return containing(std::string(function) + ": data was made for another model"); };
  CHECK_THROWS_WITH(jointPlacement(model, data, joint), of("jointPlacement"));
  CHECK_THROWS_WITH(framePlacement(model, data, frame), of("framePlacement"));
  for (const auto reference : {ReferenceFrame::LOCAL, ReferenceFrame::LOCAL_WORLD_ALIGNED}) {
    CHECK_THROWS_WITH(jointVelocity(model, data, joint, reference), of("jointVelocity"));
    CHECK_THROWS_WITH(frameVelocity(model, data, frame, reference), of("frameVelocity"));
    CHECK_THROWS_WITH(jointAcceleration(model, data, joint, reference), of("jointAcceleration"));
    CHECK_THROWS_WITH(frameAcceleration(model, data, frame, reference), of("frameAcceleration"));
    CHECK_THROWS_WITH(jointClassicalAcceleration(model, data, joint, reference), of("jointClassicalAcceleration"));
    CHECK_THROWS_WITH(frameClassicalAcceleration(model, data, frame, reference), of("frameClassicalAcceleration"));
  }
  // A copy of the model is the same model.
  const CompactModel copy = small;  // NOLINT: the copy is tested here
  CHECK(jointPlacement(copy, data, 1).R.m[0] == jointPlacement(small, data, 1).R.m[0]);
}

TEST_CASE("what no call has computed yet is refused, and not zero", "[kinematics]") {
  const CompactModel model = compile(randomTree(registry(), 6, 2, true), registry());
  Random random(2);
  const Eigen::VectorXd q = integrate(model, neutral(model), random.vector(model.nv(), 0.8)), v = random.vector(model.nv(), 1);
  Data data(model, Need::derivatives);
  Eigen::MatrixXd J(6, model.nv());
  CHECK_THROWS_WITH(framePlacement(model, data, 1), containing("has no poses yet; call forwardKinematics(model, data, q) first"));
  CHECK_THROWS_WITH(getFrameJacobian(model, data, 1, ReferenceFrame::LOCAL, J), containing("no poses yet"));
  CHECK_THROWS_WITH(getJointJacobian(model, data, 1, ReferenceFrame::LOCAL, J), containing("no poses yet"));
  forwardKinematics(model, data, q);
  framePlacement(model, data, 1);
  CHECK_THROWS_WITH(frameVelocity(model, data, 1, ReferenceFrame::LOCAL), containing("no velocities yet; call forwardKinematics(model, data, q, v)"));
  forwardKinematics(model, data, q, v);
  frameVelocity(model, data, 1, ReferenceFrame::LOCAL);
  CHECK_THROWS_WITH(jointAcceleration(model, data, 1, ReferenceFrame::LOCAL), containing("no accelerations yet"));
  CHECK_THROWS_WITH(frameClassicalAcceleration(model, data, 1, ReferenceFrame::LOCAL), containing("no accelerations yet"));
  // computeJointJacobians computes poses and keeps velocities. forwardKinematics(q) invalidates velocities.
  computeJointJacobians(model, data, q);
  frameVelocity(model, data, 1, ReferenceFrame::LOCAL);
  forwardKinematics(model, data, q);
  CHECK_THROWS_WITH(frameVelocity(model, data, 1, ReferenceFrame::LOCAL), containing("no velocities yet"));
  Data fresh(model);
  computeFrameJacobian(model, fresh, q, 1, ReferenceFrame::LOCAL, J);
  framePlacement(model, fresh, 1);
  BatchData batch(model, 3, Need::kinematics);
  CHECK_THROWS_WITH(framePlacement(model, batch, 1, 0), containing("no poses yet"));
  forwardKinematics(model, batch, Eigen::MatrixXd(q.replicate(1, 3)));
  framePlacement(model, batch, 1, 0);
  CHECK_THROWS_WITH(frameVelocity(model, batch, 1, 0, ReferenceFrame::LOCAL), containing("no velocities yet"));
}

TEST_CASE("a name that is not there is told with those that are like it", "[kinematics]") {
  Model description;
  JointDescription joint;
  joint.type = "spherical";
  for (const char* name : {"left_elbow", "right_elbow", "neck"}) {
    joint.name = name;
    description.addBody(std::string(name) + "_link", 0, joint, {1, {}, {1, 0, 0, 1, 0, 1}});
  }
  const CompactModel model = compile(description, registry());
  CHECK(model.findJoint("neck") == 3);
  CHECK(model.findFrame("nick") == -1);
  CHECK_THROWS_WITH(model.jointId("nick"), containing("the model has no joint 'nick'; did you mean 'neck'?"));
  CHECK_THROWS_WITH(model.frameId("Left_Elbow_Link"), containing("did you mean 'left_elbow_link'"));
  CHECK_THROWS_WITH(model.jointId("elbow"), containing("'left_elbow' or 'right_elbow'?"));
  CHECK_THROWS_WITH(model.frameId("neck"), containing("'neck', which is a joint; the frame of the body that it moves is 'neck_link'"));
  CHECK_THROWS_WITH(model.jointId("neck_link"), containing("'neck_link', which is a frame; the joint that moves it is 'neck'"));
  CHECK_THROWS_WITH(model.frameId("camera"), containing("the model has no frame 'camera'") && !containing("mean"));
}
