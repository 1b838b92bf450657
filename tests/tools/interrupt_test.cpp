// SPDX-License-Identifier: BSD-2-Clause
// SIGINT (Ctrl-C) and SIGTERM while dyn works.
#include "command.hpp"
#include "support/skip.hpp"

#include <nlohmann/json.hpp>

#include <fcntl.h>
#include <unistd.h>

#include <csignal>

using namespace dyn::test;

namespace fs = std::filesystem;

namespace {

/// Tells whether the process already runs dyn, not a copy of the test, and has a handler for the signal.
bool handles(pid_t process, int signal) {
  std::error_code error;
  if (fs::read_symlink("/proc/" + std::to_string(process) + "/exe", error).filename() != "dyn") return false;
  std::ifstream status("/proc/" + std::to_string(process) + "/status");
  for (std::string line; std::getline(status, line);)
    if (line.rfind("SigCgt:", 0) == 0) return (std::stoull(line.substr(7), nullptr, 16) >> (signal - 1) & 1) != 0;
  return false;
}

/// Starts dyn with these arguments and these files for its output and its messages. Returns once dyn has a handler for the signal, or has ended.
pid_t started(const std::vector<std::string>& arguments, int signal, int out, int err) {
  std::vector<char*> argv{const_cast<char*>("dyn")};
  for (const std::string& word : arguments) argv.push_back(const_cast<char*>(word.c_str()));
  argv.push_back(nullptr);
  const pid_t child = fork();
  if (child == 0) {
    alarm(120);
    if (dup2(out, STDOUT_FILENO) < 0 || dup2(err, STDERR_FILENO) < 0) _exit(1);
    execv(DYN_BINARY_DIR "/bin/dyn", argv.data());
    _exit(1);
  }
  siginfo_t end{};
  while (!handles(child, signal) && end.si_pid == 0) {
    usleep(1000);
    REQUIRE(waitid(P_PID, static_cast<id_t>(child), &end, WEXITED | WNOHANG | WNOWAIT) == 0);
  }
  return child;
}

int exitCodeOf(pid_t child) {
  int status = 0;
  REQUIRE(waitpid(child, &status, 0) == child);
  REQUIRE(WIFEXITED(status));
  return WEXITSTATUS(status);
}

/// Runs dyn with these arguments, sends the signal once dyn has a handler for it, and returns the exit code.
int interrupted(const std::vector<std::string>& arguments, int signal, const std::string& out, const std::string& err = "/dev/null") {
  const int files[] = {open(out.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600), open(err.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600)};
  REQUIRE((files[0] >= 0 && files[1] >= 0));
  const pid_t child = started(arguments, signal, files[0], files[1]);
  for (const int file : files) close(file);
  kill(child, signal);
  return exitCodeOf(child);
}

/// The state of a process: R while it runs, S while it sleeps, for example in a write to a full pipe, Z after its end.
char stateOf(pid_t process) {
  const std::string status = textOf("/proc/" + std::to_string(process) + "/status"), mark = "State:\t";
  return status.at(status.find(mark) + mark.size());
}

}  // namespace

TEST_CASE("a simulation that is interrupted writes what it has come to", "[command][simulate]") {
  for (const int signal : {SIGINT, SIGTERM}) {
    const Folder folder;
    const std::string out = (folder.path / "out.csv").string(), save = (folder.path / "saved").string();
    CHECK(interrupted({"simulate", DYN_SOURCE_DIR "/models/four_bar.urdf", "--time", "100000", "--every", "0.5", "--out", out, "--save", save},
                      signal, "/dev/null") == 128 + signal);
    CHECK_THAT(textOf(out), containing("t,"));
    CHECK_THAT(textOf(save), containing("libdyn-simulation-3"));
    CHECK(std::distance(fs::directory_iterator(folder.path), {}) == 2);
  }
}

TEST_CASE("an error after an interruption is reported, too", "[command][simulate]") {
  if (!fs::exists("/dev/full")) DYN_SKIP("there is no /dev/full");
  const Folder folder;
  const std::string err = (folder.path / "err").string();
  CHECK(interrupted({"simulate", DYN_SOURCE_DIR "/models/four_bar.urdf", "--time", "100000", "--every", "0.5", "--save", "/dev/full"}, SIGINT,
                    "/dev/null", err) == 130);
  CHECK_THAT(textOf(err), containing("dyn: note: interrupted") && containing("dyn: error: /dev/full") && containing("cannot be written"));
}

TEST_CASE("a signal while dyn waits for the reader of its output loses no output", "[command]") {
  const Folder folder;
  int ends[2];
  REQUIRE(pipe2(ends, O_CLOEXEC) == 0);
  // The pipe is full before dyn starts: 4096 bytes are the most that a pipe takes at once or not at all.
  REQUIRE(fcntl(ends[1], F_SETFL, O_NONBLOCK) == 0);
  while (write(ends[1], std::string(4096, ' ').c_str(), 4096) > 0) {
  }
  REQUIRE(fcntl(ends[1], F_SETFL, 0) == 0);
  const fs::path err = folder.path / "err";
  const int messages = open(err.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
  REQUIRE(messages >= 0);
  const std::string states = folder.write("states.json", zero_state);
  const pid_t child = started({"compute", biped, "--root", "free_flyer", "--states", states}, SIGINT, ends[1], messages);
  close(ends[1]);
  close(messages);
  while (stateOf(child) != 'S' && stateOf(child) != 'Z') usleep(1000);
  kill(child, SIGINT);
  // The handler writes a message, so the signal has then reached the write.
  while (textOf(err).empty() && stateOf(child) != 'Z') usleep(1000);
  std::string text;
  char part[4096];
  for (ssize_t n; (n = read(ends[0], part, sizeof part)) > 0;) text.append(part, static_cast<std::size_t>(n));
  close(ends[0]);
  CHECK(exitCodeOf(child) == 130);
  const nlohmann::json answer = nlohmann::json::parse(text, nullptr, false);
  REQUIRE_FALSE(answer.is_discarded());
  CHECK(answer["samples"].size() == 1);
}

TEST_CASE("compute that is interrupted prints the samples that it has computed", "[command]") {
  const Folder folder;
  nlohmann::json states;
  nlohmann::json sample = nlohmann::json::parse(zero_state)["samples"][0];
  for (int k = 0; k < 10000; ++k) states["samples"].push_back(sample);
  const std::string out = (folder.path / "out.json").string();
  CHECK(interrupted({"compute", biped, "--root", "free_flyer", "--states", folder.write("states.json", states.dump())}, SIGINT, out) == 130);
  const nlohmann::json answer = nlohmann::json::parse(textOf(out));
  CHECK(answer["samples"].size() < 10000);
}

TEST_CASE("every subcommand that lasts ends with 130 at Ctrl-C, and leaves no unfinished file", "[command]") {
  const Folder folder;
  const std::string out = (folder.path / "out.srdf").string(), code = (folder.path / "code").string();
  // Each lasts for minutes unless it is interrupted.
  CHECK(interrupted({"bench", biped, "--json", "--states", "1024"}, SIGINT, "/dev/null") == 130);
  const std::string picture = (folder.path / "p.svg").string();
  CHECK(interrupted({"profile", biped, "--plot", picture}, SIGINT, "/dev/null") == 130);
  CHECK((!fs::exists(picture) || textOf(picture).find("</svg>") != std::string::npos));
  CHECK(interrupted({"codegen", biped, "--functions", "rnea_derivatives,aba_derivatives", "--out", code}, SIGINT, "/dev/null") == 130);
  CHECK_FALSE(fs::exists(code));
  const std::string truth = (folder.path / "truth.json").string();
  CHECK(interrupted({"truth", DYN_SOURCE_DIR "/models/four_bar.urdf", "--count", "1000", "--out", truth}, SIGINT, "/dev/null") == 130);
  CHECK_FALSE(fs::exists(truth));
  CHECK(interrupted({"plugin", "check", DYN_BINARY_DIR "/bad_plugins/never_ends_or_crashes.so", "--any-plugin"}, SIGINT, "/dev/null") == 130);
  CHECK(interrupted({"collide", biped, "--learn", "1000000000", "--out", out}, SIGINT, "/dev/null") == 130);
  CHECK_THAT(textOf(out), containing("<robot name=\"biped\"/>"));
  for (const fs::directory_entry& file : fs::recursive_directory_iterator(folder.path)) {
    INFO(file.path());
    CHECK(file.path().string().find(".part") == std::string::npos);
  }
}

TEST_CASE("accuracy that is interrupted writes the sections that it has measured", "[command][accuracy]") {
  const Folder folder;
  const std::string out = (folder.path / "report").string();
  CHECK(interrupted({"accuracy", "--quick", "--out", out}, SIGTERM, "/dev/null") == 143);
  CHECK_THAT(textOf(out + "/index.html"), containing("</html>"));
  CHECK(nlohmann::json::parse(textOf(out + "/report.json"))["sections"].size() < 6);
}
