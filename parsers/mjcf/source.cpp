// SPDX-License-Identifier: BSD-2-Clause
#include "source.hpp"

#include "common/paths.hpp"

#include <dyn/file.hpp>

#include <cstring>
#include <filesystem>

namespace dyn::mjcf {

namespace fs = std::filesystem;
using reader::resolvedPath;

namespace {

bool isThere(const fs::path& path) {
  std::error_code error;
  return fs::exists(path, error);
}
bool isFile(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error);
}

}  // namespace

Source::Source(const std::string& text, const std::string& file, Files files)
    : folder_(fs::path(file).parent_path().string()), files_(files), bytes_(text.size()) {
  seen_.emplace(resolvedPath(file).string(), Where{file, 0, ""});
  add(std::make_unique<xml::Document>(text, file, "mujoco"));
  findIncludes(*documents_.front(), 0);
}

void Source::add(std::unique_ptr<xml::Document> document) {
  document_.emplace(document->robot().GetDocument(), document.get());
  documents_.push_back(std::move(document));
}

void Source::checkAllowed(const XMLElement& e, const std::string& path) const {
  if (files_ == Files::beside && !reader::isInside(path, resolvedPath(folder_.empty() ? "." : folder_)))
    fail(e, "names the file '" + path + "', which is outside the model's folder; Files::anywhere (--files anywhere) reads it all the same",
         ErrorCode::file);
  if (!isThere(path)) fail(e, "names the file '" + path + "', which does not exist", ErrorCode::file);
  if (!isFile(path)) fail(e, "names '" + path + "', which is not a file", ErrorCode::file);
}

void Source::include(const XMLElement& e, int depth) {
  if (depth > deepest) fail(e, "includes are nested deeper than " + std::to_string(deepest), ErrorCode::syntax);
  if (e.FirstChildElement() != nullptr) fail(e, "<include> has elements of its own; the included file takes its place", ErrorCode::syntax);
  const std::string name = of(e).text(e, "file");
  // A name begins in the folder of the including file, or else in that of the main file.
  fs::path file = fs::path(of(e).file()).parent_path() / name;
  if (!isThere(file)) file = fs::path(folder_) / name;
  const std::string path = file.string();
  checkAllowed(e, path);
  if (const auto [first, is_new] = seen_.emplace(resolvedPath(path).string(), where(e)); !is_new)
    fail(e,
         first->second.line == 0 ? "the file '" + name + "' includes itself"
                                 : "the file '" + name + "' is included twice; the other <include> is at " + first->second.file + ":" +
                                       std::to_string(first->second.line),
         ErrorCode::syntax);
  const std::string text = readFile(path, bytes_ < xml::largest_file ? xml::largest_file - bytes_ : 0);
  bytes_ += text.size();
  add(std::make_unique<xml::Document>(text, path, nullptr));
  const xml::Document& document = *documents_.back();
  if (std::strcmp(document.robot().Name(), "include") == 0) fail(e, "the file '" + name + "' has <include> as its root element", ErrorCode::syntax);
  included_.emplace(&e, &document);
  findIncludes(document, depth + 1);
}

void Source::findIncludes(const xml::Document& document, int depth) {
  std::vector<const XMLElement*> left{&document.robot()};
  while (!left.empty()) {
    const XMLElement& e = *left.back();
    left.pop_back();
    if (std::strcmp(e.Name(), "include") == 0) {
      include(e, depth + 1);
      continue;
    }
    // Siblings are visited in the file's order, so that the second of two equal includes is the one that is refused.
    for (const XMLElement* child = e.LastChildElement(); child; child = child->PreviousSiblingElement()) left.push_back(child);
  }
}

std::vector<std::string> Source::notes() const {
  std::vector<std::string> out;
  for (const auto& document : documents_) {
    const bool main = document == documents_.front();
    for (const std::string& note : document->notes()) out.push_back(main ? note : document->file() + ": " + note);
  }
  return out;
}

}  // namespace dyn::mjcf
