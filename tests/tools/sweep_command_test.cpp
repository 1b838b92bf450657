// SPDX-License-Identifier: BSD-2-Clause
// dyn sweep: the same results for every number of threads and ranks, after kills and full disks; faults of studies and folders.
#include "sweep_study.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <functional>

using namespace dyn::test;

namespace {

/// Starts a program with these words and returns once `ready` holds or it has ended.
pid_t started(const std::vector<std::string>& words, const std::function<bool()>& ready) {
  std::vector<char*> argv;
  for (const std::string& word : words) argv.push_back(const_cast<char*>(word.c_str()));
  argv.push_back(nullptr);
  const pid_t child = fork();
  if (child == 0) {
    alarm(300);
    for (const char* name : {"OMPI_ALLOW_RUN_AS_ROOT", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "OMPI_MCA_rmaps_base_oversubscribe"}) setenv(name, "1", 1);
    if (!std::freopen("/dev/null", "w", stdout) || !std::freopen("/dev/null", "w", stderr)) _exit(1);
    execvp(argv[0], argv.data());
    _exit(1);
  }
  siginfo_t end{};
  while (!ready() && end.si_pid == 0) {
    usleep(1000);
    REQUIRE(waitid(P_PID, static_cast<id_t>(child), &end, WEXITED | WNOHANG | WNOWAIT) == 0);
  }
  return child;
}

int statusOf(pid_t child) {
  int status = 0;
  REQUIRE(waitpid(child, &status, 0) == child);
  return status;
}

/// The process of this rank among those that work on a folder; -1 if there is none.
pid_t processOf(int rank, const std::string& folder) {
  std::error_code none;
  for (const fs::directory_entry& entry : fs::directory_iterator("/proc", none)) {
    const std::string name = entry.path().filename().string();
    if (name.find_first_not_of("0123456789") != std::string::npos) continue;
    if (textOf(entry.path() / "cmdline").find(folder) == std::string::npos) continue;
    if (textOf(entry.path() / "environ").find("OMPI_COMM_WORLD_RANK=" + std::to_string(rank)) != std::string::npos) return std::stoi(name);
  }
  return -1;
}

}  // namespace

TEST_CASE("a sweep has the same results for every number of threads and every chunk size", "[command][sweep]") {
  NEEDS_RESULTS();
  Sweep s;
  const std::string one = s.digest("one", "--threads 1");
  CHECK(s.digest("five", "--threads 5") == one);
  CHECK(textOf(s.path / "one/results.h5") == textOf(s.path / "five/results.h5"));
  s.study["chunk"] = 50;
  CHECK(s.digest("large") == one);
  s.study["seed"] = 8;
  CHECK(s.digest("other") != one);
  CHECK(Json::parse(run("sweep --status '" + s.out("one") + "'").out)["done"] == 120);
}

TEST_CASE("samples that fail are kept with reason and inputs, and the others go on", "[command][sweep]") {
  NEEDS_RESULTS();
  Sweep s;
  s.study["vary"]["tau"] = {{"list", {0, 1e200}}};
  s.study["success"] = {{"v_final", {-1e9, 1e9}}};
  const Answer answer = s.sweep("out");
  CHECK(answer.code == 0);
  CHECK_THAT(answer.out, containing("120 samples, 60 failed"));
  CHECK_THAT(answer.err, containing("dyn: warning: sample 1: "));
  std::ifstream lines(s.path / "out/failures.jsonl");
  int count = 0;
  for (std::string line; std::getline(lines, line); ++count) {
    const Json failure = Json::parse(line);
    CHECK(failure["sample"].get<int>() == 2 * count + 1);
    CHECK(failure["input"]["tau"][0] == 1e200);
  }
  CHECK(count == 60);
  const Json good = s.replay("out", 0), bad = s.replay("out", 1);
  CHECK(good["results"]["success"] == 1);
  CHECK(bad["failed"] == true);
  CHECK(Json::parse(run("sweep --status '" + s.out("out") + "'").out)["failed"] == 60);
  CHECK(run("sweep --replay '" + s.out("out") + "' 1").code == 1);
  CHECK(run("sweep --replay '" + s.out("out") + "' 120").code == 2);
  const std::string picture = s.out("p.svg");
  CHECK(run("sweep --replay '" + s.out("out") + "' 0 --plot '" + picture + "'").code == 0);
  CHECK_THAT(textOf(picture), containing("</svg>"));
}

TEST_CASE("a sweep that was killed goes on with other threads and has the same results", "[command][sweep]") {
  NEEDS_RESULTS();
  Sweep s;
  s.study["samples"] = 400;
  s.study["time"] = 0.2;
  const std::string whole = s.digest("whole");
  for (const int signal : {SIGKILL, SIGINT}) {
    const std::string name = "cut" + std::to_string(signal), out = s.out(name);
    const pid_t child = started({DYN_BINARY_DIR "/bin/dyn", "sweep", s.file(), "--out", out, "--threads", "2"}, [&] { return s.chunks(name) >= 3; });
    kill(child, signal);
    const int status = statusOf(child);
    if (signal == SIGINT) {
      REQUIRE(WIFEXITED(status));
      CHECK(WEXITSTATUS(status) == 130);
    }
    REQUIRE_FALSE(fs::exists(s.path / name / "results.h5"));
    const Json state = Json::parse(run("sweep --status '" + out + "'").out);
    CHECK(state["done"].get<int>() >= 12);
    CHECK(state["finished"] == false);
    CHECK(state["running"] == false);
    // A damaged chunk is computed again.
    const fs::path chunk = fs::directory_iterator(s.path / name / "chunks")->path();
    fs::resize_file(chunk, fs::file_size(chunk) / 2);
    CHECK(s.digest(name, "--resume --threads 3") == whole);
    CHECK(s.chunks(name) == 0);
  }
}

TEST_CASE("a sweep ends with an error on a full disk, and goes on later", "[command][sweep]") {
  NEEDS_RESULTS();
  Sweep s;
  const std::string whole = s.digest("whole");
  // Files of more than 1 KiB cannot be written: chunks have less, the results more. Then no file of more than 512 bytes can.
  const auto limited = [&](const std::string& name, int blocks, const std::string& options) {
    return shell("trap '' XFSZ; ulimit -f " + std::to_string(blocks) + "; '" DYN_BINARY_DIR "/bin/dyn' sweep '" + s.file() + "' --out '" +
                 s.out(name) + "' " + options);
  };
  const Answer merging = limited("merging", 8, "");
  CHECK(merging.code == 1);
  CHECK_THAT(merging.err, containing("error:") && containing("results.h5.part"));
  CHECK_FALSE(fs::exists(s.path / "merging/results.h5"));
  CHECK_FALSE(fs::exists(s.path / "merging/results.h5.part"));
  CHECK(s.digest("merging", "--resume") == whole);
  s.study["chunk"] = 60;
  const Answer writing = limited("writing", 8, "");
  CHECK(writing.code == 1);
  CHECK_THAT(writing.err, containing("cannot be written") && containing("--resume goes on"));
  CHECK(s.digest("writing", "--resume") == whole);
}

TEST_CASE("a sweep goes on only with the same study, model and version, and one at a time", "[command][sweep]") {
  NEEDS_RESULTS();
  Sweep s;
  s.digest("out", "--keep-chunks");
  CHECK(s.chunks("out") == 30);
  Answer again = s.sweep("out");
  CHECK(again.code == 1);
  CHECK_THAT(again.err, containing("--resume goes on with it"));
  CHECK(s.sweep("out", "--resume").code == 0);
  s.study["seed"] = 8;
  CHECK_THAT(s.sweep("out", "--resume").err, containing("another study"));
  s.study["seed"] = 7;
  const fs::path manifest = s.path / "out/manifest.json";
  Json changed = Json::parse(textOf(manifest));
  changed["version"] = "0.0.9";
  s.write("out/manifest.json", changed.dump());
  CHECK_THAT(s.sweep("out", "--resume").err, containing("begun with libdyn 0.0.9"));
  s.write("out/manifest.json", "{");
  CHECK_THAT(s.sweep("out", "--resume").err, containing("damaged"));

  s.study["model"] = "arm.urdf";
  s.write("arm.urdf", textOf(DYN_SOURCE_DIR "/models/arm.urdf"));
  s.digest("moved");
  std::string text = textOf(s.path / "arm.urdf");
  const std::string mass = "mass value=\"";
  text.insert(text.find(mass) + mass.size(), "1");
  s.write("arm.urdf", text);
  CHECK_THAT(s.sweep("moved", "--resume").err, containing("another model"));

  fs::create_directories(s.path / "full/of");
  CHECK_THAT(s.sweep("full").err, containing("not empty"));
  s.study["samples"] = 100000;
  const pid_t first = started({DYN_BINARY_DIR "/bin/dyn", "sweep", s.file(), "--out", s.out("busy")}, [&] { return s.chunks("busy") > 0; });
  const Answer second = s.sweep("busy", "--resume");
  CHECK(second.code == 1);
  CHECK_THAT(second.err, containing("another sweep runs in this folder"));
  CHECK(Json::parse(run("sweep --status '" + s.out("busy") + "'").out)["running"] == true);
  kill(first, SIGKILL);
  statusOf(first);
}

TEST_CASE("what is wrong with a study is named with its place", "[command][sweep]") {
  NEEDS_RESULTS();
  const std::pair<const char*, const char*> faults[] = {
      {R"("sample": 5)", "no member 'sample'; did you mean 'samples'?"},
      {R"("samples": 0)", "samples: must be a whole number from 1"},
      {R"("samples": 1.5)", "samples: must be a whole number"},
      {R"("samples": 2, "samples": 3)", "the member 'samples' twice"},
      {R"("seed": -1)", "seed: must be a whole number"},
      {R"("samples": 2, "dt": 0)", "dt: 0 must be positive"},
      {R"("samples": 2, "integrator": "rk5")", "integrator: rk5"},
      {R"("samples": 2, "limits": 1)", "limits: must be true or false"},
      {R"("samples": 2, "vary": {"qq": 1})", "vary: there is no quantity 'qq'"},
      {R"("samples": 2, "vary": {"q": {"unform": [0, 1]}})", "vary.q: there is no distribution 'unform'; did you mean 'uniform'?"},
      {R"("samples": 2, "vary": {"q": {"uniform": [1, 0]}})", "vary.q.uniform: the lower bound is above"},
      {R"("samples": 2, "vary": {"q": {"normal": [0, -1]}})", "vary.q.normal: a deviation is not negative"},
      {R"("samples": 2, "vary": {"q": {"grid": [0, 1, 0.5]}})", "vary.q.grid[2]: a grid has a whole number"},
      {R"("samples": 2, "vary": {"q": {"grid": [0, 1, 1000000]}})", "more than 2^40 points"},
      {R"("samples": 2, "vary": {"q": {"list": []}})", "vary.q.list: must be a list with at least one entry"},
      {R"("samples": 2, "vary": {"v": [1, 2]})", "vary.v: must be one number or 7 of them, not 2"},
      {R"("samples": 2, "vary": {"q": {"joints": {"no": 1}}})", "vary.q.joints: there is no moving joint 'no'"},
      {R"("samples": 2, "vary": {"bodies": {"hand": {"weight": 1}}})", "vary.bodies.hand: has an unknown member 'weight'"},
      {R"("samples": 2, "vary": {"joints": {"bend": {"damping": 1}}})", "acts only with \"losses\": true"},
      {R"("samples": 2, "keep": ["finals"])", "keep: there is no result 'finals'; did you mean 'final'?"},
      {R"("samples": 2, "success": {"v_fin": [0, 1]})", "success: there is no kept result 'v_fin'"},
      {R"("samples": 2, "chunk": "many")", "chunk: must be a whole number"},
      {R"("seed": 1)", "has no member 'samples'"},
  };
  const Folder folder;
  for (const auto& [members, message] : faults) {
    const std::string file =
        folder.write("s.json", std::string(R"({"model": ")" DYN_SOURCE_DIR R"(/models/arm.urdf", "task": "simulate", )") + members + "}");
    const Answer answer = run("sweep '" + file + "' --out '" + (folder.path / "out").string() + "'");
    INFO(members);
    CHECK(answer.code == 1);
    CHECK_THAT(answer.err, containing("s.json: ") && containing(message));
    CHECK_FALSE(fs::exists(folder.path / "out"));
  }
  const std::string deep = folder.write("deep.json", std::string(100000, '['));
  CHECK_THAT(run("sweep '" + deep + "' --out '" + (folder.path / "out").string() + "'").err, containing("nested deeper"));
  const std::string lost = folder.write("lost.json", R"({"model": "no.urdf", "task": "simulate", "samples": 2})");
  CHECK_THAT(run("sweep '" + lost + "' --out '" + (folder.path / "out").string() + "'").err,
             containing((folder.path / "no.urdf").string() + ": does not exist"));
  Sweep s;
  CHECK_THAT(run("sweep '" + s.file() + "' --out /dev/null/folder").err, containing("cannot be made"));
}

TEST_CASE("1, 2, 3 and 8 ranks have the results of one process, to the byte", "[command][sweep][mpi]") {
  NEEDS_RANKS();
  const Sweep s;
  const std::string one = s.digest("one"), bytes = textOf(s.path / "one/results.h5");
  for (const int ranks : {1, 2, 3, 8}) {
    const std::string name = "ranks" + std::to_string(ranks);
    const Answer answer = shell(mpi_environment + "mpirun -n " + std::to_string(ranks) + " '" DYN_BINARY_DIR "/bin/dyn' sweep '" + s.file() +
                                "' --out '" + s.out(name) + "'");
    INFO(answer.err);
    REQUIRE(answer.code == 0);
    CHECK(s.digestOf(name) == one);
    CHECK(textOf(s.path / name / "results.h5") == bytes);
  }
}

TEST_CASE("a rank that is killed ends the sweep, and other ranks go on with the same results", "[command][sweep][mpi]") {
  NEEDS_RANKS();
  Sweep s;
  s.study["samples"] = 400;
  s.study["time"] = 0.2;
  const std::string whole = s.digest("whole");
  const pid_t job =
      started({"mpirun", "-n", "3", DYN_BINARY_DIR "/bin/dyn", "sweep", s.file(), "--out", s.out("cut")}, [&] { return s.chunks("cut") >= 3; });
  const pid_t worker = processOf(1, s.out("cut"));
  REQUIRE(worker > 0);
  kill(worker, SIGKILL);
  CHECK(statusOf(job) != 0);
  REQUIRE_FALSE(fs::exists(s.path / "cut/results.h5"));
  const Answer answer =
      shell(mpi_environment + "mpirun -n 2 '" DYN_BINARY_DIR "/bin/dyn' sweep '" + s.file() + "' --out '" + s.out("cut") + "' --resume");
  INFO(answer.err);
  REQUIRE(answer.code == 0);
  CHECK(s.digestOf("cut") == whole);
}

TEST_CASE("a rank without the model, or with another study, ends all ranks with a message", "[command][sweep][mpi]") {
  NEEDS_RANKS();
  Sweep s;
  const std::string good = s.file();
  const auto together = [&](const std::string& other) {
    const std::string sweep = "'" DYN_BINARY_DIR "/bin/dyn' sweep ", out = " --out '" + s.out("out") + "'";
    return shell(mpi_environment + "mpirun -n 2 " + sweep + "'" + good + "'" + out + " : -n 1 " + sweep + "'" + other + "'" + out);
  };
  s.study["model"] = "no.urdf";
  const Answer missing = together(s.write("missing.json", s.study.dump()));
  CHECK(missing.code != 0);
  CHECK_THAT(missing.err, containing("rank 2: ") && containing("no.urdf: does not exist"));
  s.study["model"] = DYN_SOURCE_DIR "/models/four_bar.urdf";
  const Answer different = together(s.write("different.json", s.study.dump()));
  CHECK(different.code != 0);
  CHECK_THAT(different.err, containing("rank 2: it has another version of libdyn, instruction set, study, model or Python file than rank 0"));
  CHECK_FALSE(fs::exists(s.path / "out"));
}
