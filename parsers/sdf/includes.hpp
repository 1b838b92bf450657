// SPDX-License-Identifier: BSD-2-Clause
// The file and all files that it includes, checked before libsdformat reads them: sizes, circles, places, numbers, and elements that nobody reads.
#pragma once

#include "common/reader.hpp"

#include <dyn/parsers/options.hpp>

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

namespace dyn::sdf {

/// The most elements of a file with all that it includes. libsdformat takes about 100 kB for each.
inline constexpr std::int64_t most_elements = 20000;

/// The checked text. If it includes files, their checked copies lie in a folder of this object, and <uri> elements name them. Lines stay as they are.
class Sources {
 public:
  /// Checks a text, which messages call `file`, and the files that it includes. Throws Error(file | syntax | model) with file and line. Notes
  /// elements that this library does not read.
  Sources(const std::string& text, const std::string& file, Files files, reader::Notes& notes);
  ~Sources();
  Sources(const Sources&) = delete;
  Sources& operator=(const Sources&) = delete;

  const std::string& text() const { return text_; }
  /// Returns the name of the file from which libsdformat says that something is.
  std::string original(const std::string& path) const;

 private:
  class Scan;
  std::string text_, file_;
  std::filesystem::path folder_;                 ///< of the copies; empty without includes
  std::map<std::string, std::string> original_;  ///< copy -> file
};

}  // namespace dyn::sdf
