// SPDX-License-Identifier: BSD-2-Clause
#include "bench.hpp"
#include "interrupt.hpp"
#include "oracle.hpp"
#include "progress.hpp"
#include "sections.hpp"
#include "text.hpp"

#include <dyn/codegen/differentiate.hpp>
#include <dyn/codegen/trace.hpp>
#include <dyn/file.hpp>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>

namespace dyn::tool {

namespace {

/// Algorithms that the reference has results for.
const std::set<std::string> judged{"rnea", "crba", "aba", "forward_dynamics_cholesky", "minverse", "rnea_derivatives", "aba_derivatives"};

struct Line {
  std::string algorithm, scalar, mode;
  double ns, low, high, most, rms;
};

std::string modeOf(const Line& line) { return line.scalar == "float" ? line.mode + " float" : line.mode; }
bool usesLaneGroups(const CompactModel& model) {
  const std::vector<std::string>& passes = model.report().passes;
  return std::any_of(passes.begin(), passes.end(), [](const std::string& x) { return x.find("single states take them") != std::string::npos; });
}

/// Adds the single-state entries of a model compiled without lane groups.
void addWithoutLaneGroups(Subjects& x, std::vector<Entry>& entries) {
  std::vector<Entry> single;
  addSingle(x, single);
  for (Entry& entry : single) {
    entry.mode = "single, no lane groups";
    entries.push_back(std::move(entry));
  }
}

/// The label beside a line's point: only its difference from the default mode.
std::string labelOf(const Line& line) {
  const std::string mode = modeOf(line), differences = "differences ", single = "single ";
  if (mode == "single") return "";
  if (mode == "batch float") return "float";
  if (mode == "single, no lane groups") return "no lane groups";
  if (mode.rfind(differences, 0) == 0) return "h = " + mode.substr(differences.size());
  return mode.rfind(single, 0) == 0 ? mode.substr(single.size()) : mode;
}

/// Derivatives by a method other than the library's. run(state) writes those by q and by v side by side into the matrix that out() returns.
template <class Run, class Out>
Entry derivativeEntry(Subjects& x, const char* algorithm, const std::string& mode, Run run, Out out) {
  return {algorithm,
          "double",
          mode,
          Need::derivatives,
          x.states.size(),
          [&x, run] {
            for (const State& s : x.states) run(s);
          },
          [&x, run, out, algorithm] {
            ErrorSummary errors;
            for (const TruthSample& sample : x.truth) {
              run(sample.state);
              addErrors(sample, algorithm, out().reshaped(), 0x1p-53, errors);
            }
            return errors;
          }};
}

/// One-sided differences with step h, for the derivatives that aba_derivatives and rnea_derivatives compute in closed form.
Entry byDifferences(Subjects& x, bool forward_dynamics, double h) {
  char mode[32];
  std::snprintf(mode, sizeof mode, "differences %g", h);
  const auto n = x.model.nv();
  const auto out = std::make_shared<Eigen::MatrixXd>(n, 2 * n);
  const auto run = [&x, forward_dynamics, h, n, out](const State& s) {
    const auto f = [&](const Eigen::VectorXd& q, const Eigen::VectorXd& v) {
      return Eigen::VectorXd(forward_dynamics ? aba(x.model, x.data(), q, v, s.tau) : rnea(x.model, x.data(), q, v, s.a));
    };
    const Eigen::VectorXd here = f(s.q, s.v);
    Eigen::VectorXd step = Eigen::VectorXd::Zero(n);
    for (int k = 0; k < n; ++k) {
      step[k] = h;
      out->col(k) = (f(integrate(x.model, s.q, step), s.v) - here) / h;
      out->col(n + k) = (f(s.q, s.v + step) - here) / h;
      step[k] = 0;
    }
  };
  return derivativeEntry(x, forward_dynamics ? "aba_derivatives" : "rnea_derivatives", mode, run, [out]() -> const Eigen::MatrixXd& { return *out; });
}

/// Differentiates the operations of rnea forward, as dual numbers do: the graph of rnea is differentiated and replayed. Only for models whose
/// configuration space is its own tangent space (nq = nv).
Entry byDualNumbers(Subjects& x) {
  const auto n = x.model.nv();
  struct Tape {
    TracedFunction function;
    JacobianGraph jacobian;
    std::vector<double> in, values;
    Eigen::MatrixXd out;
  };
  const auto tape = std::make_shared<Tape>();
  tape->function = trace(x.model, "rnea");
  tape->jacobian = differentiate(tape->function.graph);
  tape->in.resize(static_cast<std::size_t>(tape->jacobian.graph.inputs));
  tape->values.resize(tape->jacobian.graph.nodes.size());
  tape->out = Eigen::MatrixXd::Zero(n, 3 * n);
  const auto run = [tape](const State& s) {
    auto at = tape->in.begin();
    for (const ArgumentShape& argument : tape->function.inputs) {
      const Eigen::VectorXd& value = s.argument(argument.name);
      at = std::copy(value.begin(), value.end(), at);
    }
    replayNodes(tape->jacobian.graph, tape->in.data(), tape->values.data());
    const Sparsity& entries = tape->jacobian.sparsity;
    for (std::size_t k = 0; k < entries.row.size(); ++k) tape->out(entries.row[k], entries.column[k]) = tape->values[tape->jacobian.graph.outputs[k]];
  };
  return derivativeEntry(x, "rnea_derivatives", "dual", run, [tape]() -> const Eigen::MatrixXd& { return tape->out; });
}

/// The samples in the format of a truth file, so that `dyn bench` in another process uses the same truth.
std::string truthFile(const std::vector<TruthSample>& samples) {
  Json out;
  out["samples"] = Json::array();
  for (const TruthSample& sample : samples) {
    const State& s = sample.state;
    Json entry{{"q", flat(s.q.data(), s.q.size())},
               {"v", flat(s.v.data(), s.v.size())},
               {"a", flat(s.a.data(), s.a.size())},
               {"tau", flat(s.tau.data(), s.tau.size())}};
    for (const auto& [key, numbers] : sample.truth) {
      Json digits = Json::array();
      for (const long double x : numbers) {
        char text[48];
        std::snprintf(text, sizeof text, "%.21Lg", x);
        digits.push_back(text);
      }
      entry["truth"][key] = std::move(digits);
    }
    out["samples"].push_back(std::move(entry));
  }
  return out.dump();
}

/// Runs this program again as `dyn bench --json`, with kernels for another instruction set, and returns its lines.
std::vector<Line> linesOfOther(const Specimen& x, const std::string& isa, const std::string& truth) {
  const std::string self = std::filesystem::read_symlink("/proc/self/exe").string();
  const std::string command = "DYN_SIMD=" + shellWord(isa) + ' ' + shellWord(self) + " bench " + shellWord(x.path) + " --root " + shellWord(x.root) +
                              " --quiet --json --truth " + shellWord(truth);
  FILE* pipe = popen(command.c_str(), "r");
  std::string text;
  std::array<char, 4096> part{};
  while (pipe && std::fgets(part.data(), part.size(), pipe)) text += part.data();
  const bool ended = pipe != nullptr && pclose(pipe) == 0;
  // Ctrl-C reaches both processes: the lines until then count.
  if (!ended && !Interruption::pending()) throw Error(ErrorCode::argument, "--instruction-sets " + isa + ": nothing could be measured with it");
  std::vector<Line> out;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const nlohmann::json line = nlohmann::json::parse(text.substr(at, end - at), nullptr, false);
    at = end + 1;
    if (line.is_discarded() || !line.contains("error_u") || line["mode"] != "single" || !judged.contains(line["algorithm"])) continue;
    out.push_back({line["algorithm"], line["scalar"], "single " + isa, line["ns"], line["ns_low"], line["ns_high"], line["error_u"], line["rms_u"]});
  }
  return out;
}

}  // namespace

Section algorithmSection(const std::vector<Specimen>& specimens, const AccuracyOptions& options) {
  Section out;
  out.id = "algorithms";
  out.title = "Algorithms: time against error";
  out.text = {
      "Each point is one way to compute one quantity: to the left is more exact, further down is faster. Errors are the largest over random states, "
      "in units of roundoff u (2^-53 for doubles, 2^-24 for floats), against a reference that computes from definitions with fifty digits and shares "
      "no "
      "code with the library. Errors of rnea, aba and Cholesky forward dynamics are scaled by what their summands could be before they cancel, the "
      "others by the largest entry. Times are medians of eleven repetitions over 256 random states. Points without a word are calls of one state; "
      "no lane groups: without joints of several limbs side by "
      "side; batch: many states a call; float: such in single precision; codegen: code generated for the model; others: an instruction set.",
      "What limits each: rounding alone. Finite differences are limited by their step, and gain or lose digits as it is chosen."};
  out.table.columns = {"model",      "algorithm",     "mode",          "ns a state",          "quartile 1",
                       "quartile 3", "error max [u]", "error rms [u]", "digits a microsecond"};
  for (const Specimen& specimen : specimens) {
    if (Interruption::pending()) break;
    const CompactModel& model = specimen.model;
    Subjects subjects(model, ConstraintSet(model, {}));
    const Oracle oracle(specimen.description, model);
    const bool derivatives = model.nv() <= 40;
    for (const State& s : randomStates(model, options.quick ? 2 : model.nv() <= 20 ? 8 : 3, 7))
      subjects.truth.push_back(oracle.evaluate(s, derivatives));
    // For floats, the truth is the result in doubles at the rounded states, whose errors are a hundred million times smaller.
    std::vector<Entry> entries;
    addSingle(subjects, entries);
    // The entries keep references to these two.
    std::optional<CompactModel> one_by_one;
    std::optional<Subjects> plain;
    if (usesLaneGroups(model)) {
      one_by_one = specimenOf(specimen.description, JointRegistry::standard(), false).model;
      plain.emplace(*one_by_one, ConstraintSet(*one_by_one, {}));
      plain->truth = subjects.truth;
      addWithoutLaneGroups(*plain, entries);
    }
    addBatch<double>(subjects, "double", 1, entries);
    addBatch<float>(subjects, "float", 1, entries);
    if (derivatives)
      for (const bool forward_dynamics : {false, true})
        for (const double h : {1e-4, 1e-6, 1e-8, 1e-10}) entries.push_back(byDifferences(subjects, forward_dynamics, h));
    if (derivatives && model.nq() == model.nv()) entries.push_back(byDualNumbers(subjects));
    if (options.codegen) addGenerated(subjects, {"rnea", "crba", "aba", "minverse", "rnea_derivatives", "aba_derivatives"}, entries);
    std::vector<Line> lines;
    Progress progress(static_cast<double>(entries.size()), "algorithms");
    std::size_t done = 0;
    for (const Entry& entry : entries) {
      progress.at(static_cast<double>(done++), model.name() + ": " + entry.algorithm);
      if (Interruption::pending()) break;
      if (!judged.contains(entry.algorithm)) continue;
      const ErrorSummary error = entry.error ? entry.error() : ErrorSummary();
      if (std::isnan(error.most())) continue;
      const benchmark::Quartiles t = measure(entry.round, entry.states);
      lines.push_back({entry.algorithm, entry.scalar, entry.mode, t.median, t.low, t.high, error.most(), error.rms()});
    }
    if (!specimen.path.empty() && !options.instruction_sets.empty()) {
      const std::string truth = options.out + "/truth-" + model.name() + ".json";
      replaceFile(truth, truthFile(subjects.truth));
      for (const std::string& isa : options.instruction_sets) {
        if (Interruption::pending()) break;
        for (Line& line : linesOfOther(specimen, isa, truth)) lines.push_back(std::move(line));
      }
    }
    const std::string title = model.name() + ", " + std::to_string(model.nv()) + " degrees of freedom";
    const benchmark::LineChart::Label error{"largest error [u]", benchmark::Scale::logarithmic}, time{"ns a state", benchmark::Scale::logarithmic};
    benchmark::LineChart algorithms(title, error, time), derived(title + ": derivatives", error, time);
    algorithms.joinPoints(false);
    derived.joinPoints(false);
    for (const Line& line : lines) {
      // Errors are clamped, because an error of zero has no place on a logarithmic axis.
      const bool derivative = line.algorithm.find("derivatives") != std::string::npos;
      (derivative ? derived : algorithms).add(line.algorithm, std::max(line.most, 0.01), line.ns, labelOf(line));
      const double digits = -std::log10(std::max(line.most, 0.01) * (line.scalar == "float" ? 0x1p-24 : 0x1p-53));
      out.table.rows.push_back(
          {model.name(), line.algorithm, modeOf(line), line.ns, line.low, line.high, line.most, line.rms, digits / (line.ns * 1e-3)});
    }
    out.charts.push_back(std::move(algorithms));
    if (derivatives) out.charts.push_back(std::move(derived));
  }
  return out;
}

}  // namespace dyn::tool
