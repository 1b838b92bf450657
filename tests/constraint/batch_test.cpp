// SPDX-License-Identifier: BSD-2-Clause
// Constrained dynamics and impacts of batches are those of single states, whatever the lanes, the threads and the other states.
#include "constraint/support.hpp"
#include "support/cam_model.hpp"
#include "support/shared.hpp"
#include "support/skip.hpp"
#include "support/states.hpp"

#include <dyn/parsers/urdf.hpp>

#include <Eigen/Eigenvalues>

#include <alloc_guard.hpp>

using namespace dyn;
using namespace dyn::test;

namespace {

using Matrix = Eigen::MatrixXd;

CompactModel robot(const std::string& path, const std::string& root = "free_flyer") {
  urdf::Options options;
  options.root = root;
  return compile(urdf::load(path, options), registry());
}

/// The largest |x - y|, relative to 1 and the largest number of y.
double off(const Matrix& x, const Matrix& y) {
  REQUIRE(x.rows() == y.rows());
  const double e = x.size() == 0 ? 0 : (x - y).cwiseAbs().maxCoeff() / (1 + y.cwiseAbs().maxCoeff());
  return std::isfinite(e) ? e : 1e300;
}

/// Compares both algorithms with single calls in every state.
void checkStates(const CompactModel& model, const ConstraintSet& set, const States& s, int threads, double tolerance,
                 const ConstraintSettings& settings = {}) {
  const auto states = static_cast<int>(s.q.cols());
  BatchData batch(model, states + 2, Need::state, threads);
  BatchConstraintData many(set, batch);
  Data data(model);
  ConstraintData one(set);
  many.settings = one.settings = settings;
  const BatchConstrainedMotion x = constraintDynamics(model, batch, s.q, s.v, s.a, many);
  REQUIRE(x.ddq.cols() == states);
  REQUIRE(x.lambda.rows() == set.rows());
  for (int k = 0; k < states; ++k) {
    CAPTURE(k);
    const auto at = static_cast<std::size_t>(k);
    const ConstrainedMotion y = constraintDynamics(model, data, s.q.col(k), s.v.col(k), s.a.col(k), one);
    CHECK(off(x.ddq.col(k), y.ddq) <= tolerance);
    CHECK(off(x.lambda.col(k), y.lambda) <= tolerance);
    CHECK(x.rank[at] == y.rank);
    // Iterations end when rounding prevents progress.
    CHECK((x.iterations[at] == 1) == (y.iterations == 1));
    CHECK(std::abs(x.residual[at] - y.residual) <= tolerance * (1 + y.ddq.cwiseAbs().maxCoeff()));
  }
  const BatchConstrainedImpact after = impulseDynamics(model, batch, s.q, s.v, 0.3, many);
  for (int k = 0; k < states; ++k) {
    CAPTURE(k);
    const ConstrainedImpact y = impulseDynamics(model, data, s.q.col(k), s.v.col(k), 0.3, one);
    CHECK(off(after.v_after.col(k), y.v_after) <= tolerance);
    CHECK(off(after.impulse.col(k), y.impulse) <= tolerance);
    CHECK(after.rank[static_cast<std::size_t>(k)] == y.rank);
  }
}

}  // namespace

TEST_CASE("constrained batches: contacts of robots in any number of states", "[constraint]") {
  const int states = GENERATE(1, 3, 4, 9);
  const CompactModel model = biped();
  const States s(model, states, static_cast<std::uint64_t>(states));
  for (const auto& contacts : {std::vector{frameContact("left_foot"), frameContact("right_foot")},
                               std::vector{pointContact("left_foot"), frameContact("right_forearm"), pointContact("right_foot")}})
    checkStates(model, ConstraintSet(model, contacts), s, 1, 1e-10);
  const CompactModel arm = robot(DYN_SOURCE_DIR "/models/arm.urdf", "fixed");
  checkStates(arm, ConstraintSet(arm, {pointContact(arm.frames().back().name)}), States(arm, states, 3), 2, 1e-10);
}

TEST_CASE("constrained batches: contacts of robots of the reference data", "[constraint]") {
  DYN_NEEDS_SHARED();
  for (const auto& [name, feet] : {std::pair{"talos", std::vector{frameContact("left_sole_link"), frameContact("right_sole_link")}},
                                   std::pair{"hyq", std::vector{pointContact("lf_foot"), pointContact("rh_foot")}}}) {
    CAPTURE(name);
    const CompactModel model = robot(sharedFolder() + "/models/" + name + ".urdf");
    checkStates(model, ConstraintSet(model, feet), States(model, 10, 2), 2, 1e-10);
  }
}

TEST_CASE("constrained batches: every joint type, constraints between bodies, in all axes, with feedback", "[constraint]") {
  int judged = 0;
  for (std::uint64_t seed = 1; seed < 25; ++seed) {
    CAPTURE(seed);
    Subject subject = randomScene(seed, 12, 1 + static_cast<int>(seed % 3));
    for (ConstraintDescription& d : subject.constraints) {
      auto& c = std::get<FrameConstraint>(d.relation);
      const auto turns = std::count(c.free.begin() + 3, c.free.end(), true);
      c.has_target = turns == 0 || turns == 3 || (turns == 1 && c.axes != ConstraintAxes::LOCAL_WORLD_ALIGNED);
      d.baumgarte = {c.has_target ? 20.0 : 0.0, 9};
    }
    const ConstraintSet set(subject.model, subject.constraints);
    const States s(subject.model, 6, seed);
    // Nearly dependent rows have no digits to compare.
    Data data(subject.model, Need::derivatives);
    ConstraintData c(set);
    bool regular = true;
    for (Eigen::Index k = 0; k < s.q.cols(); ++k) {
      const Eigen::VectorXd spectrum = computeDelassusMatrix(subject.model, data, s.q.col(k), c).eval().selfadjointView<Eigen::Lower>().eigenvalues();
      regular = regular && spectrum.minCoeff() > 1e-4 * spectrum.maxCoeff();
    }
    if (!regular) continue;
    ++judged;
    checkStates(subject.model, set, s, 2, 1e-8);
  }
  CHECK(judged >= 8);
}

TEST_CASE("constrained batches: closed loops, coupled and locked joints", "[constraint]") {
  const CompactModel loop = compile(urdf::load(DYN_SOURCE_DIR "/models/four_bar.urdf"), registry());
  const ConstraintSet own(loop);
  REQUIRE(own.rows() > 0);
  Data data(loop);
  ConstraintData c(own);
  States s(loop, 7, 4);
  for (Eigen::Index k = 0; k < 7; ++k) {
    s.q.col(k) = projectConfiguration(loop, data, Eigen::VectorXd(0.3 * s.q.col(k)), c).q;
    s.v.col(k) = projectVelocity(loop, data, s.q.col(k), s.v.col(k), c);
  }
  checkStates(loop, own, s, 2, 1e-10);

  const CompactModel model = biped();
  const Coupling relation{"mimic", "left_elbow", {{"coefficients", std::vector<double>{0.1, 2, -0.4}}}};
  ConstraintDescription coupled = coupleJoint("right_elbow", relation), locked = lockJoint("left_knee", {0.4});
  coupled.baumgarte = locked.baumgarte = {10, 3};
  const ConstraintSet set(model, {coupled, frameContact("left_foot"), locked}, &registry());
  checkStates(model, set, States(model, 10, 8), 2, 1e-10);
}

TEST_CASE("constrained batches: redundant rows, and regularised ones", "[constraint]") {
  const CompactModel model = biped();
  const ConstraintSet set(model, {frameContact("left_foot"), frameContact("right_foot"), renamed(frameContact("left_foot"), "again")});
  const States s(model, 6, 5);
  checkStates(model, set, s, 2, 1e-9);
  ConstraintSettings settings;
  settings.mu = 1e-3;
  checkStates(model, set, s, 2, 1e-7, settings);
  settings.max_iterations = 3;
  checkStates(model, ConstraintSet(model, {frameContact("left_foot"), frameContact("right_foot")}), s, 1, 1e-9, settings);
  // In some states of a pack only: the loop's bars are in line.
  const CompactModel loop = compile(urdf::load(DYN_SOURCE_DIR "/models/four_bar.urdf"), registry());
  States bars(loop, 4, 1);
  bars.q.col(2) = neutral(loop);
  checkStates(loop, ConstraintSet(loop), bars, 1, 1e-9);
}

TEST_CASE("constrained batches: the same bits for any number of threads and next to any states", "[constraint]") {
  const CompactModel model = biped();
  const ConstraintSet set(model, {frameContact("left_foot"), pointContact("right_foot")});
  const States s(model, 61, 5);
  BatchData one(model, 61);
  BatchConstraintData alone(set, one);
  const BatchConstrainedMotion x = constraintDynamics(model, one, s.q, s.v, s.a, alone);
  const Matrix ddq = x.ddq, lambda = x.lambda;
  const Matrix after = impulseDynamics(model, one, s.q, s.v, 0.5, alone).v_after;
  for (const int threads : {2, 3}) {
    BatchData many(model, 61, Need::state, threads);
    BatchConstraintData c(set, many);
    const BatchConstrainedMotion y = constraintDynamics(model, many, s.q, s.v, s.a, c);
    CHECK(y.ddq == ddq);
    CHECK(y.lambda == lambda);
    CHECK(impulseDynamics(model, many, s.q, s.v, 0.5, c).v_after == after);
  }
  for (const int first : {0, 1, 50, 59})
    CHECK(constraintDynamics(model, one, s.q.middleCols(first, 2), s.v.middleCols(first, 2), s.a.middleCols(first, 2), alone).ddq ==
          ddq.middleCols(first, 2));
  // A NaN stays in its state, and is gone at the next call.
  States nan = s;
  nan.v(7, 5) = nan.a(2, 10) = nan.q(20, 13) = std::nan("");
  const BatchConstrainedMotion z = constraintDynamics(model, one, nan.q, nan.v, nan.a, alone);
  for (const int k : {5, 10, 13}) CHECK(!z.ddq.col(k).allFinite());
  for (const int k : {4, 6, 7, 9, 11, 12, 14, 60}) {
    CHECK(z.ddq.col(k) == ddq.col(k));
    CHECK(z.lambda.col(k) == lambda.col(k));
  }
  CHECK(constraintDynamics(model, one, s.q, s.v, s.a, alone).ddq == ddq);
  // Results may be arguments.
  const BatchConstrainedImpact first = impulseDynamics(model, one, s.q, s.v, 0.5, alone);
  const Matrix twice = impulseDynamics(model, one, s.q, first.v_after, 0.5, alone).v_after;
  CHECK(twice == Matrix(impulseDynamics(model, one, s.q, after, 0.5, alone).v_after));
}

TEST_CASE("constrained batches: states of models with their own inertias", "[constraint]") {
  const CompactModel model = biped();
  const ConstraintSet set(model, {frameContact("left_foot"), frameContact("right_foot")});
  Random random(4);
  std::vector<CompactModel> models;
  for (int k = 0; k < 5; ++k) {
    ModelNumbers numbers = model.numbers();
    for (BodyInertia& x : numbers.inertias) x.inertia = random.inertia();
    models.push_back(model.withNumbers({.inertias = numbers.inertias}));
  }
  const States s(model, 5, 9);
  BatchData batch(model, 8);
  batch.setModels(models);
  BatchConstraintData c(set, batch);
  const BatchConstrainedMotion x = constraintDynamics(model, batch, s.q, s.v, s.a, c);
  for (int k = 0; k < 5; ++k) {
    const CompactModel& own = models[static_cast<std::size_t>(k)];
    Data data(own);
    ConstraintData one(ConstraintSet(own, {frameContact("left_foot"), frameContact("right_foot")}));
    const ConstrainedMotion y = constraintDynamics(own, data, s.q.col(k), s.v.col(k), s.a.col(k), one);
    CHECK(off(x.ddq.col(k), y.ddq) <= 1e-9);
    CHECK(off(x.lambda.col(k), y.lambda) <= 1e-9);
  }
  const States more(model, 6, 9);
  CHECK_THROWS_WITH(constraintDynamics(model, batch, more.q, more.v, more.a, c), containing("6 states") && containing("5 models"));
}

TEST_CASE("constrained batches: without constraints they are aba", "[constraint]") {
  const CompactModel model = biped();
  const States s(model, 5, 2);
  BatchData batch(model, 5);
  BatchConstraintData none(ConstraintSet(model, {}), batch);
  const Matrix free = aba(model, batch, s.q, s.v, s.a);
  CHECK(constraintDynamics(model, batch, s.q, s.v, s.a, none).ddq == free);
  CHECK(impulseDynamics(model, batch, s.q, s.v, 1, none).v_after == s.v);
}

TEST_CASE("constrained batches: what is wrong is refused, with the state", "[constraint]") {
  const CompactModel model = biped();
  const ConstraintSet set(model, {frameContact("left_foot")});
  States s(model, 6, 2);
  BatchData batch(model, 6), larger(model, 7), threaded(model, 6, Need::state, 2);
  BatchConstraintData c(set, batch);
  CHECK_THROWS_WITH(constraintDynamics(model, batch, s.q, s.v.leftCols(5), s.a, c), containing("v is") && containing("x 6"));
  CHECK_THROWS_WITH(constraintDynamics(model, batch, s.q, s.v, Matrix(), c), containing("tau is 0 x 0"));
  CHECK_THROWS_WITH(impulseDynamics(model, batch, s.v, s.v, 0, c), containing("q is"));
  for (const double restitution : {-0.1, 1.1, std::nan("")})
    CHECK_THROWS_WITH(impulseDynamics(model, batch, s.q, s.v, restitution, c), containing("between 0 and 1"));
  const States more(model, 7, 2);
  CHECK_THROWS_WITH(constraintDynamics(model, larger, more.q, more.v, more.a, c), containing("fewer states or threads"));
  CHECK_THROWS_WITH(constraintDynamics(model, threaded, s.q, s.v, s.a, c), containing("fewer states or threads"));
  CHECK_NOTHROW(constraintDynamics(model, larger, s.q, s.v, s.a, c));
  const CompactModel other = biped();
  BatchData of_other(other, 6);
  CHECK_THROWS_WITH(BatchConstraintData(set, of_other), containing("another model"));
  CHECK_THROWS_WITH(constraintDynamics(other, of_other, s.q, s.v, s.a, c), containing("another model"));
  Model follows = randomTree(registry(), 10, 2);
  addDependent(follows);
  const CompactModel dependent = compile(follows, registry());
  CHECK_THROWS_WITH(BatchConstraintData(ConstraintSet(dependent, {pointContact("tool")}), BatchData(dependent, 3)), containing("dependent joints"));

  const Matrix right = constraintDynamics(model, batch, s.q, s.v, s.a, c).lambda;
  s.q.col(4).segment(3, 4).setZero();
  const double* lambda = constraintDynamics(model, batch, s.q.leftCols(4), s.v.leftCols(4), s.a.leftCols(4), c).lambda.data();
  CHECK_THROWS_WITH(constraintDynamics(model, batch, s.q, s.v, s.a, c), containing("state 4") && containing("quaternion"));
  CHECK(Eigen::Map<const Matrix>(lambda, 6, 6).col(5) == right.col(5));

  const CompactModel cam = compile(camModel(), registry());
  BatchData cams(cam, 6);
  Matrix q = Matrix::Constant(1, 6, 1.0);
  const Matrix zero = Matrix::Zero(1, 6);
  BatchConstraintData locked(ConstraintSet(cam, {lockJoint("cam")}), cams);
  CHECK(constraintDynamics(cam, cams, q, zero, zero, locked).ddq.cwiseAbs().maxCoeff() <= 1e-12);
  q(0, 3) = 0;
  CHECK_THROWS_WITH(constraintDynamics(cam, cams, q, zero, zero, locked), containing("state 3") && containing("'cam'") && containing("singular"));
}

TEST_CASE("constrained batches allocate nothing after they are made", "[constraint]") {
  if (!tool::canCountAllocations()) DYN_SKIP("a sanitizer owns malloc in this build");
  const CompactModel model = biped();
  const States s(model, 19, 1);
  BatchData batch(model, 19, Need::state, 2);
  BatchConstraintData c(ConstraintSet(model, {frameContact("left_foot"), renamed(frameContact("left_foot"), "again"), lockJoint("left_knee")}),
                        batch);
  CHECK(c.bytes() > 19 * (13 + static_cast<std::size_t>(model.nv())) * sizeof(double));
  const long before = tool::allocationCount();
  constraintDynamics(model, batch, s.q, s.v, s.a, c);
  impulseDynamics(model, batch, s.q, s.v, 0, c);
  CHECK(tool::allocationCount() == before);
}
