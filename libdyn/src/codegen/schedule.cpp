#include "codegen/schedule.hpp"

#include <algorithm>
#include <deque>
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

/// Chooses what is done at once. A vector is taken apart if bringing its arguments into lanes, and its results out of them, takes more than it saves;
/// those beside it are then looked at again.
class Packer {
 public:
  explicit Packer(const Graph& graph) : nodes_(graph.nodes), unit_(nodes_.size(), -1), lane_(nodes_.size(), 0), read_alone_(nodes_.size(), 0) {
    for (const NodesAbreast& tuple : graph.abreast) seat(tuple);
    for (const Unit& unit : units_) exchange(unit);
    for (const std::uint32_t o : graph.outputs) ++read_alone_[o];
    countReaders();
    while (!doubtful_.empty()) {
      const int u = doubtful_.front();
      doubtful_.pop_front();
      waits_[at(u)] = 0;
      if (units_[at(u)].several && cost(u) >= saved(u)) takeApart(u);
    }
  }

  std::vector<GraphNode> nodes() { return std::move(nodes_); }
  std::vector<Unit> vectors() const {
    std::vector<Unit> out;
    std::copy_if(units_.begin(), units_.end(), std::back_inserter(out), [](const Unit& unit) { return unit.several; });
    return out;
  }

 private:
  bool inVector(std::uint32_t node) const { return unit_[node] >= 0; }

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
    if (inVector(a) && unit_[a] == unit_[b]) return 4;
    if (a == b) return 3;
    if (inVector(a) != inVector(b)) return 0;
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

  void countReaders() {
    readers_.resize(nodes_.size());
    tuple_of_.resize(units_.size());
    read_in_place_.resize(units_.size(), 0);
    waits_.resize(units_.size(), 0);
    std::map<NodesAbreast, int> known;
    for (std::size_t u = 0; u < units_.size(); ++u) {
      for (int k = 0; k < arity(units_[u].operation); ++k) {
        const NodesAbreast tuple = argumentsOf(nodes_, units_[u], k);
        const int id = known.emplace(tuple, static_cast<int>(tuples_.size())).first->second;
        if (at(id) == tuples_.size()) tuples_.push_back({tuple, {}});
        tuples_[at(id)].readers.push_back(static_cast<int>(u));
        tuple_of_[u].push_back(id);
        for (std::size_t l = 0; l < tuple.size(); ++l)
          if (tuple[l] != no_node && inVector(tuple[l])) {
            readers_[tuple[l]].push_back(static_cast<int>(u));
            if (lane_[tuple[l]] == static_cast<int>(l)) ++read_in_place_[at(unit_[tuple[l]])];
          }
      }
      doubt(static_cast<int>(u));
    }
    for (std::uint32_t node = 0; node < nodes_.size(); ++node)
      for (int k = 0; !inVector(node) && k < arity(nodes_[node].operation); ++k) ++read_alone_[nodes_[node].argument[k]];
  }
  void doubt(int u) {
    if (waits_[at(u)] || !units_[at(u)].several) return;
    waits_[at(u)] = 1;
    doubtful_.push_back(u);
  }

  /// Instructions that bring a tuple into lanes.
  double gatheringCost(const NodesAbreast& tuple) const {
    int sources = 0, constants = 0, single = 0;
    double cost = 0;
    std::vector<int> units;
    std::uint32_t first = no_node;
    bool same = true;
    for (std::size_t l = 0; l < tuple.size(); ++l) {
      const std::uint32_t node = tuple[l];
      if (node == no_node) continue;
      if (first == no_node) first = node;
      same = same && node == first;
      if (nodes_[node].operation == Operation::constant) {
        constants = 1;
      } else if (inVector(node) && lane_[node] == static_cast<int>(l)) {
        if (std::find(units.begin(), units.end(), unit_[node]) == units.end()) units.push_back(unit_[node]), ++sources;
      } else {
        single += 1;
        if (inVector(node)) cost += 0.5;
      }
    }
    if (same && nodes_[first].operation == Operation::constant) return 0;
    if (same) return inVector(first) ? 1.5 : 1;
    return cost + single + std::max(0, sources + constants - 1);
  }
  double cost(int u) const {
    double out = 0;
    for (const int id : tuple_of_[at(u)]) out += gatheringCost(tuples_[at(id)].nodes) / static_cast<double>(tuples_[at(id)].readers.size());
    for (const std::uint32_t node : units_[at(u)].nodes)
      if (node != no_node && read_alone_[node] > 0) out += 0.5;
    return out;
  }
  double saved(int u) const {
    const Unit& unit = units_[at(u)];
    const auto lanes = static_cast<int>(std::count_if(unit.nodes.begin(), unit.nodes.end(), [](std::uint32_t node) { return node != no_node; }));
    return (lanes - 1) * (unit.operation == Operation::divide ? 4 : 1) + (read_in_place_[at(u)] > 0 ? lanes : 0);
  }

  void takeApart(int u) {
    Unit& unit = units_[at(u)];
    unit.several = false;
    for (const int id : tuple_of_[at(u)]) {
      Tuple& tuple = tuples_[at(id)];
      tuple.readers.erase(std::find(tuple.readers.begin(), tuple.readers.end(), u));
      for (const int other : tuple.readers) doubt(other);
      for (std::size_t l = 0; l < tuple.nodes.size(); ++l) {
        const std::uint32_t node = tuple.nodes[l];
        if (node == no_node) continue;
        ++read_alone_[node];
        if (!inVector(node)) continue;
        if (lane_[node] == static_cast<int>(l)) --read_in_place_[at(unit_[node])];
        doubt(unit_[node]);
      }
    }
    for (const std::uint32_t node : unit.nodes) {
      if (node == no_node) continue;
      unit_[node] = -1;
      for (const int reader : readers_[node]) doubt(reader);
    }
  }

  /// What goes into lanes, and which vectors take it.
  struct Tuple {
    NodesAbreast nodes;
    std::vector<int> readers;
  };

  std::vector<GraphNode> nodes_;
  std::vector<Unit> units_;
  std::vector<int> unit_, lane_;           ///< by node
  std::vector<int> read_alone_;            ///< by node: how often by no vector
  std::vector<std::vector<int>> readers_;  ///< by node: vectors
  std::vector<Tuple> tuples_;
  std::vector<std::vector<int>> tuple_of_;  ///< by unit
  std::vector<int> read_in_place_;          ///< by unit: how often lanes are read in the same lane
  std::vector<char> waits_;                 ///< by unit: among the doubtful
  std::deque<int> doubtful_;
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
