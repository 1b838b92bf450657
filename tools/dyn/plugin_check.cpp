// SPDX-License-Identifier: BSD-2-Clause
// dyn plugin check: runs the conformance checks on every type of a shared object. Exit code 1 on a failure.
#include "alloc_guard.hpp"
#include "interrupt.hpp"
#include "messages.hpp"
#include "options.hpp"
#include "plugin.hpp"
#include "progress.hpp"

#include <dyn/conformance/conformance.hpp>
#include <dyn/near_names.hpp>

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>

namespace dyn::tool {

namespace {

struct CheckOptions {
  std::string file, type;
  std::vector<std::string> parameters;
  std::uint64_t seed = 1;
  int rounds = 3;
  double time_limit = 60;
  bool any_plugin = false;
};

/// Reads "name=1,2,3". A value that is not a list of numbers is a text.
void readParameter(const std::string& text, Parameters& parameters) {
  const std::size_t equals = text.find('=');
  if (equals == 0 || equals == std::string::npos)
    throw CLI::ValidationError("--parameters '" + text + "'", "write name=number[,number...] or name=text");
  const std::string name = text.substr(0, equals);
  std::vector<double> numbers;
  const char* p = text.data() + equals + 1;
  const char* end = text.data() + text.size();
  while (true) {
    double x = 0;
    const auto [next, error] = std::from_chars(p, end, x);
    if (error != std::errc() || (next != end && *next != ',')) {
      parameters[name] = text.substr(equals + 1);
      return;
    }
    numbers.push_back(x);
    if (next == end) break;
    p = next + 1;
  }
  parameters[name] = numbers;
}

std::string showParameters(const Parameters& parameters) {
  std::string text;
  for (const auto& [name, value] : parameters) {
    text += "  " + name + "=";
    if (const auto* numbers = std::get_if<std::vector<double>>(&value)) {
      for (std::size_t i = 0; i < numbers->size(); ++i) {
        char number[32];
        std::snprintf(number, sizeof number, "%s%.4g", i ? "," : "", (*numbers)[i]);
        text += number;
      }
    } else if (const auto* word = std::get_if<std::string>(&value)) {
      text += *word;
    } else {
      for (const JointDescription& part : std::get<std::vector<JointDescription>>(value)) text += part.type + " ";
    }
  }
  return text;
}

std::string failed() { return styled(stdout, Style::error, "FAILED"); }

int printFindings(const std::vector<ConformanceFinding>& findings) {
  int failures = 0;
  for (const ConformanceFinding& f : findings) {
    failures += f.passed ? 0 : 1;
    if (f.passed && f.bound == 0 && !f.detail.empty()) {  // a note without a measurement
      std::printf("  ok      %-54s %s\n", f.check.c_str(), f.detail.c_str());
    } else if (f.passed) {
      std::printf("  ok      %-54s %8.1e  (<= %.0e)\n", f.check.c_str(), f.error, f.bound);
    } else {
      std::printf("  %s  %-54s %8.1e  (<= %.0e)\n          %s\n", failed().c_str(), f.check.c_str(), f.error, f.bound, f.detail.c_str());
    }
  }
  return failures;
}

/// The record of that file, even if the registry knows it under another path.
const PluginRecord& recordOf(const JointRegistry& registry, const std::string& file) {
  for (const PluginRecord& plugin : registry.plugins()) {
    std::error_code error;
    if (plugin.problem.empty() && std::filesystem::equivalent(plugin.path, file, error)) return plugin;
  }
  throw Error(ErrorCode::plugin, "was loaded but is not among the plugins", {file, 0, ""});
}

/// Prints the builds of the same plugin for other instruction sets. They lie beside it, in folders named after the sets.
void printUnchecked(const PluginRecord& record) {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path file = fs::canonical(record.path, error);
  for (auto entry = fs::directory_iterator(file.parent_path(), error); !error && entry != fs::directory_iterator(); entry.increment(error)) {
    const fs::path build = entry->path() / file.filename();
    if (!fs::is_regular_file(build, error) || build == record.fast) continue;
    const std::string set = entry->path().filename().string();
    std::printf("not checked: %s; with DYN_SIMD=%s it is, on a processor that has that\n", build.c_str(), set.c_str());
  }
}

using GroupHandler = std::function<void(const char*)>;

/// The report of a child process. The child writes a line when it begins a group of checks, and "=" with a number at the end of each part.
struct Report {
  std::string group;
  int number = -1;           ///< the last number; -1 if the child did not get that far
  bool late = false;         ///< a group exceeded its time limit
  bool interrupted = false;  ///< the user interrupted
};

/// Holds SIGINT and SIGTERM back during its lifetime, except in poll(): a signal between a look at Interruption::pending() and poll() is not missed.
class HeldSignals {
 public:
  HeldSignals() {
    sigset_t both;
    sigemptyset(&both);
    sigaddset(&both, SIGINT);
    sigaddset(&both, SIGTERM);
    sigprocmask(SIG_BLOCK, &both, &before_);
  }
  ~HeldSignals() { sigprocmask(SIG_SETMASK, &before_, nullptr); }
  HeldSignals(const HeldSignals&) = delete;
  HeldSignals& operator=(const HeldSignals&) = delete;
  int poll(pollfd& ready, double seconds) const {
    const auto whole = static_cast<std::time_t>(seconds);
    const timespec limit{whole, static_cast<long>((seconds - static_cast<double>(whole)) * 1e9)};
    return ppoll(&ready, 1, &limit, &before_);
  }

 private:
  sigset_t before_;
};

/// A child process for code that may crash, hang, or end the process with any exit code.
class Child {
 public:
  Child() {
    std::fflush(stdout);
    if (pipe2(ends_, O_CLOEXEC) != 0) throw Error(ErrorCode::file, std::string("no pipe for the checks: ") + std::strerror(errno));
    process_ = fork();
    if (process_ < 0) throw Error(ErrorCode::file, std::string("no process for the checks: ") + std::strerror(errno));
    if (!here()) {
      close(ends_[1]);
      return;
    }
    // The child ends with its parent, which alone answers Ctrl-C, also one that came before the fork.
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    Interruption::forget();
    signal(SIGINT, SIG_IGN);
    signal(SIGTERM, SIG_DFL);
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  /// Whether the caller runs in the child process.
  bool here() const { return process_ == 0; }
  void say(const std::string& line) const {
    if (write(ends_[1], (line + "\n").c_str(), line.size() + 1) < 0) _exit(1);
  }
  /// Reads the child's lines until it ends, or until "=" and the number `last`. Stops with report.late if one line takes longer than time_limit [s],
  /// and with report.interrupted if the user interrupts.
  Report listen(double time_limit, int last = std::numeric_limits<int>::max()) {
    Report report;
    const HeldSignals held;
    while (true) {
      for (std::size_t end; (end = text_.find('\n')) != std::string::npos;) {
        const std::string line = text_.substr(0, end);
        text_.erase(0, end + 1);
        if (line[0] != '=') {
          report.group = line;
          continue;
        }
        report.number = std::atoi(line.c_str() + 1);
        if (report.number == last) return report;
      }
      report.interrupted = Interruption::pending();
      if (report.interrupted) return report;
      pollfd ready{ends_[0], POLLIN, 0};
      const int n = held.poll(ready, time_limit);
      report.late = n == 0;
      if (report.late) return report;
      if (n < 0 && errno == EINTR) continue;
      char buffer[512];
      const ssize_t size = n > 0 ? ::read(ends_[0], buffer, sizeof buffer) : 0;
      if (size < 0 && errno == EINTR) continue;
      if (size <= 0) return report;
      text_.append(buffer, static_cast<std::size_t>(size));
    }
  }
  /// The child's exit status from waitpid(); 0 if other code has collected it before. Kills a child that is late or interrupted.
  int end(const Report& report) const {
    close(ends_[0]);
    if (report.late || report.interrupted) kill(process_, SIGKILL);
    int status = 0;
    pid_t waited;
    do waited = waitpid(process_, &status, 0);
    while (waited < 0 && errno == EINTR);
    return waited == process_ ? status : 0;
  }

 private:
  int ends_[2];
  pid_t process_;
  std::string text_;  ///< received, but not yet processed
};

void printUnended(const CheckOptions& o, const Report& report, int status, const std::string& what) {
  std::string how = "the plugin's code ended the process";
  if (report.late) {
    char seconds[32];
    std::snprintf(seconds, sizeof seconds, "%g", o.time_limit);
    how = std::string("no end within ") + seconds + " s (--time-limit)";
  } else if (WIFSIGNALED(status)) {
    how = std::string("crashed: ") + strsignal(WTERMSIG(status));
  }
  clearLiveLine();
  std::printf("  %s  %s\n          %s\n", failed().c_str(), what.c_str(), how.c_str());
}

/// Returns the number of failed checks; -1 if the checks did not end, which is then printed.
template <class Check>
int checkInChild(const CheckOptions& o, const Check& check) {
  Child child;
  if (child.here()) {
    const std::vector<ConformanceFinding> findings = check([&](const char* group) { child.say(group); });
    clearLiveLine();
    const int failures = printFindings(findings);
    std::fflush(stdout);
    child.say("=" + std::to_string(failures));
    _exit(0);
  }
  const Report report = child.listen(o.time_limit);
  const int status = child.end(report);
  if (report.number < 0) printUnended(o, report, status, report.group);
  return report.number;
}

/// Each round has another seed, hence other parameters (unless they are given) and other configurations. Returns the number of failed checks. A round
/// that does not end is the last one.
template <class Type, class Check>
int checkType(const Type& type, const CheckOptions& o, const Check& check, Progress& progress, double done) {
  int failures = 0;
  const std::string name = type.info().name;
  for (int round = 0; round < o.rounds && !outputLost(); ++round) {
    const std::uint64_t seed = o.seed + static_cast<std::uint64_t>(round);
    Parameters parameters = exampleParameters(type.info(), seed);
    for (const std::string& text : o.parameters) readParameter(text, parameters);
    clearLiveLine();
    std::printf("%s, seed %llu%s\n", heading(name).c_str(), static_cast<unsigned long long>(seed), showParameters(parameters).c_str());
    progress.at(done + round, name);
    const int failed = checkInChild(o, [&](const GroupHandler& group) { return check(type, parameters, seed, group); });
    if (failed < 0) return failures + 1;
    failures += failed;
  }
  return failures;
}

template <class Loaded>
void check(const CheckOptions& o, const Loaded& loaded) {
  const Trust trust = o.any_plugin ? Trust::any : Trust::owner_only;
  // Only this file is checked: an older build in the path would own its type names.
  unsetenv("DYN_PLUGIN_PATH");
  JointRegistry registry = JointRegistry::standard(trust);
  timed("loaded " + o.file, [&] { registry.load(o.file, trust); });
  const PluginRecord& record = recordOf(registry, o.file);
  loaded();
  const AllocationCount allocations = canCountAllocations() ? AllocationCount(allocationCount) : AllocationCount();
  if (!canCountAllocations()) std::printf("allocations are not counted in this build\n");

  Progress progress(o.rounds * (o.type.empty() ? static_cast<double>(record.types.size()) : 1), "rounds");
  int types = 0, failures = 0;
  if (!record.remark.empty()) {
    ++failures;
    std::printf("  %s  loading\n          %s\n", failed().c_str(), record.remark.c_str());
  }
  for (const std::string& name : record.types) {
    if (!o.type.empty() && name != o.type) continue;
    const double done = types++ * o.rounds;
    for (const JointType* type : registry.jointTypes())
      if (name == type->info().name)
        failures += checkType(
            *type, o,
            [&](const JointType& t, const Parameters& p, std::uint64_t seed, const GroupHandler& group) {
              return checkJointType(t, p, registry, seed, allocations, group);
            },
            progress, done);
    for (const CouplingType* type : registry.couplingTypes())
      if (name == type->info().name)
        failures += checkType(
            *type, o,
            [&](const CouplingType& t, const Parameters& p, std::uint64_t seed, const GroupHandler& group) {
              group("coupling");
              return checkCouplingType(t, p, seed, allocations);
            },
            progress, done);
  }
  if (types == 0) {
    const std::string near = nearNames(o.type, record.types);
    throw Error(ErrorCode::argument, "has no type '" + o.type + "'" + (near.empty() ? "; it has " + CLI::detail::join(record.types, " ") : near),
                {o.file, 0, ""});
  }
  clearLiveLine();
  if (!record.fast.empty()) std::printf("checked with it: %s\n", record.fast.c_str());
  printUnchecked(record);
  std::printf("%d types, %d checks failed\n", types, failures);
  if (failures > 0) throw ExitCode{1};
}

/// Runs everything in a child process that must report its end.
void run(const CheckOptions& o) {
  constexpr int loaded = 0, done = 1;
  const Interruption interruption;
  Child child;
  const auto say = [&](int part) { child.say("=" + std::to_string(part)); };
  if (child.here()) {
    try {
      check(o, [&] { say(loaded); });
    } catch (...) {  // main() prints the message
      say(done);
      throw;
    }
    return say(done);
  }
  Report report = child.listen(o.time_limit, loaded);
  // After loading, each group of checks has its own time limit.
  if (report.number == loaded) report = child.listen(1e6, done);
  const int status = child.end(report);
  interruption.end();
  if (report.number == done && WIFEXITED(status)) throw ExitCode{WEXITSTATUS(status)};
  printUnended(o, report, status, "loading " + o.file);
  throw ExitCode{1};
}

}  // namespace

void addPluginCheck(CLI::App& plugin) {
  CLI::App* sub = addCommand(plugin, "check", "runs the conformance checks on every type of a shared object; exit code 1 on a failure");
  auto o = std::make_shared<CheckOptions>();
  sub->add_option("FILE", o->file, "the shared object")->type_name("FILE")->check(fileName())->required();
  sub->add_option("--type", o->type, "this type only");
  sub->add_option("--parameters", o->parameters, "name=1,2,3: instead of the parameters made up from the schema (repeatable)");
  sub->add_option("--seed", o->seed, "of the first round")->capture_default_str();
  sub->add_option("--rounds", o->rounds, "rounds per type, each with another seed")->check(inRange(1, 1000))->capture_default_str();
  sub->add_option("--time-limit", o->time_limit, "of a group of checks [s]; each type is checked in a process of its own")
      ->check(inRange(0.001, 1e6))
      ->capture_default_str();
  sub->add_flag("--any-plugin", o->any_plugin, "load plugins that others can write, too");
  sub->callback([o] { run(*o); });
}

}  // namespace dyn::tool
