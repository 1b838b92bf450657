// SPDX-License-Identifier: BSD-2-Clause
#include "values.hpp"

#include "vocabulary.hpp"

#include <dyn/near_names.hpp>

#include <cmath>
#include <cstring>
#include <set>

namespace dyn::mjcf {

std::string Values::described() const {
  const char* name = e_.Attribute("name");
  return std::string("<") + e_.Name() + ">" + (name ? std::string(" '") + name + "'" : "");
}

const XMLElement* Values::holder(const char* attribute) const {
  if (e_.Attribute(attribute)) return &e_;
  if (inherited_ == nullptr) return nullptr;
  const auto found = inherited_->attributes.find(attribute);
  return found == inherited_->attributes.end() ? nullptr : found->second;
}

std::string Values::text(const char* attribute, const std::string& otherwise) const {
  const XMLElement* e = holder(attribute);
  return e ? e->Attribute(attribute) : otherwise;
}

double Values::number(const char* attribute, double otherwise) const {
  const XMLElement* e = holder(attribute);
  return e ? s_.of(*e).number(*e, attribute) : otherwise;
}

double Values::positive(const char* attribute, double otherwise) const {
  const double x = number(attribute, otherwise);
  if (x < 0) fail(described() + ": its " + attribute + " is negative");
  return x;
}

int Values::integer(const char* attribute, int otherwise) const {
  const double x = number(attribute, otherwise);
  if (x != std::floor(x) || std::fabs(x) >= 0x1p31) fail(described() + ": " + attribute + " must be a whole number", ErrorCode::syntax);
  return static_cast<int>(x);
}

std::vector<double> Values::numbers(const char* attribute, std::size_t least, std::size_t most) const {
  const XMLElement* e = holder(attribute);
  if (e == nullptr) fail(described() + " has no attribute '" + attribute + "'", ErrorCode::syntax);
  std::vector<double> x = s_.of(*e).numbers(*e, attribute);
  if (x.size() < least || x.size() > most)
    s_.fail(*e,
            std::string("<") + e->Name() + "> " + attribute + " must have " + (least == most ? "" : std::to_string(least) + " to ") +
                std::to_string(most) + (most == 1 ? " number, it has " : " numbers, it has ") + std::to_string(x.size()),
            ErrorCode::syntax);
  return x;
}

Vec3<long double> Values::vector3(const char* attribute, const Vec3<long double>& otherwise) const {
  if (!has(attribute)) return otherwise;
  const std::vector<double> x = numbers(attribute, 3, 3);
  return {x[0], x[1], x[2]};
}

int Values::word(const char* attribute, std::initializer_list<const char*> words, int otherwise) const {
  const XMLElement* e = holder(attribute);
  if (e == nullptr) return otherwise;
  const std::string given = e->Attribute(attribute);
  std::string list;
  int index = 0;
  for (const char* word : words) {
    if (given == word) return index;
    list += (index++ ? ", " : "") + std::string(word);
  }
  s_.fail(*e, std::string("<") + e->Name() + " " + attribute + "=\"" + given + "\">: it can be " + list, ErrorCode::syntax);
}

std::array<double, 3> Values::size() const {
  std::array<double, 3> out = inherited_ ? inherited_->size : std::array<double, 3>{};
  if (!own("size")) return out;
  const std::vector<double> given = numbers("size", 1, 3);
  std::copy(given.begin(), given.end(), out.begin());
  return out;
}

Defaults::Defaults(const Source& source) : s_(source) {
  classes_[main_] = {};
  bool first = true;
  s_.forEach(s_.root(), [&](const XMLElement& e) {
    if (std::strcmp(e.Name(), "default") != 0) return;
    // The main class may have another name, which its first element gives.
    if (const char* name = e.Attribute("class"); first && name && main_ != name) {
      classes_.erase(main_);
      classes_[main_ = name] = {};
    }
    first = false;
    read(e, nullptr, 0);
  });
}

void Defaults::read(const XMLElement& e, const DefaultClass* parent, int depth) {
  if (depth > deepest) s_.fail(e, "default classes are nested deeper than " + std::to_string(deepest), ErrorCode::syntax);
  const char* name = e.Attribute("class");
  if (parent != nullptr && name == nullptr) s_.fail(e, "a nested <default> has no attribute 'class'", ErrorCode::syntax);
  if (name != nullptr && *name == '\0') s_.fail(e, "<default> has an empty class", ErrorCode::syntax);
  if (parent == nullptr && name != nullptr && main_ != name) s_.fail(e, std::string("two main default classes: '") + main_ + "' and '" + name + "'");
  DefaultClass& own = classes_[name ? name : main_];
  if (parent != nullptr) {
    if (own.element != nullptr || name == main_)
      s_.fail(e, std::string("two default classes are called '") + name + "'" +
                     (own.element ? "; the other is at line " + std::to_string(own.element->GetLineNum()) : ""));
    own.kinds = parent->kinds;
  }
  own.element = &e;
  // A class's own values come before the classes in it, wherever they stand.
  std::set<std::string> seen;
  s_.forEach(e, [&](const XMLElement& values) {
    const std::string kind = values.Name();
    if (kind != "joint" && kind != "geom" && kind != "site" && kind != "mesh" && kind != "equality" && !isDevice(kind)) return;
    if (!seen.insert(kind).second) s_.fail(values, "<default> has two elements <" + kind + ">", ErrorCode::syntax);
    add(values, kind, own);
  });
  s_.forEach(e, [&](const XMLElement& nested) {
    if (std::strcmp(nested.Name(), "default") == 0) read(nested, &own, depth + 1);
  });
}

void Defaults::add(const XMLElement& values, const std::string& kind, DefaultClass& to) const {
  std::shared_ptr<const ClassValues>& before = to.kinds[kind];
  auto after = before ? std::make_shared<ClassValues>(*before) : std::make_shared<ClassValues>();
  for (const tinyxml2::XMLAttribute* a = values.FirstAttribute(); a; a = a->Next()) {
    if (!isDevice(kind) && !reads(kind == "equality" ? "default/equality" : kind, a->Name())) continue;
    after->attributes[a->Name()] = &values;
    if (isDevice(kind)) continue;  // kept as text
    // Numbers are checked here, because a class need not have users.
    static const std::set<std::string_view> texts{"name",         "class", "type", "limited", "actuatorfrclimited",
                                                  "shellinertia", "mesh",  "file", "active",  "inertia"};
    if (!texts.count(a->Name())) s_.of(values).numbers(values, a->Name());
  }
  if (kind == "geom") after->size = Values(s_, values, before.get()).size();
  before = std::move(after);
}

const DefaultClass& Defaults::find(const std::string& name, const XMLElement& user) const {
  const auto found = classes_.find(name.empty() ? main_ : name);
  if (found != classes_.end()) return found->second;
  std::vector<std::string> names;
  for (const auto& [known, values] : classes_) names.push_back(known);
  s_.fail(user, "there is no default class '" + name + "'" + nearNames(name, names));
}

const DefaultClass& Defaults::classOf(const XMLElement& element, const DefaultClass& otherwise) const {
  const char* name = element.Attribute("class");
  return name ? find(name, element) : otherwise;
}

Values Defaults::of(const XMLElement& element, const DefaultClass& child_class) const {
  const DefaultClass& own = classOf(element, child_class);
  const char* kind = std::strcmp(element.Name(), "connect") == 0 || std::strcmp(element.Name(), "weld") == 0 ? "equality" : element.Name();
  const auto values = own.kinds.find(kind);
  return {s_, element, values == own.kinds.end() ? nullptr : values->second.get()};
}

}  // namespace dyn::mjcf
