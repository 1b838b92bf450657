// SPDX-License-Identifier: BSD-2-Clause
#include "common/reader.hpp"

#include <dyn/file.hpp>
#include <dyn/near_names.hpp>
#include <dyn/parsers/load.hpp>
#include <dyn/parsers/mjcf.hpp>
#ifdef DYN_HAS_LUA
#include <dyn/parsers/lua.hpp>
#endif
#ifdef DYN_HAS_SDF
#include <dyn/parsers/sdf.hpp>
#endif

#include <algorithm>
#include <cctype>
#include <cstring>

namespace dyn {

namespace {

/// Returns the text from its first character that is no white space, behind a byte order mark.
std::string_view begin(const std::string& text) {
  std::string_view rest(text);
  if (rest.starts_with("\xef\xbb\xbf")) rest.remove_prefix(3);
  while (!rest.empty() && std::isspace(static_cast<unsigned char>(rest.front()))) rest.remove_prefix(1);
  return rest;
}

/// Returns the name of an XML text's first element; empty if there is none.
std::string_view rootElement(const std::string& text) {
  for (std::string_view rest = begin(text); rest.starts_with('<');) {
    const bool comment = rest.starts_with("<!--");
    if (!comment && !rest.starts_with("<?") && !rest.starts_with("<!")) return rest.substr(1, rest.find_first_of(" \t\r\n/>", 1) - 1);
    const std::size_t end = rest.find(comment ? "-->" : ">");
    if (end == std::string_view::npos) break;
    rest = rest.substr(std::min(rest.size(), rest.find('<', end)));
  }
  return {};
}

bool isUrdf(const std::string& text) { return rootElement(text) == "robot"; }
bool isMjcf(const std::string& text) { return rootElement(text) == "mujoco"; }
bool isSdf(const std::string& text) { return rootElement(text) == "sdf"; }
bool isJson(const std::string& text) { return begin(text).starts_with('{'); }
/// A Lua model begins with a comment or a name, and returns a table.
bool isLua(const std::string& text) {
  const std::string_view rest = begin(text);
  const bool name = !rest.empty() && (std::isalpha(static_cast<unsigned char>(rest.front())) || rest.front() == '_');
  return (name || rest.starts_with("--")) && rest.find("return") != std::string_view::npos;
}
bool never(const std::string&) { return false; }

Model parseJson(const std::string& text, const std::string& path, const LoadOptions&) { return json::parse(text, path); }

/// A format's row of the table: how its files are recognised, and its reader.
struct Row {
  const char* name;
  std::vector<std::string> endings;
  bool (*recognises)(const std::string& text);  ///< by content
  std::uintmax_t largest;                       ///< most that is read of a file [bytes]
  Model (*parse)(const std::string& text, const std::string& path, const LoadOptions& options);
  std::vector<Error> (*check)(const std::string& path, const LoadOptions& options);  ///< null: the reader stops at the first error
  const char* missing;                                                               ///< why there is no reader
  bool has_root = false;  ///< models have their joint between world and robot, so that no root joint applies
};

constexpr std::uintmax_t usual = largest_model_file;

const std::vector<Row>& rows() {
  static const std::vector<Row> table{
      {"urdf", {".urdf"}, isUrdf, usual, urdf::parse, urdf::check, ""},
      {"mjcf", {".mjcf"}, isMjcf, usual, mjcf::parse, mjcf::check, ""},
      {"json", {".json"}, isJson, json::largest_file, parseJson, nullptr, "", true},
#ifdef DYN_HAS_SDF
      {"sdf", {".sdf", ".world"}, isSdf, usual, sdf::parse, nullptr, ""},
#else
      {"sdf", {".sdf", ".world"}, isSdf, usual, nullptr, nullptr, "this libdyn was built without SDF; build it with -DDYN_BUILD_SDF=ON"},
#endif
#ifdef DYN_HAS_LUA
      {"lua", {".lua"}, isLua, usual, lua::parse, nullptr, ""},
#else
      {"lua", {".lua"}, isLua, usual, nullptr, nullptr, "this libdyn was built without Lua; build it with -DDYN_BUILD_LUA=ON"},
#endif
      {"xacro", {".xacro"}, never, usual, nullptr, nullptr, "is a xacro file, which makes a URDF; run `xacro FILE > robot.urdf` and load that"},
  };
  return table;
}

std::string listed() {
  std::string out;
  for (const Row& row : rows())
    if (row.parse != nullptr) out += (out.empty() ? "" : ", ") + std::string(row.name) + " (" + row.endings.front() + ")";
  return out;
}

const Row& rowNamed(const std::string& name, const std::string& path) {
  std::vector<std::string> names;
  for (const Row& row : rows()) {
    if (row.name == name) return row;
    names.emplace_back(row.name);
  }
  throw Error(ErrorCode::argument, "there is no format '" + name + "'" + nearNames(name, names) + "; formats are " + listed(), {path, 0, ""});
}

/// Returns the row of the format that is given, or that the file's ending tells; null if neither does.
const Row* rowByName(const std::string& path, const std::string& format) {
  if (!format.empty()) return &rowNamed(format, path);
  for (const Row& row : rows())
    if (std::any_of(row.endings.begin(), row.endings.end(), [&](const std::string& e) { return path.ends_with(e); })) return &row;
  return nullptr;
}

const Row& rowByContent(const std::string& text, const std::string& path) {
  for (const Row& row : rows())
    if (row.recognises(text)) return row;
  if (text.empty()) throw Error(ErrorCode::syntax, "is empty", {path, 0, ""});
  const std::string root(rootElement(text).substr(0, 40));
  throw Error(
      ErrorCode::syntax,
      (root.empty() ? "is no model by its ending or content" : "is another format: its root element is <" + root + ">") + "; formats are " + listed(),
      {path, 0, ""});
}

/// A file whose format is known.
struct Opened {
  const Row& row;
  std::string text;
};

/// Finds a file's format. Reads the file for that if need be, or if it is `wanted` with these options.
Opened open(const std::string& path, const std::string& format, const LoadOptions* wanted) {
  const Row* row = rowByName(path, format);
  std::string text;
  if (row == nullptr) {
    text = readFile(path, json::largest_file);
    row = &rowByContent(text, path);
    if (text.size() > row->largest) readFile(path, row->largest);  // says so
  }
  if (row->parse == nullptr) {
    std::string why = row->missing;
    if (const std::size_t at = why.find("FILE"); at != std::string::npos) why.replace(at, 4, path);
    throw Error(row->recognises == never ? ErrorCode::syntax : ErrorCode::argument, why, {path, 0, ""});
  }
  if (wanted != nullptr && row->has_root && wanted->root != LoadOptions().root) reader::refuseRoot(wanted->root, path);
  if (wanted != nullptr && text.empty()) text = readFile(path, row->largest);
  return {*row, std::move(text)};
}

}  // namespace

std::vector<ModelFormat> modelFormats() {
  std::vector<ModelFormat> out;
  for (const Row& row : rows()) out.push_back({row.name, row.endings, row.missing});
  return out;
}

Model load(const std::string& path, const LoadOptions& options, const std::string& format) {
  const Opened file = open(path, format, &options);
  return file.row.parse(file.text, path, options);
}

std::vector<Error> check(const std::string& path, const LoadOptions& options, const std::string& format) {
  try {
    const Opened file = open(path, format, nullptr);
    if (file.row.check != nullptr) return file.row.check(path, options);
    load(path, options, file.row.name);
    return {};
  } catch (const Error& e) {
    return {e};
  }
}

}  // namespace dyn
