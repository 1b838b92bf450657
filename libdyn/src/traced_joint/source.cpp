// SPDX-License-Identifier: BSD-2-Clause
// Writes a traced joint type as an author would: a class with a name, parameters and functions that are templates over the scalar.
#include "traced_joint/traced_joint.hpp"

#include <dyn/error.hpp>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <set>

namespace dyn {

namespace {

// Keywords of C and C++, which cannot be names.
constexpr std::array keywords{
    "alignas",   "alignof",  "and",      "and_eq",   "asm",          "auto",       "bitand",       "bitor",         "bool",
    "break",     "case",     "catch",    "char",     "char16_t",     "char32_t",   "char8_t",      "class",         "co_await",
    "co_return", "co_yield", "compl",    "concept",  "const",        "const_cast", "consteval",    "constexpr",     "constinit",
    "continue",  "decltype", "default",  "delete",   "do",           "double",     "dynamic_cast", "else",          "enum",
    "explicit",  "export",   "extern",   "false",    "float",        "for",        "friend",       "goto",          "if",
    "inline",    "int",      "long",     "mutable",  "namespace",    "new",        "noexcept",     "not",           "not_eq",
    "nullptr",   "operator", "or",       "or_eq",    "private",      "protected",  "public",       "register",      "reinterpret_cast",
    "requires",  "restrict", "return",   "short",    "signed",       "sizeof",     "static",       "static_assert", "static_cast",
    "struct",    "switch",   "template", "this",     "thread_local", "throw",      "true",         "try",           "typedef",
    "typeid",    "typename", "union",    "unsigned", "using",        "virtual",    "void",         "volatile",      "wchar_t",
    "while",     "xor",      "xor_eq"};

bool isIdentifier(const std::string& name) {
  const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
  const auto fits = [&](char c) { return letter(c) || (c >= '0' && c <= '9'); };
  return !name.empty() && letter(name[0]) && std::all_of(name.begin(), name.end(), fits) &&
         std::find(keywords.begin(), keywords.end(), name) == keywords.end();
}

/// A text as a literal of C++.
std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    // A line break, and whatever a terminal would obey, is written as a space.
    out += static_cast<unsigned char>(c) < ' ' || c == '\x7f' ? ' ' : c;
  }
  return out + '"';
}

std::string numberText(double x) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, x);
  return std::string(text, end.ptr);
}

std::string kindOf(const TracedParameter& p) { return p.size == 1 ? "number" : p.size == 3 ? "vector3" : "numbers"; }

const char* functionName(Operation o) {
  switch (o) {
    case Operation::sqrt:
      return "sqrt";
    case Operation::sin:
      return "sin";
    case Operation::cos:
      return "cos";
    case Operation::tan:
      return "tan";
    case Operation::exp:
      return "exp";
    case Operation::log:
      return "log";
    case Operation::atan2:
      return "atan2";
    case Operation::abs:
      return "abs";
    default:
      return nullptr;
  }
}

/// The body of a function: one statement for each operation, and texts of the outputs.
class Body {
 public:
  /// `inputs` are the texts of the graph's inputs; `scalar` is the type of numbers.
  Body(const Graph& graph, const std::vector<std::string>& inputs, const std::string& scalar) : graph_(graph), scalar_(scalar) {
    texts_.reserve(graph.nodes.size());
    for (std::size_t i = 0; i < graph.nodes.size(); ++i) {
      const GraphNode& n = graph.nodes[i];
      if (n.operation == Operation::input) {
        texts_.push_back(inputs[n.argument[0]]);
      } else if (n.operation == Operation::constant) {
        texts_.push_back(scalar_ + "(" + numberText(n.value) + ")");
      } else {
        const std::string name = "t" + std::to_string(count_++);
        statements_ += "    const " + scalar_ + " " + name + " = " + expression(n) + ";\n";
        texts_.push_back(name);
      }
    }
  }

  /// The statements, with the declarations that they need.
  std::string text() const {
    std::string out;
    for (const std::string& name : functions_) out += (out.empty() ? "    using std::" : ", std::") + name;
    if (!out.empty()) out += ";\n";
    if (selects_) out += "    using dyn::select;\n";
    return out + statements_;
  }
  const std::string& output(std::size_t k) const { return texts_[graph_.outputs[k]]; }

 private:
  std::string expression(const GraphNode& n) {
    const auto a = [&](int k) -> const std::string& { return texts_[n.argument[k]]; };
    switch (n.operation) {
      case Operation::add:
        return a(0) + " + " + a(1);
      case Operation::subtract:
        return a(0) + " - " + a(1);
      case Operation::multiply:
        return a(0) + " * " + a(1);
      case Operation::divide:
        return a(0) + " / " + a(1);
      case Operation::negate:
        return "-" + a(0);
      case Operation::select_less:
        selects_ = true;
        return "select(" + a(0) + " < " + a(1) + ", " + a(2) + ", " + a(3) + ")";
      default: {
        const char* const name = functionName(n.operation);
        functions_.insert(name);
        return std::string(name) + "(" + a(0) + (arity(n.operation) == 2 ? ", " + a(1) : "") + ")";
      }
    }
  }

  const Graph& graph_;
  std::string scalar_, statements_;
  std::vector<std::string> texts_;
  std::set<std::string> functions_;
  int count_ = 0;
  bool selects_ = false;
};

/// The texts of q[0], q[1], ... or, for constants, of S(c[0]), ...
void append(std::vector<std::string>& inputs, const std::string& name, int count, const std::string& scalar = "") {
  for (int k = 0; k < count; ++k) {
    const std::string entry = name + "[" + std::to_string(k) + "]";
    inputs.push_back(scalar.empty() ? entry : scalar + "(" + entry + ")");
  }
}

std::string assignments(const Body& body, const std::string& to, int count) {
  std::string out = body.text();
  for (int k = 0; k < count; ++k) out += "    " + to + "[" + std::to_string(k) + "] = " + body.output(static_cast<std::size_t>(k)) + ";\n";
  return out;
}

std::string poseText(const TracedJoint& j, int constants) {
  std::vector<std::string> inputs;
  append(inputs, "q", j.nq);
  append(inputs, "c", constants, "S");
  const Body body(j.pose, inputs, "S");
  const auto row = [&](std::size_t first, std::size_t count) {
    std::string out;
    for (std::size_t k = first; k < first + count; ++k) out += (k > first ? ", " : "") + body.output(k);
    return out;
  };
  return "  /// The pose of the moved frame in the fixed frame.\n  template <class S>\n  static dyn::SE3<S> pose([[maybe_unused]] const S* q, "
         "[[maybe_unused]] const auto& c) {\n" +
         body.text() + "    return {{{" + row(0, 3) + ",  //\n              " + row(3, 3) + ",  //\n              " + row(6, 3) +
         "}},\n            {" + row(9, 3) + "}};\n  }\n";
}

/// A function of the configuration space.
std::string spaceText(const Graph& graph, const std::string& head, std::vector<std::string> inputs, int constants, const std::string& scalar,
                      const std::string& to, int count, const std::string& before = "", const std::string& after = "") {
  append(inputs, "c", constants, scalar);
  return head + " {\n" + before + assignments(Body(graph, inputs, scalar), to, count) + after + "  }\n";
}

std::string spaceTexts(const TracedJoint& j, int constants) {
  const TracedSpace& space = *j.space;
  const auto entries = [](std::initializer_list<std::pair<const char*, int>> arguments) {
    std::vector<std::string> out;
    for (const auto& [name, count] : arguments) append(out, name, count);
    return out;
  };
  const std::string c = "[[maybe_unused]] const auto& c", n = std::to_string(j.nq);
  std::string out = "\n  /// The configuration where the joint is at zero.\n";
  out += spaceText(space.neutral, "  static void neutral(" + c + ", double* q)", {}, constants, "double", "q", j.nq);
  out += "  /// q (+) v.\n  template <class S>\n";
  out += spaceText(space.integrate, "  static void integrate([[maybe_unused]] const S* q, [[maybe_unused]] const S* v, " + c + ", S* out)",
                   entries({{"q", j.nq}, {"v", j.nv}}), constants, "S", "out", j.nq);
  out += "  /// dq/dt.\n  template <class S>\n";
  out += spaceText(ratesOf(j), "  static void rates([[maybe_unused]] const S* q, [[maybe_unused]] const S* v, " + c + ", S* out)",
                   entries({{"q", j.nq}, {"v", j.nv}}), constants, "S", "out", j.nq);
  out += "  /// The v with q0 (+) v = q1.\n";
  out += spaceText(space.difference,
                   "  static void difference([[maybe_unused]] const double* q0, [[maybe_unused]] const double* q1, " + c + ", double* v)",
                   entries({{"q0", j.nq}, {"q1", j.nq}}), constants, "double", "v", j.nv);
  out += "  /// Brings q back onto the configuration space; returns its distance from that space before.\n";
  out += spaceText(space.normalize, "  static double normalize(" + c + ", double* q)", entries({{"q", j.nq}}), constants, "double", "n", j.nq,
                   "    double n[" + n + "];\n",
                   "    double way = 0;\n    for (int k = 0; k < " + n +
                       "; ++k) {\n      way = std::hypot(way, n[k] - q[k]);\n      q[k] = n[k];\n    }\n    return way;\n");
  return out;
}

std::string parametersText(const TracedJoint& j) {
  if (j.parameters.empty()) return "";
  std::string out = "  static constexpr std::array parameters{";
  bool first = true;
  for (const TracedParameter& p : j.parameters) {
    out += std::string(first ? "" : ",\n                                         ") + "dyn::ParameterSpec{" + quoted(p.name) +
           ", dyn::ParameterKind::" + kindOf(p) + ", " + (p.usual.empty() ? "true" : "false") + ", " + quoted(p.unit) + ", " + quoted(p.help);
    if (kindOf(p) == "numbers") out += ", " + quoted(exampleOf(p));
    out += "}";
    first = false;
  }
  return out + "};\n";
}

/// Lists of numbers have the length that the function was traced with, and parameters that a model leaves out have their usual values.
std::string constantsText(const TracedJoint& j) {
  const bool lists = std::any_of(j.parameters.begin(), j.parameters.end(), [](const auto& p) { return kindOf(p) == "numbers"; });
  const bool usual = std::any_of(j.parameters.begin(), j.parameters.end(), [](const auto& p) { return !p.usual.empty(); });
  std::string out;
  if (lists) {
    out += "  static bool check(const dyn::ParameterArgument* a, dyn::JointInstance&, const dyn::sdk::Refusal& refuse) {\n";
    for (std::size_t k = 0; k < j.parameters.size(); ++k)
      if (const TracedParameter& p = j.parameters[k]; kindOf(p) == "numbers")
        out += "    if (a[" + std::to_string(k) + "].given && a[" + std::to_string(k) + "].count != " + std::to_string(p.size) + ") return refuse(" +
               quoted(p.name + " must have " + std::to_string(p.size) + " numbers") + ");\n";
    out += "    return true;\n  }\n";
  }
  if (lists || usual) {
    out += "  static int constantCount(const dyn::ParameterArgument*) { return " + std::to_string(constantCount(j)) + "; }\n";
    out += "  static void constants(const dyn::ParameterArgument* a, double* out) {\n";
    for (std::size_t k = 0; k < j.parameters.size(); ++k) {
      const TracedParameter& p = j.parameters[k];
      const std::string i = std::to_string(k), n = std::to_string(p.size);
      std::string from = "a[" + i + "].numbers";
      if (!p.usual.empty()) {
        std::string numbers;
        for (const double x : p.usual) numbers += (numbers.empty() ? "" : ", ") + numberText(x);
        out += "    static constexpr double usual" + i + "[] = {" + numbers + "};\n";
        from = "(a[" + i + "].given ? a[" + i + "].numbers : usual" + i + ")";
      }
      out += "    for (int k = 0; k < " + n + "; ++k) *out++ = " + from + "[k];\n";
    }
    out += "  }\n";
  }
  return out.empty() ? out : "\n" + out;
}

void checkGraph(const TracedJoint& j, const char* function, const Graph& graph, int inputs, int outputs) {
  if (graph.inputs != inputs || graph.outputs.size() != static_cast<std::size_t>(outputs))
    throw Error(ErrorCode::argument, "joint type '" + j.name + "': " + function + " has " + std::to_string(graph.inputs) + " inputs and " +
                                         std::to_string(graph.outputs.size()) + " outputs; it needs " + std::to_string(inputs) + " and " +
                                         std::to_string(outputs));
}

}  // namespace

int constantCount(const TracedJoint& joint) {
  int n = 0;
  for (const TracedParameter& p : joint.parameters) n += p.size;
  return n;
}

std::string exampleOf(const TracedParameter& p) {
  std::string out;
  for (int k = 0; k < p.size; ++k) out += (k ? " " : "") + numberText(p.usual.empty() ? (k + 1) / 10.0 : p.usual[static_cast<std::size_t>(k)]);
  return out;
}

void checkTypeName(const std::string& name) {
  if (!isIdentifier(name))
    throw Error(ErrorCode::argument, "'" + name + "' cannot name a joint type: use letters, digits and _, no digit first, no keyword of C++");
}

void checkJoint(const TracedJoint& j) {
  const auto refuse = [&](const std::string& what) { throw Error(ErrorCode::argument, "joint type '" + j.name + "': " + what); };
  checkTypeName(j.name);
  if (j.nv < 1 || j.nv > max_joint_nv || j.nq < j.nv || j.nq > max_joint_nq)
    refuse("it has nq = " + std::to_string(j.nq) + " and nv = " + std::to_string(j.nv) + "; nv must be 1 to " + std::to_string(max_joint_nv) +
           ", and nq nv to " + std::to_string(max_joint_nq));
  if (j.nq != j.nv && !j.space) refuse("with more coordinates than degrees of freedom it needs neutral, integrate, difference and normalize");
  std::set<std::string> names;
  for (const TracedParameter& p : j.parameters) {
    if (!isIdentifier(p.name)) refuse("its parameter '" + p.name + "' must have an identifier of C++ as its name");
    if (!names.insert(p.name).second) refuse("two parameters are called '" + p.name + "'");
    if (p.size < 1 || p.size > 10000) refuse("its parameter '" + p.name + "' has " + std::to_string(p.size) + " numbers; it takes 1 to 10000");
    if (!p.usual.empty() && p.usual.size() != static_cast<std::size_t>(p.size))
      refuse("its parameter '" + p.name + "' has " + std::to_string(p.size) + " numbers, and " + std::to_string(p.usual.size()) + " as usual value");
    if (!std::all_of(p.usual.begin(), p.usual.end(), [](double x) { return std::isfinite(x); }))
      refuse("the usual value of its parameter '" + p.name + "' is not finite");
  }
  const int n = constantCount(j);
  checkGraph(j, "the pose", j.pose, j.nq + n, 12);
  if (!j.space) return;
  checkGraph(j, "neutral", j.space->neutral, n, j.nq);
  checkGraph(j, "integrate", j.space->integrate, j.nq + j.nv + n, j.nq);
  checkGraph(j, "difference", j.space->difference, 2 * j.nq + n, j.nv);
  checkGraph(j, "normalize", j.space->normalize, j.nq + n, j.nq);
  if (j.space->rates) checkGraph(j, "rates", *j.space->rates, j.nq + j.nv + n, j.nq);
}

Graph ratesOf(const TracedJoint& j) {
  if (j.space->rates) return *j.space->rates;
  // Column k of dq/dt is the derivative of q (+) v along v_k, beside v = 0 so that sin(|v|) / |v| has one; compare dyn::sdk::Configuration.
  using Varied = Dual<Traced>;
  constexpr double beside_zero = 0x1p-250;
  const int n = constantCount(j);
  return traceFunction(j.nq + j.nv + n, j.nq, [&](const Traced* in, Traced* out) {
    for (int k = 0; k < j.nv; ++k) {
      std::vector<Varied> x;
      for (int i = 0; i < j.nq; ++i) x.emplace_back(in[i], Traced(0));
      for (int i = 0; i < j.nv; ++i) x.emplace_back(Traced(i == k ? beside_zero : 0), Traced(i == k ? 1 : 0));
      for (int i = 0; i < n; ++i) x.emplace_back(in[j.nq + j.nv + i], Traced(0));
      const std::vector<Varied> column = replay<Varied>(j.space->integrate, x);
      for (int i = 0; i < j.nq; ++i) out[i] = (k ? out[i] : Traced(0)) + in[j.nq + k] * column[static_cast<std::size_t>(i)].d;
    }
  });
}

std::string jointClassName(const std::string& name) {
  std::string text;
  bool start = true;
  for (const char c : name) {
    if (c == '_') {
      start = true;
    } else {
      text += start ? static_cast<char>(std::toupper(static_cast<unsigned char>(c))) : c;
      start = false;
    }
  }
  if (text.empty() || std::isdigit(static_cast<unsigned char>(text[0]))) text = "My" + text;
  return text + "Joint";  // the suffix avoids names of C++ and its library
}

std::string writeJointSource(const TracedJoint& j) {
  checkJoint(j);
  const std::string type = jointClassName(j.name);
  const int constants = constantCount(j);
  std::string out = "// A joint type, written by libdyn from a traced function.\n#include <dyn_sdk/joint_plugin.hpp>\n\n";
  out += "struct " + type + " : dyn::sdk::Joint<" + type + ", " + std::to_string(j.nv) + ", " + std::to_string(j.nq) + "> {\n";
  out += "  static constexpr const char* name = " + quoted(j.name) + ";\n";
  out += "  static constexpr const char* summary = " + quoted(j.summary) + ";\n";
  out += "  static constexpr bool branch_free = true;\n" + parametersText(j) + constantsText(j) + "\n" + poseText(j, constants);
  if (j.space) out += spaceTexts(j, constants);
  return out + "};\n\nDYN_EXPORT_JOINTS(" + type + ")\n";
}

}  // namespace dyn
