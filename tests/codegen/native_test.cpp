// SPDX-License-Identifier: BSD-2-Clause
// Traced algorithms, compiled while the test runs, give the library's results. Also tests the cache and errors.
#include "support/random_model.hpp"
#include "support/registry.hpp"
#include "support/shared.hpp"
#include "support/skip.hpp"
#include "support/traced.hpp"

#include <dyn/codegen/differentiate.hpp>
#include <dyn/parsers/urdf.hpp>
#include <dyn/scalar/wide_dual.hpp>

#include <sys/stat.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>

using namespace dyn;
using namespace dyn::test;
namespace fs = std::filesystem;

namespace {

/// Results of the library for a traceable function, in the order of the function's outputs.
std::vector<Eigen::VectorXd> byLibrary(const std::string& f, const CompactModel& model, const Eigen::VectorXd& q, const Eigen::VectorXd& v,
                                       const Eigen::VectorXd& a) {
  Data data(model, Need::derivatives);
  const auto flat = [](const auto& M) {
    const Eigen::MatrixXd dense = M;
    return Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(dense.data(), dense.size()));
  };
  const auto poses = [](int n, const auto& poseOf) {
    Eigen::VectorXd out(12 * n);
    for (int i = 0; i < n; ++i) {
      const SE3<double> X = poseOf(i);
      for (int k = 0; k < 9; ++k) out[12 * i + k] = X.R.m[k];
      for (int k = 0; k < 3; ++k) out[12 * i + 9 + k] = X.p[k];
    }
    return out;
  };
  if (f == "rnea") return {flat(rnea(model, data, q, v, a))};
  if (f == "nonLinearEffects") return {flat(nonLinearEffects(model, data, q, v))};
  if (f == "gravity") return {flat(generalizedGravity(model, data, q))};
  if (f == "crba") return {flat(crba(model, data, q))};
  if (f == "aba") return {flat(aba(model, data, q, v, a))};
  if (f == "minverse") return {flat(computeMinverse(model, data, q))};
  if (f == "jacobians") return {flat(computeJointJacobians(model, data, q))};
  if (f == "centroidal_map") return {flat(ccrba(model, data, q, v).Ag)};
  if (f == "rnea_derivatives") {
    const auto x = computeRNEADerivatives(model, data, q, v, a);
    return {flat(x.dtau_dq), flat(x.dtau_dv), flat(x.dtau_da)};
  }
  if (f == "aba_derivatives") {
    const auto x = computeABADerivatives(model, data, q, v, a);
    return {flat(x.ddq_dq), flat(x.ddq_dv), flat(x.ddq_dtau)};
  }
  forwardKinematics(model, data, q);
  if (f == "frames") return {poses(static_cast<int>(model.frames().size()), [&](int i) { return framePlacement(model, data, i); })};
  return {poses(model.njoints(), [&](int i) { return jointPlacement(model, data, i); })};
}

}  // namespace

TEST_CASE("every algorithm traced over every joint type is the library's", "[codegen]") {
  int traced = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const CompactModel model = compile(randomTree(registry(), 5, seed, seed % 2 == 0), registry());
    if (const std::string why = whyNotTraced(model); !why.empty()) {
      // These joints of the example plugins are splines. They look up their interval, so they have branches.
      CHECK_THAT(why, (containing("'function_joint") || containing("'planar_rail'")) && containing("branch_free = true"));
      continue;
    }
    ++traced;
    const auto [q, v, a] = randomState(model, seed);
    for (const std::string& name : traceableFunctions()) {
      INFO(name << ", seed " << seed);
      const TracedFunction f = trace(model, name);
      const std::vector<Eigen::VectorXd> found = byGraph(f, q, v, a), expected = byLibrary(name, model, q, v, a);
      REQUIRE(found.size() == expected.size());
      for (std::size_t i = 0; i < found.size(); ++i) CHECK(difference(found[i], expected[i]) < 1e-11);
    }
  }
  CHECK(traced >= 10);
}

TEST_CASE("every algorithm traced over the reference robots is the library's", "[codegen]") {
  DYN_NEEDS_SHARED();
  for (const auto& entry : fs::directory_iterator(sharedFolder() + "/models")) {
    if (entry.path().extension() != ".urdf") continue;
    urdf::Options options;
    options.root = "free_flyer";
    options.mimic = urdf::Mimic::independent;
    options.inertias = urdf::Inertias::any;
    const CompactModel model = compile(urdf::load(entry.path().string(), options), registry());
    Random random(5);
    const Eigen::VectorXd q = randomConfiguration(model, 5), v = random.vector(model.nv(), 1), a = random.vector(model.nv(), 2);
    for (const std::string name : {"rnea", "crba", "aba", "jacobians", "rnea_derivatives"}) {
      INFO(name << ", " << entry.path().stem());
      const bool solves = name == "aba";
      const TracedFunction f = trace(model, name);
      std::vector<Eigen::VectorXd> expected;
      try {
        expected = byLibrary(name, model, q, v, a);
      } catch (const Error& e) {
        REQUIRE(e.code() == ErrorCode::singular);  // the chain ends with massless links; a graph does not report this
        continue;
      }
      const std::vector<Eigen::VectorXd> found = byGraph(f, q, v, a);
      for (std::size_t i = 0; i < found.size(); ++i) CHECK(difference(found[i], expected[i]) < (solves ? 1e-9 : 1e-13));
    }
  }
}

TEST_CASE("compiled functions are the library's, and come from the cache the next time", "[codegen]") {
  const CompilerCache cache;
  const CompactModel model = compile(urdf::load(DYN_SOURCE_DIR "/models/biped.urdf", {.root = "free_flyer"}), registry());
  const std::vector<std::string> names = {"rnea", "crba", "aba", "minverse", "jacobians", "forwardKinematics"};
  const CompiledModel jit = compileNative(model, names, cache.options());
  Random random(1);
  for (int k = 0; k < 20; ++k) {
    const Eigen::VectorXd q = randomConfiguration(model, static_cast<std::uint64_t>(k)), v = random.vector(model.nv(), 1),
                          a = random.vector(model.nv(), 2);
    for (const std::string& name : names) {
      INFO(name);
      const std::vector<Eigen::VectorXd> found = byCode(jit.function(name), q, v, a), expected = byLibrary(name, model, q, v, a);
      for (std::size_t i = 0; i < found.size(); ++i) CHECK(difference(found[i], expected[i]) < 1e-13);
    }
    Eigen::VectorXd tau(model.nv());
    jit.function("rnea")({q, v, a}, {tau});
    CHECK(tau == byCode(jit.function("rnea"), q, v, a)[0]);
  }
  CHECK_FALSE(jit.function("rnea").cached());
  CHECK(compileNative(model, {"rnea"}, cache.options()).function("rnea").cached());
  Eigen::VectorXd few(3), tau(model.nv()), q = neutral(model), v = Eigen::VectorXd::Zero(model.nv());
  CHECK_THROWS_WITH(jit.function("rnea")({few, v, v}, {tau}), containing("q has 3 numbers"));
  CHECK_THROWS_AS(jit.function("rnea")({q, v}, {tau}), Error);
  CHECK_THROWS_WITH(jit.function("fly"), containing("'fly'"));

  // The generated code calls the C library for large angles and for angles near multiples of pi / 2.
  for (const double angle : {1e5, 3e6, 1e12, std::acos(-1.0) / 2, -std::acos(-1.0), 22.0, 0.0}) {
    q.tail(model.nq() - 7).setConstant(angle);
    CHECK(difference(byCode(jit.function("rnea"), q, v, v)[0], byLibrary("rnea", model, q, v, v)[0]) < 1e-13);
  }
}

TEST_CASE("several states a call, and floats, give what single states give", "[codegen]") {
  const CompilerCache cache;
  const CompactModel model = compile(urdf::load(DYN_SOURCE_DIR "/models/biped.urdf", {.root = "free_flyer"}), registry());
  const int lanes = GENERATE(1, 4), n = model.nv();
  const bool single = GENERATE(false, true);
  NativeOptions options = cache.options();
  options.lanes = lanes;
  options.single_precision = single;
  const CompiledModel jit = compileNative(model, {"rnea", "aba"}, options);
  Eigen::MatrixXd Q(model.nq(), lanes), V = Eigen::MatrixXd::Random(n, lanes), A = Eigen::MatrixXd::Random(n, lanes);
  for (int l = 0; l < lanes; ++l) Q.col(l) = randomConfiguration(model, static_cast<std::uint64_t>(l));
  // The states are interleaved: entry i of all states lies side by side. Hence the transposed matrices.
  const auto run = [&]<class T>(T) {
    const Eigen::Matrix<T, -1, -1> q = Q.transpose().cast<T>(), v = V.transpose().cast<T>(), a = A.transpose().cast<T>();
    for (const std::string name : {"rnea", "aba"}) {
      Eigen::Matrix<T, -1, -1> out(lanes, n);
      const void* in[] = {q.data(), v.data(), a.data()};
      void* to[] = {out.data()};
      jit.function(name).call(in, to);
      for (int l = 0; l < lanes; ++l) {
        INFO(name << " " << l);
        const Eigen::VectorXd expected = byLibrary(name, model, Q.col(l), V.col(l), A.col(l))[0];
        CHECK(difference(out.row(l).transpose().template cast<double>(), expected) < (std::is_same_v<T, float> ? 2e-4 : 1e-13));
      }
    }
  };
  single ? run(1.0f) : run(1.0);
}

TEST_CASE("derivatives by graphs are the analytical ones", "[codegen]") {
  const CompactModel model = compile(urdf::load(DYN_SOURCE_DIR "/models/arm.urdf"), registry());
  Random random(3);
  const Eigen::VectorXd q = random.vector(7, 2), v = random.vector(7, 1), a = random.vector(7, 2);
  Data data(model, Need::derivatives);
  for (const std::string name : {"rnea", "aba"}) {
    const TracedFunction f = trace(model, name);
    const std::vector<Eigen::VectorXd> expected = byLibrary(name + "_derivatives", model, q, v, a);
    for (const Mode mode : {Mode::forward, Mode::reverse}) {
      const JacobianGraph J = differentiate(f.graph, mode);
      std::vector<double> in(q.begin(), q.end());
      in.insert(in.end(), v.begin(), v.end());
      in.insert(in.end(), a.begin(), a.end());
      const std::vector<double> entries = replay<double>(J.graph, in);
      Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(7, 21);
      for (std::size_t e = 0; e < entries.size(); ++e) dense(J.sparsity.row[e], J.sparsity.column[e]) = entries[e];
      for (int part = 0; part < 3; ++part) {
        const Eigen::MatrixXd block = dense.middleCols(7 * part, 7);
        CHECK(difference(Eigen::Map<const Eigen::VectorXd>(block.data(), 49), expected[static_cast<std::size_t>(part)]) < 1e-12);
      }
    }
  }
}

TEST_CASE("dual numbers of any width carry all directions through an algorithm at once", "[codegen]") {
  const CompactModel model = compile(urdf::load(DYN_SOURCE_DIR "/models/arm.urdf"), registry());
  constexpr int n = 7;
  using Wide = WideDual<double, 3 * n>;
  Random random(4);
  const Eigen::VectorXd x = random.vector(3 * n, 1);
  std::vector<Wide> in;
  in.reserve(3 * n);
  for (int i = 0; i < 3 * n; ++i) in.push_back(Wide::variable(x[i], i));
  for (const std::string name : {"rnea", "aba"}) {
    const std::vector<Wide> out = replay<Wide>(trace(model, name).graph, in);
    const std::vector<Eigen::VectorXd> expected = byLibrary(name + "_derivatives", model, x.head(n), x.segment(n, n), x.tail(n));
    for (int part = 0; part < 3; ++part)
      for (int i = 0; i < n; ++i)
        for (int k = 0; k < n; ++k)
          CHECK(out[static_cast<std::size_t>(i)].d[static_cast<std::size_t>(n * part + k)] ==
                approx(expected[static_cast<std::size_t>(part)][n * k + i])
                    .epsilon(1e-10)
                    .margin(1e-10 * expected[static_cast<std::size_t>(part)].norm()));
  }
}

TEST_CASE("a cache that is damaged or not this user's alone is made anew or refused", "[codegen]") {
  const CompilerCache cache;
  const CompactModel model = compile(urdf::load(DYN_SOURCE_DIR "/models/four_bar.urdf"), registry());
  compileNative(model, {"gravity"}, cache.options());
  const auto object = [&] {
    for (const auto& entry : fs::directory_iterator(cache.path))
      if (entry.path().extension() == ".so") return entry.path();
    return fs::path();
  }();
  REQUIRE(!object.empty());
  const auto cached = [&] { return compileNative(model, {"gravity"}, cache.options()).function("gravity").cached(); };
  CHECK(cached());
  std::ofstream(object, std::ios::app) << "x";
  CHECK_FALSE(cached());
  CHECK(cached());
  std::ofstream(object) << "";
  CHECK_FALSE(cached());
  chmod(object.c_str(), 0777);
  CHECK_FALSE(cached());
  CHECK(cached());
  for (const auto& entry : fs::directory_iterator(cache.path)) CHECK(entry.path().filename().string().find("making") == std::string::npos);
  fs::remove(object);
  fs::create_directories(object / "within");
  CHECK_FALSE(cached());
  CHECK(cached());
  chmod(cache.path.c_str(), 0777);
  CHECK_THROWS_WITH(cached(), containing("nobody else can write"));
}

TEST_CASE("what processes that were ended left in the cache is removed when it is old", "[codegen]") {
  const CompilerCache cache;
  const CompactModel model = compile(urdf::load(DYN_SOURCE_DIR "/models/four_bar.urdf"), registry());
  cache.write("making-oldone/code.c", "int x;");
  cache.write("making-newone/code.c", "int x;");
  fs::last_write_time(cache.path / "making-oldone", fs::file_time_type::clock::now() - std::chrono::hours(48));
  compileNative(model, {"gravity"}, cache.options());
  CHECK_FALSE(fs::exists(cache.path / "making-oldone"));
  CHECK(fs::exists(cache.path / "making-newone"));
}

TEST_CASE("a compiler is run where the program ignores its children's end, and CC may have several words", "[codegen]") {
  const CompactModel model = compile(urdf::load(DYN_SOURCE_DIR "/models/four_bar.urdf"), registry());
  const auto old = std::signal(SIGCHLD, SIG_IGN);
  {
    const CompilerCache cache;
    NativeOptions options = cache.options();
    CHECK_FALSE(compileNative(model, {"gravity"}, options).function("gravity").cached());
    CHECK(compileNative(model, {"gravity"}, options).function("gravity").cached());
    options.flags = {"-no-such-flag"};
    CHECK_THROWS_WITH(compileNative(model, {"gravity"}, options), containing("was not compiled by"));
    options.compiler = "no-such-compiler";
    CHECK_THROWS_WITH(compileNative(model, {"gravity"}, options), containing("there is no compiler"));
  }
  std::signal(SIGCHLD, old);
  const CompilerCache cache;
  const char* given = std::getenv("CC");
  const std::string before = given != nullptr ? given : "";
  setenv("CC", "env  LIBDYN_TEST=1 cc", 1);
  CHECK_FALSE(compileNative(model, {"gravity"}, cache.options()).function("gravity").cached());
  setenv("CC", "env no-such-compiler", 1);
  CHECK_THROWS_WITH(compileNative(model, {"gravity"}, cache.options()), containing("there is no compiler 'env no-such-compiler'"));
  before.empty() ? unsetenv("CC") : setenv("CC", before.c_str(), 1);
}

TEST_CASE("processes that compile the same at once both get it, and leave one entry", "[codegen]") {
  if (!fs::exists(DYN_BINARY_DIR "/bin/dyn")) DYN_SKIP("the command dyn is not built");
  const CompilerCache cache;
  const std::string command = "LIBDYN_CACHE='" + cache.path.string() +
                              "' '" DYN_BINARY_DIR "/bin/dyn' codegen '" DYN_SOURCE_DIR
                              "/models/arm.urdf' --functions crba --compile >/dev/null 2>&1";
  CHECK(std::system(("for i in 1 2 3 4; do (" + command + "; echo $? >'" + cache.path.string() + "/code'$i) & done; wait").c_str()) == 0);
  for (const char* i : {"1", "2", "3", "4"}) {
    int code = -1;
    std::ifstream(cache.path / ("code" + std::string(i))) >> code;
    CHECK(code == 0);
  }
  int objects = 0;
  for (const auto& entry : fs::directory_iterator(cache.path)) objects += entry.path().extension() == ".so" ? 1 : 0;
  CHECK(objects == 1);
  CHECK(std::system(("LIBDYN_CACHE='" + cache.path.string() +
                     "' '" DYN_BINARY_DIR "/bin/dyn' codegen '" DYN_SOURCE_DIR
                     "/models/arm.urdf' --functions crba --compile 2>/dev/null | grep -q 'from the cache'")
                        .c_str()) == 0);
}

TEST_CASE("what cannot be compiled says why, and the library goes on", "[codegen]") {
  const CompilerCache cache;
  const CompactModel model = compile(urdf::load(DYN_SOURCE_DIR "/models/four_bar.urdf"), registry());
  NativeOptions options = cache.options();
  options.compiler = "no-such-compiler";
  CHECK_THROWS_WITH(compileNative(model, {"rnea"}, options), containing("there is no compiler 'no-such-compiler'"));
  options = cache.options();
  options.flags = {"-no-such-flag"};
  CHECK_THROWS_WITH(compileNative(model, {"rnea"}, options), containing("'rnea' was not compiled"));
  options = cache.options();
  options.operations = 10;
  CHECK_THROWS_WITH(compileNative(model, {"rnea"}, options), containing("more than the 10"));
  options = cache.options();
  options.compiler = DYN_SOURCE_DIR "/tests/codegen/sleepy_compiler";
  options.seconds = 0.3;
  CHECK_THROWS_WITH(compileNative(model, {"rnea"}, options), containing("not compiled within"));
  CHECK_THROWS_WITH(trace(model, "fly"), containing("'fly'") && containing("rnea"));
  Model coupled = randomTree(registry(), 40, 1);
  addDependent(coupled);
  CHECK_THROWS_WITH(trace(compile(coupled, registry()), "rnea"), containing("follow others"));
  SourceOptions three;
  three.lanes = 3;
  CHECK_THROWS_AS(writeSource({trace(model, "rnea")}, three), Error);
  TracedFunction odd = trace(model, "rnea");
  odd.name = "rnea; system()";
  CHECK_THROWS_WITH(writeSource({odd}), containing("no name in C"));
}

TEST_CASE("arguments may be called as the code calls its own numbers, and cannot be called what C does not allow", "[codegen]") {
  const CompilerCache cache;
  const CompactModel model = compile(urdf::load(DYN_SOURCE_DIR "/models/arm.urdf"), registry());
  const TracedFunction plain = trace(model, "rnea");
  const auto [q, v, a] = randomState(model, 1);
  const Eigen::VectorXd expected = byGraph(plain, q, v, a)[0];
  const std::vector<std::array<const char*, 4>> names{{"t0", "v0", "g0_0", "t1"}, {"x", "y", "z", "t"}, {"R", "M", "sin", "sqrt"}};
  for (const auto& [first, second, third, result] : names) {
    TracedFunction f = plain;
    f.inputs[0].name = first;
    f.inputs[1].name = second;
    f.inputs[2].name = third;
    f.outputs[0].name = result;
    for (const int piece : {50, 2000}) {
      INFO(first << ", pieces of " << piece);
      SourceOptions how;
      how.piece = piece;
      CHECK_NOTHROW(writeSource({f}, how));
    }
    CHECK(difference(byCode(compileNative({f}, cache.options()).functions()[0], q, v, a)[0], expected) < 1e-13);
  }
  for (const char* name : {"w", "s", "c", "T", "V", "angle", "v_", "dyn_real", "rnea_0", "double", "2q", "a b", "v", ""}) {
    INFO(name);
    TracedFunction f = plain;
    f.inputs[0].name = name;
    CHECK_THROWS_WITH(writeSource({f}), containing("cannot have an argument"));
  }
}
