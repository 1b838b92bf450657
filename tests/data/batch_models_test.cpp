// SPDX-License-Identifier: BSD-2-Clause
// States of a batch that are of different models: BatchData::setModels().
#include "support/catch.hpp"
#include "support/random_model.hpp"
#include "support/registry.hpp"
#include "support/shared.hpp"
#include "support/states.hpp"

#include <dyn/parsers/load.hpp>

#include <limits>

using namespace dyn;
using namespace dyn::test;

namespace {

using Matrix = Eigen::MatrixXd;

/// Models with other inertias. Some centres of mass are so far away that origins of joints move along their axes.
std::vector<CompactModel> samples(const CompactModel& model, int n, std::uint64_t seed) {
  Random random(seed);
  std::vector<CompactModel> out;
  for (int k = 0; k < n; ++k) {
    ModelNumbers numbers = model.numbers();
    for (BodyInertia& x : numbers.inertias) {
      const Vec3<double> com = x.inertia.com;
      x.inertia = random.inertia();
      x.inertia.com = random.below(4) == 0 ? 3.0 * random.vector() : com + x.inertia.com;
    }
    out.push_back(model.withNumbers({.inertias = numbers.inertias}));
  }
  return out;
}

/// The largest |x - y| of a column relative to its largest number.
template <class X, class Y>
double off(const X& x, const Y& y) {
  const double e = (x.template cast<double>() - y.template cast<double>()).cwiseAbs().maxCoeff();
  const double scale = std::max(1e-300, static_cast<double>(y.cwiseAbs().maxCoeff()));
  return std::isfinite(e) ? e / scale : 1e300;
}

/// Compares every algorithm of batches with batches of one state each, of that state's model.
template <class T>
void checkAgainstOwnModels(const CompactModel& model, int n, std::uint64_t seed, int threads, double tolerance) {
  using M = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>;
  constexpr Need all = Need::derivatives | Need::jacobians;
  const std::vector<CompactModel> models = samples(model, n, seed);
  const States s(model, n, seed);
  const M q = s.q.cast<T>(), v = s.v.cast<T>(), a = s.a.cast<T>();
  BasicBatchData<T> batch(model, n + 2, all, threads);
  batch.setModels(models);
  for (const AlgorithmInfo& algorithm : algorithms()) {
    if (!algorithm.batched || algorithm.batch_need == Need::kinematics || algorithm.algorithm == Algorithm::frame_jacobian) continue;
    if (model.follows() && algorithm.algorithm == Algorithm::joint_jacobians) continue;
    CAPTURE(algorithm.function);
    const auto together = runAlgorithm(model, batch, algorithm.algorithm, q, v, a);
    for (int k = 0; k < n; ++k) {
      CAPTURE(k);
      BasicBatchData<T> alone(models[static_cast<std::size_t>(k)], 1, all);
      const auto one = runAlgorithm(models[static_cast<std::size_t>(k)], alone, algorithm.algorithm, M(q.col(k)), M(v.col(k)), M(a.col(k)));
      for (std::size_t r = 0; r < 4 && algorithm.outputs[r].symbol != nullptr; ++r) {
        CAPTURE(r);
        CHECK(off(together(r).col(k), one(r).col(0)) < tolerance);
      }
    }
  }
}

}  // namespace

TEST_CASE("batches of models: results are those of each state's own model", "[batch]") {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    CAPTURE(seed);
    Model description = randomTree(registry(), 10, seed, seed % 2 == 0);
    if (seed == 3) addDependent(description);
    const CompactModel model = compile(description, registry());
    checkAgainstOwnModels<double>(model, 11, seed, 1, 1e-9);
    checkAgainstOwnModels<float>(model, 9, seed, 2, 1e-1);
  }
}

TEST_CASE("batches of models: joint forces are the regressor times each state's parameters", "[batch]") {
  DYN_NEEDS_SHARED();
  for (const char* robot : {"panda", "talos", "hyq", "icub", "allegro"}) {
    CAPTURE(robot);
    LoadOptions options;
    options.root = "free_flyer";
    CompileOptions no_losses;
    no_losses.dissipation = no_losses.armature = false;
    const CompactModel model = compile(load(sharedFolder() + "/models/" + robot + ".urdf", options), registry(), no_losses);
    const int n = 13;
    const std::vector<CompactModel> models = samples(model, n, 5);
    const States s(model, n, 6);
    BatchData batch(model, n, Need::mass_matrix);
    batch.setModels(models);
    Data data(model, Need::derivatives);
    const Matrix tau = rnea(model, batch, s.q, s.v, s.a);
    const Matrix a = aba(model, batch, s.q, s.v, tau);
    for (int k = 0; k < n; ++k) {
      CAPTURE(k);
      const Matrix Y = computeJointTorqueRegressor(model, data, s.q.col(k), s.v.col(k), s.a.col(k));
      CHECK(off(tau.col(k), Matrix(Y * dynamicParameters(models[static_cast<std::size_t>(k)]))) < 1e-13);
      CHECK(off(a.col(k), s.a.col(k)) < 1e-8);
    }
  }
}

TEST_CASE("batches of models: threads change no bit, and without models all states are of the batch's own", "[batch]") {
  const CompactModel model = compile(randomTree(registry(), 10, 2), registry());
  const int n = 37;
  const std::vector<CompactModel> models = samples(model, n, 1);
  const States s(model, n, 3);
  BatchData one(model, n), three(model, n, Need::state, 3);
  const Matrix own = rnea(model, one, s.q, s.v, s.a);
  one.setModels(models);
  three.setModels(models);
  const Matrix alone = rnea(model, one, s.q, s.v, s.a), shared = rnea(model, three, s.q, s.v, s.a);
  CHECK(alone == shared);
  CHECK(alone != own);
  const Matrix few = rnea(model, one, Matrix(s.q.leftCols(5)), Matrix(s.v.leftCols(5)), Matrix(s.a.leftCols(5)));
  CHECK(few == alone.leftCols(5));
  one.setModels({});
  CHECK(rnea(model, one, s.q, s.v, s.a) == own);
}

TEST_CASE("batches of models: other models are refused", "[batch]") {
  const Model description = randomTree(groups(), 6, 2, true);
  const CompactModel model = compile(description, registry());
  BatchData batch(model, 4);
  const auto refused = [&](const std::vector<CompactModel>& models, const char* text) {
    CHECK_THROWS_WITH(batch.setModels(models), containing(text));
  };
  const std::string joint = model.joints()[1].name;
  ModelNumbers damping, placement;
  damping.damping = model.numbers().damping;
  damping.damping[0].values[0] += 1;
  placement.placements = {{joint, {Mat3<double>::identity(), {0, 0, 5}}}};
  refused({model, compile(description, registry())}, "model 1 does not come from the batch's own model");
  refused({model.withNumbers({.gravity = Vec3<double>{0, 0, 1}})}, "has another gravity");
  refused({model.withNumbers(damping)}, "has other damping");
  refused({model.withNumbers(placement)}, "has other placements");
  refused({model, model, model, model, model}, "there are 5 models, and the batch has room for 4 states");
  batch.setModels(std::vector<CompactModel>{model, model});
  const States s(model, 3, 1);
  CHECK_THROWS_WITH(rnea(model, batch, s.q, s.v, s.a), containing("there are 3 states, and setModels() was given 2 models"));
  CHECK_NOTHROW(rnea(model, batch, Matrix(s.q.leftCols(2)), Matrix(s.v.leftCols(2)), Matrix(s.a.leftCols(2))));
}
