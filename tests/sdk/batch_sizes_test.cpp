// SPDX-License-Identifier: BSD-2-Clause
// Joints of one type are computed in packs whose width depends on the number of joints. Results must not depend on it.
#include "support/cam_model.hpp"
#include "support/catch.hpp"
#include "support/random_model.hpp"
#include "support/registry.hpp"

using namespace dyn;
using namespace dyn::test;

namespace {

JointDescription revolute() {
  JointDescription joint;
  joint.type = "revolute";
  joint.parameters["axis"] = std::vector<double>{0.3, -1, 2};
  return joint;
}

/// Copies of a joint side by side on the world, each with an asymmetric body.
CompactModel fan(JointDescription joint, int count) {
  Model description;
  for (int i = 0; i < count; ++i) {
    joint.name = "joint" + std::to_string(i);
    description.addBody("body" + std::to_string(i), 0, joint, {1.5, {0.1, -0.2, 0.3}, {1, 0.1, 0.2, 1.2, 0.05, 0.9}});
  }
  return compile(description, registry());
}

}  // namespace

TEST_CASE("a joint's forces do not depend on how many of its type there are", "[batch_sizes]") {
  Random random(8);
  for (const JointDescription& joint : {revolute(), camModel().bodies.back().joint}) {
    const CompactModel one = fan(joint, 1);
    Data alone(one);
    for (int count = 1; count <= 35; ++count) {
      const CompactModel model = fan(joint, count);
      REQUIRE(model.nq() == count);
      Data data(model);
      Eigen::VectorXd q(count), v(count), a(count);
      for (Eigen::VectorXd* x : {&q, &v, &a})
        for (double& number : *x) number = random.uniform(-3, 3);
      const Eigen::VectorXd tau = rnea(model, data, q, v, a);
      for (int i = 0; i < count; ++i) {
        const double expected = rnea(one, alone, q.segment(i, 1), v.segment(i, 1), a.segment(i, 1))[0];
        INFO(joint.type << " " << i << " of " << count);
        CHECK(std::fabs(tau[i] - expected) < 1e-13 * (1 + std::fabs(expected)));
      }
    }
  }
}
