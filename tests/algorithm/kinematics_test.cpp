// What forwardKinematics found is read from the model's own data only.
#include "support/catch.hpp"
#include "support/random_model.hpp"
#include "support/registry.hpp"

using namespace dyn;
using namespace dyn::test;

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
  const CompactModel copy = small;
  CHECK(jointPlacement(copy, data, 1).R.m[0] == jointPlacement(small, data, 1).R.m[0]);
}
