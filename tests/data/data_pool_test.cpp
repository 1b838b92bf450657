// SPDX-License-Identifier: BSD-2-Clause
// DataPool runs algorithms of single states for many states, on threads with a Data each.
#include "support/cam_model.hpp"
#include "support/catch.hpp"
#include "support/random_model.hpp"
#include "support/registry.hpp"

using namespace dyn;
using namespace dyn::test;

namespace {

struct States {
  Eigen::MatrixXd q, v, a;
  States(const CompactModel& model, int count) : q(model.nq(), count), v(model.nv(), count), a(model.nv(), count) {
    Random random(3);
    for (int k = 0; k < count; ++k) {
      q.col(k) = randomConfiguration(model, static_cast<std::uint64_t>(k));
      v.col(k) = random.vector(model.nv(), 1);
      a.col(k) = random.vector(model.nv(), 1);
    }
  }
};

}  // namespace

TEST_CASE("a pool's results are those of one state after the other, whatever its threads", "[data][batch]") {
  const CompactModel model = compile(randomTree(registry(), 12, 5, true), registry());
  constexpr int count = 37;
  const States x(model, count);
  Data data(model, Need::derivatives);
  const int frame = model.frameId(model.frames().back().name);
  for (const int threads : {1, 2, 5}) {
    DataPool pool(model, Need::derivatives, threads);
    CHECK(pool.threads() == threads);
    std::vector<Eigen::MatrixXd> regressors(count), solved(count), velocities(count), accelerations(count);
    std::vector<SecondDerivativeData> scratch;
    scratch.reserve(static_cast<std::size_t>(threads));
    for (int t = 0; t < threads; ++t) scratch.emplace_back(model);
    std::vector<double> second(count);
    pool.forEach(count, [&](Data& mine, Eigen::Index k) {
      const auto i = static_cast<std::size_t>(k);
      regressors[i] = computeJointTorqueRegressor(model, mine, x.q.col(k), x.v.col(k), x.a.col(k));
      crba(model, mine, x.q.col(k));
      cholesky::decompose(model, mine);
      solved[i] = x.a.col(k);
      cholesky::solve(model, mine, solved[i]);
      computeForwardKinematicsDerivatives(model, mine, x.q.col(k), x.v.col(k), x.a.col(k));
      velocities[i].resize(6, model.nv());
      accelerations[i].resize(6, model.nv());
      getFrameVelocityDerivatives(model, mine, frame, ReferenceFrame::LOCAL, velocities[i], accelerations[i]);
    });
    pool.forEach(count, [&](Data& mine, Eigen::Index k, int thread) {
      SecondDerivativeData& own = scratch[static_cast<std::size_t>(thread)];
      const auto tensors = computeRNEASecondOrderDerivatives(model, mine, own, x.q.col(k), x.v.col(k), x.a.col(k));
      second[static_cast<std::size_t>(k)] = tensors.d2tau_dqdq[0](0, 0);
    });
    SecondDerivativeData own(model);
    for (int k = 0; k < count; ++k) {
      const auto i = static_cast<std::size_t>(k);
      CHECK(regressors[i] == computeJointTorqueRegressor(model, data, x.q.col(k), x.v.col(k), x.a.col(k)));
      crba(model, data, x.q.col(k));
      cholesky::decompose(model, data);
      Eigen::MatrixXd b = x.a.col(k), v(6, model.nv()), a(6, model.nv());
      cholesky::solve(model, data, b);
      CHECK(solved[i] == b);
      computeForwardKinematicsDerivatives(model, data, x.q.col(k), x.v.col(k), x.a.col(k));
      getFrameVelocityDerivatives(model, data, frame, ReferenceFrame::LOCAL, v, a);
      CHECK(velocities[i] == v);
      CHECK(accelerations[i] == a);
      const auto tensors = computeRNEASecondOrderDerivatives(model, data, own, x.q.col(k), x.v.col(k), x.a.col(k));
      CHECK(second[i] == tensors.d2tau_dqdq[0](0, 0));
    }
  }
}

TEST_CASE("what goes wrong in a pool names the first state, and leaves the others computed", "[data][batch][error]") {
  const CompactModel model = compile(camModel(), registry());
  constexpr int count = 20;
  Eigen::MatrixXd q = Eigen::MatrixXd::Constant(1, count, 0.5), ddq = Eigen::MatrixXd::Zero(1, count);
  q(0, 7) = q(0, 13) = 0;  // here the joint does not move, so M is singular
  DataPool pool(model, Need::state, 3);
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(1), tau = Eigen::VectorXd::Ones(1);
  const auto run = [&] { pool.forEach(count, [&](Data& data, Eigen::Index k) { ddq.col(k) = aba(model, data, q.col(k), zero, tau); }); };
  CHECK_THROWS_WITH(run(), containing("joint 'cam': state 7: aba:"));
  for (int k = 0; k < count; ++k) CHECK((ddq(0, k) != 0) == (k != 7 && k != 13));
  try {
    run();
  } catch (const Error& e) {
    CHECK(e.code() == ErrorCode::singular);
    CHECK(e.where().joint == "cam");
  }
  CHECK_THROWS_WITH(pool.forEach(3, [](Data&, std::ptrdiff_t) { throw std::runtime_error("no sensor"); }), containing("no sensor"));
  CHECK_THROWS_WITH(DataPool(model, Need::state, 0), containing("at least one"));
  int calls = 0;
  pool.forEach(0, [&](Data&, std::ptrdiff_t) { ++calls; });
  CHECK(calls == 0);
}
