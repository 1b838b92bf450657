// SPDX-License-Identifier: BSD-2-Clause
#include "messages.hpp"

#include "common/characters.hpp"

#include <console_bridge/console.h>

#include <ostream>
#include <sdf/Console.hh>

namespace dyn::sdf {

namespace {

std::mutex& consoleMutex() {
  static std::mutex mutex;
  return mutex;
}

/// Leaves out the colour and the place in libsdformat's sources, "ESC[1;33mWarning [parser.cc:123]ESC[0m ".
std::string plain(const std::string& line) {
  const std::size_t end = line.find("]\033[0m ");
  return printable(end == std::string::npos ? line : line.substr(end + 6));
}

}  // namespace

Console::Console() : lock_(consoleMutex()) {
  auto& console = *::sdf::Console::Instance();
  console.GetMsgStream().SetStream(&said_);
  // libsdformat tries whether text that is no SDF is a URDF, by urdfdom, which says that it is none.
  console_bridge::noOutputHandler();
}

Console::~Console() {
  console_bridge::restorePreviousOutputHandler();
  ::sdf::Console::Instance()->GetMsgStream().SetStream(&std::cerr);
}

void Console::note(reader::Notes& notes) {
  std::istringstream lines(said_.str());
  said_.str({});
  for (std::string line; std::getline(lines, line);)
    if (const std::string text = plain(line); !text.empty()) notes.add("libsdformat: " + text);
}

void throwFirst(const ::sdf::Errors& errors, const Sources& sources) {
  for (const ::sdf::Error& error : errors) {
    if (error.Code() == ::sdf::ErrorCode::LINK_INERTIA_INVALID) continue;
    const bool of_file = error.Code() == ::sdf::ErrorCode::FILE_READ || error.Code() == ::sdf::ErrorCode::URI_LOOKUP;
    const bool of_syntax = error.Code() == ::sdf::ErrorCode::STRING_READ || error.Code() == ::sdf::ErrorCode::ELEMENT_MISSING ||
                           error.Code() == ::sdf::ErrorCode::ATTRIBUTE_MISSING;
    throw Error(of_file ? ErrorCode::file : (of_syntax ? ErrorCode::syntax : ErrorCode::model), printable(error.Message()),
                {sources.original(error.FilePath().value_or("")), error.LineNumber().value_or(0), ""});
  }
}

void load(const Sources& sources, ::sdf::Root& root, reader::Notes& notes) {
  Console console;
  ::sdf::ParserConfig config;
  config.SetFindCallback([](const std::string&) { return std::string(); });
  ::sdf::Errors errors;
  try {
    errors = root.LoadSdfString(sources.text(), config);
  } catch (const std::exception& e) {
    throw Error(ErrorCode::model, std::string("libsdformat fails: ") + printable(e.what()), {sources.original(""), 0, ""});
  }
  console.note(notes);
  throwFirst(errors, sources);
}

}  // namespace dyn::sdf
