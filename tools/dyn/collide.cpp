// SPDX-License-Identifier: BSD-2-Clause
// dyn collide: which volumes of a robot and its surroundings collide, how far apart the others are, and which pairs need no check.
#include "commands.hpp"
#include "interrupt.hpp"
#include "messages.hpp"
#include "options.hpp"
#include "progress.hpp"
#include "states.hpp"
#include "volume_options.hpp"

#include <dyn/file.hpp>
#include <dyn/geometry/collision.hpp>
#include <dyn/geometry/distance.hpp>
#include <dyn/parsers/srdf.hpp>

#include <cstdio>
#include <limits>
#include <map>
#include <memory>
#include <set>

namespace dyn::tool {

namespace {

struct CollideOptions : ModelOptions {
  VolumeOptions volumes;
  std::string states, named, out;
  bool all_distances = false;
  int learn = 0;
  std::uint64_t seed = 1;

  void add(CLI::App& app) {
    ModelOptions::add(app);
    volumes.add(app);
    app.add_option("--states", states,
                   "JSON with {\"samples\":[{\"q\":[...]}, ...]}; - for standard input; without it and --q the neutral configuration")
        ->type_name("FILE");
    addNamedState(app, named, "--states");
    app.add_flag("--distances", all_distances, "distances of all pairs, not only the least");
    app.add_option("--learn", learn, "sample so many configurations and write an SRDF of the pairs of links that always or never collide")
        ->check(inRange(1, 1e9));
    app.add_option("--out", out, "where --learn writes; without it on standard output")->type_name("FILE")->check(fileName());
    app.add_option("--seed", seed, "of --learn")->capture_default_str();
  }
};

/// A compiled robot with memory for one state.
struct Robot {
  CompactModel model;
  GeometryModel geometry;
  Data data;
  GeometryData placed;

  Robot(const CollideOptions& o, const Model& description)
      : model(o.compile(description)), geometry(compileGeometry(model, description, o.volumes.geometry())), data(model), placed(geometry) {}
  void move(const Eigen::VectorXd& q) { updateGeometryPlacements(model, data, geometry, placed, q); }
};

Json pairOf(const GeometryModel& geometry, int pair) {
  const CollisionPair& p = geometry.pairs()[static_cast<std::size_t>(pair)];
  return Json{{"a", geometry.geometries()[static_cast<std::size_t>(p.a)].name}, {"b", geometry.geometries()[static_cast<std::size_t>(p.b)].name}};
}

Json json(const GeometryModel& geometry, const Distance& x) {
  Json out = pairOf(geometry, x.pair);
  out["distance"] = x.distance;
  out["normal"] = flat(x.normal);
  out["nearest_a"] = flat(x.nearest_a);
  out["nearest_b"] = flat(x.nearest_b);
  return out;
}

Json answer(const CollideOptions& o, const GeometryModel& geometry, GeometryData& data) {
  Json out;
  out["collisions"] = Json::array();
  for (const int pair : computeCollisions(geometry, data)) {
    const Distance x = computeDistance(geometry, data, pair);
    Json entry = pairOf(geometry, pair);
    entry["depth"] = -x.distance;
    entry["normal"] = flat(x.normal);
    entry["position"] = flat(0.5 * (x.nearest_a + x.nearest_b));
    out["collisions"].push_back(std::move(entry));
  }
  if (o.all_distances) {
    out["distances"] = Json::array();
    for (const Distance& x : computeDistances(geometry, data)) out["distances"].push_back(json(geometry, x));
  }
  const Distance least = computeMinimumDistance(geometry, data);
  // There are pairs, but all distances overflow: the minimum is infinite, not missing.
  if (least.pair < 0 && !geometry.pairs().empty())
    out["minimum"] = std::numeric_limits<double>::infinity();
  else
    out["minimum"] = least.pair < 0 ? Json(nullptr) : json(geometry, least);
  return out;
}

void collide(const CollideOptions& o, const Model& description) {
  Robot robot(o, description);
  Json out;
  out["model"] = robot.model.name();
  out["report"] = robot.geometry.report().lines;
  out["pairs"] = robot.geometry.pairs().size();
  out["states"] = Json::array();
  const auto at = [&](const Eigen::VectorXd& q) {
    robot.move(q);
    Json found = answer(o, robot.geometry, robot.placed);
    requireFinite(found, "state " + std::to_string(out["states"].size()));
    out["states"].push_back(std::move(found));
  };
  const Interruption interruption;
  if (o.states.empty()) {
    at(o.named.empty() ? neutral(robot.model) : namedConfiguration(robot.model, description, o.named));
  } else {
    const std::vector<State> states = timed("read states from " + o.states, [&] { return readStates(o.states, robot.model); });
    Progress progress(static_cast<double>(states.size()), "states");
    for (const State& s : states) {
      if (interruption) break;
      progress.at(static_cast<double>(out["states"].size()));
      at(s.q);
    }
  }
  std::printf("%s\n", out.dump(2).c_str());
  interruption.end();
}

/// Samples configurations and classifies the pairs of links. Pairs with the world belong to the scene, not to the robot, and are left out.
void learn(const CollideOptions& o, const Model& description) {
  if (!o.out.empty()) checkReplaceable(o.out);
  Robot robot(o, description);
  const GeometryModel& geometry = robot.geometry;
  const std::vector<GeometryRecord>& records = geometry.geometries();
  const auto bodies = [&](int pair) {
    const CollisionPair& p = geometry.pairs()[static_cast<std::size_t>(pair)];
    // The names are sorted, so that the order of the geometries does not matter.
    const std::string &a = records[static_cast<std::size_t>(p.a)].body, &b = records[static_cast<std::size_t>(p.b)].body;
    return a < b ? std::pair(a, b) : std::pair(b, a);
  };
  std::map<std::pair<std::string, std::string>, int> collisions;
  for (std::size_t p = 0; p < geometry.pairs().size(); ++p) collisions[bodies(static_cast<int>(p))] = 0;
  const Interruption interruption;
  int tried = 0;
  {
    Progress progress(o.learn, "configurations");
    for (; tried < o.learn && !interruption; ++tried) {
      progress.at(tried);
      robot.move(randomConfiguration(robot.model, o.seed + static_cast<std::uint64_t>(tried)));
      std::set<std::pair<std::string, std::string>> hit;
      for (const int pair : computeCollisions(geometry, robot.placed)) hit.insert(bodies(pair));
      for (const auto& pair : hit) ++collisions[pair];
    }
  }
  std::vector<DisabledCollision> found = description.disabled_collisions;
  int always = 0, never = 0;
  for (const auto& [pair, count] : collisions) {
    if (pair.first == "universe" || pair.second == "universe" || (count != 0 && count != tried)) continue;
    found.push_back({pair.first, pair.second, count == 0 ? "Never" : "Always"});
    ++(count == 0 ? never : always);
  }
  if (o.out.empty()) {
    std::printf("%s", srdf::text(robot.model.name(), found).c_str());
  } else {
    timed("wrote " + o.out, [&] { srdf::write(o.out, robot.model.name(), found); });
  }
  note(std::to_string(tried) + " configurations: of " + std::to_string(collisions.size()) + " pairs of links " + std::to_string(always) +
       " always collide and " + std::to_string(never) + " never do");
  interruption.end();
}

void run(const CollideOptions& o) {
  const Model description = o.volumes.description(o);
  o.learn > 0 ? learn(o, description) : collide(o, description);
}

}  // namespace

void addCollide(CLI::App& app) {
  CLI::App* sub = addCommand(app, "collide", "colliding pairs and least distances of states, as JSON; --learn proposes an SRDF");
  auto o = std::make_shared<CollideOptions>();
  o->add(*sub);
  sub->callback([o] { run(*o); });
}

}  // namespace dyn::tool
