// SPDX-License-Identifier: BSD-2-Clause
// dyn sweep: many samples of a study, in the threads of one process or in the ranks of an MPI job.
#include "commands.hpp"
#include "engine.hpp"
#include "folder.hpp"
#include "interrupt.hpp"
#include "messages.hpp"
#include "options.hpp"
#include "results.hpp"
#include "sha256.hpp"

#include <dyn/file.hpp>
#include <dyn/parsers/json.hpp>
#include <dyn/version.hpp>

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <thread>

namespace dyn::tool {

namespace {

using namespace sweep;

struct Options {
  std::string study, out, status, digest, plot;
  std::vector<std::string> replay;
  int threads = 0;
  bool resume = false, json_lines = false, keep_chunks = false;
};

std::string hostName() {
  char name[256] = "";
  gethostname(name, sizeof name - 1);
  return name;
}

Manifest manifestOf(const Setting& setting) {
  const Version version = dyn::version();
  const Study& study = setting.study;
  Manifest out{version.number,
               version.instruction_set,
               sha256(json::write(setting.description)),
               hostName(),
               study.name,
               study.folder,
               study.document,
               study.samples,
               0,
               study.seed,
               {},
               {},
               setting.python.file_sha256};
  Worker worker(setting);
  out.fields = Json::array();
  for (const Field& field : worker.fields())
    out.fields.push_back({{"name", field.name}, {"shape", field.shape}, {"type", field.flag ? "u8" : "f64"}});
  out.pairs = worker.task().pairs();
  readHistograms(study, worker.fields());  // says what is wrong before anything is computed
  return out;
}

/// Throws Error(argument) if a sweep that was begun as `then` cannot go on as `now`.
void requireSame(const Manifest& then, const Manifest& now, const std::string& where) {
  const auto differ = [&](const std::string& what) {
    throw Error(ErrorCode::argument, what + "; give another folder for a new sweep", {where, 0, ""});
  };
  if (then.version != now.version) differ("the sweep was begun with libdyn " + then.version + ", and this is " + now.version);
  if (then.study != now.study) differ("the sweep was begun with another study");
  if (then.model_sha256 != now.model_sha256) differ("the sweep was begun with another model");
  if (then.file_sha256 != now.file_sha256) differ("the sweep was begun with another text of the Python file");
  if (then.instruction_set != now.instruction_set)
    differ("the sweep was begun with the instruction set " + then.instruction_set + ", and this is " + now.instruction_set + " (DYN_SIMD chooses)");
  if (then.fields != now.fields || then.samples != now.samples || then.seed != now.seed) differ("the sweep was begun with other results");
}

/// Opens the folder for this sweep. Returns its manifest.
Manifest openFolder(const Options& o, const Store& store, const Setting& setting, Manifest manifest, int workers) {
  if (store.begun()) {
    Manifest then = store.manifest();
    if (!o.resume) throw Error(ErrorCode::file, "there is a sweep in this folder; --resume goes on with it", {o.out, 0, ""});
    requireSame(then, manifest, o.out);
    return then;
  }
  for (const std::filesystem::directory_entry& entry : std::filesystem::directory_iterator(o.out))
    if (entry.path().filename() != "lock" && entry.path().filename() != "chunks")
      throw Error(ErrorCode::file, "the folder is not empty; give another one", {o.out, 0, ""});
  manifest.chunk = chooseChunk(setting, workers);
  store.begin(manifest);
  return manifest;
}

/// The first of these texts that is not empty, with its rank; all texts come from gather().
std::string firstProblem(const std::vector<std::string>& problems) {
  for (std::size_t rank = 0; rank < problems.size(); ++rank)
    if (!problems[rank].empty()) return problems.size() == 1 ? problems[rank] : "rank " + std::to_string(rank) + ": " + problems[rank];
  return "";
}

/// Ends all ranks if one of them has a problem. Rank 0 reports it.
void agree(const Ranks& ranks, const std::string& problem) {
  const std::string first = ranks.broadcast(firstProblem(ranks.gather(problem)));
  if (first.empty()) return;
  if (ranks.rank() == 0) error(first);
  throw ExitCode{1};
}

/// Returns what an exception of the call says, or an empty text.
template <class Call>
std::string problemOf(const Call& call) {
  try {
    call();
    return "";
  } catch (const std::exception& e) {
    return e.what();
  }
}

void report(const Store& store, const Manifest& manifest, std::int64_t computed, double seconds) {
  const Json status = store.status();
  std::printf("%lld samples, %lld failed", static_cast<long long>(manifest.samples), status["failed"].get<long long>());
  if (computed > 0)
    std::printf("; computed %lld in %.3g s: %.3g samples/s", static_cast<long long>(computed), seconds, static_cast<double>(computed) / seconds);
  std::printf("\nwrote %s\n", store.results().c_str());
}

/// Rank 0: prepares the folder, hands out the work, and merges the results.
void lead(const Options& o, const Ranks& ranks, const Setting& setting, const Manifest& manifest, int threads) {
  const Store store(o.out);
  std::optional<FolderLock> lock;
  Manifest opened;
  std::vector<std::int64_t> missing;
  std::vector<double> times;
  std::vector<Field> fields;
  const Interruption interruption;
  agree(ranks, problemOf([&] {
          makeFolder(o.out);
          lock.emplace(o.out);
          opened = openFolder(o, store, setting, manifest, threads * ranks.count());
          Worker worker(setting);
          fields = worker.fields();
          times = worker.task().times();
          if (store.finished()) return;
          makeFolder(store.path("chunks"));
          missing = store.missing(opened, numbersOf(fields));
        }));
  ranks.broadcast(opened.text());
  agree(ranks, "");  // that the others see the folder
  const auto start = std::chrono::steady_clock::now();
  std::int64_t computed = 0;
  for (const std::int64_t number : missing) computed += opened.count(number);
  const std::string problem = problemOf([&] {
    computeChunks({setting, store, opened, ranks, threads, o.json_lines}, missing);
    if (interruption) return;
    if (!store.finished())
      timed("merged the chunks", [&] { merge(store, opened, fields, times, setting.variation, readHistograms(setting.study, fields)); });
    if (!o.keep_chunks) store.removeChunks();
  });
  for (int rank = 1; rank < ranks.count(); ++rank) ranks.send(rank, "over");
  agree(ranks, problem);
  interruption.end();
  if (!o.json_lines) report(store, opened, computed, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
}

void follow(const Options& o, const Ranks& ranks, const Setting& setting, int threads) {
  const Interruption interruption;
  agree(ranks, "");
  const std::string text = ranks.broadcast("");
  const Store store(o.out);
  Manifest manifest;
  agree(ranks, problemOf([&] {
          manifest = store.manifest();
          if (manifest.text() != text) throw Error(ErrorCode::file, "rank 0 has another folder of this name; all ranks must see one", {o.out, 0, ""});
        }));
  serveRank({setting, store, manifest, ranks, threads, false});
  agree(ranks, "");
}

void compute(const Options& o) {
  requireResults();
  const bool several = Ranks::countFromEnvironment() > 1;
  if (Ranks::numberFromEnvironment() > 0) messageOptions().quiet = true;  // rank 0 speaks for all
  std::optional<Setting> setting;
  Manifest manifest;
  const auto prepare = [&] {
    if (several && o.study == "-" && !Ranks::haveOwnInput())
      throw Error(ErrorCode::argument, "ranks do not share standard input; give the study as a file");
    setting.emplace(timed("read " + o.study, [&] { return readStudy(o.study); }));
    manifest = manifestOf(*setting);
  };
  // Joint types are loaded in trial processes, which must come before MPI.
  std::string problem;
  if (several)
    problem = problemOf(prepare);
  else
    prepare();
  const Ranks ranks;
  agree(ranks, problem);
  Manifest common = manifest;
  common.host.clear();
  const std::string first = ranks.broadcast(common.text());
  agree(ranks, first == common.text() ? "" : "it has another version of libdyn, instruction set, study, model or Python file than rank 0");
  const int threads = o.threads > 0 ? o.threads : several ? 1 : std::max(static_cast<int>(std::thread::hardware_concurrency()), 1);
  if (ranks.rank() == 0)
    lead(o, ranks, *setting, manifest, threads);
  else
    follow(o, ranks, *setting, threads);
}

/// The sample's number. Throws CLI::ValidationError.
std::int64_t sampleNumber(const std::string& text, std::int64_t samples) {
  std::int64_t k = -1;
  if (!CLI::detail::lexical_cast(text, k) || k < 0 || k >= samples)
    throw CLI::ValidationError("--replay", "'" + text + "' must be the number of a sample, from 0 to " + std::to_string(samples - 1));
  return k;
}

void replay(const Options& o) {
  const Store store(o.replay[0]);
  const Manifest then = store.manifest();
  const std::int64_t k = sampleNumber(o.replay[1], then.samples);
  const Setting setting(parseStudy(then.study.dump(), then.study_name, then.study_folder));
  requireSame(then, manifestOf(setting), o.replay[0]);
  Worker worker(setting);
  std::vector<double> row(numbersOf(worker.fields()));
  const std::optional<std::string> reason = worker.sample(k, row.data());
  const Inputs inputs = setting.variation.draw(static_cast<std::uint64_t>(k));
  Json out = {{"sample", k}, {"input", setting.variation.json(inputs)}, {"failed", reason.has_value()}};
  if (reason) {
    out["reason"] = *reason;
  } else {
    const double* number = row.data();
    for (const Field& field : worker.fields()) {
      if (field.name != "failed")
        out["results"][field.name] = field.shape.empty() ? Json(*number) : flat(number, static_cast<std::ptrdiff_t>(field.size()));
      number += field.size();
    }
  }
  std::printf("%s\n", out.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace).c_str());
  if (!o.plot.empty()) worker.task().plot(inputs, o.plot);
  if (reason) throw ExitCode{1};
}

void run(const Options& o) {
  if (!o.status.empty()) {
    std::printf("%s\n", Store(o.status).status().dump().c_str());
  } else if (!o.digest.empty()) {
    std::printf("%s\n", digestOf(Store(o.digest).results()).c_str());
  } else if (!o.replay.empty()) {
    replay(o);
  } else {
    if (o.study.empty()) throw CLI::RequiredError("STUDY");
    if (o.out.empty()) throw CLI::RequiredError("--out");
    compute(o);
  }
}

}  // namespace

void addSweep(CLI::App& app) {
  CLI::App* sub = addCommand(app, "sweep", "many simulations or evaluations of a model, in threads or in the ranks of an MPI job");
  auto o = std::make_shared<Options>();
  sub->add_option("STUDY", o->study, "JSON file that says what to compute and what varies; - for standard input")->type_name("FILE");
  sub->add_option("--out", o->out, "folder of the results")->type_name("FOLDER")->check(fileName());
  sub->add_option("--threads", o->threads, "threads of each process; without it one for each processor, and one for each rank of an MPI job")
      ->check(CLI::Range(1, 1024));
  sub->add_flag("--resume", o->resume, "go on with the sweep that is in the folder, or begin it");
  sub->add_flag("--json", o->json_lines, "progress as JSON lines on standard output");
  sub->add_flag("--keep-chunks", o->keep_chunks, "keep the parts of the results after they are merged");
  CLI::Option* status = sub->add_option("--status", o->status, "tell how far the sweep in this folder is, as JSON")->type_name("FOLDER");
  CLI::Option* digest = sub->add_option("--digest", o->digest, "print a SHA-256 of all results in this folder")->type_name("FOLDER");
  CLI::Option* replay = sub->add_option("--replay", o->replay, "folder and number of a sample: compute it alone and print its inputs and results")
                            ->type_name("FOLDER")
                            ->expected(2);
  sub->add_option("--plot", o->plot, "picture of the motion of --replay, SVG")
      ->type_name("FILE")
      ->check(fileName({".svg"}, "pictures"))
      ->needs(replay);
  status->excludes(digest)->excludes(replay);
  digest->excludes(replay);
  sub->callback([o] { run(*o); });
}

}  // namespace dyn::tool
