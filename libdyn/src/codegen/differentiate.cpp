// SPDX-License-Identifier: BSD-2-Clause
#include <dyn/codegen/differentiate.hpp>

#include <utility>

namespace dyn {

namespace {

/// Computes the partial derivatives of a node with respect to its arguments. The node has the value x, its arguments have the values a.
void partials(const GraphNode& n, const Traced& x, const Traced* a, Traced* out) {
  switch (n.operation) {
    case Operation::input:
    case Operation::constant:
      return;
    case Operation::add:
      out[0] = out[1] = 1;
      return;
    case Operation::subtract:
      out[0] = 1;
      out[1] = -1;
      return;
    case Operation::multiply:
      out[0] = a[1];
      out[1] = a[0];
      return;
    case Operation::divide:
      out[0] = 1 / a[1];
      out[1] = -(x * out[0]);
      return;
    case Operation::negate:
      out[0] = -1;
      return;
    case Operation::sqrt:
      out[0] = 0.5 / x;
      return;
    case Operation::sin:
      out[0] = cos(a[0]);
      return;
    case Operation::cos:
      out[0] = -sin(a[0]);
      return;
    case Operation::tan:
      out[0] = 1 + x * x;
      return;
    case Operation::exp:
      out[0] = x;
      return;
    case Operation::log:
      out[0] = 1 / a[0];
      return;
    case Operation::atan2: {
      const Traced r = 1 / (a[0] * a[0] + a[1] * a[1]);
      out[0] = a[1] * r;
      out[1] = -(a[0] * r);
      return;
    }
    case Operation::abs:
      out[0] = select(a[0] < 0, -1, 1);
      return;
    case Operation::select_less:
      return;  // callers select the branch: a zero factor times the other branch's derivative could be NaN
  }
}

/// The graph recorded again in a new builder, with the traced value of every node.
struct Replayed {
  /// The condition under which a selection takes its third argument.
  TracedCondition conditionOf(const GraphNode& n) const { return values[n.argument[0]] < values[n.argument[1]]; }

  GraphBuilder builder;
  std::vector<Traced> in, values;
  explicit Replayed(const Graph& g) : values(g.nodes.size()) {
    for (int i = 0; i < g.inputs; ++i) in.push_back(builder.input());
    replayNodes(g, in.data(), values.data());
  }
  void partialsOf(const Graph& g, std::size_t i, Traced* out) const {
    Traced a[4];
    const GraphNode& n = g.nodes[i];
    for (int k = 0; k < arity(n.operation); ++k) a[k] = values[n.argument[k]];
    partials(n, values[i], a, out);
  }
};

bool isZero(const Traced& x) { return !x.recorder && x.value == 0; }

/// A node's derivatives by column (input), in ascending order; zeros are left out.
using Changes = std::vector<std::pair<int, Traced>>;

void addScaled(Changes& to, const Changes& from, const Traced& factor) {
  if (isZero(factor) || from.empty()) return;
  Changes sum;
  sum.reserve(to.size() + from.size());
  auto a = to.begin();
  for (const auto& [column, change] : from) {
    while (a != to.end() && a->first < column) sum.push_back(*a++);
    const Traced share = factor * change;
    const bool both = a != to.end() && a->first == column;
    const Traced total = both ? a->second + share : share;
    if (both) ++a;
    if (!isZero(total)) sum.emplace_back(column, total);
  }
  sum.insert(sum.end(), a, to.end());
  to = std::move(sum);
}

/// Selects, column by column, the derivative of the branch that is taken.
Changes selected(const TracedCondition& condition, const Changes& yes, const Changes& no) {
  Changes out;
  auto a = yes.begin(), b = no.begin();
  while (a != yes.end() || b != no.end()) {
    const bool of_yes = a != yes.end() && (b == no.end() || a->first <= b->first), of_no = b != no.end() && (a == yes.end() || b->first <= a->first);
    const int column = of_yes ? a->first : b->first;
    out.emplace_back(column, select(condition, of_yes ? (a++)->second : Traced(0), of_no ? (b++)->second : Traced(0)));
  }
  return out;
}

JacobianGraph forward(const Graph& g) {
  Replayed r(g);
  std::vector<Changes> changes(g.nodes.size());
  for (std::size_t i = 0; i < g.nodes.size(); ++i) {
    const GraphNode& n = g.nodes[i];
    if (n.operation == Operation::input) changes[i] = {{static_cast<int>(n.argument[0]), Traced(1)}};
    if (n.operation == Operation::select_less) {
      changes[i] = selected(r.conditionOf(n), changes[n.argument[2]], changes[n.argument[3]]);
      continue;
    }
    Traced by[4];
    r.partialsOf(g, i, by);
    for (int k = 0; k < arity(n.operation); ++k) addScaled(changes[i], changes[n.argument[k]], by[k]);
  }
  JacobianGraph out;
  std::vector<Traced> entries;
  for (std::size_t row = 0; row < g.outputs.size(); ++row)
    for (const auto& [column, change] : changes[g.outputs[row]]) {
      out.sparsity.row.push_back(static_cast<int>(row));
      out.sparsity.column.push_back(column);
      entries.push_back(change);
    }
  out.graph = r.builder.finish(entries);
  return out;
}

/// Tracks whether a node contributes to an output through branches that are taken: always, or only where a traced number is positive.
class Reached {
 public:
  explicit Reached(std::size_t nodes) : always_(nodes, 0), number_(nodes) {}
  void mark(std::size_t node) { always_[node] = 1; }
  /// Records that `node` is an argument of `by`.
  void lead(std::size_t by, std::size_t node) { add(node, always_[by] != 0, number_[by]); }
  void leadIf(const TracedCondition& condition, std::size_t by, std::size_t node) {
    add(node, false, select(condition, always_[by] ? Traced(1) : number_[by], Traced(0)));
  }
  /// Returns share * factor, or zero where the node is not reached, even if the factor is infinite or NaN there.
  Traced product(std::size_t node, const Traced& share, const Traced& factor) const {
    const Traced plain = share * factor;
    return always_[node] || !factor.recorder ? plain : select(Traced(0) < number_[node], plain, Traced(0));
  }

 private:
  void add(std::size_t node, bool always, const Traced& number) {
    if (always) always_[node] = 1;
    if (!always_[node]) number_[node] += number;
  }
  std::vector<char> always_;
  std::vector<Traced> number_;
};

/// Propagates adjoints from the last node to the first. `share` starts with those of the outputs and ends with those of all nodes.
void handBack(const Graph& g, const Replayed& r, std::vector<Traced>& share) {
  Reached reached(g.nodes.size());
  for (const std::uint32_t output : g.outputs) reached.mark(output);
  for (std::size_t i = g.nodes.size(); i-- > 0;) {
    const GraphNode& n = g.nodes[i];
    if (isZero(share[i])) continue;
    if (n.operation == Operation::select_less) {
      const TracedCondition condition = r.conditionOf(n);
      const std::uint32_t yes = n.argument[2], no = n.argument[3];
      share[yes] += select(condition, share[i], Traced(0));
      reached.leadIf(condition, i, yes);
      share[no] += select(condition, Traced(0), share[i]);
      reached.leadIf(!condition, i, no);
      continue;
    }
    Traced by[4];
    r.partialsOf(g, i, by);
    for (int k = 0; k < arity(n.operation); ++k) {
      share[n.argument[k]] += reached.product(i, share[i], by[k]);
      reached.lead(i, n.argument[k]);
    }
  }
}

std::vector<Traced> sharesOfInputs(const Graph& g, const std::vector<Traced>& share) {
  std::vector<Traced> out(static_cast<std::size_t>(g.inputs));
  for (std::size_t i = 0; i < g.nodes.size(); ++i)
    if (g.nodes[i].operation == Operation::input) out[g.nodes[i].argument[0]] = share[i];
  return out;
}

JacobianGraph reverse(const Graph& g) {
  Replayed r(g);
  JacobianGraph out;
  std::vector<Traced> entries;
  for (std::size_t row = 0; row < g.outputs.size(); ++row) {
    std::vector<Traced> share(g.nodes.size());
    share[g.outputs[row]] = 1;
    handBack(g, r, share);
    const std::vector<Traced> of_inputs = sharesOfInputs(g, share);
    for (std::size_t column = 0; column < of_inputs.size(); ++column) {
      if (isZero(of_inputs[column])) continue;
      out.sparsity.row.push_back(static_cast<int>(row));
      out.sparsity.column.push_back(static_cast<int>(column));
      entries.push_back(of_inputs[column]);
    }
  }
  out.graph = r.builder.finish(entries);
  return out;
}

}  // namespace

JacobianGraph differentiate(const Graph& graph, Mode mode) {
  JacobianGraph out = mode == Mode::forward ? forward(graph) : reverse(graph);
  out.sparsity.rows = static_cast<int>(graph.outputs.size());
  out.sparsity.columns = graph.inputs;
  return out;
}

Graph gradient(const Graph& graph) {
  Replayed r(graph);
  std::vector<Traced> share(graph.nodes.size());
  for (const std::uint32_t o : graph.outputs) share[o] += r.builder.input();
  handBack(graph, r, share);
  return r.builder.finish(sharesOfInputs(graph, share));
}

Graph directional(const Graph& graph) {
  Replayed r(graph);
  std::vector<Traced> direction, change(graph.nodes.size()), out;
  for (int i = 0; i < graph.inputs; ++i) direction.push_back(r.builder.input());
  for (std::size_t i = 0; i < graph.nodes.size(); ++i) {
    const GraphNode& n = graph.nodes[i];
    if (n.operation == Operation::input) change[i] = direction[n.argument[0]];
    if (n.operation == Operation::select_less) {
      change[i] = select(r.conditionOf(n), change[n.argument[2]], change[n.argument[3]]);
      continue;
    }
    Traced by[4];
    r.partialsOf(graph, i, by);
    for (int k = 0; k < arity(n.operation); ++k)
      if (!isZero(by[k])) change[i] += by[k] * change[n.argument[k]];
  }
  for (const std::uint32_t o : graph.outputs) out.push_back(change[o]);
  return r.builder.finish(out);
}

}  // namespace dyn
