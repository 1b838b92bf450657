// SPDX-License-Identifier: BSD-2-Clause
#include "states.hpp"

#include <dyn/algorithm/configuration.hpp>
#include <dyn/algorithm/named_configuration.hpp>
#include <dyn/error.hpp>
#include <dyn/file.hpp>

#include <cmath>
#include <cstdint>
#include <iostream>
#include <random>
#include <sstream>

namespace dyn::tool {

namespace {
/// The key of the first number that is not finite, as "key[3]" in an array; empty if all are finite.
std::string notFinite(const Json& value, const std::string& name) {
  if (value.is_number_float()) return std::isfinite(value.get<double>()) ? "" : name;
  if (!value.is_structured()) return "";
  std::size_t k = 0;
  for (const auto& [key, entry] : value.items()) {
    const std::string inner = value.is_array() ? name + "[" + std::to_string(k++) + "]" : name.empty() ? key : name + "." + key;
    if (std::string found = notFinite(entry, inner); !found.empty()) return found;
  }
  return "";
}
}  // namespace

void requireFinite(const Json& results, const std::string& of) {
  if (const std::string name = notFinite(results, ""); !name.empty())
    throw Error(ErrorCode::argument, of + ": " + name + " is not finite (numbers beyond their range, or a zero quaternion?)");
}

namespace {

Eigen::VectorXd readVector(const nlohmann::json& sample, const char* key, int size, const Where& where, std::size_t index, bool required,
                           bool& given) {
  const std::string place = "sample " + std::to_string(index) + ": " + key;
  const auto found = sample.find(key);
  given = found != sample.end() && !found->is_null();
  if (!given) {
    if (required) throw Error(ErrorCode::syntax, place + " is missing", where);
    return Eigen::VectorXd::Zero(size);
  }
  if (!found->is_array()) throw Error(ErrorCode::syntax, place + " is not an array", where);
  if (static_cast<int>(found->size()) != size)
    throw Error(ErrorCode::size, place + " has " + std::to_string(found->size()) + " entries, the model wants " + std::to_string(size), where);
  Eigen::VectorXd x(size);
  for (int i = 0; i < size; ++i) {
    const nlohmann::json& entry = (*found)[static_cast<std::size_t>(i)];
    if (!entry.is_number()) throw Error(ErrorCode::syntax, place + "[" + std::to_string(i) + "] is not a number", where);
    x[i] = entry.get<double>();
    if (!std::isfinite(x[i])) throw Error(ErrorCode::argument, place + "[" + std::to_string(i) + "] is not finite", where);
  }
  return x;
}

std::string readAll(const std::string& path) {
  constexpr std::uintmax_t most = std::uintmax_t{1} << 30;
  if (path != "-") return readFile(path, most);
  std::ostringstream text;
  char chunk[1 << 16];
  for (std::uintmax_t size = 0; std::cin.read(chunk, sizeof chunk) || std::cin.gcount() > 0;) {
    text.write(chunk, std::cin.gcount());
    size += static_cast<std::uintmax_t>(std::cin.gcount());
    if (size > most) throw Error(ErrorCode::file, "is larger than 1024 MB, the most that is read of states", {"standard input", 0, ""});
  }
  return text.str();
}

/// The index of the sample that contains position `end` of the text: the number of objects of depth two that begin before it, minus one.
std::ptrdiff_t sampleAt(const std::string& text, std::size_t end) {
  std::ptrdiff_t sample = -1;
  int depth = 0;
  bool quoted = false;
  for (std::size_t i = 0; i < std::min(end, text.size()); ++i) {
    if (text[i] == '"' && (i == 0 || text[i - 1] != '\\')) quoted = !quoted;
    if (quoted) continue;
    if (text[i] == '{' && ++depth == 2) ++sample;
    if (text[i] == '}') --depth;
  }
  return sample;
}

[[noreturn]] void notFinite(const std::string& text, std::size_t position, const Where& where) {
  throw Error(ErrorCode::argument, "sample " + std::to_string(sampleAt(text, position)) + ": a number is not finite", where);
}

nlohmann::json parseJson(const std::string& text, const Where& where) {
  try {
    return nlohmann::json::parse(text);
  } catch (const nlohmann::json::parse_error& e) {
    // Some programs write NaN and Infinity, which JSON does not have. The parser stops within the word.
    const std::string near = text.substr(e.byte > 12 ? e.byte - 12 : 0, 24);
    for (const char* word : {"NaN", "nan", "Inf", "inf"})
      if (near.find(word) != std::string::npos) notFinite(text, e.byte, where);
    throw Error(ErrorCode::syntax, std::string("is not JSON: ") + e.what(), where);
  } catch (const nlohmann::json::out_of_range& e) {
    const std::string what = e.what();  // it quotes the number that exceeds the range of a double
    const std::size_t first = what.find('\''), last = what.rfind('\'');
    if (last > first) notFinite(text, text.find(what.substr(first + 1, last - first - 1)), where);
    throw Error(ErrorCode::syntax, "is not JSON that can be used: " + what, where);
  } catch (const nlohmann::json::exception& e) {
    throw Error(ErrorCode::syntax, std::string("is not JSON that can be used: ") + e.what(), where);
  }
}

}  // namespace

std::vector<std::pair<State, nlohmann::json>> readSamples(const std::string& path, const CompactModel& model) {
  const Where where{path == "-" ? "standard input" : path, 0, ""};
  nlohmann::json document = parseJson(readAll(path), where);
  if (!document.is_object() || !document.contains("samples") || !document["samples"].is_array())
    throw Error(ErrorCode::syntax, "has no array \"samples\"", where);
  std::vector<std::pair<State, nlohmann::json>> samples;
  for (nlohmann::json& sample : document["samples"]) {
    const std::size_t i = samples.size();
    if (!sample.is_object()) throw Error(ErrorCode::syntax, "sample " + std::to_string(i) + " is not an object", where);
    State s;
    bool given = false;
    s.q = readVector(sample, "q", model.nq(), where, i, true, given);
    s.v = readVector(sample, "v", model.nv(), where, i, false, s.has_v);
    s.a = readVector(sample, "a", model.nv(), where, i, false, s.has_a);
    s.tau = readVector(sample, "tau", model.nv(), where, i, false, s.has_tau);
    samples.emplace_back(std::move(s), std::move(sample));
  }
  return samples;
}

std::vector<State> readStates(const std::string& path, const CompactModel& model) {
  std::vector<State> states;
  for (auto& [state, entry] : readSamples(path, model)) states.push_back(std::move(state));
  return states;
}

State namedState(const CompactModel& model, const Model& description, const std::string& name) {
  State s;
  s.q = namedConfiguration(model, description, name);
  s.v = namedVelocity(model, description, name);
  s.a = s.tau = Eigen::VectorXd::Zero(model.nv());
  s.has_v = true;
  return s;
}

std::vector<State> randomStates(const CompactModel& model, int count, std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  const auto uniform = [&](double bound) {
    Eigen::VectorXd x(model.nv());
    for (Eigen::Index i = 0; i < x.size(); ++i) x[i] = bound * (static_cast<double>(generator() >> 11) * 0x1p-52 - 1);
    return x;
  };
  std::vector<State> states(static_cast<std::size_t>(count));
  for (State& s : states) {
    s.q = randomConfiguration(model, generator());
    s.v = uniform(1);
    s.a = uniform(1);
    s.tau = uniform(5);
  }
  return states;
}

}  // namespace dyn::tool
