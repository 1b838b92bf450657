// SPDX-License-Identifier: BSD-2-Clause
#include "includes.hpp"

#include "common/paths.hpp"
#include "vocabulary.hpp"
#include "xml/document.hpp"

#include <dyn/file.hpp>

#include <cstdlib>
#include <cstring>
#include <functional>
#include <vector>

namespace dyn::sdf {

namespace fs = std::filesystem;
using reader::isInside;
using reader::resolvedPath;
using tinyxml2::XMLElement;

namespace {

constexpr int deepest = 50;  ///< includes in includes

/// Whether a <uri> is that of an <include> which libsdformat follows.
bool isInclude(const XMLElement& uri) {
  const XMLElement* include = uri.Parent() ? uri.Parent()->ToElement() : nullptr;
  const XMLElement* around = include && include->Parent() ? include->Parent()->ToElement() : nullptr;
  if (around == nullptr || std::strcmp(include->Name(), "include") != 0) return false;
  const std::string name = around->Name();
  return name == "sdf" || name == "world" || name == "model";
}

/// Replaces the texts of the elements <uri> of `text` that are listed, which are counted in the file's order.
std::string withUris(const std::string& text, const std::map<int, std::string>& uris) {
  std::string out;
  int count = -1;
  std::size_t at = 0, copied = 0;
  while ((at = text.find('<', at)) != std::string::npos) {
    const auto skip = [&](const char* end) {
      const std::size_t found = text.find(end, at);
      at = found == std::string::npos ? text.size() : found + std::strlen(end);
    };
    if (text.compare(at, 4, "<!--") == 0) {
      skip("-->");
    } else if (text.compare(at, 9, "<![CDATA[") == 0) {
      skip("]]>");
    } else if (text.compare(at, 4, "<uri") == 0 && at + 4 < text.size() && std::strchr(" \t\r\n/>", text[at + 4]) != nullptr) {
      const auto uri = uris.find(++count);
      skip(">");
      if (uri == uris.end()) continue;
      out += text.substr(copied, at - copied) + uri->second;
      at = copied = std::min(text.find("</uri", at), text.size());
    } else {
      ++at;
    }
  }
  return out + text.substr(copied);
}

}  // namespace

/// Follows the includes of one file after the other.
class Sources::Scan {
 public:
  Scan(Sources& sources, Files files, reader::Notes& notes)
      : sources_(sources), files_(files), notes_(notes), own_(resolvedPath(fs::path(sources.file_).parent_path() / ".")) {}

  /// Checks a text and returns it with its includes replaced by paths of copies.
  std::string checked(const std::string& text, const std::string& file, int depth, std::int64_t& elements, std::uintmax_t& bytes) {
    const xml::Document document(text, file, "sdf");
    std::map<int, std::string> uris;
    int uri_count = 0;
    bytes += text.size();
    Vocabulary vocabulary(document, notes_, depth == 0 ? "" : " of " + fs::path(file).filename().string());
    std::vector<const XMLElement*> left{&document.robot()};
    while (!left.empty()) {
      const XMLElement& e = *left.back();
      left.pop_back();
      ++elements;
      vocabulary.check(e);
      if (std::strcmp(e.Name(), "uri") == 0) {
        if (isInclude(e)) uris[uri_count] = include(document, e, depth, elements, bytes);
        ++uri_count;
      }
      for (const XMLElement* child = e.LastChildElement(); child; child = child->PreviousSiblingElement()) left.push_back(child);
      if (elements > most_elements)
        document.fail(e,
                      "has more than " + std::to_string(most_elements) +
                          " elements, with all that it includes, for which libsdformat would take more than 2 GB; give the model as MJCF, URDF or "
                          ".dyn.json, or in several files, and join their models by append()",
                      ErrorCode::syntax);
      if (bytes > largest_model_file) document.fail(e, "includes more than 64 MB altogether", ErrorCode::file);
    }
    return withUris(text, uris);
  }

 private:
  struct Copy {
    std::string path;
    std::int64_t elements = 0;
    std::uintmax_t bytes = 0;
    bool open = true;  ///< it is being read, so that an include of it is a circle
  };

  /// Returns the path of the copy of the file that an <include>'s <uri> names.
  std::string include(const xml::Document& document, const XMLElement& uri, int depth, std::int64_t& elements, std::uintmax_t& bytes) {
    const std::string name = uri.GetText() ? uri.GetText() : "";
    if (name.empty() || uri.FirstChildElement() != nullptr) document.fail(uri, "<uri> of an <include> names no file", ErrorCode::syntax);
    if (depth >= deepest) document.fail(uri, "includes are nested deeper than " + std::to_string(deepest), ErrorCode::syntax);
    const std::string path = modelOf(document, uri, find(document, uri, name));
    const auto [found, is_new] = copies_.try_emplace(resolvedPath(path).string());
    Copy& copy = found->second;
    if (is_new) {
      if (sources_.folder_.empty()) {
        std::string pattern = (fs::temp_directory_path() / "dyn-sdf-XXXXXX").string();
        if (mkdtemp(pattern.data()) == nullptr) throw Error(ErrorCode::file, "no temporary folder can be made", {pattern, 0, ""});
        sources_.folder_ = pattern;
      }
      copy.path = (sources_.folder_ / (std::to_string(copies_.size()) + ".sdf")).string();
      const std::string text = readFile(path, largest_model_file);
      replaceFile(copy.path, checked(text, path, depth + 1, copy.elements, copy.bytes));
      sources_.original_[copy.path] = path;
      copy.open = false;
    } else if (copy.open || resolvedPath(path) == resolvedPath(sources_.file_)) {
      document.fail(uri, "the file '" + name + "' includes itself", ErrorCode::syntax);
    }
    elements += copy.elements;
    bytes += copy.bytes;
    return copy.path;
  }

  /// Returns the file or folder that a URI means: seen from the including file, or else from the main file.
  fs::path find(const xml::Document& document, const XMLElement& uri, const std::string& name) const {
    std::string path = name;
    for (const char* scheme : {"model://", "file://"})
      if (path.starts_with(scheme)) path.erase(0, std::strlen(scheme));
    if (path.find("://") != std::string::npos)
      document.fail(uri, "names '" + name + "', which is not on this machine; download it and name the file", ErrorCode::file);
    for (const fs::path& folder : {fs::path(document.file()).parent_path(), own_, own_.parent_path()}) {
      fs::path full = folder / path;
      std::error_code error;
      if (!fs::exists(full, error)) continue;
      if (files_ == Files::beside && !isInside(full, own_))
        document.fail(uri, "names '" + name + "', which is outside the model's folder; Files::anywhere (--files anywhere) reads it all the same",
                      ErrorCode::file);
      return full;
    }
    document.fail(uri, "names '" + name + "', which does not exist", ErrorCode::file);
  }

  /// Returns the SDF file of a folder that has a model.config, the one of the newest version; or the path itself if it is a file.
  std::string modelOf(const xml::Document& document, const XMLElement& uri, const fs::path& path) const {
    std::error_code error;
    if (!fs::is_directory(path, error)) return path.string();
    const fs::path config = path / "model.config";
    if (!fs::exists(config, error)) document.fail(uri, "names the folder '" + path.string() + "', which has no model.config", ErrorCode::file);
    const xml::Document description(readFile(config.string(), largest_model_file), config.string(), "model");
    std::string newest, file;
    for (const XMLElement* e = description.robot().FirstChildElement("sdf"); e; e = e->NextSiblingElement("sdf")) {
      const std::string version = e->Attribute("version") ? e->Attribute("version") : "";
      if (e->GetText() == nullptr || version < newest) continue;
      newest = version;
      file = e->GetText();
    }
    const fs::path full = path / file;
    if (file.empty() || !fs::is_regular_file(full, error)) description.fail(description.robot(), "names no SDF file that exists", ErrorCode::file);
    if (files_ == Files::beside && !isInside(full, own_))
      description.fail(description.robot(), "names a file outside the model's folder", ErrorCode::file);
    return full.string();
  }

  Sources& sources_;
  Files files_;
  reader::Notes& notes_;
  fs::path own_;                          ///< the main file's folder
  std::map<std::string, Copy> copies_{};  ///< by canonical path
};

Sources::Sources(const std::string& text, const std::string& file, Files files, reader::Notes& notes) : file_(file) {
  std::int64_t elements = 0;
  std::uintmax_t bytes = 0;
  try {
    text_ = Scan(*this, files, notes).checked(text, file, 0, elements, bytes);
  } catch (...) {
    std::error_code error;
    if (!folder_.empty()) fs::remove_all(folder_, error);
    throw;
  }
}

Sources::~Sources() {
  std::error_code error;
  if (!folder_.empty()) fs::remove_all(folder_, error);
}

std::string Sources::original(const std::string& path) const {
  const auto found = original_.find(path);
  return found == original_.end() ? file_ : found->second;
}

}  // namespace dyn::sdf
