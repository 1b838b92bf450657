// SPDX-License-Identifier: BSD-2-Clause
// dyn bench: ns per call of each algorithm, the median of repetitions over random states; with a truth file, the error too.
#include "bench.hpp"

#include "commands.hpp"
#include "contacts.hpp"
#include "interrupt.hpp"
#include "messages.hpp"
#include "model_options.hpp"
#include "options.hpp"
#include "progress.hpp"

#include <dyn/near_names.hpp>

#include <cmath>
#include <memory>

namespace dyn::tool {

namespace {

/// The largest nv for which derivatives are measured unless --only names them: they take about twenty nv x nv matrices, and four for each of 256
/// states of a batch.
constexpr int most_with_derivatives = 1000;

struct Options {
  ModelOptions model;
  bool json = false;
  int states = state_count, threads = 1;
  std::string truth;
  std::vector<std::string> contacts, codegen, only;
};

/// The constraints that the command line names; otherwise the model's own; otherwise contacts at its lowest leaves.
ConstraintSet constraintsOf(const Options& o, const CompactModel& model) {
  if (!o.contacts.empty()) return ConstraintSet(model, readContacts(o.contacts));
  const ConstraintSet own(model);
  return own.rows() > 0 || model.njoints() < 2 ? own : ConstraintSet(model, lowestLeaves(model));
}

std::string namesOf(const ConstraintSet& set) {
  std::string names;
  for (int k = 0; k < set.count(); ++k) names += (k ? ", " : "") + set.description(k).name + " (" + std::to_string(set.rows(k)) + ")";
  return names;
}

/// Removes the entries that --only does not name. Throws CLI::ValidationError for a name that no entry has.
void choose(const std::vector<std::string>& only, std::vector<Entry>& entries) {
  const auto isAmong = [](const std::vector<std::string>& names, const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  std::vector<std::string> known;
  for (const Entry& entry : entries)
    if (!isAmong(known, entry.algorithm)) known.push_back(entry.algorithm);
  for (const std::string& name : only)
    if (!isAmong(known, name)) {
      const std::string near = nearNames(name, known);
      throw CLI::ValidationError("--only " + name,
                                 "there is no such algorithm" + (near.empty() ? "; there are " + CLI::detail::join(known, ", ") : near));
    }
  if (!only.empty()) std::erase_if(entries, [&](const Entry& entry) { return !isAmong(only, entry.algorithm); });
}

void run(const Options& o) {
  const CompactModel model = o.model.compile();
  Subjects subjects(model, constraintsOf(o, model), o.states);
  if (!o.truth.empty()) subjects.truth = timed("read " + o.truth, [&] { return readTruth(o.truth, model); });
  std::vector<Entry> entries;
  const Interruption interruption;
  addSingle(subjects, entries);
  addBatch<double>(subjects, "double", o.threads, entries);
  addBatch<float>(subjects, "float", o.threads, entries);
  addGenerated(subjects, o.codegen, entries);
  choose(o.only, entries);
  if (o.only.empty() && model.nv() > most_with_derivatives) {
    const auto left_out = std::erase_if(entries, [](const Entry& entry) { return has(entry.need, Need::derivatives); });
    note(std::to_string(model.nv()) + " degrees of freedom: " + std::to_string(left_out) +
         " lines with matrices of derivatives are left out; --only measures them");
  }
  subjects.needs = Need::state;
  for (const Entry& entry : entries) subjects.needs = subjects.needs | entry.need;
  if (!o.json) std::printf("constraints (rows): %s\n", namesOf(subjects.constraint_set).c_str());
  if (!o.json)
    std::printf("%s, %d degrees of freedom, %zu random states, batches of %d, median of 11%s\n", model.name().c_str(), model.nv(),
                subjects.states.size(), o.states, o.truth.empty() ? "" : "; errors in units of roundoff, u");
  char columns[128];
  std::snprintf(columns, sizeof columns, "%-32s %-8s %-8s %12s %20s %10s", "algorithm", "scalar", "mode", "ns a state", "quartiles",
                o.truth.empty() ? "" : "error");
  if (!o.json) std::printf("%s\n", heading(columns).c_str());
  Progress progress(static_cast<double>(entries.size()), "algorithms");
  std::size_t done = 0;
  for (const Entry& entry : entries) {
    if (interruption || outputLost()) break;
    progress.at(static_cast<double>(done++), entry.algorithm + ", " + entry.scalar + ", " + entry.mode);
    try {
      const benchmark::Quartiles t = measure(entry.round, entry.states);
      const ErrorSummary error = entry.error ? entry.error() : ErrorSummary();
      clearLiveLine();
      if (o.json) {
        nlohmann::ordered_json line = {{"robot", model.name()},  {"algorithm", entry.algorithm},
                                       {"scalar", entry.scalar}, {"mode", entry.mode},
                                       {"states", entry.states}, {"ns", t.median},
                                       {"ns_low", t.low},        {"ns_high", t.high}};
        if (!std::isnan(error.most())) {
          line["error_u"] = error.most();
          line["rms_u"] = error.rms();
        }
        std::printf("%s\n", line.dump().c_str());
      } else {
        char range[48], off[24] = "";
        std::snprintf(range, sizeof range, "%.1f .. %.1f", t.low, t.high);
        if (!std::isnan(error.most())) std::snprintf(off, sizeof off, "%.1f u", error.most());
        std::printf("%-32s %-8s %-8s %12.1f %20s %10s\n", entry.algorithm.c_str(), entry.scalar.c_str(), entry.mode.c_str(), t.median, range, off);
      }
    } catch (const Error& e) {
      if (e.code() != ErrorCode::singular && e.code() != ErrorCode::argument && e.code() != ErrorCode::memory) throw;
      warning(entry.algorithm + ", " + entry.scalar + ", " + entry.mode + ": " + e.what());
    }
  }
  interruption.end();
}

}  // namespace

void addBench(CLI::App& app) {
  CLI::App* sub = addCommand(app, "bench", "time of each algorithm on this machine, state by state and in batches");
  auto o = std::make_shared<Options>();
  o->model.add(*sub);
  sub->add_flag("--json", o->json, "one JSON object a line");
  sub->add_option("--truth", o->truth, "a file of states with reference results of many digits: errors are shown beside times")->type_name("FILE");
  sub->add_option("--contacts", o->contacts,
                  "FRAME:6d or FRAME:3d, ... for constraint_dynamics and impulse; without: the model's own constraints, or where it stands")
      ->delimiter(',');
  sub->add_option("--codegen", o->codegen, "code generated for this model too: names of functions as dyn codegen knows them, or all")->delimiter(',');
  sub->add_option("--only", o->only, "algorithms to measure, as its lines name them")->delimiter(',');
  sub->add_option("--states", o->states, "of a batch")->capture_default_str()->check(inRange(1, 1024));
  sub->add_option("--threads", o->threads, "of batches")->capture_default_str()->check(inRange(1, 256));
  sub->callback([o] { run(*o); });
}

}  // namespace dyn::tool
