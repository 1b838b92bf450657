// SPDX-License-Identifier: BSD-2-Clause
// A model file as XML, with its bytes and syntax checked. Attributes mean the same under every locale.
#pragma once

#include <dyn/error.hpp>
#include <dyn/parsers/options.hpp>
#include <dyn/spatial/vector3.hpp>

#include <tinyxml2.h>

#include <cstdint>
#include <string>
#include <vector>

namespace dyn::xml {

/// The most that is read of a file [bytes].
constexpr std::uintmax_t largest_file = largest_model_file;

class Document {
 public:
  /// Parses a text; messages name it `file`. Throws Error(syntax) with the line if the text is not XML in UTF-8, if its first element is not
  /// `root` (null: any), and for document types (entities can grow without bound).
  Document(const std::string& text, std::string file, const char* root);

  /// The first element.
  const tinyxml2::XMLElement& robot() const { return *robot_; }
  const std::string& file() const { return file_; }
  Where where(const tinyxml2::XMLElement& e, const std::string& joint = {}) const { return {file_, e.GetLineNum(), joint}; }

  [[noreturn]] void fail(const tinyxml2::XMLElement& e, const std::string& why, ErrorCode code = ErrorCode::model) const;

  /// Returns an attribute. Throws Error(syntax) if it is missing.
  std::string text(const tinyxml2::XMLElement& e, const char* attribute) const;
  /// Returns finite numbers separated by white space. A number too small for a double becomes 0 or loses digits, with a note.
  std::vector<double> numbers(const tinyxml2::XMLElement& e, const char* attribute) const;
  double number(const tinyxml2::XMLElement& e, const char* attribute) const;
  double number(const tinyxml2::XMLElement& e, const char* attribute, double otherwise) const;
  Vec3<double> vector3(const tinyxml2::XMLElement& e, const char* attribute) const;

  /// Remarks that are not errors.
  std::vector<std::string>& notes() const { return notes_; }

 private:
  std::string file_;
  tinyxml2::XMLDocument xml_;
  const tinyxml2::XMLElement* robot_ = nullptr;
  mutable std::vector<std::string> notes_;
};

/// Whether a text consists of one or more numbers and nothing else. Writes them to `out`.
bool onlyNumbers(const std::string& text, std::vector<double>& out);

}  // namespace dyn::xml
