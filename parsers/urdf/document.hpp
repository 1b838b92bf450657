// A URDF file as checked XML: bytes, syntax, and attributes read the same under every locale.
#pragma once

#include <dyn/error.hpp>
#include <dyn/spatial/vector3.hpp>

#include <tinyxml2.h>

#include <cstdint>
#include <string>
#include <vector>

namespace dyn::urdf {

/// No URDF is larger than that.
constexpr std::uintmax_t largest_file = 64u << 20;

class Document {
 public:
  /// Parses; `file` stands for the text in messages. Refuses what is not XML in UTF-8, and document types (entities can grow without
  /// bound). Throws Error(syntax) with the line.
  Document(const std::string& text, std::string file);

  const tinyxml2::XMLElement& robot() const { return *robot_; }
  const std::string& file() const { return file_; }
  Where where(const tinyxml2::XMLElement& e, const std::string& joint = {}) const { return {file_, e.GetLineNum(), joint}; }

  [[noreturn]] void fail(const tinyxml2::XMLElement& e, const std::string& why, ErrorCode code = ErrorCode::model) const;

  /// An attribute that must be there.
  std::string text(const tinyxml2::XMLElement& e, const char* attribute) const;
  /// Finite numbers separated by white space. A number too small for a double becomes 0 and a note.
  std::vector<double> numbers(const tinyxml2::XMLElement& e, const char* attribute) const;
  double number(const tinyxml2::XMLElement& e, const char* attribute) const;
  double number(const tinyxml2::XMLElement& e, const char* attribute, double otherwise) const;
  Vec3<double> vector3(const tinyxml2::XMLElement& e, const char* attribute) const;

  /// Things worth saying that are no errors.
  std::vector<std::string>& notes() const { return notes_; }

 private:
  std::string file_;
  tinyxml2::XMLDocument xml_;
  const tinyxml2::XMLElement* robot_ = nullptr;
  mutable std::vector<std::string> notes_;
};

/// Whether a text is one or more numbers and nothing else; then they are in `out`.
bool onlyNumbers(const std::string& text, std::vector<double>& out);

}  // namespace dyn::urdf
