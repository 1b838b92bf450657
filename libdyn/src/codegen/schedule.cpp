#include "codegen/schedule.hpp"

#include "codegen/minimum_cut.hpp"

#include <algorithm>
#include <functional>
#include <iterator>
#include <map>
#include <queue>
#include <utility>

namespace dyn {

namespace {

bool goesAbreast(Operation o) {
  switch (o) {
    case Operation::add:
    case Operation::subtract:
    case Operation::multiply:
    case Operation::divide:
    case Operation::negate:
      return true;
    default:
      return false;
  }
}

constexpr NodesAbreast nobody{no_node, no_node, no_node, no_node};
std::size_t at(int i) { return static_cast<std::size_t>(i); }
bool isThere(const std::vector<GraphNode>& nodes, std::uint32_t node) { return arity(nodes[node].operation) == 0 || isTurn(nodes, node); }

/// Chooses what is done at once: of all choices that for which operations, and what brings their arguments into lanes and their results out of
/// them, are fewest.
class Packer {
 public:
  explicit Packer(const Graph& graph) : nodes_(graph.nodes), unit_(nodes_.size(), -1), lane_(nodes_.size(), 0) {
    for (const NodesAbreast& tuple : graph.abreast) seat(tuple);
    for (const Unit& unit : units_) exchange(unit);
    choose(graph);
  }

  std::vector<GraphNode> nodes() { return std::move(nodes_); }
  std::vector<Unit> vectors() const {
    std::vector<Unit> out;
    std::copy_if(units_.begin(), units_.end(), std::back_inserter(out), [](const Unit& unit) { return unit.several; });
    return out;
  }

 private:
  bool mayBeInVector(std::uint32_t node) const { return unit_[node] >= 0; }
  bool inPlace(std::uint32_t node, std::size_t lane) const { return mayBeInVector(node) && lane_[node] == static_cast<int>(lane); }

  void seat(NodesAbreast tuple) {
    int count = 0;
    Operation operation = Operation::constant;
    for (std::uint32_t& node : tuple) {
      if (node != no_node && (!goesAbreast(nodes_[node].operation) || isThere(nodes_, node))) node = no_node;
      if (node == no_node) continue;
      operation = nodes_[node].operation;
      ++count;
    }
    if (count < 2) return;
    for (std::size_t l = 0; l < tuple.size(); ++l) {
      if (tuple[l] == no_node) continue;
      unit_[tuple[l]] = static_cast<int>(units_.size());
      lane_[tuple[l]] = static_cast<int>(l);
    }
    units_.push_back({tuple, true, operation});
  }

  /// How alike two arguments are.
  int likeness(std::uint32_t a, std::uint32_t b) const {
    if (mayBeInVector(a) && unit_[a] == unit_[b]) return 4;
    if (a == b) return 3;
    if (mayBeInVector(a) != mayBeInVector(b)) return 0;
    return nodes_[a].operation == nodes_[b].operation ? 2 : 1;
  }
  /// Lets factors and summands of all lanes come in the first one's order.
  void exchange(const Unit& unit) {
    if (unit.operation != Operation::add && unit.operation != Operation::multiply) return;
    const GraphNode* first = nullptr;
    for (const std::uint32_t node : unit.nodes) {
      if (node == no_node) continue;
      GraphNode& n = nodes_[node];
      if (first == nullptr) {
        first = &n;
        continue;
      }
      const auto like = [&](int a, int b) { return likeness(n.argument[a], first->argument[0]) + likeness(n.argument[b], first->argument[1]); };
      if (like(1, 0) > like(0, 1)) std::swap(n.argument[0], n.argument[1]);
    }
  }

  // Costs, in quarters of an operation.
  static constexpr int operation_cost = 4, division_cost = 16, lane_cost = 4, first_lane_cost = 1;

  /// Asks of each unit whether its operations are done at once. Only those that are need their arguments in lanes, which are there if what
  /// computes them is such a unit, too; what is read by itself must be brought out of lanes.
  void choose(const Graph& graph) {
    MinimumCut cut;
    for (const Unit& unit : units_) {
      const auto count = std::count_if(unit.nodes.begin(), unit.nodes.end(), [](std::uint32_t node) { return node != no_node; });
      cut.costsIfNo(cut.add(), static_cast<int>(count - 1) * (unit.operation == Operation::divide ? division_cost : operation_cost));
    }
    std::vector<char> read_alone(nodes_.size(), 0);
    std::vector<std::vector<int>> readers(nodes_.size());  // units that take it in its lane
    for (const std::uint32_t output : graph.outputs) read_alone[output] = 1;
    for (std::uint32_t node = 0; node < nodes_.size(); ++node)
      for (int k = 0; !mayBeInVector(node) && k < arity(nodes_[node].operation); ++k) read_alone[nodes_[node].argument[k]] = 1;
    std::map<NodesAbreast, int> known;
    for (std::size_t u = 0; u < units_.size(); ++u)
      for (int k = 0; k < arity(units_[u].operation); ++k) {
        const NodesAbreast tuple = argumentsOf(nodes_, units_[u], k);
        const auto [found, is_new] = known.emplace(tuple, 0);
        if (is_new) found->second = askFor(tuple, cut);
        cut.follows(static_cast<int>(u), found->second);
        for (std::size_t l = 0; l < tuple.size(); ++l) {
          if (tuple[l] == no_node) continue;
          if (inPlace(tuple[l], l)) {
            readers[tuple[l]].push_back(static_cast<int>(u));
          } else {
            read_alone[tuple[l]] = 1;
          }
        }
      }
    for (std::uint32_t node = 0; node < nodes_.size(); ++node) {
      if (!mayBeInVector(node)) continue;
      const int cost = lane_[node] == 0 ? first_lane_cost : lane_cost;
      if (read_alone[node]) {
        cut.costsIfYes(unit_[node], cost);
      } else if (!readers[node].empty()) {
        const int stays = cut.add();
        cut.costsIf(unit_[node], stays, cost);
        for (const int reader : readers[node]) cut.follows(stays, reader);
      }
    }
    cut.solve();
    for (std::size_t u = 0; u < units_.size(); ++u) units_[u].several = cut.answer(static_cast<int>(u));
  }
  /// Whether these are brought into lanes.
  int askFor(const NodesAbreast& tuple, MinimumCut& cut) const {
    const int question = cut.add();
    int parts = 0;  // what is put together: vectors, single numbers, constants
    bool constants = false, same = true;
    std::map<int, int> lanes_of;  // by unit
    std::uint32_t first = no_node;
    for (std::size_t l = 0; l < tuple.size(); ++l) {
      const std::uint32_t node = tuple[l];
      if (node == no_node) continue;
      if (first == no_node) first = node;
      same = same && node == first;
      if (nodes_[node].operation == Operation::constant) {
        constants = true;
      } else if (inPlace(node, l)) {
        ++lanes_of[unit_[node]];
      } else {
        ++parts;
      }
    }
    if (same) {
      cut.costsIfYes(question, nodes_[first].operation == Operation::constant ? 0 : lane_cost);
      return question;
    }
    parts += static_cast<int>(lanes_of.size()) + (constants ? 1 : 0);
    cut.costsIfYes(question, lane_cost * (parts - 1));
    for (const auto& [unit, lanes] : lanes_of) cut.costsIf(question, unit, lane_cost * (lanes - 1));
    return question;
  }

  std::vector<GraphNode> nodes_;
  std::vector<Unit> units_;
  std::vector<int> unit_, lane_;  ///< by node
};

/// Units one after the other, of those that have all that they take the one with the first node. What waits for itself is taken apart.
class Orderer {
 public:
  Orderer(const std::vector<GraphNode>& nodes, std::vector<Unit> vectors)
      : nodes_(nodes), units_(std::move(vectors)), unit_(nodes.size(), -1), waits_(nodes.size(), 0), users_(nodes.size()) {
    std::vector<Item> left;
    for (std::size_t u = 0; u < units_.size(); ++u) {
      for (const std::uint32_t node : units_[u].nodes)
        if (node != no_node) unit_[node] = static_cast<int>(u);
      left.emplace_back(firstOf(static_cast<int>(u)), static_cast<int>(u));
    }
    std::sort(left.begin(), left.end());
    for (std::uint32_t node = 0; node < nodes_.size(); ++node) {
      if (isThere(nodes_, node)) continue;
      if (unit_[node] < 0) single(node);
      for (int k = 0; k < arity(nodes_[node].operation); ++k)
        if (const std::uint32_t from = nodes_[node].argument[k]; !isThere(nodes_, from)) {
          users_[from].push_back(node);
          ++waits_[node];
        }
    }
    for (std::size_t u = 0; u < units_.size(); ++u) offer(static_cast<int>(u));
    done_.resize(units_.size(), 0);
    for (auto next = left.begin();;) {
      doAllReady();
      while (next != left.end() && done_[at(next->second)]) ++next;
      if (next == left.end()) return;
      // Nothing is ready: the first vector of those left waits for itself, or for one that does.
      for (const std::uint32_t node : std::exchange(units_[at(next++->second)].nodes, nobody))
        if (node != no_node) offer(single(node));
    }
  }

  void fill(Schedule& out) const {
    for (const int u : order_) {
      const Unit& unit = units_[at(u)];
      for (int l = 0; l < most_abreast; ++l)
        if (const std::uint32_t node = unit.nodes[at(l)]; node != no_node) out.places[node] = {static_cast<int>(out.units.size()), l};
      out.units.push_back(unit);
    }
  }

 private:
  using Item = std::pair<std::uint32_t, int>;  ///< first node and unit

  std::uint32_t firstOf(int u) const { return *std::min_element(units_[at(u)].nodes.begin(), units_[at(u)].nodes.end()); }
  int single(std::uint32_t node) {
    unit_[node] = static_cast<int>(units_.size());
    units_.push_back({{node, no_node, no_node, no_node}, false, nodes_[node].operation});
    done_.resize(units_.size(), 0);
    return unit_[node];
  }
  void offer(int u) {
    const NodesAbreast& of = units_[at(u)].nodes;
    if (std::all_of(of.begin(), of.end(), [&](std::uint32_t node) { return node == no_node || waits_[node] == 0; })) ready_.emplace(firstOf(u), u);
  }
  void doAllReady() {
    while (!ready_.empty()) {
      const int u = ready_.top().second;
      ready_.pop();
      order_.push_back(u);
      done_[at(u)] = 1;
      for (const std::uint32_t node : units_[at(u)].nodes) {
        if (node == no_node) continue;
        for (const std::uint32_t user : users_[node])
          if (--waits_[user] == 0) offer(unit_[user]);
      }
    }
  }

  const std::vector<GraphNode>& nodes_;
  std::vector<Unit> units_;
  std::vector<int> unit_, waits_;  ///< by node: of its arguments how many are not there yet
  std::vector<std::vector<std::uint32_t>> users_;
  std::vector<char> done_;  ///< by unit
  std::priority_queue<Item, std::vector<Item>, std::greater<>> ready_;
  std::vector<int> order_;
};

}  // namespace

bool isTurn(const std::vector<GraphNode>& nodes, std::uint32_t node) {
  const GraphNode& n = nodes[node];
  return (n.operation == Operation::sin || n.operation == Operation::cos) && nodes[n.argument[0]].operation == Operation::input;
}

NodesAbreast argumentsOf(const std::vector<GraphNode>& nodes, const Unit& unit, int k) {
  NodesAbreast out;
  for (std::size_t l = 0; l < out.size(); ++l) out[l] = unit.nodes[l] == no_node ? no_node : nodes[unit.nodes[l]].argument[k];
  return out;
}

Schedule schedule(const Graph& graph, bool abreast) {
  Schedule out;
  std::vector<Unit> vectors;
  if (abreast) {
    Packer packer(graph);
    vectors = packer.vectors();
    out.nodes = packer.nodes();
  } else {
    out.nodes = graph.nodes;
  }
  out.places.resize(out.nodes.size());
  Orderer(out.nodes, std::move(vectors)).fill(out);
  return out;
}

}  // namespace dyn
