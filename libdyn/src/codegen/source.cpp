#include "codegen/prelude.hpp"

#include <dyn/codegen/source.hpp>
#include <dyn/error.hpp>

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <set>

namespace dyn {

namespace {

std::string number(double x, bool single) {
  char text[64];
  if (x != x) return "(0.0 / 0.0)";
  if (x - x != 0) return x > 0 ? "HUGE_VAL" : "-HUGE_VAL";
  std::snprintf(text, sizeof text, single ? "%.9gf" : "%.17g", single ? static_cast<double>(static_cast<float>(x)) : x);
  std::string out = text;
  // "2" would be an int, "2f" is nothing.
  if (out.find_first_of(".e") == std::string::npos) out.insert(single ? out.size() - 1 : out.size(), ".0");
  return x < 0 ? "(" + out + ")" : out;
}

/// One function: its nodes in pieces, each a C function of its own; values that a later piece reads go through memory.
class Writer {
 public:
  Writer(const TracedFunction& f, const SourceOptions& options) : f_(f), g_(f.graph), options_(options), name_(options.prefix + f.name) {
    const std::size_t n = g_.nodes.size();
    for (const ArgumentShape& a : f.inputs)
      for (int i = 0; i < a.size(); ++i) inputs_.push_back(a.name + "[" + std::to_string(i) + "]");
    std::size_t o = 0;
    for (const ArgumentShape& a : f.outputs)
      for (int i = 0; i < a.size(); ++i) stores_.push_back({a.name + "[" + std::to_string(i) + "] = ", g_.outputs[o++]});
    piece_of_.assign(n, -1);
    last_use_.assign(n, -1);
    slot_.assign(n, -1);
    sine_.assign(n, -1);
  }

  std::string declaration() const {
    std::string out = "void " + name_ + "(";
    for (const ArgumentShape& a : f_.inputs) out += "const dyn_real* " + a.name + ", ";
    for (const ArgumentShape& a : f_.outputs) out += "dyn_real* " + a.name + ", ";
    out.resize(out.size() - 2);
    return out + ")";
  }

  std::string definition() {
    plan();
    std::string out;
    for (int p = 0; p < pieces_; ++p) out += piece(p);
    out += declaration() + " {\n";
    for (const auto* list : {&f_.inputs, &f_.outputs})
      for (const ArgumentShape& a : *list) {
        const std::string qualifier = list == &f_.inputs ? "const " : "";
        out += "  " + qualifier + "T* const " + a.name + "_ = (" + qualifier + "T*)" + a.name + ";\n";
      }
    if (slots_ > 0) out += "  T w[" + std::to_string(slots_) + "];\n";
    if (!angles_.empty()) {
      // Sines come in whole vectors of 64 bytes, the last one filled up.
      const std::size_t lanes = static_cast<std::size_t>(options_.lanes),
                        width = std::max<std::size_t>((options_.single_precision ? 16 : 8) / lanes, 1);
      const std::string count = std::to_string((angles_.size() + width - 1) / width * width);
      out += "  T angle[" + count + "] = {" + (options_.lanes > 1 ? "{0}" : "0") + "}, s[" + count + "], c[" + count + "];\n";
      for (std::size_t i = 0; i < angles_.size(); ++i) {
        const GraphNode& n = g_.nodes[angles_[i]];
        std::string text = inputs_[n.argument[0]];
        text.insert(text.find('['), "_");
        out += "  angle[" + std::to_string(i) + "] = " + text + ";\n";
      }
      out += "  dyn_sincos(angle, s, c, " + count + ");\n";
    }
    for (int p = 0; p < pieces_; ++p) out += "  " + name_ + "_" + std::to_string(p) + "(" + passed() + ");\n";
    return out + "}\n\n";
  }

 private:
  bool isValue(std::size_t i) const { return g_.nodes[i].operation != Operation::input && g_.nodes[i].operation != Operation::constant; }

  /// Which piece computes each node, which values wait in memory, which angles are known from the start.
  void plan() {
    std::vector<int> angle_of(g_.nodes.size(), -1);
    int count = 0;
    for (std::size_t i = 0; i < g_.nodes.size(); ++i) {
      const GraphNode& n = g_.nodes[i];
      if (!isValue(i)) continue;
      const bool turns = n.operation == Operation::sin || n.operation == Operation::cos;
      if (turns && g_.nodes[n.argument[0]].operation == Operation::input) {
        int& angle = angle_of[n.argument[0]];
        if (angle < 0) {
          angle = static_cast<int>(angles_.size());
          angles_.push_back(n.argument[0]);
        }
        sine_[i] = angle;
        continue;
      }
      piece_of_[i] = count++ / options_.piece;
      for (int k = 0; k < arity(n.operation); ++k) last_use_[n.argument[k]] = std::max(last_use_[n.argument[k]], piece_of_[i]);
    }
    pieces_ = std::max(1, (count + options_.piece - 1) / options_.piece);
    for (std::size_t i = 0; i < g_.nodes.size(); ++i)
      if (piece_of_[i] >= 0 && last_use_[i] > piece_of_[i]) slot_[i] = slots_++;
    // A result is stored by the piece that computes it; those that none computes by the last one.
    stores_of_.resize(static_cast<std::size_t>(pieces_));
    for (std::size_t s = 0; s < stores_.size(); ++s) {
      const int p = piece_of_[stores_[s].second];
      stores_of_[static_cast<std::size_t>(p < 0 ? pieces_ - 1 : p)].push_back(s);
    }
  }

  std::string parameters() const {
    std::string out;
    for (const ArgumentShape& a : f_.inputs) out += "const T* restrict " + a.name + ", ";
    for (const ArgumentShape& a : f_.outputs) out += "T* restrict " + a.name + ", ";
    if (slots_ > 0) out += "T* restrict w, ";
    if (!angles_.empty()) out += "const T* restrict s, const T* restrict c, ";
    out.resize(out.size() - 2);
    return out;
  }
  std::string passed() const {
    std::string out;
    for (const auto* list : {&f_.inputs, &f_.outputs})
      for (const ArgumentShape& a : *list) out += a.name + "_, ";
    if (slots_ > 0) out += "w, ";
    if (!angles_.empty()) out += "s, c, ";
    out.resize(out.size() - 2);
    return out;
  }

  std::string value(std::uint32_t i, int piece) const {
    const GraphNode& n = g_.nodes[i];
    if (n.operation == Operation::constant) return number(n.value, options_.single_precision);
    if (n.operation == Operation::input) return inputs_[n.argument[0]];
    if (sine_[i] >= 0) return (n.operation == Operation::sin ? "s[" : "c[") + std::to_string(sine_[i]) + "]";
    if (piece_of_[i] != piece) return "w[" + std::to_string(slot_[i]) + "]";
    return "t" + std::to_string(i);
  }

  std::string expression(std::size_t i, int piece) const {
    const GraphNode& n = g_.nodes[i];
    const auto arg = [&](int k) { return value(n.argument[k], piece); };
    switch (n.operation) {
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

  std::string piece(int p) const {
    std::string out = "static DYN_PIECE void " + name_ + "_" + std::to_string(p) + "(" + parameters() + ") {\n";
    for (std::size_t i = 0; i < g_.nodes.size(); ++i) {
      if (piece_of_[i] != p) continue;
      out += "  const T t" + std::to_string(i) + " = " + expression(i, p) + ";\n";
      if (slot_[i] >= 0) out += "  w[" + std::to_string(slot_[i]) + "] = t" + std::to_string(i) + ";\n";
    }
    for (const std::size_t s : stores_of_[static_cast<std::size_t>(p)]) {
      const std::string x = value(stores_[s].second, p);
      out += "  " + stores_[s].first + (g_.nodes[stores_[s].second].operation == Operation::constant ? "DYN_ALL(" + x + ")" : x) + ";\n";
    }
    return out + "}\n\n";
  }

  const TracedFunction& f_;
  const Graph& g_;
  const SourceOptions& options_;
  std::string name_;
  std::vector<std::string> inputs_;                            ///< how each input is read
  std::vector<std::pair<std::string, std::uint32_t>> stores_;  ///< where each output goes
  std::vector<int> piece_of_, last_use_, slot_, sine_;         ///< by node
  std::vector<std::uint32_t> angles_;                          ///< nodes of inputs whose sines and cosines are taken together
  std::vector<std::vector<std::size_t>> stores_of_;            ///< by piece
  int pieces_ = 1, slots_ = 0;
};

bool isName(const std::string& text) {
  if (text.empty() || std::isdigit(static_cast<unsigned char>(text[0]))) return false;
  return std::all_of(text.begin(), text.end(), [](unsigned char c) { return c == '_' || (c < 128 && std::isalnum(c)); });
}

void checkNames(const std::vector<TracedFunction>& functions, const SourceOptions& options) {
  std::set<std::string> known;
  for (const TracedFunction& f : functions) {
    if (!isName(options.prefix + f.name)) throw Error(ErrorCode::argument, "'" + options.prefix + f.name + "' is no name in C");
    if (!known.insert(f.name).second) throw Error(ErrorCode::argument, "function '" + f.name + "' is asked for twice");
    std::set<std::string> arguments{"w", "s", "c", "T"};
    for (const auto* list : {&f.inputs, &f.outputs})
      for (const ArgumentShape& a : *list)
        if (!isName(a.name) || !arguments.insert(a.name).second)
          throw Error(ErrorCode::argument, "function '" + f.name + "' cannot have an argument '" + a.name + "'");
  }
  if (options.lanes < 1 || options.lanes > 64 || (options.lanes & (options.lanes - 1)) != 0)
    throw Error(ErrorCode::argument, std::to_string(options.lanes) + " lanes; it takes 1, 2, 4, ... 64");
  if (options.piece < 1) throw Error(ErrorCode::argument, "a piece of " + std::to_string(options.piece) + " operations; it takes 1 at least");
}

std::string comment(const TracedFunction& f, int lanes) {
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
  checkNames(functions, options);
  Source out;
  out.types = std::string("typedef ") + (options.single_precision ? "float" : "double") + " dyn_real;\n";
  out.definitions = codegenPrelude(options.single_precision, options.lanes);
  for (const TracedFunction& f : functions) {
    Writer writer(f, options);
    out.declarations += comment(f, options.lanes) + writer.declaration() + ";\n\n";
    out.definitions += writer.definition();
  }
  return out;
}

}  // namespace dyn
