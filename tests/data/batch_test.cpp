// SPDX-License-Identifier: BSD-2-Clause
// Batches give the same results as single states, whatever the lanes, the threads and the number of states.
#include "support/cam_model.hpp"
#include "support/catch.hpp"
#include "support/random_model.hpp"
#include "support/registry.hpp"
#include "support/skip.hpp"
#include "support/states.hpp"

#include <dyn/algorithm/batch_derivatives.hpp>
#include <dyn/spatial/eigen.hpp>

#include <alloc_guard.hpp>

using namespace dyn;
using namespace dyn::test;

namespace {

/// Results of f for each state alone, as columns with `rows` entries.
template <class F>
Eigen::MatrixXd oneByOne(Eigen::Index rows, const States& s, F&& f) {
  Eigen::MatrixXd out(rows, s.q.cols());
  for (Eigen::Index k = 0; k < s.q.cols(); ++k) {
    const Eigen::MatrixXd column = f(Eigen::VectorXd(s.q.col(k)), Eigen::VectorXd(s.v.col(k)), Eigen::VectorXd(s.a.col(k)));
    out.col(k) = Eigen::Map<const Eigen::VectorXd>(column.data(), rows);
  }
  return out;
}

/// The largest ratio max |x - y| / max |y| of any column.
template <class X>
double off(const X& x, const Eigen::MatrixXd& y) {
  REQUIRE(x.rows() == y.rows());
  REQUIRE(x.cols() == y.cols());
  double worst = 0;
  for (Eigen::Index k = 0; k < y.cols(); ++k) {
    const double e = (x.col(k).template cast<double>() - y.col(k)).cwiseAbs().maxCoeff() / std::max(1e-300, y.col(k).cwiseAbs().maxCoeff());
    worst = std::isfinite(e) ? std::max(worst, e) : 1e300;
  }
  return worst;
}

template <class T>
void checkAll(const CompactModel& model, const States& s, int threads, double tolerance, double aba_tolerance) {
  using Matrix = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>;
  Data data(model, Need::mass_matrix);
  BasicBatchData<T> batch(model, static_cast<int>(s.q.cols()) + 3, Need::mass_matrix, threads);
  const Matrix q = s.q.cast<T>(), v = s.v.cast<T>(), a = s.a.cast<T>();
  const Eigen::Index nv = model.nv();
  CHECK(off(rnea(model, batch, q, v, a),
            oneByOne(nv, s, [&](const auto& x, const auto& y, const auto& z) { return Eigen::VectorXd(rnea(model, data, x, y, z)); })) < tolerance);
  CHECK(off(nonLinearEffects(model, batch, q, v), oneByOne(nv, s, [&](const auto& x, const auto& y, const auto&) {
              return Eigen::VectorXd(nonLinearEffects(model, data, x, y));
            })) < tolerance);
  CHECK(off(generalizedGravity(model, batch, q), oneByOne(nv, s, [&](const auto& x, const auto&, const auto&) {
              return Eigen::VectorXd(generalizedGravity(model, data, x));
            })) < tolerance);
  CHECK(off(crba(model, batch, q),
            oneByOne(nv * nv, s, [&](const auto& x, const auto&, const auto&) { return Eigen::MatrixXd(crba(model, data, x)); })) < tolerance);
  CHECK(off(aba(model, batch, q, v, a), oneByOne(nv, s, [&](const auto& x, const auto& y, const auto& z) {
              return Eigen::VectorXd(aba(model, data, x, y, z));
            })) < aba_tolerance);
}

}  // namespace

TEST_CASE("a batch gives what single states give, for every joint type and any number of states", "[batch]") {
  const int states = GENERATE(1, 2, 7, 16, 19);
  const auto seed = static_cast<std::uint64_t>(states);
  const CompactModel model = compile(randomTree(registry(), 25, seed, states % 2 == 1), registry());
  const States s(model, states, seed);
  checkAll<double>(model, s, 1, 1e-13, 1e-9);
  checkAll<double>(model, s, 3, 1e-13, 1e-9);
}

TEST_CASE("columns of any length go into a batch and out of it, also out of a larger matrix", "[batch]") {
  Model chain;
  Random random(3);
  for (int n = 1; n <= 18; ++n) {
    JointDescription joint;
    joint.name = "joint" + std::to_string(n);
    joint.type = "revolute";
    joint.parameters["axis"] = std::vector<double>{0, 1, 0};
    joint.placement.p = {0.1, 0.2, 0.3};
    chain.addBody("body" + std::to_string(n), n - 1, joint, random.inertia());
    const CompactModel model = compile(chain, registry());
    for (const int states : {1, 2, 7, 8, 9, 17}) {
      // The blocks end at the end of the matrices' memory, so that reading beyond a block is an error.
      const Eigen::MatrixXd q = Eigen::MatrixXd::Random(n + 3, states + 1), v = Eigen::MatrixXd::Random(n + 3, states + 1);
      const auto block = [&](const Eigen::MatrixXd& x) { return x.bottomRightCorner(n, states); };
      BatchData batch(model, states);
      BatchDataFloat floats(model, states);
      Data data(model);
      const Eigen::MatrixXd tau = rnea(model, batch, block(q), block(v), block(v));
      const Eigen::MatrixXf qf = q.cast<float>(), vf = v.cast<float>();
      const Eigen::MatrixXf tauf =
          rnea(model, floats, qf.bottomRightCorner(n, states), vf.bottomRightCorner(n, states), vf.topRightCorner(n, states));
      for (int k = 0; k < states; ++k) {
        const Eigen::VectorXd qk = block(q).col(k), vk = block(v).col(k), ak = v.topRightCorner(n, states).col(k);
        CHECK((tau.col(k) - rnea(model, data, qk, vk, vk)).norm() < 1e-13 * (1 + tau.col(k).norm()));
        CHECK((tauf.col(k).cast<double>() - rnea(model, data, qk, vk, ak)).norm() < 1e-5 * (1 + tau.col(k).norm()));
      }
    }
  }
}

TEST_CASE("a batch of floats has the digits of floats", "[batch]") {
  const auto seed = static_cast<std::uint64_t>(GENERATE(range(1, 6)));
  const CompactModel model = compile(randomTree(registry(), 8, seed), registry());
  checkAll<float>(model, States(model, 21, seed), 2, 1e-5, 2e-3);
}

TEST_CASE("joints that follow others are computed in batches, too", "[batch]") {
  Model description = randomTree(registry(), 22, 4, true);
  addDependent(description);
  const CompactModel model = compile(description, registry());
  CHECK(BatchData(model, 9).lanes() == BatchData(compile(camModel(), registry()), 9).lanes());
  checkAll<double>(model, States(model, 9, 2), 2, 1e-13, 1e-9);
  checkAll<float>(model, States(model, 9, 2), 2, 1e-5, 1e-2);
  // Adds a joint with a quadratic coupling and a joint with a cubic one.
  addDependent(description, "2", {0.1, 0.5, -0.3});
  addDependent(description, "3", {-0.2, 1.5, 0.2, 0.1});
  const CompactModel further = compile(description, registry());
  checkAll<double>(further, States(further, 19, 3), 2, 1e-13, 1e-9);
}

TEST_CASE("results are the same bits whatever the number of threads", "[batch]") {
  Model description = randomTree(registry(), 20, 3);
  if (GENERATE(false, true)) addDependent(description);
  const CompactModel model = compile(description, registry());
  const States s(model, 101, 5);
  BatchData one(model, 101, Need::mass_matrix);
  const Eigen::MatrixXd tau = rnea(model, one, s.q, s.v, s.a), ddq = aba(model, one, s.q, s.v, s.a), M = crba(model, one, s.q);
  for (const int threads : {2, 3, 8}) {
    BatchData many(model, 101, Need::mass_matrix, threads);
    CHECK(many.threads() == threads);
    for (int round = 0; round < 20; ++round) {
      CHECK(rnea(model, many, s.q, s.v, s.a) == tau);
      CHECK(aba(model, many, s.q, s.v, s.a) == ddq);
      CHECK(crba(model, many, s.q) == M);
    }
  }
  // The other states in a pack do not matter, either.
  BatchData few(model, 101);
  for (const int first : {0, 1, 50, 99})
    CHECK(rnea(model, few, s.q.middleCols(first, 2), s.v.middleCols(first, 2), s.a.middleCols(first, 2)) == tau.middleCols(first, 2));
}

TEST_CASE("kinematics of a batch are those of single states", "[batch]") {
  Model description = randomTree(registry(), 20, 7);
  if (GENERATE(false, true)) addDependent(description);
  const CompactModel model = compile(description, registry());
  const States s(model, 11, 6);
  BatchData batch(model, 11, Need::kinematics, 2);
  Data data(model);
  forwardKinematics(model, batch, s.q, s.v, s.a);
  for (int k = 0; k < 11; ++k) {
    forwardKinematics(model, data, s.q.col(k), s.v.col(k), s.a.col(k));
    for (int f = 0; f < static_cast<int>(model.frames().size()); ++f) {
      CHECK((toEigen(framePlacement(model, batch, f, k)) - toEigen(framePlacement(model, data, f))).cwiseAbs().maxCoeff() < 1e-13);
      for (const auto reference : {ReferenceFrame::LOCAL, ReferenceFrame::WORLD, ReferenceFrame::LOCAL_WORLD_ALIGNED}) {
        const auto v = toEigen(frameVelocity(model, data, f, reference)), a = toEigen(frameAcceleration(model, data, f, reference));
        CHECK((toEigen(frameVelocity(model, batch, f, k, reference)) - v).norm() < 1e-12 * (1 + v.norm()));
        CHECK((toEigen(frameAcceleration(model, batch, f, k, reference)) - a).norm() < 1e-12 * (1 + a.norm()));
      }
    }
  }
  CHECK_THROWS_WITH(framePlacement(model, batch, 0, 11), containing("state 11"));
  forwardKinematics(model, batch, s.q.leftCols(5), s.v.leftCols(5), s.a.leftCols(5));
  CHECK_NOTHROW(framePlacement(model, batch, 0, 4));
  CHECK_THROWS_WITH(framePlacement(model, batch, 0, 5), containing("state 5") && containing("had 5"));
  CHECK_THROWS_WITH(frameAcceleration(model, batch, 0, 5, ReferenceFrame::LOCAL), containing("state 5"));
  const CompactModel larger = compile(randomTree(registry(), 200, 7), registry());
  const int last = static_cast<int>(larger.frames().size()) - 1;
  CHECK_THROWS_WITH(framePlacement(larger, batch, last, 0), containing("framePlacement") && containing("another model"));
  CHECK_THROWS_WITH(frameVelocity(larger, batch, last, 0, ReferenceFrame::LOCAL), containing("another model"));
  CHECK_THROWS_WITH(frameAcceleration(larger, batch, last, 0, ReferenceFrame::LOCAL), containing("another model"));
  BatchData without(model, 11);
  CHECK_THROWS_WITH(forwardKinematics(model, without, s.q), containing("Need::kinematics"));
}

TEST_CASE("what is wrong with a batch is said with the state", "[batch]") {
  Model description = randomTree(registry(), 20, 7);
  if (GENERATE(false, true)) addDependent(description);
  const CompactModel model = compile(description, registry());
  States s(model, 19, 6);
  BatchData batch(model, 19);
  CHECK_THROWS_WITH(rnea(model, batch, s.q.leftCols(5), s.v.leftCols(4), s.a.leftCols(5)), containing("v is") && containing("x 5"));
  CHECK_THROWS_WITH(rnea(model, batch, s.v, s.v, s.a), containing("q is"));
  const Eigen::MatrixXd nothing;
  CHECK_THROWS_WITH(rnea(model, batch, s.q, nothing, s.a), containing("v is 0 x 0"));
  CHECK_THROWS_WITH(rnea(model, batch, s.q, s.v, nothing), containing("a is 0 x 0"));
  CHECK_THROWS_WITH(aba(model, batch, s.q, s.v, nothing), containing("tau is 0 x 0"));
  CHECK_THROWS_WITH(crba(model, batch, s.q), containing("Need::mass_matrix"));
  CHECK_THROWS_AS(BatchData(model, 0), Error);
  CHECK_THROWS_AS(BatchData(model, 3, Need::state, 0), Error);
  const Eigen::MatrixXd right = rnea(model, batch, s.q, s.v, s.a);
  for (const JointRecord& r : model.joints()) {
    if (r.type != "spherical") continue;
    s.q.col(13).segment(r.idx_q, 4).setZero();
    CHECK_THROWS_WITH(rnea(model, batch, s.q, s.v, s.a), containing("state 13") && containing(r.name));
    break;
  }
  States nan(model, 19, 6);
  nan.q(model.nq() - 1, 4) = std::nan("");
  const Eigen::MatrixXd tau = rnea(model, batch, nan.q, nan.v, nan.a);
  CHECK(!tau.col(4).allFinite());
  for (const int k : {3, 5, 18}) CHECK(tau.col(k) == right.col(k));

  const CompactModel cam = compile(camModel(), registry());
  BatchData cams(cam, 10);
  Eigen::MatrixXd q = Eigen::MatrixXd::Constant(1, 10, 1.0);
  const Eigen::MatrixXd zero = Eigen::MatrixXd::Zero(1, 10);
  const Eigen::MatrixXd good = aba(cam, cams, q, zero, zero);
  q(0, 6) = 0;
  CHECK_THROWS_WITH(aba(cam, cams, q, zero, zero), containing("state 6") && containing("'cam'") && containing("singular"));

  Model massless = camModel();
  JointDescription joint;
  joint.name = "empty";
  joint.parameters["axis"] = std::vector<double>{0, 0, 1};
  joint.type = "revolute";
  massless.addBody("nothing", 0, joint, {});
  for (const double ratio : {2.0, -1.0}) {
    joint.name = "follower of " + std::to_string(ratio);
    joint.coupling = {"mimic", "empty", {{"coefficients", std::vector<double>{0, ratio}}}};
    massless.addBody(joint.name, 0, joint, {});
  }
  const CompactModel empty = compile(massless, registry());
  BatchData batch_of_empty(empty, 10, Need::derivatives);
  const Eigen::MatrixXd ones = Eigen::MatrixXd::Ones(2, 10);
  CHECK_THROWS_WITH(aba(empty, batch_of_empty, ones, ones, ones), containing("state 0") && containing("'empty'") && containing("singular"));
  CHECK_THROWS_WITH(computeMinverse(empty, batch_of_empty, ones), containing("state 0") && containing("'empty'") && containing("singular"));
}

TEST_CASE("a batch with room for derivatives has room for mass matrices, as a Data has", "[batch]") {
  const bool coupled = GENERATE(true, false);
  Model description = randomTree(registry(), 22, 4);
  if (coupled) addDependent(description);
  const CompactModel model = compile(description, registry());
  BatchData batch(model, 3, Need::derivatives);
  Data data(model, Need::derivatives);
  const Eigen::MatrixXd q = neutral(model).replicate(1, 3);
  const Eigen::MatrixXd M = crba(model, batch, q), expected = crba(model, data, q.col(0));
  for (Eigen::Index k = 0; k < 3; ++k) CHECK(off(M.col(k), expected.reshaped()) <= 1e-12);
  CHECK_THROWS_WITH(crba(model, batch, q.leftCols(0)), containing("x 1 to 3"));
}

TEST_CASE("a batch of a model without motion has results without rows", "[batch]") {
  Model still;
  JointDescription fixed;
  fixed.name = "joint";
  fixed.type = "fixed";
  still.addBody("body", 0, fixed, Random(1).inertia());
  const CompactModel model = compile(still, registry());
  REQUIRE(model.nv() == 0);
  BatchData batch(model, 5, Need::kinematics);
  const Eigen::MatrixXd none(0, 5);
  CHECK(rnea(model, batch, none, none, none).cols() == 5);
  CHECK(aba(model, batch, none, none, none).rows() == 0);
  CHECK_THROWS_WITH(rnea(model, batch, none, none, Eigen::MatrixXd()), containing("a is 0 x 0"));
  forwardKinematics(model, batch, none, none, none);
  CHECK(toEigen(frameVelocity(model, batch, model.frameId("body"), 4, ReferenceFrame::LOCAL)).isZero(0));
}

TEST_CASE("no batch allocates after it is made", "[batch]") {
  if (!tool::canCountAllocations()) DYN_SKIP("a sanitizer owns malloc in this build");
  Model description = randomTree(registry(), 25, 5, true);
  if (GENERATE(false, true)) addDependent(description);
  const CompactModel model = compile(description, registry());
  const States s(model, 37, 1);
  BatchData batch(model, 37, Need::mass_matrix | Need::kinematics, 2);
  const auto allocations = [](auto&& f) {
    const long before = tool::allocationCount();
    f();
    return tool::allocationCount() - before;
  };
  CHECK(allocations([&] { rnea(model, batch, s.q, s.v, s.a); }) == 0);
  CHECK(allocations([&] { crba(model, batch, s.q); }) == 0);
  CHECK(allocations([&] { aba(model, batch, s.q, s.v, s.a); }) == 0);
  CHECK(allocations([&] { forwardKinematics(model, batch, s.q, s.v, s.a); }) == 0);
}

TEST_CASE("memory of a batch grows as its states", "[batch]") {
  const CompactModel model = compile(randomTree(registry(), 25, 5), registry());
  const auto bytes = [&](int n) { return static_cast<double>(BatchData(model, n, Need::kinematics).bytes()); };
  CHECK(bytes(20000) - bytes(10000) == approx(bytes(30000) - bytes(20000)).epsilon(1e-3));
}

TEST_CASE("a batch that no machine has the memory for is refused with how much it takes", "[batch]") {
  const CompactModel model = compile(randomTree(registry(), 20, 1), registry());
  CHECK_THROWS_WITH(BatchData(model, std::numeric_limits<int>::max(), Need::derivatives), containing("takes") && containing("GB of memory"));
}
