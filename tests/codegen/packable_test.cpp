// SPDX-License-Identifier: BSD-2-Clause
// Equal limbs traced as packable runs: the results stay the same, schedules are valid orders, and the source uses vectors.
#include "support/random_model.hpp"
#include "support/registry.hpp"
#include "support/traced.hpp"

#include <dyn/parsers/urdf.hpp>

#include <codegen/schedule.hpp>

#include <algorithm>
#include <map>
#include <set>

using namespace dyn;
using namespace dyn::test;

namespace {

/// A body with two to six limbs of the same joint types, some of them one joint shorter. Some parameters are zeros and ones.
Model limbed(std::uint64_t seed) {
  Random random(seed);
  Model model;
  model.gravity = random.vector(10);
  const auto& types = registry().jointTypes();
  int joints = 0;
  const auto add = [&](const std::string& type, std::uint64_t parameters, int parent) {
    JointDescription joint;
    joint.name = "j" + std::to_string(joints);
    joint.type = type;
    joint.parameters = exampleParameters(registry().jointType(type, {}).info(), parameters);
    if (random.below(3) > 0) joint.placement = random.pose();
    if (random.below(4) == 0) joint.placement.p = {0, 0, random.uniform()};
    joint.damping.assign(static_cast<std::size_t>(degreesOfFreedom(joint, registry())), random.uniform(0, 1));
    Inertia<double> inertia = random.inertia();
    if (random.below(4) == 0) inertia = {1, {}, {0.1, 0, 0, 0.1, 0, 0.1}};
    return model.addBody("b" + std::to_string(joints++), parent, joint, inertia);
  };
  const int trunk = random.below(2) == 0 ? add("free_flyer", 1, 0) : add("revolute", 1, 0);
  const int length = 1 + random.below(3), limbs = 2 + random.below(5);
  std::vector<std::string> of_limb(static_cast<std::size_t>(length));
  for (std::string& type : of_limb) type = types[static_cast<std::size_t>(random.below(static_cast<int>(types.size())))]->info().name;
  for (int l = 0; l < limbs; ++l) {
    int end = trunk;
    for (int k = 0; k < length - (random.below(4) == 0 ? 1 : 0); ++k)
      end = add(of_limb[static_cast<std::size_t>(k)], seed + static_cast<std::uint64_t>(k), end);
  }
  return model;
}

/// Tells whether the schedule is valid: every node appears once and after its arguments, each unit has one operation, and nodes have the arguments
/// that the graph gives them.
bool isOrder(const Graph& graph, const Schedule& found) {
  std::vector<char> there(graph.nodes.size(), 0);
  std::size_t left = 0;
  for (std::size_t i = 0; i < graph.nodes.size(); ++i) {
    const GraphNode &n = graph.nodes[i], &m = found.nodes[i];
    const bool from_start = arity(n.operation) == 0 || isTurn(graph.nodes, static_cast<std::uint32_t>(i));
    if (from_start != (found.places[i].unit < 0)) return false;
    there[i] = from_start;
    left += from_start ? 0 : 1;
    const bool exchanged =
        m.argument[0] == n.argument[1] && m.argument[1] == n.argument[0] && (n.operation == Operation::add || n.operation == Operation::multiply);
    if (!exchanged && !std::equal(m.argument, m.argument + arity(n.operation), n.argument)) return false;
  }
  for (const Unit& unit : found.units) {
    for (const std::uint32_t node : unit.nodes) {
      if (node == no_node) continue;
      const GraphNode& n = graph.nodes[node];
      if (n.operation != unit.operation || there[node]) return false;
      for (int k = 0; k < arity(n.operation); ++k)
        if (!there[n.argument[k]]) return false;
    }
    for (const std::uint32_t node : unit.nodes)
      if (node != no_node) there[node] = 1, --left;
  }
  return left == 0;
}

}  // namespace

TEST_CASE("a run whose number has no lane is refused", "[packable]") {
  GraphBuilder builder;
  builder.packable([&] {
    CHECK_THROWS_AS(builder.run(-1), Error);
    CHECK_THROWS_AS(builder.run(most_packable), Error);
  });
}

TEST_CASE("operations of runs of the same code go abreast", "[codegen]") {
  GraphBuilder builder;
  std::vector<Traced> x, y(3);
  for (int i = 0; i < 4; ++i) x.push_back(builder.input());
  builder.packable([&] {
    for (int k = 0; k < 3; ++k) {
      builder.run(k);
      builder.step(1);
      y[static_cast<std::size_t>(k)] = x[static_cast<std::size_t>(k)] * x[3] + Traced(2);
      builder.step(-1);
      if (k == 1) y[1] = y[1] * y[1];  // step -1 is not matched with other runs
      builder.step(2);
      y[static_cast<std::size_t>(k)] = sin(y[static_cast<std::size_t>(k)]) / x[3];
    }
  });
  CHECK_FALSE(builder.inRun());
  const Graph graph = builder.finish(y);
  std::multiset<Operation> packable;
  for (const PackableNodes& tuple : graph.packable) {
    CHECK(tuple[3] == no_node);
    for (int l = 0; l < 3; ++l) CHECK(graph.nodes[tuple[static_cast<std::size_t>(l)]].operation == graph.nodes[tuple[0]].operation);
    packable.insert(graph.nodes[tuple[0]].operation);
  }
  CHECK(packable == std::multiset<Operation>{Operation::multiply, Operation::add, Operation::sin, Operation::divide});
}

TEST_CASE("a run that knows some of its numbers beforehand goes abreast with the others", "[codegen]") {
  GraphBuilder builder;
  std::vector<Traced> x, y(4);
  for (int i = 0; i < 4; ++i) x.push_back(builder.input());
  builder.packable([&] {
    for (int k = 0; k < 4; ++k) {
      const std::size_t lane = static_cast<std::size_t>(k);
      builder.run(k);
      builder.step(1);
      const Traced known = k == 1 ? Traced(2) : x[(lane + 1) % 4], sum = exp(x[lane]) + x[3];
      // Operations on constants only are not recorded, so run 1 records less.
      const Traced root = sqrt(known) * known, quotient = root / sum;
      y[lane] = quotient - x[lane];
    }
  });
  const Graph graph = builder.finish(y);
  std::map<Operation, std::ptrdiff_t> packable;
  for (const PackableNodes& tuple : graph.packable) {
    const std::uint32_t first = *std::min_element(tuple.begin(), tuple.end());
    packable[graph.nodes[first].operation] = 4 - std::count(tuple.begin(), tuple.end(), no_node);
  }
  using enum Operation;
  CHECK((packable == std::map<Operation, std::ptrdiff_t>{{add, 4}, {subtract, 4}, {multiply, 3}, {divide, 4}, {sqrt, 3}, {exp, 4}}));
}

TEST_CASE("what is stored side by side goes abreast for less than what is not", "[codegen]") {
  GraphBuilder builder;
  const Traced x = builder.input(), y = builder.input();
  std::vector<Traced> sums, products;
  for (int k = 0; k < 4; ++k) {
    sums.push_back(x + Traced(k + 1));
    products.push_back(y * Traced(k + 2));
  }
  builder.markPackable({sums[0], sums[1], sums[2], sums[3]});
  builder.markPackable({products[0], products[1], products[2], products[3]});
  const auto vectors = [&](const std::vector<Traced>& results) {
    const Schedule found = schedule(builder.finish(results), true);
    return std::count_if(found.units.begin(), found.units.end(), [](const Unit& unit) { return unit.several; });
  };
  CHECK(vectors(sums) == 1);
  CHECK(vectors({sums[0], products[0], sums[1], products[1], sums[2], products[2], sums[3], products[3]}) == 2);
  // Results that are read singly would have to be extracted from lanes one by one, so vectors do not pay here.
  CHECK(vectors({sin(sums[0]) / sums[1] + sin(sums[2]) / sums[3]}) == 0);
}

TEST_CASE("columns of an arm's matrices go abreast, whatever is zero of its last body's", "[codegen]") {
  Model model;
  Random random(3);
  for (int k = 0; k < 7; ++k) {
    JointDescription joint;
    joint.name = "j" + std::to_string(k);
    joint.type = "revolute";
    joint.parameters["axis"] = std::vector<double>{0, 0, 1};
    joint.placement = random.pose();
    // The last body's centre of mass lies on its joint axis, so rotation about this axis does not move it.
    const Inertia<double> on_axis{1, {0, 0, 0.1}, {0.1, 0, 0, 0.1, 0, 0.05}};
    model.addBody("b" + std::to_string(k), k, joint, k == 6 ? on_axis : random.inertia());
  }
  const CompactModel arm = compile(model, registry());
  const Source plain = writeSource({trace(arm, "rnea_derivatives")}), packable = writeSource({trace(arm, "rnea_derivatives", {.packable = true})});
  CHECK(packable.steps[0] < 0.85 * plain.steps[0]);
}

TEST_CASE("opaque numbers are computed with like any other", "[codegen]") {
  GraphBuilder builder;
  const Traced x = builder.input(), zero = builder.opaque(0), one = builder.opaque(1);
  const Graph graph = builder.finish(std::vector<Traced>{x * one + zero, x * 1 + 0});
  CHECK(graph.count().total() == 2);
  CHECK(replay<double>(graph, std::vector<double>{3}) == std::vector<double>{3, 3});
}

TEST_CASE("nodes abreast that would wait for one another are computed one by one", "[codegen]") {
  GraphBuilder builder;
  const Traced x = builder.input();
  const Traced a = x * x, b = a + x, c = b * x, d = c + x;
  Graph graph = builder.finish({&d, 1});
  // The two vectors depend on each other: b uses a, c uses b, and d uses c.
  graph.packable = {{1, 3, no_node, no_node}, {2, 4, no_node, no_node}};
  const Schedule found = schedule(graph, true);
  CHECK(isOrder(graph, found));
}

TEST_CASE("every algorithm traced abreast is what it is one body after the other", "[codegen]") {
  int traced = 0;
  std::size_t vectors = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    const CompactModel model = compile(limbed(seed), registry());
    if (!whyNotTraced(model).empty()) continue;
    ++traced;
    const auto [q, v, a] = randomState(model, seed);
    for (const std::string& name : traceableFunctions()) {
      INFO(name << ", seed " << seed);
      const TracedFunction plain = trace(model, name), packable = trace(model, name, {.packable = true});
      CHECK(plain.graph.packable.empty());
      const std::vector<Eigen::VectorXd> expected = byGraph(plain, q, v, a), found = byGraph(packable, q, v, a);
      for (std::size_t i = 0; i < found.size(); ++i) CHECK(difference(found[i], expected[i]) < 1e-11);
      std::set<std::uint32_t> seen;
      bool each_once = true;
      for (const PackableNodes& tuple : packable.graph.packable)
        for (const std::uint32_t node : tuple)
          if (node != no_node) each_once = seen.insert(node).second && each_once;
      CHECK(each_once);
      const Schedule order = schedule(packable.graph, true);
      CHECK(isOrder(packable.graph, order));
      for (const Unit& unit : order.units) vectors += unit.several ? 1 : 0;
      CHECK(isOrder(plain.graph, schedule(plain.graph, true)));
    }
  }
  CHECK(traced >= 20);
  CHECK(vectors > 10000);
}

TEST_CASE("source in vectors gives what the graph does, in double and in float", "[codegen]") {
  const CompilerCache cache;
  const bool single = GENERATE(false, true);
  const CompactModel biped = compile(urdf::load(DYN_SOURCE_DIR "/models/biped.urdf", {.root = "free_flyer"}), registry());
  std::vector<std::pair<CompactModel, std::vector<std::string>>> subjects{{biped, {"rnea_derivatives", "centroidal_map"}}};
  for (std::uint64_t seed = 1; subjects.size() < 5; ++seed) {
    const CompactModel model = compile(limbed(seed), registry());
    if (whyNotTraced(model).empty()) subjects.emplace_back(model, std::vector<std::string>{"rnea", "crba", "aba", "minverse", "jacobians"});
  }
  NativeOptions options = cache.options();
  options.single_precision = single;
  options.flags[0] = "-O1";  // the source is tested, not how fast it is
  for (const auto& [model, names] : subjects) {
    const CompiledModel jit = compileNative(model, names, options);
    const auto [q, v, a] = randomState(model, 1);
    for (const std::string& name : names) {
      INFO(name);
      const std::vector<Eigen::VectorXd> expected = byGraph(trace(model, name), q, v, a);
      const CompiledFunction& f = jit.function(name);
      for (std::size_t i = 0; i < expected.size(); ++i) {
        if (!single) {
          CHECK(difference(byCode(f, q, v, a)[i], expected[i]) < 1e-11);
          continue;
        }
        const Eigen::VectorXf in[] = {q.cast<float>(), v.cast<float>(), a.cast<float>()};
        std::vector<Eigen::VectorXf> parts;
        for (const ArgumentShape& shape : f.outputs()) parts.emplace_back(shape.size());
        const void* from[] = {in[0].data(), in[1].data(), in[2].data()};
        void* to[4];
        for (std::size_t k = 0; k < parts.size(); ++k) to[k] = parts[k].data();
        f.call(from, to);
        CHECK(difference(parts[i].cast<double>(), expected[i]) < 2e-3);
      }
    }
  }
}

TEST_CASE("source in vectors is shorter, and source of a plain trace is C99", "[codegen]") {
  const Folder folder;
  const CompactModel model = compile(urdf::load(DYN_SOURCE_DIR "/models/biped.urdf", {.root = "free_flyer"}), registry());
  for (const std::string name : {"rnea", "aba", "minverse"}) {
    const TracedFunction plain = trace(model, name);
    const Source without = writeSource({plain}), with = writeSource({trace(model, name, {.packable = true})});
    CHECK(without.steps[0] == plain.graph.count().total());
    CHECK(with.steps[0] < 0.8 * without.steps[0]);
    CHECK(with.definitions.find("#error") != std::string::npos);
    CHECK(without.definitions.find("#error") == std::string::npos);
    const std::string file = folder.write(name + ".c", without.code());
    CHECK(std::system(("cc -std=c99 -pedantic -Wall -Werror -Wno-unused-function -fsyntax-only '" + file + "'").c_str()) == 0);
  }
}
