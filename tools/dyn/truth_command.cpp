// SPDX-License-Identifier: BSD-2-Clause
// dyn truth: references with 25 digits for a model, computed with fifty, as a file that `dyn bench --truth` and the tests read.
#include "commands.hpp"
#include "interrupt.hpp"
#include "model_options.hpp"
#include "options.hpp"
#include "progress.hpp"
#include "references.hpp"

#include <dyn/error.hpp>
#include <dyn/file.hpp>

#include <memory>

namespace dyn::tool {

namespace {

struct TruthOptions {
  ModelOptions model;
  std::string states, named, out;
  int count = 2;
  std::uint64_t seed = 1;
};

void writeTruth(const TruthOptions& o) {
  // Joint parameters that the definitions do not have would make other numbers than the library's.
  if (o.model.losses || !o.model.lock.empty())
    throw CLI::ValidationError("--losses, --lock", "the definitions know neither damping nor held joints; leave these options out");
  checkReplaceable(o.out);
  const Model description = o.model.description();
  CompileOptions options = o.model.compileOptions();
  options.armature = false;
  const CompactModel model = compile(description, o.model.registry(), options);
  const std::vector<State> states = !o.named.empty()   ? std::vector<State>{namedState(model, description, o.named)}
                                    : o.states.empty() ? referenceStates(model, o.count, o.seed)
                                                       : readStates(o.states, model);
  const Interruption interruption;
  std::string text;
  {
    Progress progress(static_cast<double>(states.size()), "states");
    text = referenceFile({o.model.path, o.model.root, o.model.mimic}, description, model, states, [&](std::size_t k) {
      interruption.end();  // a file has all states, or it is not written
      progress.at(static_cast<double>(k));
    });
  }
  timed("wrote " + o.out, [&] { replaceFile(o.out, text); });
  interruption.end();
}

}  // namespace

void addTruth(CLI::App& app) {
  CLI::App* sub =
      addCommand(app, "truth", "references with 25 digits, computed with fifty from definitions, for every algorithm at some states, as JSON");
  auto o = std::make_shared<TruthOptions>();
  o->model.add(*sub);
  sub->add_option("--out", o->out, "file to write")->type_name("FILE")->required()->check(fileName({".json"}, "references"));
  sub->add_option("--states", o->states, "JSON file of states, or an older file of references. The default is random states.")
      ->type_name("FILE")
      ->check(fileName());
  addNamedState(*sub, o->named, "--states");
  sub->add_option("--count", o->count, "number of random states")->check(inRange(1, 1000))->capture_default_str();
  sub->add_option("--seed", o->seed, "seed of the random states")->capture_default_str();
  sub->callback([o] { writeTruth(*o); });
}

}  // namespace dyn::tool
