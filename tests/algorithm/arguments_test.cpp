// SPDX-License-Identifier: BSD-2-Clause
// Arguments of calls. Results of a Data may be arguments of the next call with the same Data. States with NaN give NaN and leave nothing behind that
// affects the next call.
#include "support/difference.hpp"
#include "support/random_model.hpp"
#include "support/registry.hpp"

#include <functional>
#include <numbers>

using namespace dyn;
using namespace dyn::test;

namespace {

struct Arguments {
  VectorView q, v, a, tau;
};

/// An argument that refers to the vector x without copying it.
VectorArg arg(const VectorView& x) { return {x.data, x.size}; }
VectorView viewOf(const Eigen::VectorXd& x) { return {x.data(), x.size()}; }

/// One model, and everything that its algorithms write to.
struct Subject {
  const CompactModel& model;
  Data data;
  SecondDerivativeData second;
  ConstraintData constraints;
  std::vector<FrictionCone> cones{{0, 0.5}};
  explicit Subject(const CompactModel& m)
      : model(m),
        data(m, Need::derivatives),
        second(m),
        constraints(ConstraintSet(m, {frictionContact("contact", "tool", {0.1, 0.2, 0.3}, {0, 0, 1})}), Need::derivatives) {}
};

Eigen::VectorXd joined(std::initializer_list<Eigen::MatrixXd> parts) {
  Eigen::VectorXd out(0);
  for (const Eigen::MatrixXd& part : parts) {
    const Eigen::Index n = out.size();
    out.conservativeResize(n + part.size());
    out.tail(part.size()) = part.reshaped();
  }
  return out;
}

/// The member of an Arguments or a State that a letter of Call::reads stands for.
template <class X>
auto& argument(X& x, char letter) {
  return letter == 'q' ? x.q : letter == 'v' ? x.v : letter == 'a' ? x.a : x.tau;
}

/// An algorithm; run() returns all its results in one vector.
struct Call {
  const char* name;
  const char* reads;  ///< letters of its arguments, t for tau
  std::function<Eigen::VectorXd(Subject&, const Arguments&)> run;
  bool of_dependents = true;  ///< supports models with dependent joints
};

const std::vector<Call>& calls() {
  constexpr Quantity many = Quantity::accelerations | Quantity::rnea | Quantity::nle | Quantity::gravity | Quantity::mass_matrix |
                            Quantity::minverse | Quantity::coriolis | Quantity::centroidal_rate | Quantity::rnea_derivatives;
  static const std::vector<Call> all = {
      {"rnea", "qva", [](Subject& s, const Arguments& x) { return joined({rnea(s.model, s.data, arg(x.q), arg(x.v), arg(x.a))}); }},
      {"nonLinearEffects", "qv", [](Subject& s, const Arguments& x) { return joined({nonLinearEffects(s.model, s.data, arg(x.q), arg(x.v))}); }},
      {"generalizedGravity", "q", [](Subject& s, const Arguments& x) { return joined({generalizedGravity(s.model, s.data, arg(x.q))}); }},
      {"crba", "q", [](Subject& s, const Arguments& x) { return joined({crba(s.model, s.data, arg(x.q))}); }},
      {"aba", "qvt", [](Subject& s, const Arguments& x) { return joined({aba(s.model, s.data, arg(x.q), arg(x.v), arg(x.tau))}); }},
      {"forwardDynamics", "qvt",
       [](Subject& s, const Arguments& x) { return joined({forwardDynamics(s.model, s.data, arg(x.q), arg(x.v), arg(x.tau))}); }, false},
      {"computeMinverse", "q", [](Subject& s, const Arguments& x) { return joined({computeMinverse(s.model, s.data, arg(x.q))}); }},
      {"computeRNEADerivatives", "qva",
       [](Subject& s, const Arguments& x) {
         const RNEADerivatives d = computeRNEADerivatives(s.model, s.data, arg(x.q), arg(x.v), arg(x.a));
         return joined({d.dtau_dq, d.dtau_dv, d.dtau_da});
       }},
      {"computeABADerivatives", "qvt",
       [](Subject& s, const Arguments& x) {
         const ABADerivatives d = computeABADerivatives(s.model, s.data, arg(x.q), arg(x.v), arg(x.tau));
         return joined({d.ddq_dq, d.ddq_dv, d.ddq_dtau});
       }},
      {"computeRNEASecondOrderDerivatives", "qva",
       [](Subject& s, const Arguments& x) {
         const auto d = computeRNEASecondOrderDerivatives(s.model, s.data, s.second, arg(x.q), arg(x.v), arg(x.a));
         return joined({d.d2tau_dqdq[0], d.d2tau_dqdv[1], d.d2tau_dvdv[2], d.d2tau_dadq[3]});
       },
       false},
      {"computeCoriolisMatrix", "qv",
       [](Subject& s, const Arguments& x) { return joined({computeCoriolisMatrix(s.model, s.data, arg(x.q), arg(x.v))}); }},
      {"computeJointTorqueRegressor", "qva",
       [](Subject& s, const Arguments& x) { return joined({computeJointTorqueRegressor(s.model, s.data, arg(x.q), arg(x.v), arg(x.a))}); }},
      {"ccrba", "qv",
       [](Subject& s, const Arguments& x) {
         const CentroidalMomentum h = ccrba(s.model, s.data, arg(x.q), arg(x.v));
         return joined({h.hg, h.Ag});
       }},
      {"computeCentroidalMomentumTimeVariation", "qva",
       [](Subject& s, const Arguments& x) {
         const CentroidalRate h = computeCentroidalMomentumTimeVariation(s.model, s.data, arg(x.q), arg(x.v), arg(x.a));
         return joined({h.hg, h.dhg, h.Ag, h.dAg});
       }},
      {"computeCentroidalDynamicsDerivatives", "qva",
       [](Subject& s, const Arguments& x) {
         const CentroidalDerivatives h = computeCentroidalDynamicsDerivatives(s.model, s.data, arg(x.q), arg(x.v), arg(x.a));
         return joined({h.dhg_dq, h.dhgdot_dq, h.dhgdot_dv, h.dhgdot_da});
       }},
      {"computeForwardKinematicsDerivatives", "qva",
       [](Subject& s, const Arguments& x) {
         computeForwardKinematicsDerivatives(s.model, s.data, arg(x.q), arg(x.v), arg(x.a));
         Eigen::MatrixXd d[5];
         for (Eigen::MatrixXd& columns : d) columns.resize(6, s.model.nv());
         getFrameVelocityDerivatives(s.model, s.data, s.model.frameId("tool"), ReferenceFrame::LOCAL, d[0], d[1]);
         getFrameAccelerationDerivatives(s.model, s.data, s.model.frameId("tool"), ReferenceFrame::LOCAL, d[0], d[2], d[3], d[4]);
         return joined({d[0], d[1], d[2], d[3], d[4]});
       }},
      {"compute", "qva",
       [](Subject& s, const Arguments& x) {
         const Computed c = compute(s.model, s.data, many, arg(x.q), arg(x.v), arg(x.a));
         return joined({c.tau, c.nle, c.gravity, c.M, c.Minv, c.C, c.hg, c.dhg, c.dtau_dq, c.dtau_dv});
       }},
      {"constraintDynamics", "qvt",
       [](Subject& s, const Arguments& x) {
         const ConstrainedMotion m = constraintDynamics(s.model, s.data, arg(x.q), arg(x.v), arg(x.tau), s.constraints);
         return joined({m.ddq, m.lambda});
       }},
      {"constraintDynamics by M", "qvt",
       [](Subject& s, const Arguments& x) {
         const ConstrainedMotion m = constraintDynamics(s.model, s.data, arg(x.q), arg(x.v), arg(x.tau), s.constraints, ConstraintMethod::kkt);
         return joined({m.ddq, m.lambda});
       }},
      {"impulseDynamics", "qv",
       [](Subject& s, const Arguments& x) {
         const ConstrainedImpact m = impulseDynamics(s.model, s.data, arg(x.q), arg(x.v), 0.5, s.constraints);
         return joined({m.v_after, m.impulse});
       }},
      {"computeConstraintMotion", "qv",
       [](Subject& s, const Arguments& x) {
         const ConstraintMotion m = computeConstraintMotion(s.model, s.data, arg(x.q), arg(x.v), s.constraints);
         return joined({m.velocity, m.bias, m.error});
       }},
      {"computeConstraintJacobian", "q",
       [](Subject& s, const Arguments& x) { return joined({computeConstraintJacobian(s.model, s.data, arg(x.q), s.constraints)}); }},
      {"computeDelassusMatrix", "q",
       [](Subject& s, const Arguments& x) { return joined({computeDelassusMatrix(s.model, s.data, arg(x.q), s.constraints)}); }},
      {"computeConstraintDynamicsDerivatives", "qvt",
       [](Subject& s, const Arguments& x) {
         const ConstraintDynamicsDerivatives d = computeConstraintDynamicsDerivatives(s.model, s.data, arg(x.q), arg(x.v), arg(x.tau), s.constraints);
         return joined({d.ddq_dq, d.ddq_dv, d.ddq_dtau});
       }},
      {"computeImpulseDynamicsDerivatives", "qv",
       [](Subject& s, const Arguments& x) {
         const ImpulseDynamicsDerivatives d = computeImpulseDynamicsDerivatives(s.model, s.data, arg(x.q), arg(x.v), 0.5, s.constraints);
         return joined({d.v_after, d.v_after_dq, d.v_after_dv});
       }},
      {"contactStep", "qvt",
       [](Subject& s, const Arguments& x) {
         const ContactStep m = contactStep(s.model, s.data, arg(x.q), arg(x.v), arg(x.tau), 1e-3, s.constraints, s.cones);
         return joined({m.v_after, m.impulse});
       }},
      {"contactForces", "qvat",
       [](Subject& s, const Arguments& x) {
         const ContactForces m = contactForces(s.model, s.data, arg(x.q), arg(x.v), arg(x.a), arg(x.tau), s.constraints, s.cones);
         return joined({m.lambda, m.left});
       }},
  };
  return all;
}

struct State {
  Eigen::VectorXd q, v, a, tau;
  State(const CompactModel& model, std::uint64_t seed) {
    Random random(seed);
    q = integrate(model, neutral(model), Eigen::VectorXd(random.vector(model.nv(), 0.4).array() + 0.8));
    v = random.vector(model.nv(), 1);
    a = random.vector(model.nv(), 2);
    tau = random.vector(model.nv(), 5);
  }
  Arguments views() const { return {viewOf(q), viewOf(v), viewOf(a), viewOf(tau)}; }
};

/// Computes results with nv entries that lie in the memory of the subject's Data and ConstraintData.
std::vector<std::pair<const char*, VectorView>> results(Subject& s, const State& x) {
  std::vector<std::pair<const char*, VectorView>> out;
  const auto add = [&](const char* name, const auto& result) { out.emplace_back(name, VectorView{result.data(), result.size()}); };
  add("tau", rnea(s.model, s.data, x.q, x.v, x.a));
  add("nle", nonLinearEffects(s.model, s.data, x.q, x.v));
  add("gravity", generalizedGravity(s.model, s.data, x.q));
  add("a column of Minv", computeMinverse(s.model, s.data, x.q).col(0));
  add("a column of M", crba(s.model, s.data, x.q).col(0));
  add("v_after", impulseDynamics(s.model, s.data, x.q, x.v, 0.5, s.constraints).v_after);
  add("ddq", constraintDynamics(s.model, s.data, x.q, x.v, x.tau, s.constraints).ddq);
  return out;
}

/// A tree of random joint types, or an arm with nq = nv. With `coupled` the model has a dependent joint.
Model describe(bool arm, bool coupled) {
  Model model = arm ? treeOf(registry(), {"revolute", "prismatic"}, 7, 3) : randomTree(registry(), coupled ? 22 : 15, coupled ? 4 : 2, true);
  if (arm) {
    model.addFrame("tool", 7, {});
    for (BodyDescription& body : model.bodies) body.joint.friction.assign(body.joint.armature.size(), 0.2);
  }
  if (coupled) addDependent(model);
  return model;
}

/// A floating trunk with four limbs that form lane groups.
Model limbs() {
  Random random(6);
  Model model;
  for (int i = 0; i < 13; ++i) {
    JointDescription joint;
    joint.name = "j" + std::to_string(i);
    joint.type = i == 0 ? "free_flyer" : "revolute";
    if (i > 0) {
      joint.parameters["axis"] = std::vector<double>{0, 1, 0};
      joint.damping = {0.2};
    }
    joint.placement = random.pose();
    model.addBody("b" + std::to_string(i), i % 3 == 1 ? 1 : i, joint, random.inertia());
  }
  model.addFrame("tool", 13, random.pose());
  return model;
}

/// A gimbal whose two outer rings have no inertia, around a body with an arm. It locks when the second angle is pi/2.
Model gimbal(bool coupled = false) {
  Model model;
  for (int i = 0; i < 5; ++i) {
    JointDescription joint;
    joint.name = "j" + std::to_string(i);
    joint.type = "revolute";
    joint.parameters["axis"] = std::vector<double>{i == 0 ? 1.0 : 0.0, i == 1 ? 1.0 : 0.0, i > 1 ? 1.0 : 0.0};
    if (i > 2) joint.placement.p = {0.2, 0.1, 0.3};
    model.addBody("b" + std::to_string(i), i, joint, i < 2 ? Inertia<double>{} : Random(7).inertia());
  }
  model.addFrame("tool", 5, {});
  if (coupled) addDependent(model);
  return model;
}

/// Model makers run in the body of a test. Without plugins they throw, and Catch2 2.13 does not survive an exception inside GENERATE.
using Description = Model (*)();

}  // namespace

TEST_CASE("results of a Data may be arguments of the next call with it", "[arguments]") {
  const bool arm = GENERATE(true, false), coupled = GENERATE(true, false);
  const CompactModel model = compile(describe(arm, coupled), registry());
  REQUIRE((model.nq() == model.nv()) == arm);
  const State state(model, 5);
  Subject subject(model), other(model);
  for (const Call& call : calls()) {
    if (coupled && !call.of_dependents) continue;
    for (const char letter : std::string(call.reads)) {
      if (letter == 'q' && !arm) continue;
      const std::size_t count = results(other, state).size();
      for (std::size_t i = 0; i < count; ++i) {
        const auto [name, view] = results(subject, state)[i];
        const Eigen::VectorXd copy = Eigen::Map<const Eigen::VectorXd>(view.data, view.size);
        const auto with = [&, letter = letter](const VectorView& x) {
          Arguments out = state.views();
          argument(out, letter) = x;
          return out;
        };
        results(other, state);
        const Eigen::VectorXd expected = call.run(other, with(viewOf(copy))), found = call.run(subject, with(view));
        INFO(call.name << ", " << letter << " = " << name << (coupled ? ", with a follower" : ""));
        REQUIRE(expected.allFinite());
        CHECK(off(found, expected) <= 1e-12);
      }
    }
  }
}

TEST_CASE("arguments that are all results of one Data are told from each other", "[arguments]") {
  const bool coupled = GENERATE(true, false);
  const CompactModel model = compile(describe(false, coupled), registry());
  const State state(model, 6);
  Subject subject(model), other(model);
  for (const Call& call : calls()) {
    if (coupled && !call.of_dependents) continue;
    const auto views = results(subject, state);
    results(other, state);
    std::vector<Eigen::VectorXd> copies;
    copies.reserve(views.size());
    for (const auto& [name, view] : views) copies.emplace_back(Eigen::Map<const Eigen::VectorXd>(view.data, view.size));
    const Arguments given{viewOf(state.q), views[2].second, views[0].second, views[1].second};
    const Arguments copied{viewOf(state.q), viewOf(copies[2]), viewOf(copies[0]), viewOf(copies[1])};
    INFO(call.name);
    CHECK(off(call.run(subject, given), call.run(other, copied)) <= 1e-12);
  }
}

TEST_CASE("forward dynamics of inverse dynamics' own result gives the accelerations back", "[arguments]") {
  const bool coupled = GENERATE(true, false);
  const CompactModel model = compile(describe(false, coupled), registry());
  const State s(model, 7);
  Data data(model, Need::mass_matrix);
  CHECK(off(aba(model, data, s.q, s.v, rnea(model, data, s.q, s.v, s.a)), s.a) <= 1e-9);
}

TEST_CASE("what is not a number in q comes out as such, and is no fault of inertias", "[arguments]") {
  const bool arm = GENERATE(true, false), coupled = GENERATE(true, false);
  const CompactModel model = compile(describe(arm, coupled), registry());
  State state(model, 8);
  const double bad = GENERATE(std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity());
  const int joint = model.frames()[static_cast<std::size_t>(model.frameId("tool"))].joint;
  state.q[model.joints()[static_cast<std::size_t>(joint)].idx_q] = bad;
  Subject subject(model);
  for (const Call& call : calls()) {
    if (coupled && !call.of_dependents) continue;
    INFO(call.name);
    Eigen::VectorXd found;
    CHECK_NOTHROW(found = call.run(subject, state.views()));
    CHECK(!found.allFinite());
  }
  crba(model, subject.data, state.q);
  if (!coupled) CHECK_NOTHROW(cholesky::decompose(model, subject.data));

  BatchData batch(model, 9, Need::derivatives);
  const State sound(model, 8);
  const auto repeated = [](const Eigen::VectorXd& x) { return Eigen::MatrixXd(x.replicate(1, 9)); };
  Eigen::MatrixXd q = repeated(sound.q);
  q.col(3) = state.q;
  const Eigen::MatrixXd ddq = aba(model, batch, q, repeated(sound.v), repeated(sound.tau)), Minv = computeMinverse(model, batch, q);
  for (Eigen::Index k = 0; k < 9; ++k) {
    CHECK(ddq.col(k).allFinite() == (k != 3));
    CHECK(Minv.col(k).allFinite() == (k != 3));
  }
}

TEST_CASE("what is computed, and what cannot be, leaves nothing behind for the next call", "[arguments]") {
  struct Case {
    const char* name;
    Description described;
    bool coupled = false, locks = false;
  };
  const Case x = GENERATE(values<Case>({{"an arm", [] { return describe(true, false); }},
                                        {"an arm with a follower", [] { return describe(true, true); }, true},
                                        {"a tree", [] { return describe(false, false); }},
                                        {"a tree with a follower", [] { return describe(false, true); }, true},
                                        {"limbs", [] { return limbs(); }},
                                        {"a gimbal", [] { return gimbal(); }, false, true},
                                        {"a gimbal with a follower", [] { return gimbal(true); }, true, true}}));
  const CompactModel model = compile(x.described(), registry());
  const State sound(model, 8);
  State locked = sound;
  locked.q[1] = std::numbers::pi / 2;
  Data refusing(model, Need::derivatives);
  if (x.locks) CHECK_THROWS_AS(computeMinverse(model, refusing, locked.q), Error);
  for (const Call& next : calls()) {
    if (x.coupled && !next.of_dependents) continue;
    Subject fresh(model);
    const Eigen::VectorXd expected = next.run(fresh, sound.views());
    REQUIRE(expected.allFinite());
    for (const Call& before : calls()) {
      if (x.coupled && !before.of_dependents) continue;
      Subject subject(model);
      for (const char letter : "o" + std::string(before.reads) + (x.locks ? "s" : "") + (model.nq() > model.nv() ? "z" : "")) {
        State bad = letter == 'o' ? State(model, 9) : letter == 's' ? locked : sound;
        if (letter == 'z') bad.q.setZero();  // makes quaternions zero, too
        if (std::string("qvat").find(letter) != std::string::npos) argument(bad, letter).setConstant(std::nan(""));
        try {
          before.run(subject, bad.views());
        } catch (const Error& e) {
          CHECK(((letter == 's' && e.code() == ErrorCode::singular) || (letter == 'z' && e.code() == ErrorCode::argument)));
        }
        INFO(x.name << ": " << next.name << " after " << before.name << " with " << letter);
        CHECK(off(next.run(subject, sound.views()), expected) <= 1e-12);
      }
    }
  }
}

TEST_CASE("states of a batch that cannot be computed leave nothing behind for the next ones", "[arguments]") {
  const auto described = GENERATE(values<Description>(
      {[] { return describe(true, false); }, [] { return describe(false, false); }, [] { return limbs(); }, [] { return gimbal(); }}));
  const CompactModel model = compile(described(), registry());
  const State sound(model, 8);
  const auto repeated = [](const Eigen::VectorXd& x) { return Eigen::MatrixXd(x.replicate(1, 5)); };
  const Eigen::MatrixXd q = repeated(sound.q), v = repeated(sound.v), a = repeated(sound.a);
  Eigen::MatrixXd bad = q;
  bad.col(2).setConstant(std::nan(""));
  const std::vector<std::function<Eigen::MatrixXd(BatchData&, const Eigen::MatrixXd&)>> all = {
      [&](BatchData& x, const Eigen::MatrixXd& at) { return rnea(model, x, at, v, a); },
      [&](BatchData& x, const Eigen::MatrixXd& at) { return crba(model, x, at); },
      [&](BatchData& x, const Eigen::MatrixXd& at) { return aba(model, x, at, v, a); },
      [&](BatchData& x, const Eigen::MatrixXd& at) { return computeMinverse(model, x, at); },
      [&](BatchData& x, const Eigen::MatrixXd& at) { return computeRNEADerivatives(model, x, at, v, a).dtau_dq; },
      [&](BatchData& x, const Eigen::MatrixXd& at) { return computeABADerivatives(model, x, at, v, a).ddq_dq; },
      [&](BatchData& x, const Eigen::MatrixXd& at) { return computeCoriolisMatrix(model, x, at, v); },
      [&](BatchData& x, const Eigen::MatrixXd& at) { return computeCentroidalDynamicsDerivatives(model, x, at, v, a).dhgdot_dq; }};
  for (const auto& next : all) {
    BatchData fresh(model, 5, Need::mass_matrix | Need::derivatives);
    const Eigen::MatrixXd expected = next(fresh, q);
    REQUIRE(expected.allFinite());
    for (const auto& before : all) {
      BatchData used(model, 5, Need::mass_matrix | Need::derivatives);
      before(used, bad);
      CHECK(off(next(used, q), expected) <= 1e-12);
    }
  }
}

TEST_CASE("objects that were moved from say so when they are used, and models never are empty", "[arguments][error]") {
  const auto refused = [](const auto& call) { CHECK_THROWS_WITH(call(), containing("moved from")); };
  const CompactModel model = compile(randomTree(registry(), 5, 3), registry());
  const Eigen::VectorXd q = neutral(model), v = Eigen::VectorXd::Zero(model.nv());
  CompactModel from = model;
  const CompactModel to = std::move(from);
  CHECK(from.nv() == model.nv());  // NOLINT: use after move is tested here
  Data data(model, Need::derivatives);
  const Data moved = std::move(data);
  refused([&] { rnea(model, data, q, v, v); });  // NOLINT
  refused([&] { data.bytes(); });                // NOLINT
  data = Data(model);
  CHECK_NOTHROW(rnea(model, data, q, v, v));
  BatchData batch(model, 4);
  const BatchData batch_moved = std::move(batch);
  refused([&] { rnea(model, batch, q, v, v); });  // NOLINT
  Simulator simulator(model);
  const Simulator simulator_moved = std::move(simulator);
  refused([&] { simulator.step(); });  // NOLINT
  refused([&] { simulator.time(); });  // NOLINT
  DataPool pool(model);
  const DataPool pool_moved = std::move(pool);
  refused([&] { pool.forEach(1, [](Data&, std::ptrdiff_t) {}); });  // NOLINT
  ConstraintSet set(model);
  const ConstraintSet set_moved = std::move(set);
  CHECK(set.rows() == 0);  // NOLINT
  SecondDerivativeData second(model);
  const SecondDerivativeData second_moved = std::move(second);
  refused([&] { second.impl(); });  // NOLINT
}

TEST_CASE("null pointers and reference frames that do not exist are refused by name", "[arguments][error]") {
  const auto refused = [](const char* says, const auto& call) {
    INFO(says);
    CHECK_THROWS_WITH(call(), containing(says));
  };
  const CompactModel model = compile(randomTree(registry(), 5, 3), registry());
  const int n = model.nv();
  const Eigen::VectorXd q = neutral(model), v = Eigen::VectorXd::Zero(n);
  Data data(model, Need::derivatives);
  const double* none = nullptr;
  refused("rnea: q is a null pointer", [&] { rnea(model, data, VectorArg(none, model.nq()), v, v); });
  refused("aba: tau is a null pointer", [&] { aba(model, data, q, v, VectorArg(none, n)); });
  refused("J is a null pointer", [&] { computeJointJacobian(model, data, q, 1, ReferenceFrame::LOCAL, MatrixOut(nullptr, 6, n)); });
  const auto frame = static_cast<ReferenceFrame>(77);
  const char* says = "ReferenceFrame(77) does not exist";
  Eigen::MatrixXd J(6, n);
  forwardKinematics(model, data, q, v, v);
  refused(says, [&] { jointVelocity(model, data, 1, frame); });
  refused(says, [&] { frameAcceleration(model, data, 1, frame); });
  refused(says, [&] { computeJointJacobian(model, data, q, 1, frame, J); });
  refused(says, [&] { getFrameJacobian(model, data, 1, frame, J); });
  refused(says, [&] { computeFrameJacobianTimeVariation(model, data, q, v, 1, frame, J); });
  computeForwardKinematicsDerivatives(model, data, q, v, v);
  refused(says, [&] { getJointVelocityDerivatives(model, data, 1, frame, J, J); });
  BatchData batch(model, 4, Need::jacobians);
  refused(says, [&] { computeFrameJacobian(model, batch, q, 1, frame); });
}
