// SPDX-License-Identifier: BSD-2-Clause
// dyn accuracy: speed against error, as one page.
#include "commands.hpp"
#include "folder.hpp"
#include "interrupt.hpp"
#include "messages.hpp"
#include "problems.hpp"
#include "sections.hpp"

#include <chrono>
#include <functional>
#include <memory>

namespace dyn::tool {

Specimen specimenOf(const Model& description, const JointRegistry& registry, bool lane_groups) {
  CompileOptions options;
  options.dissipation = options.armature = false;
  options.lane_groups = lane_groups;
  return {"", "", description, compile(description, registry, options)};
}

namespace {

/// Reads "FILE" or "FILE:ROOT".
Specimen specimenFrom(const std::string& word, const JointRegistry& registry) {
  const std::size_t colon = word.rfind(':');
  const bool rooted = colon != std::string::npos && word.find('/', colon) == std::string::npos;
  urdf::Options options;
  options.root = rooted ? word.substr(colon + 1) : "fixed";
  options.mimic = urdf::Mimic::independent;  // `dyn bench` and the reference treat them in the same way
  const std::string path = rooted ? word.substr(0, colon) : word;
  Specimen out = timed("read and compiled " + path, [&] { return specimenOf(urdf::load(path, options), registry); });
  out.path = path;
  out.root = options.root;
  return out;
}

void run(const AccuracyOptions& o) {
  const JointRegistry registry = JointRegistry::standard();
  std::vector<Specimen> specimens;
  if (o.models.empty()) specimens.push_back(specimenOf(chain(7), registry));
  for (const std::string& word : o.models) specimens.push_back(specimenFrom(word, registry));
  makeFolder(o.out);
  // The file is read before minutes of measurement, so that its errors are reported at once.
  std::vector<Section> peers;
  if (!o.peers.empty()) peers = peerSections(o.peers);
  Page page("libdyn: speed against error");
  const Interruption interruption;
  const std::function<Section()> sections[] = {[&] { return algorithmSection(specimens, o); },
                                               [&] { return motionSection(specimens, o); },
                                               [&] { return driftSection(o); },
                                               [&] { return lengthSection(o); },
                                               [&] { return distanceSection(o); },
                                               [&] { return lieSection(o); }};
  for (const auto& section : sections) {
    if (interruption) break;
    const auto start = std::chrono::steady_clock::now();
    Section made = section();
    detail("measured: " + made.title, std::chrono::steady_clock::now() - start);
    if (!made.table.rows.empty()) page.add(std::move(made));
  }
  for (Section& section : peers) page.add(std::move(section));
  page.write(o.out);
  std::printf("%s/index.html\n%s/report.json\n", o.out.c_str(), o.out.c_str());
  interruption.end();
}

}  // namespace

void addAccuracy(CLI::App& app) {
  CLI::App* sub = addCommand(
      app, "accuracy",
      "a page of speed against error: algorithms, integrators, long chains, far bases, rotations; against references of fifty digits and more");
  auto o = std::make_shared<AccuracyOptions>();
  sub->add_option("--models", o->models, "URDF files, each with :ROOT if it does not stand fixed, as in talos.urdf:free_flyer; without, a chain")
      ->type_name("FILE")
      ->delimiter(',');
  sub->add_option("--out", o->out, "folder of the page and its numbers")->type_name("FOLDER")->capture_default_str();
  sub->add_option("--instruction-sets", o->instruction_sets, "measure the models' algorithms once more with these, as scalar,avx2")
      ->delimiter(',')
      ->check(CLI::IsMember({"scalar", "baseline", "sse2", "avx2", "avx512"}));
  sub->add_option("--peers", o->peers, "what tools/bench-peers wrote, to be shown beside")->type_name("FILE");
  sub->add_flag("--codegen", o->codegen, "generated code, too (minutes of compiling for large models)");
  sub->add_flag("--quick", o->quick, "fewer states and shorter runs");
  sub->callback([o] { run(*o); });
}

}  // namespace dyn::tool
