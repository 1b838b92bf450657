// SPDX-License-Identifier: BSD-2-Clause
// dyn_collision [STATES [OBSTACLES]]: compares libdyn's distances with FCL's for all pairs of solids, then measures how many states a second are
// checked for an arm among obstacles.
#include "fcl_pair.hpp"

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

/// Pairs of solids fixed in the world. libdyn computes all pairs, then FCL does.
struct Pairs {
  Model description;
  std::vector<bench::FclPair> fcl;
  std::vector<test::Placed> placed;  ///< two for each pair

  Pairs(int a, int b, int count) {
    Random random;
    for (int k = 0; k < count; ++k) {
      const GeometryShape sa = random.shape(a, 1), sb = random.shape(b, 1);
      const SE3<double> Xa = random.pose(1.5), Xb = random.pose(1.5);
      description.addGeometry("a" + std::to_string(k), 0, Xa, sa);
      description.addGeometry("b" + std::to_string(k), 0, Xb, sb);
      fcl.emplace_back(sa, sb);
      placed.push_back({sa, cast<test::Wide>(Xa)});
      placed.push_back({sb, cast<test::Wide>(Xb)});
    }
  }
};

void comparePairs(const JointRegistry& registry) {
  constexpr int count = 200, rounds = 11;
  std::printf(
      "Signed distance with normal and nearest points, ns a pair: median [quartiles] of %d rounds over %d random pairs, both sides in turn.\n",
      rounds, count);
  std::printf("gap: the largest difference, beside solids of size 1, between a distance and how far its own normal parts the two solids.\n\n");
  std::printf("| pair | libdyn | FCL | ratio | gap, libdyn | gap, FCL |\n|---|---|---|---|---|---|\n");
  for (int a = 0; a < 5; ++a) {
    for (int b = a; b < 5; ++b) {
      const Pairs pairs(a, b, count);
      GeometryOptions options;
      options.pairs = GeometryOptions::Pairs::none;
      for (int k = 0; k < count; ++k) options.add.push_back({"a" + std::to_string(k), "b" + std::to_string(k)});
      const GeometryModel geometry = compileGeometry(compile(pairs.description, registry), pairs.description, options);
      GeometryData data(geometry);
      std::vector<double> ours, theirs;
      double our_gap = 0, their_gap = 0;
      for (int r = 0; r < rounds; ++r) {
        auto start = Clock::now();
        const std::vector<Distance>& found = computeDistances(geometry, data);
        ours.push_back(1e9 * secondsSince(start) / count);
        std::vector<std::pair<double, Vec3<double>>> other(count);
        start = Clock::now();
        for (std::size_t k = 0; k < count; ++k)
          other[k].first = pairs.fcl[k].distance(pairs.description.geometries[2 * k].placement, pairs.description.geometries[2 * k + 1].placement,
                                                 other[k].second);
        theirs.push_back(1e9 * secondsSince(start) / count);
        for (std::size_t k = 0; k < count; ++k) {
          const auto gap = [&](double d, const Vec3<double>& n) {
            return std::fabs(static_cast<double>(d - test::parted(pairs.placed[2 * k], pairs.placed[2 * k + 1], test::wide(n))));
          };
          our_gap = std::max(our_gap, gap(found[k].distance, found[k].normal));
          // FCL gives no finite normal where the distance is zero.
          if (std::isfinite(other[k].second.x)) their_gap = std::max(their_gap, gap(other[k].first, other[k].second));
        }
      }
      const Quartiles x = quartiles(ours), y = quartiles(theirs);
      std::printf("| %s, %s | %.0f [%.0f, %.0f] | %.0f [%.0f, %.0f] | %.1f | %.0e | %.0e |\n", kinds[a], kinds[b], x.median, x.low, x.high, y.median,
                  y.low, y.high, y.median / x.median, our_gap, their_gap);
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
