#include "document.hpp"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <utility>

namespace dyn::urdf {

namespace {

constexpr std::uintmax_t largest_file = 64u << 20;

bool isSpace(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

enum class Parsed { number, underflow, wrong };

/// One word as a double. from_chars knows no locale, no hexadecimal prefix and no trailing units.
Parsed parseNumber(const char* first, const char* last, double& out) {
  if (first != last && *first == '+') ++first;
  const auto [end, error] = std::from_chars(first, last, out);
  if (end != last || error == std::errc::invalid_argument) return Parsed::wrong;
  if (error == std::errc::result_out_of_range) {
    // Too large or too small: extended precision has the range to tell, beyond that the exponent's sign.
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

std::size_t lineOf(const std::string& text, std::size_t position) {
  return 1 + static_cast<std::size_t>(std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(position), '\n'));
}

}  // namespace

std::string readFile(const std::string& path) {
  const Where where{path, 0, ""};
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) throw Error(ErrorCode::file, "does not exist", where);
  if (std::filesystem::is_directory(status)) throw Error(ErrorCode::file, "is a folder; give the file", where);
  if (std::filesystem::is_regular_file(status) && std::filesystem::file_size(path, error) > largest_file)
    throw Error(ErrorCode::file, "is larger than 64 MB; no URDF is", where);
  std::ifstream file(path, std::ios::binary);
  if (!file) throw Error(ErrorCode::file, "cannot be opened: " + std::string(std::strerror(errno)), where);
  std::string text;
  char chunk[1 << 16];
  while (file.read(chunk, sizeof chunk) || file.gcount() > 0) {
    text.append(chunk, static_cast<std::size_t>(file.gcount()));
    if (text.size() > largest_file) throw Error(ErrorCode::file, "is larger than 64 MB; no URDF is", where);
  }
  if (file.bad()) throw Error(ErrorCode::file, "cannot be read", where);
  return text;
}

Document::Document(const std::string& text, std::string file) : file_(std::move(file)) {
  const auto refuse = [&](const std::string& why, int line) { throw Error(ErrorCode::syntax, why, {file_, line, ""}); };
  if (text.empty()) refuse("is empty", 0);
  if (text.size() >= 2 && ((text[0] == '\xff' && text[1] == '\xfe') || (text[0] == '\xfe' && text[1] == '\xff')))
    refuse("is UTF-16; save it as UTF-8", 0);
  if (const std::size_t zero = text.find('\0'); zero != std::string::npos)
    refuse("is not a text (or not UTF-8): it has a zero byte", static_cast<int>(lineOf(text, zero)));
  if (const std::size_t type = text.find("<!DOCTYPE"); type != std::string::npos)
    refuse("has a document type, which URDF does not use and this reader refuses", static_cast<int>(lineOf(text, type)));
  if (xml_.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS) {
    const bool deep = xml_.ErrorID() == tinyxml2::XML_ELEMENT_DEPTH_EXCEEDED;
    refuse(deep ? "nests elements too deep; URDF lists links and joints side by side" : std::string("is not XML: ") + xml_.ErrorStr(),
           xml_.ErrorLineNum());
  }
  robot_ = xml_.RootElement();
  if (robot_ == nullptr || std::strcmp(robot_->Name(), "robot") != 0)
    refuse(robot_ ? std::string("is another format: its root element is <") + robot_->Name() + ">, not <robot>" : "has no element <robot>", 1);
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
                         std::to_string(x));
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

}  // namespace dyn::urdf
