// SPDX-License-Identifier: BSD-2-Clause
// Functions of configurations over many states give what single calls give.
#include "support/catch.hpp"
#include "support/random_model.hpp"
#include "support/registry.hpp"
#include "support/skip.hpp"

#include <dyn/algorithm/configuration.hpp>
#include <dyn/algorithm/states.hpp>

#include <algorithm/support/random_numbers.hpp>
#include <alloc_guard.hpp>

#include <random>

using namespace dyn;
using namespace dyn::test;

namespace {

struct Columns {
  Eigen::MatrixXd q0, q1, v;
  Columns(const CompactModel& model, int states) : q0(model.nq(), states), q1(model.nq(), states), v(model.nv(), states) {
    states::randomConfiguration(model, 3, q0);
    states::randomConfiguration(model, 500, q1);
    Random random(8);
    for (int k = 0; k < states; ++k) v.col(k) = random.vector(model.nv(), 2);
  }
};

}  // namespace

TEST_CASE("functions of configurations over many states give the same bits as single calls", "[states]") {
  const int states = GENERATE(1, 2, 15, 16, 17, 40);
  Model description = randomTree(registry(), 25, static_cast<std::uint64_t>(states), states % 2 == 1);
  if (states == 17) addDependent(description);
  const CompactModel model = compile(description, registry());
  const Columns x(model, states);
  Eigen::MatrixXd q(model.nq(), states), v(model.nv(), states);
  states::integrate(model, x.q0, x.v, q);
  for (int k = 0; k < states; ++k) CHECK(q.col(k) == integrate(model, x.q0.col(k), x.v.col(k)));
  states::difference(model, x.q0, x.q1, v);
  for (int k = 0; k < states; ++k) CHECK(v.col(k) == difference(model, x.q0.col(k), x.q1.col(k)));
  Eigen::RowVectorXd t = Eigen::RowVectorXd::LinSpaced(states, 0, 1);
  states::interpolate(model, x.q0, x.q1, t, q);
  for (int k = 0; k < states; ++k) CHECK(q.col(k) == interpolate(model, x.q0.col(k), x.q1.col(k), t[k]));
  const Eigen::MatrixXd longer = 3 * x.q0;
  states::normalize(model, longer, q);
  for (int k = 0; k < states; ++k) CHECK(q.col(k) == normalize(model, longer.col(k)));
  states::randomConfiguration(model, 11, q);
  for (int k = 0; k < states; ++k) CHECK(q.col(k) == randomConfiguration(model, 11 + static_cast<std::uint64_t>(k)));
}

TEST_CASE("one column counts for all states, and a result may be an argument", "[states]") {
  const CompactModel model = compile(randomTree(registry(), 25, 4), registry());
  const Columns x(model, 21);
  Eigen::MatrixXd q(model.nq(), 21), v(model.nv(), 21);
  Eigen::RowVectorXd t = Eigen::RowVectorXd::LinSpaced(21, 0, 1);
  states::interpolate(model, x.q0.col(2), x.q1.col(5), t, q);
  for (int k = 0; k < 21; ++k) CHECK(q.col(k) == interpolate(model, x.q0.col(2), x.q1.col(5), t[k]));
  states::difference(model, x.q0.col(1), x.q1, v);
  for (int k = 0; k < 21; ++k) CHECK(v.col(k) == difference(model, x.q0.col(1), x.q1.col(k)));
  q = x.q0;
  states::integrate(model, q, x.v, q);
  for (int k = 0; k < 21; ++k) CHECK(q.col(k) == integrate(model, x.q0.col(k), x.v.col(k)));
  // Columns of a larger matrix.
  Eigen::MatrixXd large = Eigen::MatrixXd::Zero(model.nq() + 2, 23);
  states::integrate(model, x.q0, x.v, large.block(1, 1, model.nq(), 21));
  CHECK(large.block(1, 1, model.nq(), 21) == q);
  CHECK(large.row(0).isZero(0));
}

TEST_CASE("functions of configurations over many states say which state is wrong, and compute the others", "[states]") {
  const CompactModel model = compile(randomTree(registry(), 30, 7), registry());
  const Columns x(model, 20);
  Eigen::MatrixXd q(model.nq(), 20), v(model.nv(), 20), wrong = x.q0, right(model.nq(), 20);
  states::integrate(model, x.q0, x.v, right);
  CHECK_THROWS_WITH(states::integrate(model, x.q0.leftCols(3), x.v, q), containing("integrate: q is") && containing("x 20, or have one column"));
  CHECK_THROWS_WITH(states::difference(model, x.q0, x.v, v), containing("difference: q1 is"));
  CHECK_THROWS_WITH(states::integrate(model, x.q0, x.v, v), containing("the result"));
  bool found = false;
  for (const JointRecord& r : model.joints()) {
    if (r.type != "spherical" || found) continue;
    found = true;
    wrong.col(17).segment(r.idx_q, 4).setZero();
    wrong(r.idx_q, 5) = std::nan("");
    CHECK_THROWS_WITH(states::integrate(model, wrong, x.v, q), containing("state 17: q") && containing(r.name));
    for (const int k : {0, 4, 6, 16, 18, 19}) CHECK(q.col(k) == right.col(k));
    CHECK_FALSE(q.col(5).allFinite());
    CHECK_THROWS_WITH(states::difference(model, x.q1, wrong, v), containing("state 17: q1") && containing(r.name));
    CHECK_THROWS_WITH(states::normalize(model, wrong, q), containing("state 17: q"));
  }
  REQUIRE(found);
}

TEST_CASE("functions of configurations over many states allocate nothing", "[states]") {
  if (!tool::canCountAllocations()) DYN_SKIP("a sanitizer owns malloc in this build");
  const CompactModel model = compile(randomTree(registry(), 25, 5), registry());
  const Columns x(model, 33);
  Eigen::MatrixXd q(model.nq(), 33), v(model.nv(), 33);
  const Eigen::RowVectorXd t = Eigen::RowVectorXd::LinSpaced(33, 0, 1);
  const long before = tool::allocationCount();
  states::integrate(model, x.q0, x.v, q);
  states::difference(model, x.q0, x.q1, v);
  states::interpolate(model, x.q0, x.q1, t, q);
  states::normalize(model, x.q0, q);
  states::randomConfiguration(model, 1, q);
  CHECK(tool::allocationCount() == before);
}

TEST_CASE("random numbers are those of the Mersenne twister of 64 bits", "[states]") {
  for (const std::uint64_t seed : {std::uint64_t{0}, std::uint64_t{5489}, ~std::uint64_t{0} - 1}) {
    std::array<RandomNumbers, 3> generators;
    RandomNumbers::seed<3>(seed, generators);
    for (std::size_t k = 0; k < 3; ++k) {
      std::mt19937_64 expected(seed + k);
      for (int i = 0; i < 1000; ++i) REQUIRE(generators[k]() == expected());
    }
  }
}
