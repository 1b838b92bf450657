// SPDX-License-Identifier: BSD-2-Clause
#include "at.hpp"
#include "codegen/names.hpp"
#include "codegen/prelude.hpp"
#include "codegen/schedule.hpp"

#include <dyn/codegen/source.hpp>
#include <dyn/error.hpp>

#include <algorithm>
#include <cstdio>
#include <map>

namespace dyn {

namespace {

std::string number(double x, bool single) {
  char text[64];
  if (x != x) return "(0.0 / 0.0)";
  if (x - x != 0) return x > 0 ? "HUGE_VAL" : "-HUGE_VAL";
  std::snprintf(text, sizeof text, single ? "%.9gf" : "%.17g", single ? static_cast<double>(static_cast<float>(x)) : x);
  std::string out = text;
  // In C, "2" is an int and "2f" is not a number.
  if (out.find_first_of(".e") == std::string::npos) out.insert(single ? out.size() - 1 : out.size(), ".0");
  return x < 0 ? "(" + out + ")" : out;
}

/// Writes one function. Its operations are cut into pieces, each a C function of its own; values that a later piece reads go through memory.
class Writer {
 public:
  Writer(const TracedFunction& f, const SourceOptions& options)
      : f_(f), options_(options), schedule_(schedule(f.graph, options.lanes == 1)), name_(options.prefix + f.name) {
    for (const ArgumentShape& a : f.inputs)
      for (int i = 0; i < a.size(); ++i) inputs_.push_back({a.name + "_", i});
    std::size_t o = 0;
    for (const ArgumentShape& a : f.outputs)
      for (int i = 0; i < a.size(); ++i) stores_.push_back({a.name + "_", i, f.graph.outputs[o++]});
    vectors_ = std::any_of(schedule_.units.begin(), schedule_.units.end(), [](const Unit& unit) { return unit.several; });
    plan();
  }

  int steps() const {
    int out = static_cast<int>(schedule_.units.size());
    for (std::size_t i = 0; i < nodes().size(); ++i) out += isTurned(static_cast<std::uint32_t>(i)) ? 1 : 0;
    return out;
  }
  /// Whether vectors compute several operations at once. Lanes of several states do not count.
  bool hasVectors() const { return vectors_; }

  std::string declaration() const {
    std::string out = "void " + name_ + "(";
    for (const ArgumentShape& a : f_.inputs) out += "const dyn_real* " + a.name + ", ";
    for (const ArgumentShape& a : f_.outputs) out += "dyn_real* " + a.name + ", ";
    out.resize(out.size() - 2);
    return out + ")";
  }

  std::string definition() const {
    std::string out;
    for (int p = 0; p < pieces_; ++p) out += piece(p);
    out += declaration() + " {\n";
    for (const auto* list : {&f_.inputs, &f_.outputs})
      for (const ArgumentShape& a : *list) {
        const std::string qualifier = list == &f_.inputs ? "const " : "";
        out += "  " + qualifier + "T* const " + a.name + "_ = (" + qualifier + "T*)" + a.name + ";\n";
      }
    if (slots_ > 0) out += "  DYN_ALIGNED T w[" + std::to_string(slots_) + "];\n";
    if (!angles_.empty()) out += sines();
    for (int p = 0; p < pieces_; ++p) out += "  " + name_ + "_" + std::to_string(p) + "(" + passed() + ");\n";
    return out + "}\n\n";
  }

 private:
  /// Code that writes the sines and cosines of all angles to s and c, in whole vectors of 64 bytes. The last vector is padded.
  std::string sines() const {
    const std::size_t lanes = at(options_.lanes), width = std::max<std::size_t>((options_.single_precision ? 16 : 8) / lanes, 1);
    const std::string count = std::to_string((angles_.size() + width - 1) / width * width);
    const auto angle = [&](std::size_t i) {
      const auto& [argument, index] = inputs_[nodes()[angles_[i]].argument[0]];
      return argument + "[" + std::to_string(index) + "]";
    };
    const auto store = [](std::size_t i) { return ", s + " + std::to_string(i) + ", c + " + std::to_string(i) + ");\n"; };
    std::string out;
    if (lanes > 1) {
      out = "  DYN_ALIGNED T angle[" + count + "] = {{0}}, s[" + count + "], c[" + count + "];\n";
      for (std::size_t i = 0; i < angles_.size(); ++i) out += "  angle[" + std::to_string(i) + "] = " + angle(i) + ";\n";
      return out + "  dyn_sincos(angle, s, c, " + count + ");\n";
    }
    out = "  DYN_ALIGNED T s[" + count + "], c[" + count + "];\n#if DYN_WIDTH > 1\n";
    for (std::size_t first = 0; first < angles_.size(); first += width) {
      out += "  dyn_sincos_vector((V){" + angle(first);
      for (std::size_t i = first + 1; i < std::min(first + width, angles_.size()); ++i) out += ", " + angle(i);
      out += "}" + store(first);
    }
    out += "#else\n";
    for (std::size_t i = 0; i < angles_.size(); ++i) out += "  dyn_sincos_vector(" + angle(i) + store(i);
    return out + "#endif\n";
  }

  const std::vector<GraphNode>& nodes() const { return schedule_.nodes; }
  bool isTurned(std::uint32_t node) const { return isTurn(nodes(), node); }
  int pieceOf(std::uint32_t node) const {
    const int unit = schedule_.places[node].unit;
    return unit < 0 ? -1 : unit / options_.piece;
  }
  bool isConstant(std::uint32_t node) const { return nodes()[node].operation == Operation::constant; }
  const Unit& unitOf(std::uint32_t node) const { return schedule_.units[static_cast<std::size_t>(schedule_.places[node].unit)]; }

  /// Decides which values go through memory and where, and in which order sines are taken.
  void plan() {
    const auto& units = schedule_.units;
    pieces_ = std::max(1, (static_cast<int>(units.size()) + options_.piece - 1) / options_.piece);
    std::vector<int> last_use(units.size(), -1);
    angle_.assign(nodes().size(), -1);
    slot_.assign(units.size(), -1);
    const auto turn = [&](std::uint32_t node) {
      int& angle = angle_[nodes()[node].argument[0]];
      if (angle >= 0) return;
      angle = static_cast<int>(angles_.size());
      angles_.push_back(nodes()[node].argument[0]);
    };
    // Angles whose sines or cosines a vector reads are placed side by side.
    for (const Unit& unit : units)
      for (int k = 0; unit.several && k < arity(unit.operation); ++k) {
        const PackableNodes tuple = argumentsOf(nodes(), unit, k);
        if (std::all_of(tuple.begin(), tuple.end(), [&](std::uint32_t node) { return node == no_node || isTurned(node); }))
          for (const std::uint32_t node : tuple)
            if (node != no_node) turn(node);
      }
    for (std::size_t i = 0; i < nodes().size(); ++i)
      if (isTurned(static_cast<std::uint32_t>(i))) turn(static_cast<std::uint32_t>(i));
    for (std::size_t u = 0; u < units.size(); ++u)
      for (const std::uint32_t node : units[u].nodes)
        for (int k = 0; node != no_node && k < arity(nodes()[node].operation); ++k) {
          const int from = schedule_.places[nodes()[node].argument[k]].unit;
          if (from >= 0) last_use[at(from)] = static_cast<int>(u) / options_.piece;
        }
    // Vectors come first, so that none lies across two cache lines.
    for (const bool several : {true, false}) {
      // Addresses near w, before or after it, are short in the code; vectors may be four times as far. So w points amid the single values.
      middle_ += slots_;
      for (std::size_t u = 0; u < units.size(); ++u)
        if (units[u].several == several && last_use[u] > static_cast<int>(u) / options_.piece) {
          slot_[u] = slots_;
          slots_ += several ? most_packable : 1;
        }
    }
    middle_ = (middle_ + slots_) / 2;
    // The piece that computes a result stores it. The last piece stores results that no piece computes.
    stores_of_.resize(at(pieces_));
    for (std::size_t s = 0; s < stores_.size(); ++s) {
      const int p = pieceOf(stores_[s].node);
      stores_of_[at(p < 0 ? pieces_ - 1 : p)].push_back(s);
    }
  }

  std::string parameters() const {
    std::string out;
    for (const ArgumentShape& a : f_.inputs) out += "const T* restrict " + a.name + "_, ";
    for (const ArgumentShape& a : f_.outputs) out += "T* restrict " + a.name + "_, ";
    if (slots_ > 0) out += "T* restrict w, ";
    if (!angles_.empty()) out += "const T* restrict s, const T* restrict c, ";
    out.resize(out.size() - 2);
    return out;
  }
  std::string passed() const {
    std::string out;
    for (const auto* list : {&f_.inputs, &f_.outputs})
      for (const ArgumentShape& a : *list) out += a.name + "_, ";
    if (slots_ > 0) out += "w + " + std::to_string(middle_) + ", ";
    if (!angles_.empty()) out += "s, c, ";
    out.resize(out.size() - 2);
    return out;
  }

  /// Array and index of a value that is in memory from the start. Constants have no array.
  std::pair<std::string, int> memoryOf(std::uint32_t i) const {
    const GraphNode& n = nodes()[i];
    if (n.operation == Operation::input) return inputs_[n.argument[0]];
    if (isTurned(i)) return {n.operation == Operation::sin ? "s" : "c", angle_[n.argument[0]]};
    return {"", 0};
  }
  std::string value(std::uint32_t i, int piece) const {
    const GraphNode& n = nodes()[i];
    if (isConstant(i)) return number(n.value, options_.single_precision);
    const Place& place = schedule_.places[i];
    if (place.unit < 0) {
      const auto [array, index] = memoryOf(i);
      return array + "[" + std::to_string(index) + "]";
    }
    if (pieceOf(i) != piece) return "w[" + std::to_string(slot_[at(place.unit)] + place.lane - middle_) + "]";
    return unitOf(i).several ? "v" + std::to_string(place.unit) + "[" + std::to_string(place.lane) + "]" : "t" + std::to_string(place.unit);
  }
  /// Expression for a vector of these values. Lanes without a node may have any value.
  std::string vector(const PackableNodes& tuple, int piece) const {
    const std::uint32_t first = *std::find_if(tuple.begin(), tuple.end(), [](std::uint32_t node) { return node != no_node; });
    const Place& place = schedule_.places[first];
    bool in_place = place.unit >= 0 && unitOf(first).several, side_by_side = place.unit < 0 && !isConstant(first);
    int start = -1;
    for (int l = 0; l < most_packable; ++l) {
      const std::uint32_t node = tuple[at(l)];
      if (node == no_node) {
        side_by_side = false;  // a load of four numbers might read past the end of the array
        continue;
      }
      in_place = in_place && schedule_.places[node].unit == place.unit && schedule_.places[node].lane == l;
      if (!side_by_side) continue;
      side_by_side = schedule_.places[node].unit < 0 && !isConstant(node) && memoryOf(node).first == memoryOf(first).first;
      if (start < 0) start = memoryOf(node).second - l;
      side_by_side = side_by_side && memoryOf(node).second == start + l;
    }
    if (in_place) {
      if (pieceOf(first) == piece) return "v" + std::to_string(place.unit);
      return "*(const dyn_four*)(w + " + std::to_string(slot_[at(place.unit)] - middle_) + ")";
    }
    if (side_by_side) return "*(const dyn_four*)(" + memoryOf(first).first + " + " + std::to_string(start) + ")";
    std::string out = "(dyn_four){";
    for (const std::uint32_t node : tuple) out += (out.back() == '{' ? "" : ", ") + value(node == no_node ? first : node, piece);
    return out + "}";
  }

  /// Expression for the values of four stores that are side by side, if all are constants or they are the lanes of one vector; else an empty text.
  std::string fourFrom(const std::vector<std::size_t>& stores, std::size_t k, int piece) const {
    if (!vectors_ || k + most_packable > stores.size()) return "";
    const Store& first = stores_[stores[k]];
    PackableNodes tuple;
    bool known = true;
    for (std::size_t l = 0; l < tuple.size(); ++l) {
      const Store& store = stores_[stores[k + l]];
      if (store.array != first.array || store.index != first.index + static_cast<int>(l)) return "";
      tuple[l] = store.node;
      known = known && isConstant(store.node);
    }
    const std::string out = vector(tuple, piece);
    return known || out[0] == 'v' ? out : "";
  }

  template <class Argument>
  static std::string expression(Operation operation, const Argument& arg) {
    switch (operation) {
      case Operation::input:
      case Operation::constant:
        return "";
      case Operation::add:
        return arg(0) + " + " + arg(1);
      case Operation::subtract:
        return arg(0) + " - " + arg(1);
      case Operation::multiply:
        return arg(0) + " * " + arg(1);
      case Operation::divide:
        return arg(0) + " / " + arg(1);
      case Operation::negate:
        return "-" + arg(0);
      case Operation::sqrt:
        return "dyn_sqrt(" + arg(0) + ")";
      case Operation::sin:
        return "dyn_sin(" + arg(0) + ")";
      case Operation::cos:
        return "dyn_cos(" + arg(0) + ")";
      case Operation::tan:
        return "dyn_tan(" + arg(0) + ")";
      case Operation::exp:
        return "dyn_exp(" + arg(0) + ")";
      case Operation::log:
        return "dyn_log(" + arg(0) + ")";
      case Operation::atan2:
        return "dyn_atan2(" + arg(0) + ", " + arg(1) + ")";
      case Operation::abs:
        return "dyn_abs(" + arg(0) + ")";
      case Operation::select_less:
        return "dyn_select_less(" + arg(0) + ", " + arg(1) + ", " + arg(2) + ", " + arg(3) + ")";
    }
    return "";
  }

  /// Stores of piece p, by the unit that they follow: a result is stored as soon as it is computed, or else it would occupy a register. Unit -1 has
  /// the values that no unit computes.
  std::map<int, std::string> storesOf(int p) const {
    std::map<int, std::string> out;
    const std::vector<std::size_t>& stores = stores_of_[at(p)];
    for (std::size_t k = 0; k < stores.size(); ++k) {
      const Store& store = stores_[stores[k]];
      const std::string four = fourFrom(stores, k, p);
      if (!four.empty()) {
        out[schedule_.places[store.node].unit] += "  *(dyn_four*)(" + store.array + " + " + std::to_string(store.index) + ") = " + four + ";\n";
        k += most_packable - 1;
        continue;
      }
      const std::string x = value(store.node, p);
      out[schedule_.places[store.node].unit] +=
          "  " + store.array + "[" + std::to_string(store.index) + "] = " + (isConstant(store.node) ? "DYN_ALL(" + x + ")" : x) + ";\n";
    }
    return out;
  }

  std::string piece(int p) const {
    const std::map<int, std::string> stores = storesOf(p);
    const auto storesAfter = [&](int unit) {
      const auto found = stores.find(unit);
      return found == stores.end() ? "" : found->second;
    };
    std::string out = "static DYN_PIECE void " + name_ + "_" + std::to_string(p) + "(" + parameters() + ") {\n";
    std::map<PackableNodes, std::string> gathered;
    const int count = static_cast<int>(schedule_.units.size());
    for (int u = p * options_.piece; u < std::min((p + 1) * options_.piece, count); ++u) {
      const Unit& unit = schedule_.units[at(u)];
      const std::string slot = std::to_string(slot_[at(u)] - middle_), id = std::to_string(u);
      if (unit.several) {
        const auto argument = [&](int k) {
          const PackableNodes tuple = argumentsOf(nodes(), unit, k);
          std::string x = vector(tuple, p);
          if (x[0] == 'v') return x;
          std::string& name = gathered[tuple];
          if (name.empty()) {
            name = "g" + id + "_" + std::to_string(k);
            out += "  const dyn_four " + name + " = " + x + ";\n";
          }
          return name;
        };
        std::vector<std::string> names(at(arity(unit.operation)));
        for (std::size_t k = 0; k < names.size(); ++k) names[k] = argument(static_cast<int>(k));
        out += "  const dyn_four v" + id + " = " + expression(unit.operation, [&](int k) { return names[at(k)]; }) + ";\n";
        if (slot_[at(u)] >= 0) out += "  *(dyn_four*)(w + " + slot + ") = v" + id + ";\n";
        out += storesAfter(u);
        continue;
      }
      const GraphNode& n = nodes()[unit.nodes[0]];
      out += "  const T t" + id + " = " + expression(n.operation, [&](int k) { return value(n.argument[k], p); }) + ";\n";
      if (slot_[at(u)] >= 0) out += "  w[" + slot + "] = t" + id + ";\n";
      out += storesAfter(u);
    }
    out += storesAfter(-1);
    return out + "}\n\n";
  }

  const TracedFunction& f_;
  const SourceOptions& options_;
  const Schedule schedule_;
  std::string name_;
  // Arrays have the names of their arguments followed by "_"; no other variable in the code has such a name.
  std::vector<std::pair<std::string, int>> inputs_;  ///< array and index of each input
  struct Store {
    std::string array;
    int index;
    std::uint32_t node;
  };
  std::vector<Store> stores_;                        ///< where each output goes
  std::vector<int> slot_;                            ///< by unit: its place in w, or -1
  std::vector<int> angle_;                           ///< by node of an input: its place in angles_, or -1
  std::vector<std::uint32_t> angles_;                ///< nodes of the inputs whose sines or cosines are taken
  std::vector<std::vector<std::size_t>> stores_of_;  ///< by piece
  int pieces_ = 1, slots_ = 0;
  int middle_ = 0;  ///< the slot that w points to
  bool vectors_ = false;
};

std::string comment(const TracedFunction& f, int lanes, int steps) {
  std::string out = "/* " + f.name + ":";
  for (const auto* list : {&f.inputs, &f.outputs}) {
    out += list == &f.inputs ? " from" : " to";
    for (const ArgumentShape& a : *list)
      out += " " + a.name + "[" + std::to_string(a.rows) + (a.columns > 1 ? " x " + std::to_string(a.columns) : "") + "]";
  }
  const OperationCounts n = f.graph.count();
  out += "; " + std::to_string(n.total()) + " operations: " + std::to_string(n.additions) + " sums, " + std::to_string(n.multiplications) +
         " products, " + std::to_string(n.divisions) + " quotients and roots, " + std::to_string(n.functions) + " functions, " +
         std::to_string(n.selections) + " selections. ";
  if (steps < n.total()) out += "Done in " + std::to_string(steps) + " steps, some of them vectors of four. ";
  if (lanes > 1) out += "Numbers of " + std::to_string(lanes) + " states side by side. ";
  return out + "*/\n";
}

}  // namespace

std::string Source::header() const {
  return "/* Written by libdyn. Matrices are column after column. */\n#pragma once\n\n" + types + "\n#ifdef __cplusplus\nextern \"C\" {\n#endif\n\n" +
         declarations + "#ifdef __cplusplus\n}\n#endif\n";
}
std::string Source::code(const std::string& header_name) const { return "#include \"" + header_name + "\"\n\n" + definitions; }
std::string Source::code() const { return types + declarations + definitions; }

Source writeSource(const std::vector<TracedFunction>& functions, const SourceOptions& options) {
  checkSource(functions, options);
  Source out;
  out.types = std::string("typedef ") + (options.single_precision ? "float" : "double") + " dyn_real;\n";
  out.definitions = codegenPrelude(options.single_precision, options.lanes);
  bool has_vectors = false;
  for (const TracedFunction& f : functions) {
    Writer writer(f, options);
    out.steps.push_back(writer.steps());
    if (writer.hasVectors() && !has_vectors)
      out.definitions += "#if !defined(__GNUC__)\n#error \"this has vectors of gcc and clang; dyn codegen --plain writes C99\"\n#endif\n\n";
    has_vectors = has_vectors || writer.hasVectors();
    out.declarations += comment(f, options.lanes, writer.steps()) + writer.declaration() + ";\n\n";
    out.definitions += writer.definition();
  }
  return out;
}

}  // namespace dyn
