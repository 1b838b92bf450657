// SPDX-License-Identifier: BSD-2-Clause
// Values of a file of libdyn's own format. They know their place, for messages.
#pragma once

#include "common/characters.hpp"

#include <dyn/model/model.hpp>
#include <dyn/near_names.hpp>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace dyn::json {

/// The words for DeviceDescription::Kind.
inline constexpr std::array<std::string_view, 3> kindNames{"actuator", "tendon", "sensor"};

/// A value of the file, and its place there for messages.
class Value {
 public:
  Value(const nlohmann::json& json, std::string place, const std::string& file) : json_(&json), place_(std::move(place)), file_(&file) {}

  [[noreturn]] void fail(const std::string& what, ErrorCode code = ErrorCode::syntax) const {
    throw Error(code, (place_.empty() ? "the file" : place_) + ": " + what, {*file_, 0, ""});
  }

  /// The members of an object. Throws for one that is not in the list.
  const Value& only(std::initializer_list<const char*> known) const {
    if (!json_->is_object()) fail("must be an object");
    for (const auto& [key, value] : json_->items())
      if (std::none_of(known.begin(), known.end(), [&key = key](const char* name) { return key == name; }))
        fail("has an unknown member '" + printable(key) + "'" + nearNames(key, std::vector<std::string>(known.begin(), known.end())));
    return *this;
  }
  bool has(const char* key) const { return json_->contains(key); }
  Value operator[](const char* key) const {
    if (!json_->is_object() || !has(key)) fail(std::string("has no member '") + key + "'");
    return {(*json_)[key], place_.empty() ? key : place_ + "." + key, *file_};
  }
  template <class Each>
  void each(const Each& one) const {
    if (!json_->is_array()) fail("must be a list");
    for (std::size_t k = 0; k < json_->size(); ++k) one(Value((*json_)[k], place_ + "[" + std::to_string(k) + "]", *file_));
  }
  template <class Each>
  void eachMember(const Each& one) const {
    if (!json_->is_object()) fail("must be an object");
    for (const auto& [key, value] : json_->items()) {
      if (!isPlainText(key)) fail("has a member '" + printable(key) + "' whose name has control characters");
      one(key, Value(value, place_ + "." + key, *file_));
    }
  }

  double number() const {
    if (json_->is_number()) return json_->get<double>();
    if (json_->is_string()) {
      const std::string text = json_->get<std::string>();
      if (text == "inf") return std::numeric_limits<double>::infinity();
      if (text == "-inf") return -std::numeric_limits<double>::infinity();
      if (text == "nan") return std::numeric_limits<double>::quiet_NaN();
    }
    fail("must be a number, \"inf\", \"-inf\" or \"nan\"");
  }
  int integer() const {
    if (!json_->is_number_integer()) fail("must be a whole number");
    const auto x = json_->get<std::int64_t>();
    if (x < std::numeric_limits<int>::min() || x > std::numeric_limits<int>::max()) fail("is out of range");
    return static_cast<int>(x);
  }
  bool boolean() const {
    if (!json_->is_boolean()) fail("must be true or false");
    return json_->get<bool>();
  }
  std::string text() const {
    if (!json_->is_string()) fail("must be a text");
    const auto& text = json_->get_ref<const std::string&>();
    if (!isPlainText(text)) fail("has control characters, which a terminal would obey: '" + printable(text) + "'");
    return text;
  }
  std::vector<double> numbers() const {
    std::vector<double> out;
    each([&](const Value& x) { out.push_back(x.number()); });
    return out;
  }
  std::vector<double> numbers(std::size_t count) const {
    std::vector<double> out = numbers();
    if (out.size() != count) fail("must have " + std::to_string(count) + " numbers, not " + std::to_string(out.size()));
    return out;
  }
  Vec3<double> vector() const {
    const std::vector<double> x = numbers(3);
    return {x[0], x[1], x[2]};
  }
  const nlohmann::json& json() const { return *json_; }

 private:
  const nlohmann::json* json_;
  std::string place_;
  const std::string* file_;
};

inline Where whereOf(const Value& x) {
  Where out;
  if (!x.has("where")) return out;
  const Value where = x["where"];
  where.only({"file", "line", "joint"});
  if (where.has("file")) out.file = where["file"].text();
  if (where.has("line")) out.line = where["line"].integer();
  if (where.has("joint")) out.joint = where["joint"].text();
  return out;
}

inline void read(const Value& x, const char* key, std::vector<double>& out) {
  if (x.has(key)) out = x[key].numbers();
}
inline void read(const Value& x, const char* key, bool& out) {
  if (x.has(key)) out = x[key].boolean();
}
inline void read(const Value& x, const char* key, std::string& out) {
  if (x.has(key)) out = x[key].text();
}

/// Reads groups, end effectors, virtual and passive joints, and named states into the model.
void readGroups(const Value& document, Model& model);

}  // namespace dyn::json
