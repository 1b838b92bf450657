// SPDX-License-Identifier: BSD-2-Clause
#include "xml/document.hpp"

#include "common/characters.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <utility>

namespace dyn::xml {

namespace {

bool isSpace(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

enum class Parsed { number, underflow, wrong };

/// Parses one word as a double. from_chars ignores the locale and takes no hexadecimal prefix; trailing units are refused.
Parsed parseNumber(const char* first, const char* last, double& out) {
  if (last - first > 1 && *first == '+' && first[1] != '-') ++first;
  const auto [end, error] = std::from_chars(first, last, out);
  if (end != last || error == std::errc::invalid_argument) return Parsed::wrong;
  if (error == std::errc::result_out_of_range) {
    // Whether the number is too large or too small follows from extended precision, and beyond its range from the exponent's sign.
    long double wide = 0;
    const auto [wide_end, wide_error] = std::from_chars(first, last, wide);
    const bool small = wide_error == std::errc() ? std::fabs(wide) < 1
                                                 : std::string(first, last).find_first_of("eE") != std::string::npos &&
                                                       std::string(first, last).find('-', 1) != std::string::npos;
    if (!small) return Parsed::wrong;
    out = static_cast<double>(wide);
    return Parsed::underflow;
  }
  return std::isfinite(out) ? Parsed::number : Parsed::wrong;
}

int lineOf(const std::string& text, std::size_t position) {
  return 1 + static_cast<int>(std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(position), '\n'));
}

/// Whether the reference "&#...;" at `i` has a number that no character has or XML forbids.
bool standsForNothing(const std::string& text, std::size_t i) {
  const bool hexadecimal = text.compare(i + 2, 1, "x") == 0;
  unsigned long code = 0;
  const char* first = text.data() + i + (hexadecimal ? 3 : 2);
  const auto [end, error] = std::from_chars(first, text.data() + text.size(), code, hexadecimal ? 16 : 10);
  if (end == first || end == text.data() + text.size() || *end != ';') return false;
  return error != std::errc() || isControl(code) || (code >= 0xd800 && code < 0xe000) || code > 0x10ffff;
}

}  // namespace

Document::Document(const std::string& text, std::string file, const char* root) : file_(std::move(file)) {
  const auto refuse = [&](const std::string& why, int line) { throw Error(ErrorCode::syntax, why, {file_, line, ""}); };
  if (text.empty()) refuse("is empty", 0);
  if (text.size() >= 2 && ((text[0] == '\xff' && text[1] == '\xfe') || (text[0] == '\xfe' && text[1] == '\xff')))
    refuse("is UTF-16; save it as UTF-8", 0);
  if (const std::size_t zero = text.find('\0'); zero != std::string::npos)
    refuse("is not a text (or not UTF-8): it has a zero byte", lineOf(text, zero));
  for (std::size_t i = 0, length = 1; i < text.size(); i += length) {
    length = characterAt(text, i);
    if (isControl(static_cast<unsigned char>(text[i])))
      refuse("is not XML: it has the control character " + std::to_string(int(text[i])) + ", which a terminal would obey", lineOf(text, i));
    if (length == 0) refuse("is not UTF-8 (Latin-1, perhaps); save it as UTF-8", lineOf(text, i));
  }
  for (std::size_t i = text.find("&#"); i != std::string::npos; i = text.find("&#", i + 2))
    if (standsForNothing(text, i)) refuse("is not XML: '" + text.substr(i, text.find(';', i) + 1 - i) + "' stands for no character", lineOf(text, i));
  if (const std::size_t type = text.find("<!DOCTYPE"); type != std::string::npos)
    refuse("has a document type, which models do not use and this reader refuses", lineOf(text, type));
  if (xml_.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS) {
    const bool deep = xml_.ErrorID() == tinyxml2::XML_ELEMENT_DEPTH_EXCEEDED;
    refuse(deep ? "nests elements too deep for a model" : std::string("is not XML: ") + xml_.ErrorStr(), xml_.ErrorLineNum());
  }
  robot_ = xml_.RootElement();
  if (robot_ == nullptr) refuse(root ? std::string("has no element <") + root + ">" : "has no element", 1);
  if (root != nullptr && std::strcmp(robot_->Name(), root) != 0)
    refuse(std::string("is another format: its root element is <") + robot_->Name() + ">, not <" + root + ">", 1);
}

void Document::fail(const tinyxml2::XMLElement& e, const std::string& why, ErrorCode code) const { throw Error(code, why, where(e)); }

std::string Document::text(const tinyxml2::XMLElement& e, const char* attribute) const {
  const char* value = e.Attribute(attribute);
  if (value == nullptr) fail(e, std::string("<") + e.Name() + "> has no attribute '" + attribute + "'", ErrorCode::syntax);
  return value;
}

std::vector<double> Document::numbers(const tinyxml2::XMLElement& e, const char* attribute) const {
  const std::string value = text(e, attribute);
  const auto described = [&] { return std::string("<") + e.Name() + " " + attribute + "=\"" + value + "\">"; };
  std::vector<double> out;
  for (const char *p = value.data(), *end = p + value.size(); p != end;) {
    if (isSpace(*p)) {
      ++p;
      continue;
    }
    const char* last = p;
    while (last != end && !isSpace(*last)) ++last;
    double x = 0;
    switch (parseNumber(p, last, x)) {
      case Parsed::number:
        break;
      case Parsed::underflow:
        notes_.push_back("line " + std::to_string(e.GetLineNum()) + ": " + described() + " is too small for a double and became " +
                         (x == 0 ? "0" : "one of fewer digits"));
        break;
      case Parsed::wrong:
        fail(e, described() + ": '" + std::string(p, last) + "' is not a finite number (decimal point, no unit)", ErrorCode::syntax);
    }
    out.push_back(x);
    p = last;
  }
  return out;
}

double Document::number(const tinyxml2::XMLElement& e, const char* attribute) const {
  const std::vector<double> x = numbers(e, attribute);
  if (x.size() != 1)
    fail(e, std::string("<") + e.Name() + "> " + attribute + " must be one number, it has " + std::to_string(x.size()), ErrorCode::syntax);
  return x[0];
}

double Document::number(const tinyxml2::XMLElement& e, const char* attribute, double otherwise) const {
  return e.Attribute(attribute) ? number(e, attribute) : otherwise;
}

Vec3<double> Document::vector3(const tinyxml2::XMLElement& e, const char* attribute) const {
  const std::vector<double> x = numbers(e, attribute);
  if (x.size() != 3)
    fail(e, std::string("<") + e.Name() + "> " + attribute + " must be three numbers, it has " + std::to_string(x.size()), ErrorCode::syntax);
  return {x[0], x[1], x[2]};
}

bool onlyNumbers(const std::string& text, std::vector<double>& out) {
  out.clear();
  for (std::size_t i = 0; i < text.size();) {
    if (isSpace(text[i])) {
      ++i;
      continue;
    }
    std::size_t last = i;
    while (last < text.size() && !isSpace(text[last])) ++last;
    double x = 0;
    if (parseNumber(text.data() + i, text.data() + last, x) == Parsed::wrong) return false;
    out.push_back(x);
    i = last;
  }
  return !out.empty();
}

}  // namespace dyn::xml
