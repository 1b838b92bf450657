// Every type there is passes the conformance kit; joints broken in one place each are caught by the check that looks there.
#include "support/catch.hpp"

#include <dyn/conformance/conformance.hpp>
#include <dyn/dyn.hpp>
#include <dyn_sdk/joint_plugin.hpp>

#include <alloc_guard.hpp>

#include <algorithm>
#include <atomic>
#include <limits>

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

/// The check of that name (its beginning) was run and failed.
bool caughtBy(const std::vector<ConformanceFinding>& findings, const std::string& check) {
  return std::any_of(findings.begin(), findings.end(), [&](const ConformanceFinding& f) { return f.check.rfind(check, 0) == 0 && !f.passed; });
}

template <class Author>
std::vector<ConformanceFinding> check(std::uint64_t seed) {
  static const dyn::sdk::JointTypeOf<Author> type;
  return dyn::checkJointType(type, dyn::exampleParameters(type.info(), seed), registry(), seed);
}

/// Rotation about z with a rise along it: the sound joint that the broken ones start from.
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
    return {{S(0), S(0), -(S(2) * v[0] * v[0])}, {}};  // the sign
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
    out[0] = ++calls;  // other numbers each time
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
    out.subspace[1] = 1;  // along y, but the pose moves along x
    return true;
  }
  template <class S>
  static dyn::SE3<S> pose(const S* q, const dyn::sdk::Constants&) {
    return {dyn::Mat3<S>::identity(), {q[0], S(0), S(0)}};
  }
};

struct WrongCoupling {
  static constexpr const char* name = "wrong_coupling";
  static constexpr const char* summary = "for tests";
  static constexpr std::array<dyn::ParameterSpec, 0> parameters{};
  static bool check(const dyn::ParameterArgument*, const dyn::sdk::Refusal&) { return true; }
  template <class S>
  static S value(const S& x, const dyn::sdk::Constants&) {
    return x * x + S(dyn::valueOf(x));  // the second term has no derivative
  }
};

}  // namespace

namespace {
/// None where a sanitizer owns malloc.
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
}

TEST_CASE("a coupling whose derivatives are wrong is caught") {
  static const dyn::sdk::CouplingTypeOf<WrongCoupling> type;
  CHECK(caughtBy(dyn::checkCouplingType(type, {}, 1), "f' is"));
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
