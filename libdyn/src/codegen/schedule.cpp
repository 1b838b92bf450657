// SPDX-License-Identifier: BSD-2-Clause
#include "codegen/schedule.hpp"

#include "at.hpp"
#include "codegen/minimum_cut.hpp"

#include <algorithm>
#include <functional>
#include <iterator>
#include <map>
#include <queue>
#include <set>
#include <utility>

namespace dyn {

namespace {

bool isPackable(Operation o) {
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

constexpr PackableNodes nobody{no_node, no_node, no_node, no_node};
bool isThere(const std::vector<GraphNode>& nodes, std::uint32_t node) { return arity(nodes[node].operation) == 0 || isTurn(nodes, node); }

/// Chooses which packable nodes a vector computes at once. The choice has the lowest total cost of operations and of moving their arguments into
/// lanes and their results out of them.
class Packer {
 public:
  explicit Packer(const Graph& graph) : nodes_(graph.nodes), unit_(nodes_.size(), -1), lane_(nodes_.size(), 0), is_fused_(nodes_.size(), 0) {
    std::vector<int> uses(nodes_.size(), 0);
    for (const GraphNode& n : nodes_)
      for (int k = 0; k < arity(n.operation); ++k) uses[n.argument[k]] += n.operation == Operation::add || n.operation == Operation::subtract ? 1 : 2;
    for (const std::uint32_t output : graph.outputs) uses[output] += 2;
    for (std::size_t node = 0; node < uses.size(); ++node) is_fused_[node] = uses[node] == 1;
    for (const PackableNodes& tuple : graph.packable) assignLane(tuple);
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

  void assignLane(PackableNodes tuple) {
    int count = 0;
    Operation operation = Operation::constant;
    for (std::uint32_t& node : tuple) {
      if (node != no_node && (!isPackable(nodes_[node].operation) || isThere(nodes_, node))) node = no_node;
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

  /// Scores how well two arguments fit into lanes of one vector, from 0 to 4.
  int likeness(std::uint32_t a, std::uint32_t b) const {
    if (mayBeInVector(a) && unit_[a] == unit_[b]) return 4;
    if (a == b) return 3;
    if (mayBeInVector(a) != mayBeInVector(b)) return 0;
    return nodes_[a].operation == nodes_[b].operation ? 2 : 1;
  }
  /// Swaps factors or summands in the lanes so that their order matches that of the first lane.
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

  // Costs in quarters of an operation.
  static constexpr int operation_cost = 4, division_cost = 16, lane_cost = 4, first_lane_cost = 1;
  /// Cost of storing one lane by itself; the upper two lanes cost twice that.
  static constexpr int stored_cost = 1;
  /// Cost of a product that is read only by one sum: the two are one instruction.
  static constexpr int fused_cost = 1;
  int costOf(std::uint32_t node) const {
    switch (nodes_[node].operation) {
      case Operation::divide:
        return division_cost;
      case Operation::multiply:
        return is_fused_[node] ? fused_cost : operation_cost;
      default:
        return operation_cost;
    }
  }

  /// Whether output o and its neighbours are the lanes of the vector that may compute it, so that one store writes them all.
  bool isStoredInPack(const std::vector<std::uint32_t>& outputs, std::size_t o) const {
    const std::uint32_t node = outputs[o];
    if (!mayBeInVector(node)) return false;
    const PackableNodes& of = units_[at(unit_[node])].nodes;
    const std::size_t lane = at(lane_[node]);
    return o >= lane && o - lane + of.size() <= outputs.size() &&
           std::equal(of.begin(), of.end(), outputs.begin() + static_cast<std::ptrdiff_t>(o - lane));
  }
  /// Decides for each unit whether a vector computes it. A vector needs its arguments in lanes; they are there already if another vector computes
  /// them in the same lanes. A value that is read by itself must be moved out of its lane.
  void choose(const Graph& graph) {
    MinimumCut cut;
    for (const Unit& unit : units_) {
      int all = 0, most = 0;
      for (const std::uint32_t node : unit.nodes) {
        if (node == no_node) continue;
        all += costOf(node);
        most = std::max(most, costOf(node));
      }
      cut.costsIfNo(cut.add(), all - most);
    }
    std::vector<char> read_alone(nodes_.size(), 0);
    std::vector<std::vector<int>> readers(nodes_.size());  // units that read the node in its own lane
    std::vector<char> stored_alone(nodes_.size(), 0);
    for (std::size_t o = 0; o < graph.outputs.size(); ++o)
      if (!isStoredInPack(graph.outputs, o)) stored_alone[graph.outputs[o]] = 1;
    for (std::uint32_t node = 0; node < nodes_.size(); ++node)
      for (int k = 0; !mayBeInVector(node) && k < arity(nodes_[node].operation); ++k) read_alone[nodes_[node].argument[k]] = 1;
    std::map<PackableNodes, int> known;
    for (std::size_t u = 0; u < units_.size(); ++u)
      for (int k = 0; k < arity(units_[u].operation); ++k) {
        const PackableNodes tuple = argumentsOf(nodes_, units_[u], k);
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
        continue;
      }
      if (stored_alone[node]) cut.costsIfYes(unit_[node], lane_[node] < 2 ? stored_cost : 2 * stored_cost);
      if (!readers[node].empty()) {
        const int stays = cut.add();
        cut.costsIf(unit_[node], stays, cost);
        for (const int reader : readers[node]) cut.follows(stays, reader);
      }
    }
    cut.solve();
    for (std::size_t u = 0; u < units_.size(); ++u) units_[u].several = cut.answer(static_cast<int>(u));
  }
  /// Adds the question whether these nodes are moved into lanes, with its costs, and returns its number.
  int askFor(const PackableNodes& tuple, MinimumCut& cut) const {
    const int question = cut.add();
    int parts = 0;  // sources to put together: vectors, single numbers, all constants as one
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
  std::vector<char> is_fused_;    ///< by node: read by one sum or difference and by nothing else
};

/// Puts the units in order. Among the units whose arguments are computed, the one that is the last reader of the most values comes next, and of
/// several such units the one with the lowest node. This saves registers: values that wait long are written to memory and read again. A vector that
/// waits for itself is split into single nodes.
class Orderer {
 public:
  Orderer(const std::vector<GraphNode>& nodes, std::vector<Unit> vectors)
      : nodes_(nodes), units_(std::move(vectors)), unit_(nodes.size(), -1), waits_(nodes.size(), 0), left_(nodes.size(), 0), users_(nodes.size()) {
    std::vector<std::pair<std::uint32_t, int>> left;
    for (std::size_t u = 0; u < units_.size(); ++u) {
      for (const std::uint32_t node : units_[u].nodes)
        if (node != no_node) unit_[node] = static_cast<int>(u);
      left.emplace_back(firstOf(static_cast<int>(u)), static_cast<int>(u));
    }
    std::sort(left.begin(), left.end());
    for (std::uint32_t node = 0; node < nodes_.size(); ++node) {
      if (isThere(nodes_, node)) continue;
      if (unit_[node] < 0) single(node);
      eachArgument(node, [&](std::uint32_t from) {
        users_[from].push_back(node);
        ++waits_[node];
        ++left_[from];
      });
    }
    done_.resize(units_.size(), 0);
    ends_.resize(units_.size(), 0);
    for (std::uint32_t node = 0; node < nodes_.size(); ++node)
      if (const int u = lastUser(node); u >= 0) ++ends_[at(u)];
    for (std::size_t u = 0; u < units_.size(); ++u) offer(static_cast<int>(u));
    for (auto next = left.begin();;) {
      doAllReady();
      while (next != left.end() && done_[at(next->second)]) ++next;
      if (next == left.end()) return;
      // No unit is ready, so the first vector that is left waits for itself or for one that does. It is split.
      for (const std::uint32_t node : std::exchange(units_[at(next++->second)].nodes, nobody))
        if (node != no_node) offer(single(node));
    }
  }

  void fill(Schedule& out) const {
    for (const int u : order_) {
      const Unit& unit = units_[at(u)];
      for (int l = 0; l < most_packable; ++l)
        if (const std::uint32_t node = unit.nodes[at(l)]; node != no_node) out.places[node] = {static_cast<int>(out.units.size()), l};
      out.units.push_back(unit);
    }
  }

 private:
  struct Ready {
    int ends;
    std::uint32_t first;
    int unit;
    bool operator<(const Ready& other) const { return ends != other.ends ? ends < other.ends : first > other.first; }
  };

  std::uint32_t firstOf(int u) const { return *std::min_element(units_[at(u)].nodes.begin(), units_[at(u)].nodes.end()); }
  int single(std::uint32_t node) {
    unit_[node] = static_cast<int>(units_.size());
    units_.push_back({{node, no_node, no_node, no_node}, false, nodes_[node].operation});
    done_.resize(units_.size(), 0);
    ends_.resize(units_.size(), 0);
    return unit_[node];
  }
  /// Calls use(argument) once for each different argument that a unit computes.
  template <class Use>
  void eachArgument(std::uint32_t node, Use&& use) const {
    const GraphNode& n = nodes_[node];
    for (int k = 0; k < arity(n.operation); ++k)
      if (!isThere(nodes_, n.argument[k]) && std::find(n.argument, n.argument + k, n.argument[k]) == n.argument + k) use(n.argument[k]);
  }
  /// The only unit left that reads a node, or -1 if there is none or more than one.
  int lastUser(std::uint32_t node) const {
    if (left_[node] > most_packable) return -1;
    int last = -1;
    for (const std::uint32_t user : users_[node]) {
      const int u = unit_[user];
      if (done_[at(u)] || u == last) continue;
      if (last >= 0) return -1;
      last = u;
    }
    return last;
  }
  void offer(int u) {
    const PackableNodes& of = units_[at(u)].nodes;
    if (std::all_of(of.begin(), of.end(), [&](std::uint32_t node) { return node == no_node || waits_[node] == 0; }))
      ready_.push({ends_[at(u)], firstOf(u), u});
  }
  void doAllReady() {
    while (!ready_.empty()) {
      const Ready next = ready_.top();
      ready_.pop();
      // A unit that has become the last reader of more values since was offered again.
      if (done_[at(next.unit)] || next.ends != ends_[at(next.unit)]) continue;
      order_.push_back(next.unit);
      done_[at(next.unit)] = 1;
      std::set<std::uint32_t> taken;
      for (const std::uint32_t node : units_[at(next.unit)].nodes) {
        if (node == no_node) continue;
        for (const std::uint32_t user : users_[node])
          if (--waits_[user] == 0) offer(unit_[user]);
        eachArgument(node, [&](std::uint32_t from) {
          --left_[from];
          taken.insert(from);
        });
      }
      for (const std::uint32_t node : taken)
        if (const int u = lastUser(node); u >= 0) {
          ++ends_[at(u)];
          offer(u);
        }
    }
  }

  const std::vector<GraphNode>& nodes_;
  std::vector<Unit> units_;
  std::vector<int> unit_, waits_;  ///< by node: waits_ counts its arguments that are not computed yet
  std::vector<int> left_;          ///< by node: how many of its users are not done yet
  std::vector<std::vector<std::uint32_t>> users_;
  std::vector<char> done_;  ///< by unit
  std::vector<int> ends_;   ///< by unit: how many nodes it is the last to read
  std::priority_queue<Ready> ready_;
  std::vector<int> order_;
};

}  // namespace

bool isTurn(const std::vector<GraphNode>& nodes, std::uint32_t node) {
  const GraphNode& n = nodes[node];
  return (n.operation == Operation::sin || n.operation == Operation::cos) && nodes[n.argument[0]].operation == Operation::input;
}

PackableNodes argumentsOf(const std::vector<GraphNode>& nodes, const Unit& unit, int k) {
  PackableNodes out;
  for (std::size_t l = 0; l < out.size(); ++l) out[l] = unit.nodes[l] == no_node ? no_node : nodes[unit.nodes[l]].argument[k];
  return out;
}

Schedule schedule(const Graph& graph, bool packable) {
  Schedule out;
  std::vector<Unit> vectors;
  if (packable) {
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
