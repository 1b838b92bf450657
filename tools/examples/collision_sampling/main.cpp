// SPDX-License-Identifier: BSD-2-Clause
// Samples configurations of a robot between obstacles, keeps those free of collision, and joins them to a roadmap, as motion planners do. Prints
// the counts and a path from the first to the second free configuration, and checks the path with a batch of collision checks.
#include <dyn/dyn.hpp>
#include <dyn/geometry/collision.hpp>
#include <dyn/geometry/distance.hpp>
#include <dyn/parsers/urdf.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <queue>
#include <set>
#include <utility>
#include <vector>

namespace {

constexpr std::size_t nodes_wanted = 150, neighbours = 6;
constexpr int most_samples = 5000;
constexpr double resolution = 0.1;  // [rad] distance of the configurations that are checked along a straight line

/// Scratch of one thread for collision checks. Threads may share the models.
struct Checker {
  const dyn::CompactModel& model;
  const dyn::GeometryModel& geometry;
  dyn::Data data{model};
  dyn::GeometryData placed{geometry};

  bool isFree(const Eigen::VectorXd& q) {
    dyn::updateGeometryPlacements(model, data, geometry, placed, q);
    return !dyn::anyCollision(geometry, placed);
  }
};

/// The configurations on the straight line from `a` to `b`, both included.
std::vector<Eigen::VectorXd> line(const dyn::CompactModel& model, const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  const int pieces = 1 + static_cast<int>(dyn::distance(model, a, b) / resolution);
  std::vector<Eigen::VectorXd> out;
  for (int i = 0; i <= pieces; ++i) out.push_back(dyn::interpolate(model, a, b, static_cast<double>(i) / pieces));
  return out;
}

}  // namespace

int main(int argc, char** argv) try {
  // Obstacles are volumes on body 0, the world.
  dyn::Model description = dyn::urdf::load(argc > 1 ? argv[1] : "models/arm.urdf");
  description.addGeometry("floor", 0, {}, dyn::geometry::HalfSpace{});
  description.addGeometry("post", 0, {dyn::Mat3<double>::identity(), {0.5, 0.2, 0.6}}, dyn::geometry::Cylinder{0.05, 1.2});
  description.addGeometry("shelf", 0, {dyn::Mat3<double>::identity(), {-0.6, 0, 0.7}}, dyn::geometry::Box{{0.4, 0.8, 0.03}});
  const dyn::CompactModel model = dyn::compile(description, dyn::JointRegistry::standard());
  const dyn::GeometryModel geometry = dyn::compileGeometry(model, description);
  Checker checker{model, geometry};

  // Samples within the joint limits. A volume pair collides exactly where its distance is not positive.
  std::vector<Eigen::VectorXd> nodes;
  int samples = 0, contradictions = 0;
  double clearance = 0;
  for (; nodes.size() < nodes_wanted && samples < most_samples; ++samples) {
    const Eigen::VectorXd q = dyn::randomConfiguration(model, static_cast<std::uint64_t>(samples));
    const bool is_free = checker.isFree(q);
    const dyn::Distance least = dyn::computeMinimumDistance(geometry, checker.placed);
    if (is_free != (least.distance > 0)) ++contradictions;
    if (!is_free) continue;
    nodes.push_back(q);
    clearance = std::max(clearance, least.distance);
  }
  std::printf("%d volumes, %d pairs\n", geometry.report().kept, geometry.report().pairs);
  std::printf("%d samples, %zu of them free; the largest minimum distance is %.3f m\n", samples, nodes.size(), clearance);

  // Joins each node to its nearest neighbours where the straight line is free.
  std::vector<std::vector<std::size_t>> edges(nodes.size());
  std::set<std::pair<std::size_t, std::size_t>> tried;
  int free_lines = 0;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    std::vector<std::pair<double, std::size_t>> others;
    for (std::size_t j = 0; j < nodes.size(); ++j)
      if (j != i) others.emplace_back(dyn::distance(model, nodes[i], nodes[j]), j);
    std::sort(others.begin(), others.end());
    others.resize(std::min(neighbours, others.size()));
    for (const auto& [distance, j] : others) {
      if (!tried.emplace(std::minmax(i, j)).second) continue;  // tried from the other side
      const std::vector<Eigen::VectorXd> between = line(model, nodes[i], nodes[j]);
      if (!std::all_of(between.begin(), between.end(), [&](const Eigen::VectorXd& q) { return checker.isFree(q); })) continue;
      ++free_lines;
      edges[i].push_back(j);
      edges[j].push_back(i);
    }
  }
  std::printf("roadmap: %zu nodes, %d of %zu straight lines are free\n", nodes.size(), free_lines, tried.size());

  // Searches a path from node 1 back to node 0, breadth first, so it has the fewest edges.
  const std::size_t none = nodes.size();
  std::vector<std::size_t> next(nodes.size(), none);
  std::queue<std::size_t> open;
  if (nodes.size() > 1) {
    next[1] = 1;
    open.push(1);
  }
  for (; !open.empty(); open.pop())
    for (const std::size_t j : edges[open.front()])
      if (next[j] == none) {
        next[j] = open.front();
        open.push(j);
      }
  if (nodes.size() < 2 || next[0] == none) {
    std::puts("FAILURE: the roadmap has no path");
    return 1;
  }

  // Checks all configurations of the path at once. The threads of a batch have a Data and a GeometryData each.
  std::vector<Eigen::VectorXd> path;
  std::size_t hops = 0;
  for (std::size_t i = 0; i != 1; i = next[i], ++hops)
    for (Eigen::VectorXd& q : line(model, nodes[i], nodes[next[i]])) path.push_back(std::move(q));
  Eigen::MatrixXd Q(model.nq(), static_cast<Eigen::Index>(path.size()));
  for (std::size_t k = 0; k < path.size(); ++k) Q.col(static_cast<Eigen::Index>(k)) = path[k];
  dyn::GeometryBatch batch(model, geometry, static_cast<int>(path.size()), /*threads=*/2);
  const bool blocked = dyn::computeCollisions(model, batch, Q).any();
  std::printf("path: %zu edges, %zu configurations, %s\n", hops, path.size(), blocked ? "blocked" : "all free");

  const bool good = !blocked && contradictions == 0;
  std::puts(good ? "success" : "FAILURE");
  return good ? 0 : 1;
} catch (const std::exception& problem) {
  std::fprintf(stderr, "%s\n", problem.what());
  return 1;
}
