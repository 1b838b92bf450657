// SPDX-License-Identifier: BSD-2-Clause
#include "codegen/align.hpp"

#include <dyn/codegen/graph.hpp>
#include <dyn/error.hpp>

#include <algorithm>
#include <bit>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <unordered_map>
#include <utility>

namespace dyn {

OperationCounts Graph::count() const {
  OperationCounts out;
  for (const GraphNode& n : nodes) switch (n.operation) {
      case Operation::input:
      case Operation::constant:
        break;
      case Operation::add:
      case Operation::subtract:
      case Operation::negate:
      case Operation::abs:
        ++out.additions;
        break;
      case Operation::multiply:
        ++out.multiplications;
        break;
      case Operation::divide:
      case Operation::sqrt:
        ++out.divisions;
        break;
      case Operation::select_less:
        ++out.selections;
        break;
      default:
        ++out.functions;
    }
  return out;
}

struct GraphBuilder::Impl {
  struct Key {
    Operation operation;
    std::uint32_t a, b, c, d;
    bool operator==(const Key&) const = default;
  };
  struct KeyHash {
    std::size_t operator()(const Key& k) const {
      std::uint64_t h = static_cast<std::uint64_t>(k.operation);
      for (const std::uint64_t x : {k.a, k.b, k.c, k.d}) h = (h ^ x) * 0x9e3779b97f4a7c15u, h ^= h >> 29;
      return static_cast<std::size_t>(h);
    }
  };

  GraphBuilder* self;
  std::vector<GraphNode> nodes;
  std::unordered_map<Key, std::uint32_t, KeyHash> known;
  std::unordered_map<std::uint64_t, std::uint32_t> constants;  ///< nodes by the bits of their values
  std::unordered_map<std::uint64_t, std::uint32_t> opaque;     ///< the same for constants that no operation is simplified for
  std::vector<char> is_opaque;
  int inputs = 0;
  std::size_t most_nodes = 0;
  // For each run, the results recorded in each step, in order.
  using Steps = std::map<int, std::vector<std::uint32_t>>;
  std::array<Steps, most_packable> runs;
  std::vector<std::uint32_t>* step = nullptr;
  int run = -1, depth = 0;
  std::uint32_t first_of_runs = 0;
  std::vector<PackableNodes> packable;
  std::vector<char> is_packable;  ///< by node
  std::set<PackableNodes> tried;
  std::vector<std::uint32_t> seen;  ///< by node: the last search of areIndependent() that met it
  std::uint32_t looks = 0;

  bool isConstant(std::uint32_t node) const { return nodes[node].operation == Operation::constant && (node >= is_opaque.size() || !is_opaque[node]); }
  bool full() const { return nodes.size() > most_nodes; }

  Traced traced(std::uint32_t node) const {
    if (isConstant(node)) return nodes[node].value;
    Traced out;
    out.recorder = self;
    out.node = node;
    return out;
  }
  std::uint32_t constant(double x) {
    const auto [found, is_new] = constants.emplace(std::bit_cast<std::uint64_t>(x), static_cast<std::uint32_t>(nodes.size()));
    if (is_new) nodes.push_back({Operation::constant, {}, x});
    return found->second;
  }
  std::uint32_t nodeOf(const Traced& x) { return x.recorder ? x.node : constant(x.value); }
  bool isKnown(const Traced& x, double value) const { return !x.recorder && x.value == value; }
  /// Whether simplifications may look into x. Runs do not look into nodes older than themselves, whose signs would make the runs differ.
  bool isOpen(const Traced& x) const { return x.recorder && (run < 0 || x.node >= first_of_runs); }
  bool isNegation(const Traced& x) const { return isOpen(x) && nodes[x.node].operation == Operation::negate; }
  Traced argument(const Traced& x, int k) const { return traced(nodes[x.node].argument[k]); }
  /// Whether x = factor * rest with a known factor.
  bool isScaled(const Traced& x, double& factor, Traced& rest) const {
    if (!isOpen(x) || nodes[x.node].operation != Operation::multiply || !isConstant(nodes[x.node].argument[0])) return false;
    factor = nodes[nodes[x.node].argument[0]].value;
    rest = argument(x, 1);
    return true;
  }
  const std::uint32_t* find(Operation o, const Traced& a, const Traced& b) {
    const auto found = known.find({o, nodeOf(a), nodeOf(b), 0, 0});
    return found == known.end() ? nullptr : &found->second;
  }

  Traced node(Operation o, const Traced& a, const Traced& b = 0, const Traced& c = 0, const Traced& d = 0) {
    const int n = arity(o);
    const Key key{o, nodeOf(a), n > 1 ? nodeOf(b) : 0, n > 2 ? nodeOf(c) : 0, n > 2 ? nodeOf(d) : 0};
    const auto [found, is_new] = known.emplace(key, static_cast<std::uint32_t>(nodes.size()));
    if (is_new) nodes.push_back({o, {key.a, key.b, key.c, key.d}, 0});
    return traced(found->second);
  }

  Traced add(const Traced& a, const Traced& b) {
    if (isKnown(a, 0)) return b;
    if (isKnown(b, 0)) return a;
    if (isNegation(b)) return a - argument(b, 0);
    if (isNegation(a)) return b - argument(a, 0);
    return nodeOf(a) <= nodeOf(b) ? node(Operation::add, a, b) : node(Operation::add, b, a);
  }
  Traced subtract(const Traced& a, const Traced& b) {
    if (isKnown(b, 0)) return a;
    if (isKnown(a, 0)) return -b;
    if (a.recorder && b.recorder && a.node == b.node) return 0;
    if (isNegation(b)) return a + argument(b, 0);
    if (isNegation(a)) return -(argument(a, 0) + b);
    if (const std::uint32_t* reversed = find(Operation::subtract, b, a)) return -traced(*reversed);
    return node(Operation::subtract, a, b);
  }
  Traced multiply(const Traced& a, const Traced& b) {
    if (a.recorder && !b.recorder) return multiply(b, a);
    if (isNegation(a)) return -(argument(a, 0) * b);
    if (isNegation(b)) return -(a * argument(b, 0));
    if (!a.recorder) {
      if (a.value == 0) return 0;
      if (a.value == 1) return b;
      if (a.value < 0) return -(Traced(-a.value) * b);
      double factor;
      Traced rest;
      if (isScaled(b, factor, rest)) return Traced(a.value * factor) * rest;
      return node(Operation::multiply, a, b);
    }
    return nodeOf(a) <= nodeOf(b) ? node(Operation::multiply, a, b) : node(Operation::multiply, b, a);
  }
  Traced divide(const Traced& a, const Traced& b) {
    if (isKnown(a, 0)) return 0;
    if (isKnown(b, 1)) return a;
    if (isNegation(a)) return -(argument(a, 0) / b);
    if (isNegation(b)) return -(a / argument(b, 0));
    if (a.recorder && b.recorder && a.node == b.node) return 1;
    // A quotient costs as much as several products, so a reciprocal that exists already is used.
    if (!isKnown(a, 1))
      if (const std::uint32_t* reciprocal = find(Operation::divide, 1, b)) return a * traced(*reciprocal);
    return node(Operation::divide, a, b);
  }
  Traced negate(const Traced& a) { return isNegation(a) ? argument(a, 0) : node(Operation::negate, a); }

  Traced simplified(Operation operation, const Traced& a, const Traced& b, const Traced& c, const Traced& d) {
    switch (operation) {
      case Operation::add:
        return add(a, b);
      case Operation::subtract:
        return subtract(a, b);
      case Operation::multiply:
        return multiply(a, b);
      case Operation::divide:
        return divide(a, b);
      case Operation::negate:
        return negate(a);
      case Operation::sin:
        return isNegation(a) ? -sin(argument(a, 0)) : node(operation, a);
      case Operation::cos:
      case Operation::abs:
        return node(operation, isNegation(a) ? argument(a, 0) : a);
      case Operation::select_less:
        if (!a.recorder && !b.recorder) return a.value < b.value ? c : d;
        if (nodeOf(c) == nodeOf(d)) return c;
        return node(operation, a, b, c, d);
      default:
        return node(operation, a, b, c, d);
    }
  }

  /// Marks the nodes that have the tuple's most frequent operation as packable, unless one of them depends on another. Then does the same with their
  /// arguments. Entries may be no_node.
  void join(PackableNodes tuple) {
    is_packable.resize(nodes.size(), 0);
    int count = 0;
    for (std::uint32_t& node : tuple) {
      const bool open = node != no_node && !is_packable[node] && arity(nodes[node].operation) > 0;
      const std::uint32_t* same = std::find(tuple.begin(), &node, node);
      if (!open || same != &node) {
        node = no_node;
        continue;
      }
      ++count;
    }
    if (count < 2) return;
    const auto alikeTo = [&](std::uint32_t one) {
      return std::count_if(tuple.begin(), tuple.end(),
                           [&](std::uint32_t node) { return one != no_node && node != no_node && nodes[node].operation == nodes[one].operation; });
    };
    const GraphNode& first =
        nodes[*std::max_element(tuple.begin(), tuple.end(), [&](std::uint32_t a, std::uint32_t b) { return alikeTo(a) < alikeTo(b); })];
    for (std::uint32_t& node : tuple)
      if (node != no_node && nodes[node].operation != first.operation) node = no_node, --count;
    if (count < 2 || !tried.insert(tuple).second) return;
    if (areIndependent(tuple)) {
      for (const std::uint32_t node : tuple)
        if (node != no_node) is_packable[node] = 1;
      packable.push_back(tuple);
    }
    const bool exchangeable = first.operation == Operation::add || first.operation == Operation::multiply;
    const auto like = [&](std::uint32_t a, std::uint32_t b) { return nodes[a].operation == nodes[b].operation; };
    for (int k = 0; k < arity(first.operation); ++k) {
      PackableNodes arguments;
      for (std::size_t l = 0; l < tuple.size(); ++l) {
        arguments[l] = no_node;
        if (tuple[l] == no_node) continue;
        const GraphNode& n = nodes[tuple[l]];
        const auto alike = [&](int a, int b) { return like(n.argument[a], first.argument[0]) + like(n.argument[b], first.argument[1]); };
        arguments[l] = n.argument[exchangeable && alike(1, 0) > alike(0, 1) ? 1 - k : k];
      }
      join(arguments);
    }
  }
  /// Whether none of these nodes depends on another one, directly or indirectly.
  bool areIndependent(const PackableNodes& tuple) {
    std::uint32_t least = no_node;
    for (const std::uint32_t node : tuple) least = std::min(least, node);
    seen.resize(nodes.size(), 0);
    ++looks;
    std::vector<std::uint32_t> open;
    for (const std::uint32_t node : tuple)
      if (node != no_node) open.push_back(node);
    while (!open.empty()) {
      const GraphNode& n = nodes[open.back()];
      open.pop_back();
      for (int k = 0; k < arity(n.operation); ++k) {
        const std::uint32_t node = n.argument[k];
        if (node < least || seen[node] == looks) continue;
        if (std::find(tuple.begin(), tuple.end(), node) != tuple.end()) return false;
        seen[node] = looks;
        open.push_back(node);
      }
    }
    return true;
  }
  void joinRuns() {
    std::set<int> numbers;
    for (const Steps& steps : runs)
      for (const auto& [number, nodes_of] : steps) numbers.insert(number);
    for (const int number : numbers) {
      std::array<std::vector<std::uint32_t>, most_packable> of;
      for (std::size_t l = 0; l < of.size(); ++l)
        if (const auto found = runs[l].find(number); found != runs[l].end()) of[l] = std::move(found->second);
      const auto longest = *std::max_element(of.begin(), of.end(), [](const auto& a, const auto& b) { return a.size() < b.size(); });
      for (auto& nodes_of : of)
        if (!nodes_of.empty()) nodes_of = aligned(nodes, nodes_of, longest);
      for (std::size_t i = 0; i < longest.size(); ++i) {
        PackableNodes tuple;
        for (std::size_t l = 0; l < of.size(); ++l) tuple[l] = of[l].empty() ? no_node : of[l][i];
        join(tuple);
      }
    }
    for (Steps& steps : runs) steps.clear();
  }
};

GraphBuilder::GraphBuilder(std::size_t most_nodes) : impl_(std::make_unique<Impl>()) {
  impl_->self = this;
  impl_->most_nodes = most_nodes;
}
GraphBuilder::~GraphBuilder() = default;

Traced GraphBuilder::input() {
  impl_->nodes.push_back({Operation::input, {static_cast<std::uint32_t>(impl_->inputs++)}, 0});
  return impl_->traced(static_cast<std::uint32_t>(impl_->nodes.size() - 1));
}

Traced GraphBuilder::record(Operation operation, const Traced& a, const Traced& b, const Traced& c, const Traced& d) noexcept {
  Impl& g = *impl_;
  // No exception may pass through a plugin's code, which may be the caller. Known numbers bring that code to its end soon.
  if (g.full()) return std::numeric_limits<double>::quiet_NaN();
  ++g.depth;
  const Traced result = g.simplified(operation, a, b, c, d);
  // Operations that simplification records belong to this one and are not entered by themselves.
  if (--g.depth == 0 && g.step) g.step->push_back(result.recorder ? result.node : no_node);
  return result;
}

void GraphBuilder::packable(const std::function<void()>& runs) {
  Impl& g = *impl_;
  g.first_of_runs = static_cast<std::uint32_t>(g.nodes.size());
  runs();
  g.run = -1;
  g.step = nullptr;
  g.joinRuns();
}
void GraphBuilder::markPackable(const std::array<Traced, most_packable>& numbers) {
  PackableNodes tuple;
  for (std::size_t l = 0; l < tuple.size(); ++l) tuple[l] = numbers[l].recorder ? numbers[l].node : no_node;
  impl_->join(tuple);
}
void GraphBuilder::run(int k) {
  if (k < 0 || k >= most_packable)
    throw Error(ErrorCode::argument,
                "GraphBuilder: there is no run " + std::to_string(k) + "; runs have numbers from 0 to " + std::to_string(most_packable - 1));
  impl_->run = k;
  impl_->step = nullptr;
}
void GraphBuilder::step(int number) {
  Impl& g = *impl_;
  if (g.run >= 0) g.step = number < 0 ? nullptr : &g.runs[static_cast<std::size_t>(g.run)][number];
}
bool GraphBuilder::inRun() const { return impl_->run >= 0; }

Traced GraphBuilder::opaque(double x) {
  Impl& g = *impl_;
  const auto [found, is_new] = g.opaque.emplace(std::bit_cast<std::uint64_t>(x), static_cast<std::uint32_t>(g.nodes.size()));
  if (is_new) {
    g.nodes.push_back({Operation::constant, {}, x});
    g.is_opaque.resize(g.nodes.size(), 0);
    g.is_opaque.back() = 1;
  }
  return g.traced(found->second);
}
Graph GraphBuilder::finish(std::span<const Traced> results) const {
  Impl& g = *impl_;
  if (g.full())
    throw Error(ErrorCode::size, "the function has more than " + std::to_string(g.most_nodes) +
                                     " operations; what grows as the square of a long chain is better computed than generated");
  Graph out;
  out.inputs = g.inputs;
  std::vector<std::uint32_t> ends;
  for (const Traced& r : results) ends.push_back(g.nodeOf(r));
  std::vector<char> live(g.nodes.size(), 0);
  for (const std::uint32_t e : ends) live[e] = 1;
  for (std::size_t i = g.nodes.size(); i-- > 0;)
    if (live[i])
      for (int k = 0; k < arity(g.nodes[i].operation); ++k) live[g.nodes[i].argument[k]] = 1;
  std::vector<std::uint32_t> number(g.nodes.size(), 0);
  for (std::size_t i = 0; i < g.nodes.size(); ++i) {
    if (!live[i]) continue;
    number[i] = static_cast<std::uint32_t>(out.nodes.size());
    GraphNode n = g.nodes[i];
    for (int k = 0; k < arity(n.operation); ++k) n.argument[k] = number[n.argument[k]];
    out.nodes.push_back(n);
  }
  for (const std::uint32_t e : ends) out.outputs.push_back(number[e]);
  for (PackableNodes tuple : g.packable) {
    int count = 0;
    for (std::uint32_t& node : tuple) {
      if (node != no_node && !live[node]) node = no_node;
      if (node == no_node) continue;
      node = number[node];
      ++count;
    }
    if (count > 1) out.packable.push_back(tuple);
  }
  return out;
}

Graph traceFunction(int inputs, int outputs, const std::function<void(const Traced* in, Traced* out)>& f) {
  GraphBuilder builder;
  std::vector<Traced> in, out(static_cast<std::size_t>(outputs));
  for (int i = 0; i < inputs; ++i) in.push_back(builder.input());
  f(in.data(), out.data());
  return builder.finish(out);
}

}  // namespace dyn
