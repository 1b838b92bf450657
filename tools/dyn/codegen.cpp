// SPDX-License-Identifier: BSD-2-Clause
// dyn codegen: algorithms of one model as C source, with a CMakeLists.txt and a test that compares them with the library.
#include "bench.hpp"
#include "commands.hpp"
#include "folder.hpp"
#include "interrupt.hpp"
#include "messages.hpp"
#include "model_options.hpp"
#include "progress.hpp"
#include "states.hpp"

#include <dyn/codegen/casadi.hpp>
#include <dyn/codegen/native.hpp>
#include <dyn/file.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <span>

namespace dyn::tool {

namespace {

namespace fs = std::filesystem;

/// Generated code pays if it takes at most this share of the library's time.
constexpr double most_of_library = 0.9;

struct CodegenOptions : ModelOptions {
  std::vector<std::string> functions;
  std::string out, prefix;
  bool compile_now = false, single_precision = false, casadi = false, plain = false;
  int lanes = 1;
};

/// A C identifier made of a model's name: other characters become underscores, and a leading digit gets a prefix.
std::string identifier(const std::string& name) {
  std::string out;
  for (const char c : name) out += std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
  return out.empty() || std::isdigit(static_cast<unsigned char>(out[0])) ? "model_" + out : out;
}

/// An array definition. It has one number where `numbers` is empty, as C has no empty arrays. Infinity is written as NAN; the test skips NAN.
std::string array(const char* type, const std::string& name, std::span<const double> numbers, int repeat) {
  std::string out = std::string("static ") + type + " " + name + "[] = {";
  char text[40];
  for (const double x : numbers)
    for (int l = 0; l < repeat; ++l) {
      std::snprintf(text, sizeof text, std::isfinite(x) ? "%.17g, " : "NAN, ", x);
      out += text;
    }
  return out + (numbers.empty() ? "0};\n" : "};\n");
}

/// A C program that calls each function at a few states and compares the results with the library's. It skips expected values that are not finite, as
/// in the inverse of a singular mass matrix. All lanes hold the same state.
std::string testOf(const CodegenOptions& o, const CompactModel& model, const std::vector<TracedFunction>& functions, const std::string& header) {
  std::string arrays, calls;
  const std::vector<State> states = randomStates(model, 3, 7);
  for (const TracedFunction& f : functions) {
    for (std::size_t k = 0; k < states.size(); ++k) {
      const std::string id = f.name + "_" + std::to_string(k);
      std::vector<double> in;
      std::string arguments;
      for (const ArgumentShape& a : f.inputs) {
        const Eigen::VectorXd& x = states[k].argument(a.name);
        in.insert(in.end(), x.begin(), x.end());
        arrays += array("const dyn_real", id + "_" + a.name, {x.data(), static_cast<std::size_t>(x.size())}, o.lanes);
        arguments += id + "_" + a.name + ", ";
      }
      const std::vector<double> out = replay<double>(f.graph, in);
      std::size_t first = 0;
      std::string checks;
      for (const ArgumentShape& a : f.outputs) {
        const auto size = static_cast<std::size_t>(a.size());
        arrays += array("const dyn_real", id + "_" + a.name + "_expected", {out.data() + first, size}, o.lanes);
        arrays += "static dyn_real " + id + "_" + a.name + "[" + std::to_string(std::max<std::size_t>(size, 1) * static_cast<std::size_t>(o.lanes)) +
                  "];\n";
        arguments += id + "_" + a.name + ", ";
        checks += "  compare(\"" + f.name + ", " + a.name + "\", " + id + "_" + a.name + ", " + id + "_" + a.name + "_expected, " +
                  std::to_string(size * static_cast<std::size_t>(o.lanes)) + ");\n";
        first += size;
      }
      arguments.resize(arguments.size() - 2);
      calls += "  " + o.prefix + f.name + "(" + arguments + ");\n" + checks;
    }
  }
  return "/* Written by dyn codegen: results of the library at random states. */\n#include \"" + header +
         "\"\n\n#include <math.h>\n#include <stdio.h>\n\n" + arrays +
         "\nstatic int failed = 0;\nstatic void compare(const char* what, const dyn_real* found, const dyn_real* expected, int n) {\n"
         "  double worst = 0, largest = 0;\n  int i, none = 0;\n  for (i = 0; i < n; ++i) {\n    const double off = fabs((double)found[i] - "
         "(double)expected[i]);\n"
         "    if (expected[i] != expected[i]) {\n      ++none;\n      continue;\n    }\n"
         "    if (!(off <= worst)) worst = off;\n    if (fabs((double)expected[i]) > largest) largest = fabs((double)expected[i]);\n  }\n"
         "  printf(\"%-40s %.1e\", what, largest > 0 ? worst / largest : worst);\n"
         "  if (none > 0) printf(\", %d of %d not compared: the mass matrix is singular there\", none, n);\n  printf(\"\\n\");\n  if (!(worst <= " +
         std::string(o.single_precision ? "1e-3" : "1e-12") + " * largest)) failed = 1;\n}\n\nint main(void) {\n" + calls + "  return failed;\n}\n";
}

/// Target names have a suffix, so that no model name can clash: `test` and `all` belong to CMake, `m` is a library.
std::string listsOf(const std::string& name) {
  return "cmake_minimum_required(VERSION 3.16)\nproject(" + name +
         " C)\n\nif(NOT CMAKE_BUILD_TYPE)\n  set(CMAKE_BUILD_TYPE Release CACHE STRING \"\" FORCE)\nendif()\n"
         "include(CheckCCompilerFlag)\ncheck_c_compiler_flag(-march=native has_native)\nadd_library(" +
         name + "_model " + name + ".c)\ntarget_include_directories(" + name + "_model PUBLIC ${CMAKE_CURRENT_SOURCE_DIR})\ntarget_compile_options(" +
         name +
         "_model PRIVATE -O2 -ffp-contract=fast -fno-math-errno -fno-trapping-math -fno-tree-vectorize "
         "$<$<BOOL:${has_native}>:-march=native> $<$<BOOL:${has_native}>:-mtune=generic>)\ntarget_link_libraries(" +
         name + "_model PUBLIC m)\n\nenable_testing()\nadd_executable(" + name + "_test " + name + "_test.c)\ntarget_link_libraries(" + name +
         "_test PRIVATE " + name + "_model)\nadd_test(NAME " + name + " COMMAND " + name + "_test)\n";
}

std::string casadiListsOf(const std::string& name) {
  return "\n# casadi.external(\"rnea\", \"./lib" + name + "_casadi.so\")\nadd_library(" + name + "_casadi SHARED " + name +
         "_casadi.c)\ntarget_compile_options(" + name +
         "_casadi PRIVATE -O2 -ffp-contract=fast -fno-math-errno -fno-trapping-math -fno-tree-vectorize)\n" + "target_link_libraries(" + name +
         "_casadi PRIVATE m)\n";
}

void run(const CodegenOptions& o) {
  using Clock = std::chrono::steady_clock;
  if (o.plain && o.lanes > 1)
    throw CLI::ValidationError("--plain", "it is C99 without vectors, and --lanes makes vectors of states: leave out one of them");
  const CompactModel model = o.compile();
  const std::string name = identifier(model.name());
  std::vector<TracedFunction> functions, plain;  // `plain` for CasADi
  const auto start = Clock::now();
  const Interruption interruption;
  {
    const bool casadi = o.casadi && !o.out.empty();
    Progress progress(static_cast<double>(o.functions.size()) * (casadi ? 2 : 1), "functions");
    const auto add = [&](const std::string& f, const TraceOptions& options, std::vector<TracedFunction>& traced) {
      progress.at(static_cast<double>(functions.size() + plain.size()), "tracing " + f);
      traced.push_back(timed("traced " + f, [&] { return trace(model, f, options); }));
      interruption.end();
    };
    for (const std::string& f : o.functions) {
      add(f, {.packable = o.lanes == 1 && !o.plain}, functions);
      if (casadi) add(f, {}, plain);
    }
  }
  SourceOptions how;
  how.single_precision = o.single_precision;
  how.lanes = o.lanes;
  how.prefix = o.prefix;
  const Source source = writeSource(functions, how);
  if (!o.out.empty()) {
    makeFolder(o.out);
    const fs::path folder = o.out;
    replaceFile(folder / (name + ".h"), source.header());
    replaceFile(folder / (name + ".c"), source.code(name + ".h"));
    replaceFile(folder / (name + "_test.c"), testOf(o, model, functions, name + ".h"));
    replaceFile(folder / "CMakeLists.txt", listsOf(name) + (o.casadi ? casadiListsOf(name) : ""));
    if (o.casadi) replaceFile(folder / (name + "_casadi.c"), writeCasadiSource(plain));
    note("written to " + o.out + ": cmake -S " + o.out + " -B " + o.out + "/build && cmake --build " + o.out + "/build && ctest --test-dir " + o.out +
         "/build");
  }
  interruption.end();
  char columns[128];
  std::snprintf(columns, sizeof columns, "%-24s %10s %10s %10s %10s %10s %10s %10s", "function", "operations", "sums", "products", "quotients",
                "functions", "selections", "steps");
  std::printf("%s\n", heading(columns).c_str());
  for (std::size_t i = 0; i < functions.size(); ++i) {
    const OperationCounts n = functions[i].graph.count();
    std::printf("%-24s %10d %10d %10d %10d %10d %10d %10d\n", functions[i].name.c_str(), n.total(), n.additions, n.multiplications, n.divisions,
                n.functions, n.selections, source.steps[i]);
  }
  std::printf("traced and written in %.2f s\n", std::chrono::duration<double>(Clock::now() - start).count());
  if (!o.compile_now) return;
  NativeOptions native;
  native.single_precision = o.single_precision;
  native.lanes = o.lanes;
  Progress progress(static_cast<double>(functions.size()), "functions");
  double done = 0;
  std::string slower;
  native.progress = [&](const std::string& what) {
    detail(what);
    progress.at(done, what);
  };
  for (const TracedFunction& f : functions) {
    const auto before = Clock::now();
    const CompiledModel compiled = compileNative({f}, native);
    ++done;
    clearLiveLine();
    std::printf("%-24s compiled in %.2f s%s", f.name.c_str(), std::chrono::duration<double>(Clock::now() - before).count(),
                compiled.functions()[0].cached() ? " (from the cache)" : "");
    if (const std::optional<Pace> pace = paceOf(model, compiled.functions()[0], o.lanes, o.single_precision)) {
      std::printf("; %.1f ns a state, the library takes %.1f ns", pace->generated, pace->library);
      if (pace->generated > most_of_library * pace->library) slower += (slower.empty() ? "" : ", ") + f.name;
    }
    std::printf("\n");
    interruption.end();
  }
  if (!slower.empty())
    note("generated code does not pay for " + slower + ": call the library's own" + (o.lanes > 1 || o.single_precision ? " batches" : " functions"));
}

}  // namespace

void addCodegen(CLI::App& app) {
  CLI::App* sub = addCommand(app, "codegen", "algorithms of one model as C source, with a test of itself; --compile for use at run time");
  auto o = std::make_shared<CodegenOptions>();
  o->add(*sub);
  sub->add_option("--functions", o->functions, "separated by commas")->delimiter(',')->required()->check(CLI::IsMember(traceableFunctions()));
  sub->add_option("--out", o->out, "folder for source, header, CMakeLists and test")->type_name("FOLDER");
  sub->add_flag("--compile", o->compile_now, "compile into the cache that compileNative() uses, and compare with the library's time");
  sub->add_flag("--float", o->single_precision, "float for double");
  sub->add_flag("--plain", o->plain, "C99 without vectors: fewer operations, more steps; of one state a call");
  sub->add_flag("--casadi", o->casadi, "beside them a CasADi external with Jacobians, NAME_casadi.c");
  const auto begins_name = [](const std::string& text) {
    return text.empty() || identifier(text) == text ? std::string() : "'" + text + "' begins no name in C: letters, digits and _, no digit first";
  };
  sub->add_option("--prefix", o->prefix, "what the functions' names in the source begin with")->check(begins_name);
  sub->add_option("--lanes", o->lanes, "states a call")->capture_default_str()->check(CLI::IsMember({1, 2, 4, 8, 16, 32, 64}));
  sub->callback([o] { run(*o); });
}

}  // namespace dyn::tool
