// SPDX-License-Identifier: BSD-2-Clause
#include "codegen/names.hpp"

#include <dyn/error.hpp>

#include <algorithm>
#include <cctype>
#include <set>
#include <string>

namespace dyn {

namespace {

bool isName(const std::string& text) {
  static const std::string words =
      " auto break case char const continue default do double else enum extern float for goto if inline int long register restrict return short "
      "signed sizeof static struct switch typedef union unsigned void volatile while ";
  if (words.find(" " + text + " ") != std::string::npos) return false;
  if (text.empty() || std::isdigit(static_cast<unsigned char>(text[0]))) return false;
  return std::all_of(text.begin(), text.end(), [](unsigned char c) { return c == '_' || (c < 128 && std::isalnum(c)); });
}

}  // namespace

void checkSource(const std::vector<TracedFunction>& functions, const SourceOptions& options) {
  std::set<std::string> known;
  for (const TracedFunction& f : functions) {
    if (!isName(options.prefix + f.name)) throw Error(ErrorCode::argument, "'" + options.prefix + f.name + "' is no name in C");
    if (!known.insert(f.name).second) throw Error(ErrorCode::argument, "function '" + f.name + "' is asked for twice");
    std::set<std::string> arguments{"w", "s", "c", "T", "V", "angle"};
    for (const auto* list : {&f.inputs, &f.outputs})
      for (const ArgumentShape& a : *list)
        if (!isName(a.name) || a.name.starts_with("dyn_") || a.name.starts_with("DYN_") || a.name.starts_with(options.prefix + f.name + "_") ||
            !arguments.insert(a.name).second || !arguments.insert(a.name + "_").second)
          throw Error(ErrorCode::argument, "function '" + f.name + "' cannot have an argument '" + a.name +
                                               "', which is there twice, is no name in C, or is one of the code's own; call it otherwise");
  }
  if (options.lanes < 1 || options.lanes > 64 || (options.lanes & (options.lanes - 1)) != 0)
    throw Error(ErrorCode::argument, std::to_string(options.lanes) + " lanes; it takes 1, 2, 4, ... 64");
  if (options.piece < 1) throw Error(ErrorCode::argument, "a piece of " + std::to_string(options.piece) + " operations; it takes 1 at least");
}

}  // namespace dyn
