// dyn plugin check: the conformance kit on every type of a shared object. Exit code 1 on a failure.
#include "alloc_guard.hpp"
#include "plugin.hpp"

#include <dyn/conformance/conformance.hpp>

#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>

namespace dyn::tool {

namespace {

struct CheckOptions {
  std::string file, type;
  std::vector<std::string> parameters;
  std::uint64_t seed = 1;
  int rounds = 3;
  bool any_plugin = false;
};

/// "name=1,2,3"; what is not made of numbers is a text.
void readParameter(const std::string& text, Parameters& parameters) {
  const std::size_t equals = text.find('=');
  if (equals == 0 || equals == std::string::npos)
    throw Error(ErrorCode::argument, "--parameters '" + text + "': write name=number[,number...] or name=text");
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

/// Each round has another seed: other parameters (unless given), other configurations. Returns how many checks failed.
template <class Type, class Check>
int checkType(const Type& type, const CheckOptions& o, const Check& check) {
  int failures = 0;
  for (int round = 0; round < o.rounds; ++round) {
    const std::uint64_t seed = o.seed + static_cast<std::uint64_t>(round);
    Parameters parameters = exampleParameters(type.info(), seed);
    for (const std::string& text : o.parameters) readParameter(text, parameters);
    std::printf("%s, seed %llu%s\n", type.info().name, static_cast<unsigned long long>(seed), showParameters(parameters).c_str());
    failures += printFindings(check(type, parameters, seed));
  }
  return failures;
}

void run(const CheckOptions& o) {
  const Trust trust = o.any_plugin ? Trust::any : Trust::owner_only;
  // Of this file alone: an older build of it in the path would have its types.
  unsetenv("DYN_PLUGIN_PATH");
  JointRegistry registry = JointRegistry::standard(trust);
  registry.load(o.file, trust);
  const PluginRecord& record = recordOf(registry, o.file);
  const AllocationCount allocations = canCountAllocations() ? AllocationCount(allocationCount) : AllocationCount();
  if (!canCountAllocations()) std::printf("allocations are not counted in this build\n");

  int types = 0, failures = 0;
  for (const std::string& name : record.types) {
    if (!o.type.empty() && name != o.type) continue;
    ++types;
    for (const JointType* type : registry.jointTypes())
      if (name == type->info().name)
        failures += checkType(
            *type, o, [&](const JointType& t, const Parameters& p, std::uint64_t seed) { return checkJointType(t, p, registry, seed, allocations); });
    for (const CouplingType* type : registry.couplingTypes())
      if (name == type->info().name)
        failures += checkType(
            *type, o, [&](const CouplingType& t, const Parameters& p, std::uint64_t seed) { return checkCouplingType(t, p, seed, allocations); });
  }
  if (types == 0) {
    std::string known;
    for (const std::string& name : record.types) known += " " + name;
    throw Error(ErrorCode::argument, "has no type '" + o.type + "'; it has" + known, {o.file, 0, ""});
  }
  std::printf("%d types, %d checks failed\n", types, failures);
  if (failures > 0) throw ExitCode{1};
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
  sub->add_flag("--any-plugin", o->any_plugin, "load plugins that others can write, too");
  sub->callback([o] { run(*o); });
}

}  // namespace dyn::tool
