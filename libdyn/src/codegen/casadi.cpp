// SPDX-License-Identifier: BSD-2-Clause
#include <dyn/codegen/casadi.hpp>
#include <dyn/codegen/source.hpp>

#include <algorithm>
#include <numeric>

namespace dyn {

namespace {

/// Compressed columns: rows, columns, where each column begins, and the row of each entry.
std::string compressed(const Sparsity& s) {
  std::vector<int> begin(static_cast<std::size_t>(s.columns) + 1, 0);
  for (const int c : s.column) ++begin[static_cast<std::size_t>(c) + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::string out = std::to_string(s.rows) + ", " + std::to_string(s.columns);
  for (const int b : begin) out += ", " + std::to_string(b);
  for (const int r : s.row) out += ", " + std::to_string(r);
  return out;
}

std::string compressed(const ArgumentShape& dense) { return std::to_string(dense.rows) + ", " + std::to_string(dense.columns) + ", 1"; }

/// C source of a function FUNCTION_WHAT(i) that returns value i, or 0 if there is none.
std::string listed(const std::string& function, const char* what, const std::vector<std::string>& values, const char* type) {
  std::string out = "DYN_EXPORT " + std::string(type) + " " + function + "_" + what + "(casadi_int i) {\n  switch (i) {\n";
  for (std::size_t i = 0; i < values.size(); ++i) out += "    case " + std::to_string(i) + ": return " + values[i] + ";\n";
  return out + "    default: return 0;\n  }\n}\n";
}

std::string sparsities(const std::string& function, const char* what, const std::vector<std::string>& patterns) {
  std::string out;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < patterns.size(); ++i) {
    names.push_back(function + "_" + what + std::to_string(i));
    out += "static const casadi_int " + names.back() + "[] = {" + patterns[i] + "};\n";
  }
  return out + listed(function, what, names, "const casadi_int*");
}

struct Interface {
  std::string name, code;  ///< `code` is the function that the wrapper calls
  std::vector<ArgumentShape> in, ignored, out;
  std::vector<std::string> out_patterns;
};

std::string wrapper(const Interface& f) {
  std::vector<std::string> names_in, names_out, patterns_in;
  int work = 0;
  std::string body, call;
  const auto quoted = [](const std::string& s) { return "\"" + s + "\""; };
  for (std::size_t i = 0; i < f.in.size(); ++i) {
    const std::string k = std::to_string(i);
    names_in.push_back(quoted(f.in[i].name));
    patterns_in.push_back(compressed(f.in[i]));
    body += "  const casadi_real* in" + k + " = arg[" + k + "] ? arg[" + k + "] : dyn_zeros(w + " + std::to_string(work) + ", " +
            std::to_string(f.in[i].size()) + ");\n";
    call += "in" + k + ", ";
    work += f.in[i].size();
  }
  for (const ArgumentShape& a : f.ignored) {
    names_in.push_back(quoted("out_" + a.name));
    patterns_in.push_back(compressed(a));
  }
  for (std::size_t i = 0; i < f.out.size(); ++i) {
    const std::string k = std::to_string(i);
    names_out.push_back(quoted(f.out[i].name));
    body += "  casadi_real* out" + k + " = res[" + k + "] ? res[" + k + "] : w + " + std::to_string(work) + ";\n";
    call += "out" + k + ", ";
    work += f.out[i].size();
  }
  call.resize(call.size() - 2);
  std::string out = "DYN_EXPORT int " + f.name + "(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem) {\n" + body +
                    "  (void)iw;\n  (void)mem;\n  " + f.code + "(" + call + ");\n  return 0;\n}\n";
  const auto count = [&](const char* what, std::size_t n) {
    out += "DYN_EXPORT casadi_int " + f.name + "_" + what + "(void) { return " + std::to_string(n) + "; }\n";
  };
  count("n_in", names_in.size());
  count("n_out", names_out.size());
  out += listed(f.name, "name_in", names_in, "const char*") + listed(f.name, "name_out", names_out, "const char*");
  out += sparsities(f.name, "sparsity_in", patterns_in) + sparsities(f.name, "sparsity_out", f.out_patterns);
  out += "DYN_EXPORT int " + f.name +
         "_work(casadi_int* sz_arg, casadi_int* sz_res, casadi_int* sz_iw, casadi_int* sz_w) {\n  if (sz_arg) *sz_arg = " +
         std::to_string(names_in.size()) + ";\n  if (sz_res) *sz_res = " + std::to_string(names_out.size()) +
         ";\n  if (sz_iw) *sz_iw = 0;\n  if (sz_w) *sz_w = " + std::to_string(std::max(work, 1)) + ";\n  return 0;\n}\n\n";
  return out;
}

}  // namespace

JacobianBlocks jacobianBlocks(const TracedFunction& function) {
  const JacobianGraph J = differentiate(function.graph);
  JacobianBlocks out;
  out.function.name = "jac_" + function.name;
  out.function.inputs = function.inputs;
  out.function.graph.inputs = J.graph.inputs;
  out.function.graph.nodes = J.graph.nodes;
  int row0 = 0;
  for (const ArgumentShape& o : function.outputs) {
    int column0 = 0;
    for (const ArgumentShape& i : function.inputs) {
      std::vector<std::size_t> entries;
      for (std::size_t e = 0; e < J.sparsity.row.size(); ++e)
        if (J.sparsity.row[e] >= row0 && J.sparsity.row[e] < row0 + o.size() && J.sparsity.column[e] >= column0 &&
            J.sparsity.column[e] < column0 + i.size())
          entries.push_back(e);
      // The entries come row after row; blocks have them column after column.
      std::stable_sort(entries.begin(), entries.end(), [&](std::size_t a, std::size_t b) { return J.sparsity.column[a] < J.sparsity.column[b]; });
      Sparsity block;
      block.rows = o.size();
      block.columns = i.size();
      for (const std::size_t e : entries) {
        block.row.push_back(J.sparsity.row[e] - row0);
        block.column.push_back(J.sparsity.column[e] - column0);
        out.function.graph.outputs.push_back(J.graph.outputs[e]);
      }
      out.function.outputs.push_back({"jac_" + o.name + "_" + i.name, static_cast<int>(entries.size())});
      out.blocks.push_back(std::move(block));
      column0 += i.size();
    }
    row0 += o.size();
  }
  return out;
}

std::string writeCasadiSource(const std::vector<TracedFunction>& functions, bool jacobians) {
  std::vector<TracedFunction> all;
  std::string interfaces;
  const auto add = [&](const TracedFunction& f, const std::vector<ArgumentShape>& ignored, const std::vector<std::string>& patterns) {
    all.push_back(f);
    interfaces += wrapper({f.name, "libdyn_" + f.name, f.inputs, ignored, f.outputs, patterns});
  };
  for (const TracedFunction& f : functions) {
    std::vector<std::string> patterns;
    patterns.reserve(f.outputs.size());
    for (const ArgumentShape& a : f.outputs) patterns.push_back(compressed(a));
    add(f, {}, patterns);
    if (!jacobians) continue;
    const JacobianBlocks J = jacobianBlocks(f);
    patterns.clear();
    for (const Sparsity& s : J.blocks) patterns.push_back(compressed(s));
    add(J.function, f.outputs, patterns);
  }
  SourceOptions how;
  how.prefix = "libdyn_";
  return "/* Written by libdyn: functions for casadi.external. */\n" + writeSource(all, how).code() +
         "typedef double casadi_real;\ntypedef long long int casadi_int;\n#if defined(__GNUC__)\n#define DYN_EXPORT "
         "__attribute__((visibility(\"default\")))\n"
         "#else\n#define DYN_EXPORT\n#endif\nstatic casadi_real* dyn_zeros(casadi_real* x, int n) {\n  int i;\n  for (i = 0; i < n; ++i) x[i] = 0;\n "
         " "
         "return x;\n}\n\n" +
         interfaces;
}

}  // namespace dyn
