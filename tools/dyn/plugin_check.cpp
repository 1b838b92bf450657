// dyn plugin check: the conformance kit on every type of a shared object. Exit code 1 on a failure.
#include "alloc_guard.hpp"
#include "plugin.hpp"

#include <dyn/conformance/conformance.hpp>

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
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

/// "name=1,2,3"; what is not made of numbers is a text.
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

int printFindings(const std::vector<ConformanceFinding>& findings) {
  int failures = 0;
  for (const ConformanceFinding& f : findings) {
    failures += f.passed ? 0 : 1;
    if (f.passed && f.bound == 0 && !f.detail.empty()) {  // nothing was measured, something is told
      std::printf("  ok      %-54s %s\n", f.check.c_str(), f.detail.c_str());
    } else if (f.passed) {
      std::printf("  ok      %-54s %8.1e  (<= %.0e)\n", f.check.c_str(), f.error, f.bound);
    } else {
      std::printf("  FAILED  %-54s %8.1e  (<= %.0e)\n          %s\n", f.check.c_str(), f.error, f.bound, f.detail.c_str());
    }
  }
  return failures;
}

/// The record of that file, whatever way it was reached.
const PluginRecord& recordOf(const JointRegistry& registry, const std::string& file) {
  for (const PluginRecord& plugin : registry.plugins()) {
    std::error_code error;
    if (plugin.problem.empty() && std::filesystem::equivalent(plugin.path, file, error)) return plugin;
  }
  throw Error(ErrorCode::plugin, "was loaded but is not among the plugins", {file, 0, ""});
}

using Progress = std::function<void(const char*)>;

/// What a child process reported: a line for each group of checks that it began, and at last "=" and how many failed.
struct Report {
  std::string group;
  int failures = -1;  ///< -1: it did not get that far
  bool late = false;  ///< a group took longer than it may
};

/// Up to its end, or up to "=" and this number.
Report readReport(int pipe, double time_limit, int last = std::numeric_limits<int>::max()) {
  Report report;
  std::string text;
  while (true) {
    pollfd ready{pipe, POLLIN, 0};
    const int n = poll(&ready, 1, static_cast<int>(time_limit * 1000));
    if (n < 0 && errno == EINTR) continue;
    char buffer[512];
    const ssize_t size = n > 0 ? read(pipe, buffer, sizeof buffer) : 0;
    if (size < 0 && errno == EINTR) continue;
    report.late = n == 0;
    if (size <= 0) return report;
    text.append(buffer, static_cast<std::size_t>(size));
    for (std::size_t end; (end = text.find('\n')) != std::string::npos; text.erase(0, end + 1)) {
      if (text[0] == '=') {
        report.failures = std::atoi(text.c_str() + 1);
        if (report.failures == last) return report;
      } else {
        report.group = text.substr(0, end);
      }
    }
  }
}

std::string howItEnded(const CheckOptions& o, const Report& report, int status) {
  if (report.late) {
    char seconds[32];
    std::snprintf(seconds, sizeof seconds, "%g", o.time_limit);
    return std::string("no end within ") + seconds + " s (--time-limit)";
  }
  if (WIFSIGNALED(status)) return std::string("crashed: ") + strsignal(WTERMSIG(status));
  return "code of it ended the process";
}

/// Runs checks in a process of their own, which a type may crash or never leave. Returns how many failed; -1 if they did not end, which is said.
template <class Check>
int checkInChild(const CheckOptions& o, const Check& check) {
  int ends[2];
  std::fflush(stdout);
  if (pipe2(ends, O_CLOEXEC) != 0) throw Error(ErrorCode::file, std::string("no pipe for the checks: ") + std::strerror(errno));
  const pid_t child = fork();
  if (child < 0) throw Error(ErrorCode::file, std::string("no process for the checks: ") + std::strerror(errno));
  if (child == 0) {
    const auto say = [&](const std::string& line) {
      if (write(ends[1], (line + "\n").c_str(), line.size() + 1) < 0) _exit(1);
    };
    const int failures = printFindings(check([&](const char* group) { say(group); }));
    std::fflush(stdout);
    say("=" + std::to_string(failures));
    _exit(0);
  }
  close(ends[1]);
  const Report report = readReport(ends[0], o.time_limit);
  close(ends[0]);
  if (report.late) kill(child, SIGKILL);
  int status = 0;
  pid_t waited;
  do waited = waitpid(child, &status, 0);
  while (waited < 0 && errno == EINTR);
  if (report.failures >= 0) return report.failures;
  std::printf("  FAILED  %s\n          %s\n", report.group.c_str(), howItEnded(o, report, waited == child ? status : 0).c_str());
  return -1;
}

/// Each round has another seed: other parameters (unless given), other configurations. Returns how many checks failed. The first that does not
/// end is the last.
template <class Type, class Check>
int checkType(const Type& type, const CheckOptions& o, const Check& check) {
  int failures = 0;
  for (int round = 0; round < o.rounds; ++round) {
    const std::uint64_t seed = o.seed + static_cast<std::uint64_t>(round);
    Parameters parameters = exampleParameters(type.info(), seed);
    for (const std::string& text : o.parameters) readParameter(text, parameters);
    std::printf("%s, seed %llu%s\n", type.info().name, static_cast<unsigned long long>(seed), showParameters(parameters).c_str());
    const int failed = checkInChild(o, [&](const Progress& progress) { return check(type, parameters, seed, progress); });
    if (failed < 0) return failures + 1;
    failures += failed;
  }
  return failures;
}

void check(const CheckOptions& o, const Progress& progress) {
  const Trust trust = o.any_plugin ? Trust::any : Trust::owner_only;
  // Of this file alone: an older build of it in the path would have its types.
  unsetenv("DYN_PLUGIN_PATH");
  JointRegistry registry = JointRegistry::standard(trust);
  registry.load(o.file, trust);
  const PluginRecord& record = recordOf(registry, o.file);
  progress("=0");
  const AllocationCount allocations = canCountAllocations() ? AllocationCount(allocationCount) : AllocationCount();
  if (!canCountAllocations()) std::printf("allocations are not counted in this build\n");

  int types = 0, failures = 0;
  if (!record.remark.empty()) {
    ++failures;
    std::printf("  FAILED  loading\n          %s\n", record.remark.c_str());
  }
  for (const std::string& name : record.types) {
    if (!o.type.empty() && name != o.type) continue;
    ++types;
    for (const JointType* type : registry.jointTypes())
      if (name == type->info().name)
        failures += checkType(*type, o, [&](const JointType& t, const Parameters& p, std::uint64_t seed, const Progress& group) {
          return checkJointType(t, p, registry, seed, allocations, group);
        });
    for (const CouplingType* type : registry.couplingTypes())
      if (name == type->info().name)
        failures += checkType(*type, o, [&](const CouplingType& t, const Parameters& p, std::uint64_t seed, const Progress& group) {
          group("coupling");
          return checkCouplingType(t, p, seed, allocations);
        });
  }
  if (types == 0) {
    std::string known;
    for (const std::string& name : record.types) known += " " + name;
    throw Error(ErrorCode::argument, "has no type '" + o.type + "'; it has" + known, {o.file, 0, ""});
  }
  std::printf("%d types, %d checks failed\n", types, failures);
  if (failures > 0) throw ExitCode{1};
}

/// In a process of its own, which must say that it has come to its end: code that a plugin runs may end it, with any exit code.
void run(const CheckOptions& o) {
  int ends[2];
  std::fflush(stdout);
  if (pipe2(ends, O_CLOEXEC) != 0) throw Error(ErrorCode::file, std::string("no pipe for the checks: ") + std::strerror(errno));
  const pid_t child = fork();
  if (child < 0) throw Error(ErrorCode::file, std::string("no process for the checks: ") + std::strerror(errno));
  if (child == 0) {
    const auto say = [&](const char* line) {
      if (write(ends[1], (std::string(line) + "\n").c_str(), std::strlen(line) + 1) < 0) _exit(1);
    };
    try {
      check(o, say);
    } catch (...) {  // what it says is main()'s to print
      say("=1");
      throw;
    }
    say("=1");
    return;
  }
  close(ends[1]);
  // "=0": it is loaded, and from there on each group of checks has its own time; "=1": it is done.
  Report report = readReport(ends[0], o.time_limit, 0);
  if (report.failures == 0) report = readReport(ends[0], 1e6, 1);
  close(ends[0]);
  if (report.late) kill(child, SIGKILL);
  int status = 0;
  pid_t waited;
  do waited = waitpid(child, &status, 0);
  while (waited < 0 && errno == EINTR);
  if (report.failures == 1 && waited == child && WIFEXITED(status)) throw ExitCode{WEXITSTATUS(status)};
  std::printf("  FAILED  loading %s\n          %s\n", o.file.c_str(), howItEnded(o, report, waited == child ? status : 0).c_str());
  throw ExitCode{1};
}

}  // namespace

void addPluginCheck(CLI::App& plugin) {
  CLI::App* sub = plugin.add_subcommand("check", "runs the conformance checks on every type of a shared object; exit code 1 on a failure");
  auto o = std::make_shared<CheckOptions>();
  sub->add_option("FILE", o->file, "the shared object")->required();
  sub->add_option("--type", o->type, "this type only");
  sub->add_option("--parameters", o->parameters, "name=1,2,3: instead of the parameters made up from the schema (repeatable)");
  sub->add_option("--seed", o->seed, "of the first round")->capture_default_str();
  sub->add_option("--rounds", o->rounds, "rounds per type, each with another seed")->check(CLI::Range(1, 1000))->capture_default_str();
  sub->add_option("--time-limit", o->time_limit, "of a group of checks [s]; each type is checked in a process of its own")
      ->check(CLI::Range(0.001, 1e6))
      ->capture_default_str();
  sub->add_flag("--any-plugin", o->any_plugin, "load plugins that others can write, too");
  sub->callback([o] { run(*o); });
}

}  // namespace dyn::tool
