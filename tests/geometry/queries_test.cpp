// SPDX-License-Identifier: BSD-2-Clause
// Geometry queries: no collision is missed, distances are those of the nearest parts, and batches and derivatives agree with single states.
#include "geometry/scene.hpp"
#include "support/skip.hpp"

#include <alloc_guard.hpp>

#include <set>

using namespace dyn;
using namespace dyn::test;
namespace g = dyn::geometry;

namespace {

/// A random tree with one or two volumes on each body, among obstacles of all kinds.
Model clutter(int bodies, int obstacles, std::uint64_t seed) {
  Random random(seed);
  Model m = randomTree(registry(), bodies, seed);
  for (int i = 1; i <= bodies; ++i)
    for (int k = 0; k <= random.below(2); ++k)
      m.addGeometry("g" + std::to_string(i) + "." + std::to_string(k), i, random.pose(), someShape(random, 0.4));
  for (int i = 0; i < obstacles; ++i) {
    SE3<double> pose = random.pose();
    pose.p = random.vector(2);
    if (i == 0) {
      m.addGeometry("ground", 0, pose, g::HalfSpace{{0, 0, 1}, -1.5});
    } else if (i == 1) {
      std::vector<double> heights;
      heights.reserve(36);
      for (int k = 0; k < 36; ++k) heights.push_back(random.uniform(-0.2, 0.2));
      m.addGeometry("field", 0, pose, heightField(6, 6, heights, -1, -1, 0.4, 0.4));
    } else if (i == 2) {
      g::Voxels voxels;
      for (int k = 0; k < 50; ++k) voxels.cubes.push_back({random.vector(0.6), random.uniform(0.05, 0.15)});
      m.addGeometry("voxels", 0, pose, voxels);
    } else {
      m.addGeometry("o" + std::to_string(i), 0, pose, someShape(random, 0.5));
    }
  }
  return m;
}

}  // namespace

TEST_CASE("whatever boxes and spheres rule out, no collision is missed that asking every pair finds", "[geometry]") {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const int bodies = 4 + 5 * static_cast<int>(seed), obstacles = 4 + 8 * static_cast<int>(seed % 5);
    const Model description = clutter(bodies, obstacles, seed);
    const CompactModel model = compile(description, registry());
    const GeometryModel geometry = compileGeometry(model, description);
    Data data(model);
    GeometryData geometry_data(geometry, 100000);
    Random random(seed);
    int hits = 0;
    for (int k = 0; k < 10; ++k) {
      const Eigen::VectorXd q = integrate(model, neutral(model), random.vector(model.nv(), 1.5));
      updateGeometryPlacements(model, data, geometry, geometry_data, q);
      std::vector<int> all;
      Distance least;
      least.distance = std::numeric_limits<double>::infinity();
      for (int p = 0; p < static_cast<int>(geometry.pairs().size()); ++p) {
        const Distance d = computeDistance(geometry, geometry_data, p);
        if (d.distance <= 0) all.push_back(p);
        if (d.distance < least.distance) least = d;
        CHECK(computeCollision(geometry, geometry_data, p) == (d.distance <= 0));
      }
      CHECK(computeCollisions(geometry, geometry_data) == all);
      CHECK(anyCollision(geometry, geometry_data) == !all.empty());
      CHECK(firstCollision(geometry_data) == (all.empty() ? -1 : all.front()));
      std::vector<int> touched;
      double deepest = -std::numeric_limits<double>::infinity();
      for (const Contact& c : computeContacts(geometry, geometry_data)) {
        if (touched.empty() || touched.back() != c.pair) touched.push_back(c.pair);
        deepest = std::max(deepest, c.depth);
      }
      CHECK(touched == all);
      const Distance found = computeMinimumDistance(geometry, geometry_data);
      CHECK(found.distance == approx(least.distance).margin(1e-12));
      if (!all.empty()) CHECK(deepest == approx(-least.distance).margin(1e-12));
      CHECK(computeDistances(geometry, geometry_data).size() == geometry.pairs().size());
      hits += static_cast<int>(all.size());
    }
    CHECK(hits > 0);
  }
}

TEST_CASE("in a crowd of bodies and obstacles trees find what asking every pair finds", "[geometry]") {
  Random random(4);
  Model m;
  for (int i = 0; i < 270; ++i) {
    m.addBody("b" + std::to_string(i), 0, jointOf("j" + std::to_string(i), "free_flyer"), {1, {}, {1, 0, 0, 1, 0, 1}});
    m.addGeometry("g" + std::to_string(i), i + 1, random.pose(), someShape(random, 0.3));
  }
  for (int i = 0; i < 600; ++i) {
    SE3<double> pose = random.pose();
    pose.p = random.vector(3);
    m.addGeometry("o" + std::to_string(i), 0, pose, someShape(random, 0.3));
  }
  m.addGeometry("ground", 0, {}, g::HalfSpace{{0, 0, 1}, -2.5});
  m.addGeometry("nothing", 0, {}, g::Voxels{});
  const CompactModel model = compile(m, registry());
  const GeometryModel geometry = compileGeometry(model, m);
  CHECK_THAT(geometry.report().lines[3], containing("a tree of what stands still, a tree of what moves, 270 pairs always asked"));
  Data data(model);
  GeometryData geometry_data(geometry);
  for (int k = 0; k < 3; ++k) {
    Eigen::VectorXd q = randomConfiguration(model, static_cast<std::uint64_t>(k));
    for (int i = 0; i < 270; ++i) q.segment<3>(7 * i) *= 3;
    updateGeometryPlacements(model, data, geometry, geometry_data, q);
    std::vector<int> all;
    for (int p = 0; p < static_cast<int>(geometry.pairs().size()); ++p)
      if (computeCollision(geometry, geometry_data, p)) all.push_back(p);
    CHECK(all.size() > 10);
    CHECK(computeCollisions(geometry, geometry_data) == all);
  }
}

TEST_CASE("a mesh's distance is that of its nearest triangle, voxels' that of their nearest cube", "[geometry]") {
  Random random(6);
  const auto field = [&](int n) {
    std::vector<double> heights;
    heights.reserve(static_cast<std::size_t>(n * n));
    for (int k = 0; k < n * n; ++k) heights.push_back(random.uniform(-0.3, 0.3));
    return heightField(n, n, heights, -1, -1, 2.0 / (n - 1), 2.0 / (n - 1));
  };
  const auto pieces = [](const GeometryShape& shape) {
    std::vector<std::pair<GeometryShape, Vec3<double>>> out;
    if (const auto* mesh = std::get_if<g::TriangleMesh>(&shape)) {
      for (const auto& t : mesh->triangles) {
        g::ConvexHull hull;
        for (const int corner : t) hull.points.push_back(mesh->vertices[static_cast<std::size_t>(corner)]);
        out.emplace_back(hull, Vec3<double>{});
      }
    } else if (const auto* voxels = std::get_if<g::Voxels>(&shape)) {
      for (const auto& c : voxels->cubes) out.emplace_back(g::Box{{c.size, c.size, c.size}}, c.center);
    } else {
      out.emplace_back(shape, Vec3<double>{});
    }
    return out;
  };
  g::Voxels voxels;
  for (int k = 0; k < 40; ++k) voxels.cubes.push_back({random.vector(0.8), random.uniform(0.05, 0.2)});
  const GeometryShape complex[] = {field(6), field(5), voxels};
  for (int round = 0; round < 60; ++round) {
    const GeometryShape a = complex[static_cast<std::size_t>(random.below(3))];
    const GeometryShape b = round % 3 == 0 ? complex[static_cast<std::size_t>(random.below(3))] : someShape(random, 0.6);
    const SE3<double> at = random.pose();
    SE3<double> pose = random.pose();
    pose.p = random.vector(1.5);
    TwoSolids whole(a, at, b);
    const Distance found = whole.distance(pose);
    // The same triangles or cubes as separate geometries.
    Model m;
    m.addBody("body", 0, jointOf("joint", "free_flyer"), {1, {}, {1, 0, 0, 1, 0, 1}});
    int count = 0;
    for (const auto& [shape, p] : pieces(a)) m.addGeometry("a" + std::to_string(count++), 0, at * SE3<double>{Mat3<double>::identity(), p}, shape);
    for (const auto& [shape, p] : pieces(b)) m.addGeometry("b" + std::to_string(count++), 1, {Mat3<double>::identity(), p}, shape);
    const CompactModel model = compile(m, registry());
    const GeometryModel geometry = compileGeometry(model, m);
    Data data(model);
    GeometryData placed(geometry, 100000);
    updateGeometryPlacements(model, data, geometry, placed, configurationOf(pose));
    double nearest = std::numeric_limits<double>::infinity();
    std::size_t touching = 0;
    for (const Distance& d : computeDistances(geometry, placed)) {
      nearest = std::min(nearest, d.distance);
      touching += d.distance <= 0 ? 1 : 0;
    }
    CHECK(found.distance == approx(nearest).margin(1e-8));
    whole.move(pose);
    CHECK(anyCollision(whole.geometry, whole.geometry_data) == (touching > 0));
    CHECK(computeContacts(whole.geometry, whole.geometry_data).size() == std::min<std::size_t>(touching, 256));
  }
}

TEST_CASE("asking about a scene with a few moving bodies allocates nothing", "[geometry][no_alloc]") {
  if (!tool::canCountAllocations()) DYN_SKIP("a sanitizer owns malloc in this build");
  const Model description = clutter(8, 40, 2);
  const CompactModel model = compile(description, registry());
  const GeometryModel geometry = compileGeometry(model, description);
  Data data(model);
  GeometryData geometry_data(geometry);
  const Eigen::VectorXd q = neutral(model);
  Eigen::VectorXd row(model.nv());
  const long before = tool::allocationCount();
  updateGeometryPlacements(model, data, geometry, geometry_data, q);
  anyCollision(geometry, geometry_data);
  computeCollisions(geometry, geometry_data);
  computeContacts(geometry, geometry_data);
  computeDistances(geometry, geometry_data);
  const Distance d = computeMinimumDistance(geometry, geometry_data);
  computeDistanceDerivative(model, data, geometry, geometry_data, d, row);
  CHECK(tool::allocationCount() == before);
}

TEST_CASE("a batch says what each state says, whatever the number of threads", "[geometry]") {
  const Model description = clutter(9, 30, 3);
  const CompactModel model = compile(description, registry());
  const GeometryModel geometry = compileGeometry(model, description);
  Data data(model);
  GeometryData geometry_data(geometry);
  Random random(1);
  Eigen::MatrixXd Q(model.nq(), 300);
  std::vector<unsigned char> expected;
  for (int k = 0; k < Q.cols(); ++k) {
    Q.col(k) = integrate(model, neutral(model), random.vector(model.nv(), 1));
    updateGeometryPlacements(model, data, geometry, geometry_data, Q.col(k));
    expected.push_back(anyCollision(geometry, geometry_data) ? 1 : 0);
  }
  CHECK(std::set<unsigned char>(expected.begin(), expected.end()).size() == 2);
  for (const int threads : {1, 2, 5}) {
    GeometryBatch batch(model, geometry, 512, threads);
    const auto flags = computeCollisions(model, batch, Q);
    CHECK(std::vector<unsigned char>(flags.begin(), flags.end()) == expected);
    CHECK_THROWS_AS(computeCollisions(model, batch, Q.topRows(2)), Error);
    Eigen::MatrixXd bad = Q;
    bad(0, 17) = std::numeric_limits<double>::quiet_NaN();
    CHECK_THROWS_WITH(computeCollisions(model, batch, bad), containing("state 17"));
  }
  CHECK_THROWS_AS(GeometryBatch(model, geometry, 0, 1), Error);
}

TEST_CASE("the derivative of the distance is that of its differences", "[geometry]") {
  int compared = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const Model description = clutter(6, 6, seed);
    const CompactModel model = compile(description, registry());
    const GeometryModel geometry = compileGeometry(model, description);
    Data data(model);
    GeometryData geometry_data(geometry);
    Random random(seed);
    const Eigen::VectorXd q = integrate(model, neutral(model), random.vector(model.nv(), 1));
    updateGeometryPlacements(model, data, geometry, geometry_data, q);
    const std::vector<Distance> distances = computeDistances(geometry, geometry_data);
    std::vector<Eigen::VectorXd> analytic;
    for (const Distance& d : distances) {
      analytic.emplace_back(model.nv());
      computeDistanceDerivative(model, data, geometry, geometry_data, d, analytic.back());
    }
    const double h = 1e-5;
    for (int k = 0; k < model.nv(); ++k) {
      std::vector<double> ahead, behind;
      for (const double s : {h, -h}) {
        updateGeometryPlacements(model, data, geometry, geometry_data, integrate(model, q, s * Eigen::VectorXd::Unit(model.nv(), k)));
        for (const Distance& d : computeDistances(geometry, geometry_data)) (s > 0 ? ahead : behind).push_back(d.distance);
      }
      for (std::size_t p = 0; p < distances.size(); ++p) {
        // If the nearest features change within the step, the one-sided differences differ, and there is no derivative to compare with.
        const double right = (ahead[p] - distances[p].distance) / h, left = (distances[p].distance - behind[p]) / h;
        if (distances[p].distance <= 0 || std::fabs(right - left) > 1e-3) continue;
        CHECK(analytic[p][k] == approx(0.5 * (right + left)).margin(2e-5));
        ++compared;
      }
    }
  }
  CHECK(compared > 1000);
}
