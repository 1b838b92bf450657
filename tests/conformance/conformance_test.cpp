// SPDX-License-Identifier: BSD-2-Clause
// Every registered type passes the conformance kit. Joints that are broken in one place each fail the check for that place.
#include "support/catch.hpp"

#include <dyn/conformance/conformance.hpp>
#include <dyn/dyn.hpp>
#include <dyn_sdk/joint_plugin.hpp>

#include <alloc_guard.hpp>

#include <algorithm>
#include <atomic>
#include <limits>
#include <stdexcept>

namespace {

using dyn::ConformanceFinding;

const dyn::JointRegistry& registry() {
  static const dyn::JointRegistry all = dyn::JointRegistry::standard();
  return all;
}

void requireAllPass(const std::vector<ConformanceFinding>& findings) {
  REQUIRE(!findings.empty());
  for (const ConformanceFinding& f : findings) {
    INFO(f.check << ": " << f.error << " > " << f.bound << ", " << f.detail);
    CHECK(f.passed);
  }
}

/// Tells whether a check whose name begins with `check` was run and failed.
bool caughtBy(const std::vector<ConformanceFinding>& findings, const std::string& check) {
  return std::any_of(findings.begin(), findings.end(), [&](const ConformanceFinding& f) { return f.check.rfind(check, 0) == 0 && !f.passed; });
}

template <class Author>
std::vector<ConformanceFinding> check(std::uint64_t seed) {
  static const dyn::sdk::JointTypeOf<Author> type;
  return dyn::checkJointType(type, dyn::exampleParameters(type.info(), seed), registry(), seed);
}

/// Rotation about z with a rise along z. The broken joints derive from this sound joint.
template <class Author, int NQ = 1>
struct Rising : dyn::sdk::Joint<Author, 1, NQ> {
  static constexpr const char* summary = "for tests";
  template <class S>
  static dyn::SE3<S> pose(const S* q, const dyn::sdk::Constants&) {
    using std::cos, std::sin;
    const S c = cos(q[0]), s = sin(q[0]);
    return {{{c, -s, S(0), s, c, S(0), S(0), S(0), S(1)}}, {S(0), S(0), q[0] * q[0]}};
  }
  template <class S>
  static dyn::Motion<S> rightSubspace(const S* q) {
    return {{S(0), S(0), S(2) * q[0]}, {S(0), S(0), S(1)}};
  }
};

struct Sound : Rising<Sound> {
  static constexpr const char* name = "sound";
};

struct WrongSubspace : Rising<WrongSubspace> {
  static constexpr const char* name = "wrong_subspace";
  template <class S>
  static void subspace(const S* q, const dyn::sdk::Constants&, dyn::Motion<S>* columns) {
    columns[0] = S(1.000001) * rightSubspace(q);
  }
};

struct WrongBias : Rising<WrongBias> {
  static constexpr const char* name = "wrong_bias";
  template <class S>
  static dyn::Motion<S> bias(const S*, const S* v, const dyn::sdk::Constants&) {
    return {{S(0), S(0), -(S(2) * v[0] * v[0])}, {}};  // the sign is wrong
  }
};

struct WrongIntegrate : Rising<WrongIntegrate> {
  static constexpr const char* name = "wrong_integrate";
  static void integrate(const double* q, const double* v, double* out) { out[0] = q[0] + 1.5 * v[0]; }
};

struct WrongJacobian : Rising<WrongJacobian> {
  static constexpr const char* name = "wrong_jacobian";
  static void dDifference(const double*, const double*, double* J0, double* J1) { J0[0] = J1[0] = 1; }
};

struct NanPose : Rising<NanPose> {
  static constexpr const char* name = "nan_pose";
  template <class S>
  static dyn::SE3<S> pose(const S* q, const dyn::sdk::Constants& c) {
    dyn::SE3<S> X = Rising<NanPose>::pose(q, c);
    X.p.x = S(std::numeric_limits<double>::quiet_NaN());
    return X;
  }
};

struct NoRotation : Rising<NoRotation> {
  static constexpr const char* name = "no_rotation";
  template <class S>
  static dyn::SE3<S> pose(const S* q, const dyn::sdk::Constants& c) {
    dyn::SE3<S> X = Rising<NoRotation>::pose(q, c);
    X.R = S(1.000001) * X.R;
    return X;
  }
};

struct DriftingNormalize : Rising<DriftingNormalize> {
  static constexpr const char* name = "drifting_normalize";
  static double normalize(double* q) {
    q[0] *= 0.5;
    return 0;
  }
};

struct OffNeutral : Rising<OffNeutral> {
  static constexpr const char* name = "off_neutral";
  static void neutral(double* q) { q[0] = std::numeric_limits<double>::infinity(); }
};

struct Stateful : Rising<Stateful> {
  static constexpr const char* name = "stateful";
  template <class S>
  static dyn::SE3<S> pose(const S* q, const dyn::sdk::Constants& c) {
    static std::atomic<int> calls{0};
    dyn::SE3<S> X = Rising<Stateful>::pose(q, c);
    X.p.y = S(1e-15 * (calls++ % 7));
    return X;
  }
};

struct TooManyConstants : Rising<TooManyConstants> {
  static constexpr const char* name = "too_many_constants";
  static int constantCount(const dyn::ParameterArgument*) { return 1; }
  static void constants(const dyn::ParameterArgument*, double* out) {
    static int calls = 0;
    out[0] = ++calls;  // gives other numbers in each call
  }
};

struct Refusing : Rising<Refusing> {
  static constexpr const char* name = "refusing";
  static bool check(const dyn::ParameterArgument*, dyn::JointInstance&, const dyn::sdk::Refusal& refuse) { return refuse("never"); }
};

struct WrongConstantSubspace : dyn::sdk::Joint<WrongConstantSubspace, 1> {
  static constexpr const char* name = "wrong_constant_subspace";
  static constexpr const char* summary = "for tests";
  static constexpr dyn::Shape shape = dyn::Shape::dense_constant;
  static bool check(const dyn::ParameterArgument*, dyn::JointInstance& out, const dyn::sdk::Refusal&) {
    out.subspace[1] = 1;  // moves along y, but the pose moves along x
    return true;
  }
  template <class S>
  static dyn::SE3<S> pose(const S* q, const dyn::sdk::Constants&) {
    return {dyn::Mat3<S>::identity(), {q[0], S(0), S(0)}};
  }
};

/// Slides along x by |q|, so the pose has a kink at neutral.
struct Kinked : Rising<Kinked> {
  static constexpr const char* name = "kinked";
  template <class S>
  static dyn::SE3<S> pose(const S* q, const dyn::sdk::Constants&) {
    return {dyn::Mat3<S>::identity(), {q[0] < S(0) ? -q[0] : q[0], S(0), S(0)}};
  }
};

struct Clamped : Rising<Clamped> {
  static constexpr const char* name = "clamped";
  template <class S>
  static dyn::SE3<S> pose(const S* q, const dyn::sdk::Constants&) {
    return {dyn::Mat3<S>::identity(), {q[0] < S(-1) ? S(-1) : S(1) < q[0] ? S(1) : q[0], S(0), S(0)}};
  }
};

struct Throwing : Rising<Throwing> {
  static constexpr const char* name = "throwing";
  static bool check(const dyn::ParameterArgument*, dyn::JointInstance&, const dyn::sdk::Refusal&) { throw std::runtime_error("no table found"); }
};

struct ThrowingConstants : Rising<ThrowingConstants> {
  static constexpr const char* name = "throwing_constants";
  static int constantCount(const dyn::ParameterArgument*) { return 1; }
  static void constants(const dyn::ParameterArgument*, double*) { throw 1; }
};

/// Has one constant, h, but constantCount() says that it has none.
struct FewConstants : Rising<FewConstants> {
  static constexpr const char* name = "few_constants";
  static constexpr std::array parameters{dyn::ParameterSpec{"h", dyn::ParameterKind::number, true, "m", "of the rise"}};
  static int constantCount(const dyn::ParameterArgument*) { return 0; }
};

/// Slides along x; three constants shift it along x, y and z.
struct Placed : dyn::sdk::Joint<Placed, 1> {
  static constexpr const char* name = "placed";
  static constexpr const char* summary = "for tests";
  static constexpr std::array parameters{
      dyn::ParameterSpec{"h", dyn::ParameterKind::number, true, "m", ""}, dyn::ParameterSpec{"d", dyn::ParameterKind::vector3, false, "m", ""},
      dyn::ParameterSpec{"word", dyn::ParameterKind::text, false, "", ""}, dyn::ParameterSpec{"e", dyn::ParameterKind::number, false, "m", ""},
      dyn::ParameterSpec{"rest", dyn::ParameterKind::numbers, false, "m", ""}};
  template <class S>
  static dyn::SE3<S> pose(const S* q, const dyn::sdk::Constants& c) {
    return {dyn::Mat3<S>::identity(), {S(c[0]) + q[0], S(c[2]), S(c[4])}};
  }
};

struct Unnamed : Rising<Unnamed> {
  static constexpr const char* name = nullptr;
};
struct EmptyName : Rising<EmptyName> {
  static constexpr const char* name = "";
};
struct MarkupName : Rising<MarkupName> {
  static constexpr const char* name = "a <b>";
};
struct TwoOfOneName : Rising<TwoOfOneName> {
  static constexpr const char* name = "two_of_one_name";
  static constexpr std::array parameters{dyn::ParameterSpec{"h", dyn::ParameterKind::number, true, "m", ""},
                                         dyn::ParameterSpec{"h", dyn::ParameterKind::number, true, "m", ""}};
};

struct WrongCoupling {
  static constexpr const char* name = "wrong_coupling";
  static constexpr const char* summary = "for tests";
  static constexpr std::array<dyn::ParameterSpec, 0> parameters{};
  static bool check(const dyn::ParameterArgument*, const dyn::sdk::Refusal&) { return true; }
  template <class S>
  static S value(const S& x, const dyn::sdk::Constants&) {
    return x * x + S(dyn::valueOf(x));  // valueOf drops the derivative of the second term
  }
};
struct WrongClosedForm {
  static constexpr const char* name = "wrong_closed_form";
  static constexpr const char* summary = "for tests";
  static constexpr std::array<dyn::ParameterSpec, 0> parameters{};
  static bool check(const dyn::ParameterArgument*, const dyn::sdk::Refusal&) { return true; }
  static void derivatives(double x, const dyn::sdk::Constants&, double* f) {
    f[0] = x * x;
    f[1] = 2 * x;
    f[2] = 1;  // the right value is 2
    f[3] = 0;
  }
};

}  // namespace

namespace {
/// The count of allocations; empty where a sanitizer owns malloc.
dyn::AllocationCount allocationCount() {
  return dyn::tool::canCountAllocations() ? dyn::AllocationCount(dyn::tool::allocationCount) : dyn::AllocationCount();
}
}  // namespace

TEST_CASE("every registered joint type passes the conformance kit") {
  REQUIRE(registry().jointTypes().size() >= 14);
  for (const dyn::JointType* type : registry().jointTypes())
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
      INFO(type->info().name << ", seed " << seed);
      requireAllPass(dyn::checkJointType(*type, dyn::exampleParameters(type->info(), seed), registry(), seed, allocationCount()));
    }
}

TEST_CASE("every registered coupling type passes the conformance kit") {
  REQUIRE(!registry().couplingTypes().empty());
  for (const dyn::CouplingType* type : registry().couplingTypes())
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
      INFO(type->info().name << ", seed " << seed);
      requireAllPass(dyn::checkCouplingType(*type, dyn::exampleParameters(type->info(), seed), seed, allocationCount()));
    }
}

TEST_CASE("a sound joint that no plugin provides passes, so what follows is caught for its fault") {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) requireAllPass(check<Sound>(seed));
}

TEST_CASE("broken joints are caught by the check that looks there") {
  const auto seed = static_cast<std::uint64_t>(GENERATE(range(1, 4)));
  CHECK(caughtBy(check<WrongSubspace>(seed), "subspace: S is the velocity of the pose (differences)"));
  CHECK(caughtBy(check<WrongSubspace>(seed), "subspace: S is the velocity of the pose (duals)"));
  CHECK(caughtBy(check<WrongConstantSubspace>(seed), "subspace"));
  CHECK(caughtBy(check<WrongBias>(seed), "bias"));
  CHECK(caughtBy(check<WrongBias>(seed), "dynamics: dE/dt"));
  CHECK(caughtBy(check<WrongIntegrate>(seed), "(q (+) v) (-) q = v"));
  CHECK(caughtBy(check<WrongIntegrate>(seed), "q (+) v = q + v"));
  CHECK(caughtBy(check<WrongJacobian>(seed), "dDifference by q0"));
  CHECK(!caughtBy(check<WrongJacobian>(seed), "dDifference by q1"));
  CHECK(caughtBy(check<NanPose>(seed), "pose is in SE(3)"));
  CHECK(caughtBy(check<NoRotation>(seed), "pose is in SE(3)"));
  CHECK(caughtBy(check<DriftingNormalize>(seed), "normalize"));
  CHECK(caughtBy(check<OffNeutral>(seed), "pose is in SE(3)"));
  CHECK(caughtBy(check<Stateful>(seed), "two threads"));
  CHECK(caughtBy(check<TooManyConstants>(seed), "constants"));
  CHECK(caughtBy(check<Refusing>(seed), "parameters"));
  CHECK(caughtBy(check<Kinked>(seed), "subspace: S at neutral"));
  CHECK(caughtBy(check<Clamped>(seed), "subspace: S does not break off"));
  CHECK(caughtBy(check<Throwing>(seed), "parameters"));
  CHECK(caughtBy(check<ThrowingConstants>(seed), "parameters"));
  CHECK(caughtBy(check<FewConstants>(seed), "parameters"));
}

TEST_CASE("what an author's check or constants throw refuses the joint, and compile() says so") {
  static const dyn::sdk::JointTypeOf<Throwing> throwing;
  static const dyn::sdk::JointTypeOf<FewConstants> few;
  dyn::JointRegistry mine;
  mine.add(throwing);
  mine.add(few);
  const auto compiled = [&](const char* type, const dyn::Parameters& parameters) {
    dyn::Model model;
    dyn::JointDescription joint;
    joint.name = "j";
    joint.type = type;
    joint.parameters = parameters;
    model.addBody("b", 0, joint, {1, {}, {1, 0, 0, 1, 0, 1}});
    return dyn::compile(model, mine);
  };
  CHECK_THROWS_WITH(compiled("throwing", {}), dyn::test::containing("'throwing'") && dyn::test::containing("no table found"));
  CHECK_THROWS_WITH(compiled("few_constants", {{"h", std::vector<double>{1}}}),
                    dyn::test::containing("'few_constants'") && dyn::test::containing("constantCount"));
}

TEST_CASE("each number of a schema has its place among the constants, whatever is not given") {
  static const dyn::sdk::JointTypeOf<Placed> type;
  dyn::JointRegistry mine;
  mine.add(type);
  const auto place = [&](const dyn::Parameters& parameters) {
    dyn::Model model;
    dyn::JointDescription joint;
    joint.name = "j";
    joint.type = "placed";
    joint.parameters = parameters;
    model.addBody("b", 0, joint, {1, {}, {1, 0, 0, 1, 0, 1}});
    const dyn::CompactModel compact = dyn::compile(model, mine);
    dyn::Data data(compact);
    dyn::forwardKinematics(compact, data, Eigen::VectorXd::Zero(1));
    return dyn::framePlacement(compact, data, compact.frameId("b")).p;
  };
  const auto numbers = [](std::initializer_list<double> x) { return std::vector<double>(x); };
  const dyn::Vec3<double> all = place({{"h", numbers({1})}, {"d", numbers({2, 3, 4})}, {"e", numbers({5})}, {"rest", numbers({6, 7})}});
  CHECK((all.x == 1 && all.y == 3 && all.z == 5));
  const dyn::Vec3<double> some = place({{"h", numbers({1})}, {"e", numbers({5})}});
  CHECK((some.x == 1 && some.y == 0 && some.z == 5));
  static_assert(dyn::sdk::hasPlaces(Placed::parameters));
  static_assert(!dyn::sdk::hasPlaces(std::array{Placed::parameters[4], Placed::parameters[0]}));
}

TEST_CASE("types and parameters that no file could name are refused when they are registered") {
  static const dyn::sdk::JointTypeOf<Unnamed> unnamed;
  static const dyn::sdk::JointTypeOf<EmptyName> empty;
  static const dyn::sdk::JointTypeOf<MarkupName> markup;
  static const dyn::sdk::JointTypeOf<TwoOfOneName> twice;
  dyn::JointRegistry mine;
  CHECK_THROWS_WITH(mine.add(unnamed), dyn::test::containing("has no name"));
  CHECK_THROWS_WITH(mine.add(empty), dyn::test::containing("empty name"));
  CHECK_THROWS_WITH(mine.add(markup), dyn::test::containing("'a <b>'"));
  CHECK_THROWS_WITH(mine.add(twice), dyn::test::containing("two parameters are called 'h'"));
  CHECK(mine.jointTypes().empty());
}

TEST_CASE("a coupling whose derivatives are wrong is caught") {
  static const dyn::sdk::CouplingTypeOf<WrongCoupling> type;
  CHECK(caughtBy(dyn::checkCouplingType(type, {}, 1), "f' is"));
  static const dyn::sdk::CouplingTypeOf<WrongClosedForm> closed;
  CHECK(caughtBy(dyn::checkCouplingType(closed, {}, 1), "f'' is"));
}

TEST_CASE("a type that allocates is caught when the program counts") {
  static const dyn::sdk::JointTypeOf<Sound> type;
  long count = 0;
  const auto findings = dyn::checkJointType(type, {}, registry(), 1, [&] { return count++; });
  CHECK(caughtBy(findings, "no allocation"));
  requireAllPass(dyn::checkJointType(type, {}, registry(), 1, [] { return 0L; }));
}

TEST_CASE("parameters that do not fit the schema are a finding, not an exception") {
  const dyn::JointType& type = registry().jointType("revolute");
  CHECK(caughtBy(dyn::checkJointType(type, {}, registry(), 1), "parameters"));
  CHECK(caughtBy(dyn::checkJointType(type, {{"axis", std::vector<double>{0, 0, 0}}}, registry(), 1), "parameters"));
}

TEST_CASE("without revolute joints the dynamics checks say so") {
  static const dyn::sdk::JointTypeOf<Sound> type;
  CHECK(caughtBy(dyn::checkJointType(type, {}, dyn::JointRegistry(), 1), "dynamics"));
}

TEST_CASE("a program adds a joint type of its own; a name taken is refused") {
  static const dyn::sdk::JointTypeOf<Sound> type;
  dyn::JointRegistry mine = dyn::JointRegistry::standard();
  mine.add(type);
  CHECK(&mine.jointType("sound") == &type);
  CHECK_THROWS_AS(mine.add(type), dyn::Error);
  CHECK_THROWS_AS(mine.add(mine.jointType("revolute")), dyn::Error);
  CHECK_THROWS_AS(registry().jointType("sound"), dyn::Error);
}
