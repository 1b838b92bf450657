// SPDX-License-Identifier: BSD-2-Clause
// dyn_collision [STATES [OBSTACLES]]: compares libdyn's distances with FCL's for all pairs of solids, then measures how many states a second are
// checked for an arm among obstacles.
#include <dyn/dyn.hpp>
#include <dyn/lie/so3.hpp>
#include <dyn/parsers/urdf.hpp>

#include <geometry/geometry_impl.hpp>
#include <geometry/oracle.hpp>
#include <report/quartiles.hpp>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>
#include <thread>

namespace {

using namespace dyn;
using benchmark::Quartiles;
using benchmark::quartiles;
using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

class Random {
 public:
  double uniform(double a, double b) { return a + (b - a) * (static_cast<double>(generator_() >> 11) * 0x1p-53); }
  int below(int n) { return static_cast<int>(generator_() % static_cast<std::uint64_t>(n)); }
  Vec3<double> vector(double bound) { return {uniform(-bound, bound), uniform(-bound, bound), uniform(-bound, bound)}; }
  SE3<double> pose(double bound) { return {exp3(vector(2)), vector(bound)}; }
  GeometryShape shape(int kind, double size) {
    const auto side = [&] { return size * uniform(0.2, 1); };
    switch (kind) {
      case 0:
        return geometry::Sphere{side()};
      case 1:
        return geometry::Box{{2 * side(), 2 * side(), 2 * side()}};
      case 2:
        return geometry::Capsule{side(), 2 * side()};
      case 3:
        return geometry::Cylinder{side(), 2 * side()};
      default:
        return geometry::Cone{side(), 2 * side()};
    }
  }

 private:
  std::mt19937_64 generator_{1};
};

constexpr const char* kinds[] = {"sphere", "box", "capsule", "cylinder", "cone"};

/// Pairs of solids fixed in the world.
struct Pairs {
  Model description;
  GeometryOptions options;
  std::vector<test::Placed> placed;  ///< two for each pair

  Pairs(int a, int b, int count) {
    Random random;
    options.pairs = GeometryOptions::Pairs::none;
    for (int k = 0; k < count; ++k) {
      for (const auto& [letter, kind] : {std::pair("a", a), std::pair("b", b)}) {
        const GeometryShape shape = random.shape(kind, 1);
        const SE3<double> X = random.pose(1.5);
        description.addGeometry(letter + std::to_string(k), 0, X, shape);
        placed.push_back({shape, cast<test::Wide>(X)});
      }
      options.add.push_back({"a" + std::to_string(k), "b" + std::to_string(k)});
    }
  }
  /// The largest distance that this normal, computed for the pair k, proves. It is no larger than the true one.
  test::Wide proved(const Distance& x) const {
    const auto k = static_cast<std::size_t>(x.pair);
    return test::parted(placed[2 * k], placed[2 * k + 1], test::unit(test::wide(x.normal)));
  }
};

/// The functions of libdyn, or those of FCL at one tolerance, with the times of their rounds.
struct Contender {
  GeometryModel geometry;
  GeometryData data;
  std::vector<Distance> found = {};  ///< of the pairs that do not fail
  std::vector<double> rounds = {};   ///< [us] a pair

  explicit Contender(const GeometryModel& g) : geometry(g), data(g) {
    for (std::size_t p = 0; p < g.pairs().size(); ++p) {
      try {
        found.push_back(computeDistance(geometry, data, static_cast<int>(p)));
      } catch (const Error&) {  // FCL fails
      }
    }
  }
  void time() {
    const auto start = Clock::now();
    for (Distance& x : found) x = computeDistance(geometry, data, x.pair);
    rounds.push_back(1e6 * secondsSince(start) / static_cast<double>(found.size()));
  }
};

void comparePairs(const JointRegistry& registry) {
  constexpr int count = 200, rounds = 11;
  constexpr double tolerances[] = {1e-6, 1e-9, 1e-12};
  std::printf(
      "Signed distance with normal and nearest points of %d random pairs of solids of size 1, all contenders in turn, FCL at three tolerances.\n"
      "Each entry: us a pair, median [quartiles] of %d rounds; largest error; calls that fail, which neither time nor error counts.\n"
      "The error is the difference from the largest distance that any contender's normal proves, in long double.\n\n",
      count, rounds);
  std::printf("| pair | libdyn | FCL, 1e-6 | FCL, 1e-9 | FCL, 1e-12 |\n|---|---|---|---|---|\n");
  for (int a = 0; a < 5; ++a) {
    for (int b = a; b < 5; ++b) {
      Pairs pairs(a, b, count);
      const CompactModel model = compile(pairs.description, registry);
      std::vector<Contender> contenders;
      contenders.emplace_back(compileGeometry(model, pairs.description, pairs.options));
      pairs.options.narrow = GeometryOptions::Narrow::fcl;
      for (const double tolerance : tolerances) {
        pairs.options.fcl_tolerance = tolerance;
        contenders.emplace_back(compileGeometry(model, pairs.description, pairs.options));
      }
      for (int r = 0; r < rounds; ++r)
        for (Contender& c : contenders) c.time();
      std::vector<test::Wide> most(count, -std::numeric_limits<test::Wide>::infinity());
      for (const Contender& c : contenders)
        for (const Distance& x : c.found) {
          test::Wide& proved = most[static_cast<std::size_t>(x.pair)];
          proved = std::max(proved, pairs.proved(x));
        }
      std::printf("| %s, %s |", kinds[a], kinds[b]);
      for (const Contender& c : contenders) {
        test::Wide error = 0;
        for (const Distance& x : c.found) error = std::max(error, std::fabs(x.distance - most[static_cast<std::size_t>(x.pair)]));
        const Quartiles t = quartiles(c.rounds);
        std::printf(" %.3g [%.3g, %.3g]; %.0e; %zu |", t.median, t.low, t.high, static_cast<double>(error), count - c.found.size());
      }
      std::printf("\n");
      std::fflush(stdout);
    }
  }
}

Model armAmongObstacles(int obstacles) {
  Model m = urdf::load(DYN_SOURCE_DIR "/models/arm.urdf");
  Random random;
  for (int i = 0; i < obstacles;) {
    SE3<double> X = random.pose(1.2);
    if (std::sqrt(X.p.x * X.p.x + X.p.y * X.p.y) < 0.35) continue;  // an obstacle must not overlap the arm's base
    m.addGeometry("obstacle" + std::to_string(i++), 0, X, random.shape(random.below(5), 0.12));
  }
  return m;
}

void arm(const JointRegistry& registry, int states, int obstacles) {
  const Model description = armAmongObstacles(obstacles);
  const CompactModel model = compile(description, registry);
  const GeometryModel geometry = compileGeometry(model, description);
  for (const std::string& line : geometry.report().lines) std::printf("%s\n", line.c_str());
  const int chunk = 10000, rounds = (states + chunk - 1) / chunk;
  Eigen::MatrixXd Q(model.nq(), chunk);
  Data data(model);
  GeometryData placed(geometry);
  const int threads = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  GeometryBatch one(model, geometry, chunk, 1), all(model, geometry, chunk, threads);
  std::vector<double> placing, looking, whole, several;
  long hits = 0;
  for (int r = 0; r < rounds; ++r) {
    for (int k = 0; k < chunk; ++k) Q.col(k) = randomConfiguration(model, static_cast<std::uint64_t>(r) * chunk + static_cast<std::uint64_t>(k));
    auto start = Clock::now();
    for (int k = 0; k < chunk; ++k) updateGeometryPlacements(model, data, geometry, placed, Q.col(k));
    placing.push_back(secondsSince(start) / chunk);
    start = Clock::now();
    std::size_t pairs = 0;
    for (int k = 0; k < chunk; ++k) {
      updateGeometryPlacements(model, data, geometry, placed, Q.col(k));
      pairs += nearPairs(geometry.impl(), placed.impl()).size();
    }
    looking.push_back(secondsSince(start) / chunk);
    start = Clock::now();
    hits += computeCollisions(model, one, Q).cast<long>().sum();
    whole.push_back(secondsSince(start) / chunk);
    start = Clock::now();
    computeCollisions(model, all, Q);
    several.push_back(secondsSince(start) / chunk);
    if (r == 0)
      std::printf("%.1f pairs a state are near; %.0f %% of states collide\n", static_cast<double>(pairs) / chunk,
                  100.0 * static_cast<double>(hits) / chunk);
  }
  const auto print = [](const char* what, const Quartiles& t) {
    std::printf("%-28s %8.0f [%.0f, %.0f] ns a state, %.3g states a second\n", what, 1e9 * t.median, 1e9 * t.low, 1e9 * t.high, 1 / t.median);
  };
  print("placing", quartiles(placing));
  print("placing, looking in trees", quartiles(looking));
  print("computeCollisions", quartiles(whole));
  print(("computeCollisions, threads: " + std::to_string(threads)).c_str(), quartiles(several));
  std::printf("%d states, %ld of them collide; share of looking for near pairs in the time: %.0f %%\n", rounds * chunk, hits,
              100 * (quartiles(looking).median - quartiles(placing).median) / quartiles(whole).median);
}

}  // namespace

int main(int argc, char** argv) {
  const JointRegistry registry = JointRegistry::standard();
  const int states = argc > 1 ? std::atoi(argv[1]) : 1000000;
  const int obstacles = argc > 2 ? std::atoi(argv[2]) : 100;
  comparePairs(registry);
  std::printf("\nAn arm of seven joints (models/arm.urdf) among %d obstacles\n", obstacles);
  arm(registry, std::max(states, 1), obstacles);
}
