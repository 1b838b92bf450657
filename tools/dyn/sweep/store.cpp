// SPDX-License-Identifier: BSD-2-Clause
#include "store.hpp"

#include "folder.hpp"
#include "messages.hpp"
#include "sha256.hpp"

#include <dyn/file.hpp>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <set>

namespace dyn::tool::sweep {

namespace fs = std::filesystem;

namespace {

constexpr int format = 1;  ///< of the files in the folder
constexpr std::size_t digest_length = 64;
static_assert(std::endian::native == std::endian::little, "chunks have the bytes of little-endian machines");

/// The first line of a chunk's file, as JSON. Throws Error(syntax).
nlohmann::json headOf(const std::string& line, const std::string& path) {
  nlohmann::json head = nlohmann::json::parse(line, nullptr, false);
  if (head.is_object() && head.value("libdyn_sweep_chunk", 0) == format) return head;
  throw Error(ErrorCode::syntax, "is no chunk of a sweep", {path, 0, ""});
}

}  // namespace

FolderLock::FolderLock(const std::string& folder) {
  const std::string path = folder + "/lock";
  file_ = open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (file_ < 0) throw Error(ErrorCode::file, std::string("cannot be written: ") + std::strerror(errno), {path, 0, ""});
  if (flock(file_, LOCK_EX | LOCK_NB) == 0) return;
  const int why = errno;
  close(file_);
  if (why == EWOULDBLOCK) throw Error(ErrorCode::file, "another sweep runs in this folder", {folder, 0, ""});
  throw Error(ErrorCode::file, std::string("cannot be locked: ") + std::strerror(why), {path, 0, ""});
}

FolderLock::~FolderLock() { close(file_); }

bool FolderLock::held(const std::string& folder) {
  const int file = open((folder + "/lock").c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return false;
  const bool free = flock(file, LOCK_SH | LOCK_NB) == 0;
  close(file);
  return !free;
}

std::string Manifest::text() const {
  Json out;
  out["libdyn_sweep"] = format;
  out["version"] = version;
  out["instruction_set"] = instruction_set;
  out["model_sha256"] = model_sha256;
  if (!file_sha256.empty()) out["file_sha256"] = file_sha256;
  out["host"] = host;
  out["samples"] = samples;
  out["chunk"] = chunk;
  out["seed"] = seed;
  out["fields"] = fields;
  out["pairs"] = pairs;
  out["study_name"] = study_name;
  out["study_folder"] = study_folder;
  out["study"] = study;
  return out.dump(1) + "\n";
}

bool Store::begun() const { return fs::exists(path("manifest.json")); }
bool Store::finished() const { return fs::exists(results()); }

void Store::begin(const Manifest& manifest) const {
  makeFolder(path("chunks"));
  replaceFile(path("manifest.json"), manifest.text());
}

Manifest Store::manifest() const {
  const std::string file = path("manifest.json");
  if (!begun()) throw Error(ErrorCode::file, "there is no sweep in this folder", {folder_, 0, ""});
  try {
    const Json x = Json::parse(readFile(file, std::uintmax_t{1} << 28));
    if (x.at("libdyn_sweep") != format) throw Error(ErrorCode::syntax, "is of another version of libdyn", {file, 0, ""});
    Manifest out{x.at("version"),      x.at("instruction_set"), x.at("model_sha256"),      x.at("host"),  x.at("study_name"),
                 x.at("study_folder"), x.at("study"),           x.at("samples"),           x.at("chunk"), x.at("seed"),
                 x.at("fields"),       x.at("pairs"),           x.value("file_sha256", "")};
    if (out.samples < 1 || out.chunk < 1) throw Error(ErrorCode::syntax, "is damaged", {file, 0, ""});
    return out;
  } catch (const nlohmann::json::exception& e) {
    throw Error(ErrorCode::syntax, std::string("is damaged: ") + e.what(), {file, 0, ""});
  }
}

std::string Store::chunkPath(std::int64_t number) const { return path("chunks/" + std::to_string(number)); }

std::vector<std::int64_t> Store::missing(const Manifest& manifest, std::size_t numbers_a_sample) const {
  std::vector<std::int64_t> out;
  for (std::int64_t number = 0; number < manifest.chunks(); ++number) {
    if (fs::exists(chunkPath(number))) {
      try {
        read(manifest, number, numbers_a_sample);
        continue;
      } catch (const Error& e) {
        warning(std::string(e.what()) + "; it is computed again");
        fs::remove(chunkPath(number));
      }
    }
    out.push_back(number);
  }
  return out;
}

void Store::write(const Manifest& manifest, std::int64_t number, const Chunk& chunk) const {
  nlohmann::json head = {{"libdyn_sweep_chunk", format}, {"first", chunk.first}, {"count", chunk.count}, {"failures", nlohmann::json::array()}};
  for (const Failure& failure : chunk.failures) head["failures"].push_back({failure.sample, failure.reason});
  std::string text = head.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace) + "\n";
  text.append(reinterpret_cast<const char*>(chunk.numbers.data()), chunk.numbers.size() * sizeof(double));
  text += sha256(text);
  if (manifest.chunks() <= number) throw Error(ErrorCode::argument, "there is no such chunk");
  replaceFile(chunkPath(number), text);
}

Chunk Store::read(const Manifest& manifest, std::int64_t number, std::size_t numbers_a_sample) const {
  const std::string file = chunkPath(number), text = readFile(file);
  const auto damaged = [&] { return Error(ErrorCode::syntax, "is damaged", {file, 0, ""}); };
  const std::size_t line = text.find('\n');
  if (line == std::string::npos || text.size() < line + 1 + digest_length) throw damaged();
  if (sha256(std::string_view(text).substr(0, text.size() - digest_length)) != text.substr(text.size() - digest_length)) throw damaged();
  const nlohmann::json head = headOf(text.substr(0, line), file);
  Chunk out{head.at("first"), head.at("count"), {}, {}};
  const std::size_t bytes = text.size() - digest_length - line - 1;
  if (out.first != manifest.first(number) || out.count != manifest.count(number) ||
      bytes != static_cast<std::size_t>(out.count) * numbers_a_sample * sizeof(double))
    throw damaged();
  for (const nlohmann::json& failure : head.at("failures")) out.failures.push_back({failure.at(0), failure.at(1)});
  out.numbers.resize(bytes / sizeof(double));
  std::memcpy(out.numbers.data(), text.data() + line + 1, bytes);
  return out;
}

void Store::removeChunks() const {
  std::error_code ignored;
  fs::remove_all(path("chunks"), ignored);
}

Json Store::status() const {
  const Manifest m = manifest();
  Json out = {
      {"samples", m.samples},   {"done", 0}, {"failed", 0}, {"running", FolderLock::held(folder_)}, {"finished", finished()}, {"rate", nullptr},
      {"seconds_left", nullptr}};
  out["host"] = m.host;
  Json reasons = Json::array();
  const auto note = [&](std::int64_t sample, const std::string& reason) {
    out["failed"] = out["failed"].get<std::int64_t>() + 1;
    if (reasons.size() < 10) reasons.push_back({{"sample", sample}, {"reason", reason}});
  };
  if (finished()) {
    out["done"] = m.samples;
    std::ifstream lines(failures());
    for (std::string line; std::getline(lines, line);) {
      const nlohmann::json entry = nlohmann::json::parse(line, nullptr, false);
      if (entry.is_object()) note(entry.value("sample", std::int64_t{0}), entry.value("reason", std::string()));
    }
  } else {
    std::int64_t done = 0;
    std::vector<std::pair<fs::file_time_type, std::int64_t>> written;
    for (std::int64_t number = 0; number < m.chunks(); ++number) {
      std::ifstream file(chunkPath(number));
      std::string line;
      if (!file || !std::getline(file, line)) continue;
      std::error_code failed;
      written.emplace_back(fs::last_write_time(chunkPath(number), failed), m.count(number));
      const nlohmann::json head = headOf(line, chunkPath(number));
      done += m.count(number);
      for (const nlohmann::json& failure : head.at("failures")) note(failure.at(0), failure.at(1));
    }
    out["done"] = done;
    // The rate is that of the last chunks, since the sweep may have been resumed.
    std::sort(written.begin(), written.end());
    if (written.size() > 50) written.erase(written.begin(), written.end() - 50);
    if (written.size() > 1) {
      const double seconds = std::chrono::duration<double>(written.back().first - written.front().first).count();
      double samples = 0;
      for (std::size_t k = 1; k < written.size(); ++k) samples += static_cast<double>(written[k].second);
      if (seconds > 0) {
        out["rate"] = samples / seconds;
        out["seconds_left"] = static_cast<double>(m.samples - done) * seconds / samples;
      }
    }
  }
  out["reasons"] = reasons;
  return out;
}

}  // namespace dyn::tool::sweep
