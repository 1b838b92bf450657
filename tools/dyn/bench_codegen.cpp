// SPDX-License-Identifier: BSD-2-Clause
// Modes codegen and codegen_batch of `dyn bench`.
#include "bench.hpp"
#include "interrupt.hpp"
#include "messages.hpp"
#include "progress.hpp"

#include <dyn/codegen/native.hpp>

#include <map>
#include <memory>
#include <set>

namespace dyn::tool {

namespace {

/// The name that the other modes use for the same function.
std::string entryName(const std::string& function) {
  static const std::map<std::string, std::string> names = {
      {"nonLinearEffects", "nle"}, {"forwardKinematics", "forward_kinematics"}, {"jacobians", "joint_jacobians"}, {"centroidal_map", "ccrba"}};
  const auto found = names.find(function);
  return found == names.end() ? function : found->second;
}

/// A function of numbers T with memory for its arguments and results, for `lanes` states side by side.
template <class T>
struct Subject {
  CompiledFunction function;
  int lanes;
  std::vector<std::vector<T>> in;  ///< by argument: all states, one group of `lanes` after the other
  std::vector<std::vector<T>> out;

  Subject(const CompiledFunction& f, const std::vector<State>& states, int l) : function(f), lanes(l) {
    for (const ArgumentShape& a : f.inputs()) {
      const auto n = static_cast<std::size_t>(a.size()), w = static_cast<std::size_t>(l);
      std::vector<T> all(n * states.size());
      for (std::size_t k = 0; k < states.size(); ++k)
        for (std::size_t i = 0; i < n; ++i)
          all[k / w * w * n + i * w + k % w] = static_cast<T>(states[k].argument(a.name)[static_cast<Eigen::Index>(i)]);
      in.push_back(std::move(all));
    }
    for (const ArgumentShape& a : f.outputs()) out.emplace_back(static_cast<std::size_t>(a.size() * l));
  }
  void run(std::size_t group) {
    const void* from[4];
    void* to[4];
    for (std::size_t i = 0; i < in.size(); ++i)
      from[i] = in[i].data() + group * static_cast<std::size_t>(lanes) * static_cast<std::size_t>(function.inputs()[i].size());
    for (std::size_t i = 0; i < out.size(); ++i) to[i] = out[i].data();
    function.call(from, to);
  }
};

/// One round of all states, in groups of `lanes`.
template <class T>
Entry entryOf(const CompiledFunction& function, const std::vector<State>& states, int lanes) {
  const auto subject = std::make_shared<Subject<T>>(function, states, lanes);
  const std::size_t groups = states.size() / static_cast<std::size_t>(lanes);
  Entry out{entryName(function.name()),
            std::is_same_v<T, double> ? "double" : "float",
            lanes == 1 ? "codegen" : "codegen_batch",
            Need::state,
            groups * static_cast<std::size_t>(lanes),
            {},
            {}};
  out.round = [subject, groups] {
    for (std::size_t g = 0; g < groups; ++g) subject->run(g);
  };
  return out;
}

void add(Subjects& x, const std::string& name, int lanes, std::vector<Entry>& entries, const std::function<void(const std::string&)>& progress) {
  NativeOptions options;
  options.lanes = lanes;
  options.progress = progress;
  const CompiledFunction function = compileNative(x.model, {name}, options).functions()[0];
  Entry entry = entryOf<double>(function, x.states, lanes);
  if (lanes == 1)
    entry.error = [&x, function, algorithm = entry.algorithm] {
      ErrorSummary errors;
      for (const TruthSample& sample : x.truth) {
        Subject<double> one(function, {sample.state}, 1);
        one.run(0);
        std::vector<double> all;
        for (const std::vector<double>& out : one.out) all.insert(all.end(), out.begin(), out.end());
        addErrors(sample, algorithm, Eigen::Map<const Eigen::VectorXd>(all.data(), static_cast<Eigen::Index>(all.size())), 0x1p-53, errors);
      }
      return errors;
    };
  entries.push_back(std::move(entry));
}

}  // namespace

void addGenerated(Subjects& x, const std::vector<std::string>& functions, std::vector<Entry>& entries) {
  std::vector<std::string> names = functions;
  if (names.size() == 1 && names[0] == "all") names = traceableFunctions();
  const std::set<int> all_lanes{1, BatchData(x.model, 1).lanes()};  // one entry, if a register holds one number
  Progress progress(static_cast<double>(all_lanes.size() * names.size()), "functions");
  double done = 0;
  for (const std::string& name : names)
    for (const int lanes : all_lanes) {
      if (Interruption::pending()) return;
      add(x, name, lanes, entries, [&](const std::string& what) {
        detail(what);
        progress.at(done, what);
      });
      ++done;
    }
}

std::optional<Pace> paceOf(const CompactModel& model, const CompiledFunction& function, int lanes, bool single_precision) {
  Subjects x(model, ConstraintSet(model, std::vector<ConstraintDescription>()));
  const Entry generated = single_precision ? entryOf<float>(function, x.states, lanes) : entryOf<double>(function, x.states, lanes);
  std::vector<Entry> entries;
  if (single_precision)
    addBatch<float>(x, "float", 1, entries);
  else if (lanes > 1)
    addBatch<double>(x, "double", 1, entries);
  else
    addSingle(x, entries);
  const auto library = std::find_if(entries.begin(), entries.end(), [&](const Entry& entry) { return entry.algorithm == generated.algorithm; });
  if (library == entries.end()) return std::nullopt;
  x.needs = library->need;
  // In turn, so that other load on the machine affects both.
  Pace out{INFINITY, INFINITY};
  for (int turn = 0; turn < 3; ++turn) {
    out.generated = std::min(out.generated, measure(generated.round, generated.states).median);
    out.library = std::min(out.library, measure(library->round, library->states).median);
  }
  return out;
}

}  // namespace dyn::tool
