// What forwardKinematics found is read from the model's own data only, and stays until the next.
#include "support/catch.hpp"
#include "support/random_model.hpp"
#include "support/registry.hpp"

using namespace dyn;
using namespace dyn::test;

namespace {

/// Velocities and accelerations of all frames, columns of 6.
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
  if (coupled) addFollower(description);
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
  if (coupled) return;  // their factors do not follow the tree
  forwardDynamics(model, data, q, other_v, other_a);
  CHECK(motions(model, data) == found);
}

TEST_CASE("accelerations and forces that are computed together are those of each alone", "[kinematics]") {
  const auto seed = static_cast<std::uint64_t>(GENERATE(range(1, 5)));
  const bool coupled = seed == 4;
  Model description = randomTree(registry(), coupled ? 22 : 15, seed, true);
  if (coupled) addFollower(description);
  const CompactModel model = compile(description, registry());
  Random random(seed);
  const Eigen::VectorXd q = integrate(model, neutral(model), random.vector(model.nv(), 0.8)), v = random.vector(model.nv(), 1),
                        a = random.vector(model.nv(), 2);
  Data data(model);
  forwardKinematics(model, data, q, v, a);
  const Eigen::MatrixXd alone = motions(model, data);
  for (const Quantity forces : {Quantity::rnea, Quantity::nle, Quantity::gravity, Quantity::rnea | Quantity::nle | Quantity::gravity}) {
    compute(model, data, Quantity::accelerations | forces, q, v, a);
    CHECK(motions(model, data) == alone);
  }
}

TEST_CASE("poses, velocities and accelerations are not read out of another model's data", "[kinematics][error]") {
  const CompactModel model = compile(randomTree(registry(), 300, 1), registry()), small = compile(randomTree(registry(), 2, 1), registry());
  const Data data(small);
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
  const CompactModel copy = small;  // NOLINT: what is tested
  CHECK(jointPlacement(copy, data, 1).R.m[0] == jointPlacement(small, data, 1).R.m[0]);
}
