// SPDX-License-Identifier: BSD-2-Clause
// Results that do not depend on a uniform velocity of the base lose no digits when the base is fast.
#include "support/catch.hpp"
#include "support/random_model.hpp"
#include "support/registry.hpp"

#include <dyn/dyn.hpp>

using namespace dyn;
using namespace dyn::test;

namespace {

/// A tree on a carriage that translates along x, y and z.
CompactModel carried(std::uint64_t seed) {
  Model m;
  JointDescription carriage;
  carriage.name = "carriage";
  carriage.type = "translation";
  m.addBody("carriage", 0, carriage, {2, {0.1, 0, 0.3}, {1, 0, 0, 1, 0, 1}});
  return compile(append(m, randomTree(registry(), 12, seed), "carriage"), registry());
}

double off(const Eigen::MatrixXd& found, const Eigen::MatrixXd& expected) {
  return (found - expected).cwiseAbs().maxCoeff() / expected.cwiseAbs().maxCoeff();
}

}  // namespace

TEST_CASE("a fast base spoils no acceleration, force or rate of momentum", "[galilei]") {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    CAPTURE(seed);
    const CompactModel model = carried(seed);
    Random random(seed);
    const Eigen::VectorXd q = integrate(model, neutral(model), random.vector(model.nv(), 0.7)), v = random.vector(model.nv(), 1),
                          a = random.vector(model.nv(), 1), tau = random.vector(model.nv(), 3);
    Eigen::VectorXd fast = v;
    fast.head<3>() += Eigen::Vector3d(1e6, -2e6, 0.5e6);
    const double bound = 1e-13;
    Data data(model, Need::derivatives);
    const auto same = [&](const char* what, const auto& compute) {
      const Eigen::MatrixXd slow = compute(v), quick = compute(fast);
      INFO(what);
      CHECK(off(quick, slow) < bound);
    };
    same("rnea", [&](const Eigen::VectorXd& u) { return Eigen::MatrixXd(rnea(model, data, q, u, a)); });
    same("aba", [&](const Eigen::VectorXd& u) { return Eigen::MatrixXd(aba(model, data, q, u, tau)); });
    same("acom", [&](const Eigen::VectorXd& u) { return Eigen::MatrixXd(toEigen(centerOfMass(model, data, q, u, a).acceleration)); });
    same("frames", [&](const Eigen::VectorXd& u) {
      forwardKinematics(model, data, q, u, a);
      Eigen::MatrixXd all(6, static_cast<Eigen::Index>(model.frames().size()) - 1);
      for (Eigen::Index f = 0; f < all.cols(); ++f)
        all.col(f) = toEigen(frameClassicalAcceleration(model, data, static_cast<int>(f) + 1, ReferenceFrame::LOCAL_WORLD_ALIGNED));
      return all;
    });
    same("rate of linear momentum", [&](const Eigen::VectorXd& u) {
      return Eigen::MatrixXd(Eigen::MatrixXd(computeCentroidalMomentumTimeVariation(model, data, q, u, a).dhg).topRows(3));
    });
    same("rate of momentum",
         [&](const Eigen::VectorXd& u) { return Eigen::MatrixXd(computeCentroidalMomentumTimeVariation(model, data, q, u, a).dhg); });
    same("rnea by q", [&](const Eigen::VectorXd& u) { return Eigen::MatrixXd(computeRNEADerivatives(model, data, q, u, a).dtau_dq); });
    same("rnea by v", [&](const Eigen::VectorXd& u) { return Eigen::MatrixXd(computeRNEADerivatives(model, data, q, u, a).dtau_dv); });
    same("aba by q", [&](const Eigen::VectorXd& u) { return Eigen::MatrixXd(computeABADerivatives(model, data, q, u, tau).ddq_dq); });
    same("regressor", [&](const Eigen::VectorXd& u) { return Eigen::MatrixXd(computeJointTorqueRegressor(model, data, q, u, a)); });
  }
}
