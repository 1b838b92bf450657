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
bool isThere(const std::vector<GraphNode>& nodes, std::uint32_t node) { return arity(nodes[node].operation) == 0 || isTurn(nodes, node); }

/// Chooses what is done at once: of all choices that for which operations, and what brings their arguments into lanes and their results out of
/// them, are fewest.
class Packer {
 public:
  explicit Packer(const Graph& graph) : nodes_(graph.nodes), unit_(nodes_.size(), -1), lane_(nodes_.size(), 0), is_fused_(nodes_.size(), 0) {
    std::vector<int> uses(nodes_.size(), 0);
    for (const GraphNode& n : nodes_)
      for (int k = 0; k < arity(n.operation); ++k) uses[n.argument[k]] += n.operation == Operation::add || n.operation == Operation::subtract ? 1 : 2;
    for (const std::uint32_t output : graph.outputs) uses[output] += 2;
    for (std::size_t node = 0; node < uses.size(); ++node) is_fused_[node] = uses[node] == 1;
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
  /// Of a lane that is stored by itself; of the upper two twice that.
  static constexpr int stored_cost = 1;
  /// Of a product that nothing but one sum takes: the two are one instruction.
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

  /// Whether this output is stored together with its neighbours, by the vector that it may be in.
  bool isStoredAbreast(const std::vector<std::uint32_t>& outputs, std::size_t o) const {
    const std::uint32_t node = outputs[o];
    if (!mayBeInVector(node)) return false;
    const NodesAbreast& of = units_[at(unit_[node])].nodes;
    const std::size_t lane = at(lane_[node]);
    return o >= lane && o - lane + of.size() <= outputs.size() &&
           std::equal(of.begin(), of.end(), outputs.begin() + static_cast<std::ptrdiff_t>(o - lane));
  }
  /// Asks of each unit whether its operations are done at once. Only those that are need their arguments in lanes, which are there if what
  /// computes them is such a unit, too; what is read by itself must be brought out of lanes.
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
    std::vector<std::vector<int>> readers(nodes_.size());  // units that take it in its lane
    std::vector<char> stored_alone(nodes_.size(), 0);
    for (std::size_t o = 0; o < graph.outputs.size(); ++o)
      if (!isStoredAbreast(graph.outputs, o)) stored_alone[graph.outputs[o]] = 1;
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
  std::vector<char> is_fused_;    ///< by node: taken by one sum, or difference, and nothing else
};

/// Units one after the other, of those that have all that they take one that is the last to take most: registers are few, and what waits in memory
/// meanwhile is written and read again. Of several the one with the first node. What waits for itself is taken apart.
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
  /// Calls use(argument), once each, for those that are not there from the start.
  template <class Use>
  void eachArgument(std::uint32_t node, Use&& use) const {
    const GraphNode& n = nodes_[node];
    for (int k = 0; k < arity(n.operation); ++k)
      if (!isThere(nodes_, n.argument[k]) && std::find(n.argument, n.argument + k, n.argument[k]) == n.argument + k) use(n.argument[k]);
  }
  /// The only unit left that takes a node, or -1.
  int lastUser(std::uint32_t node) const {
    if (left_[node] > most_abreast) return -1;
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
    const NodesAbreast& of = units_[at(u)].nodes;
    if (std::all_of(of.begin(), of.end(), [&](std::uint32_t node) { return node == no_node || waits_[node] == 0; }))
      ready_.push({ends_[at(u)], firstOf(u), u});
  }
  void doAllReady() {
    while (!ready_.empty()) {
      const Ready next = ready_.top();
      ready_.pop();
      // What ends more now has been offered again.
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
  std::vector<int> unit_, waits_;  ///< by node: of its arguments how many are not there yet
  std::vector<int> left_;          ///< by node: of its users how many are not done yet
  std::vector<std::vector<std::uint32_t>> users_;
  std::vector<char> done_;  ///< by unit
  std::vector<int> ends_;   ///< by unit: how many nodes it is the last to take
  std::priority_queue<Ready> ready_;
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
