// SPDX-License-Identifier: BSD-2-Clause
// The attributes of an element, which its default class completes.
#pragma once

#include "source.hpp"

#include <array>
#include <initializer_list>
#include <map>
#include <memory>
#include <string_view>

namespace dyn::mjcf {

/// Attributes by name, and the element that has each.
using Attributes = std::map<std::string_view, const XMLElement*>;

/// The values of a default class for one kind of element.
struct ClassValues {
  Attributes attributes;
  /// Sizes of geoms. An element that gives fewer numbers than its class replaces only the first ones.
  std::array<double, 3> size{};
};

class Values {
 public:
  /// `inherited` may be null: the element then stands for itself.
  Values(const Source& source, const XMLElement& element, const ClassValues* inherited) : s_(source), e_(element), inherited_(inherited) {}

  const XMLElement& element() const { return e_; }
  [[noreturn]] void fail(const std::string& why, ErrorCode code = ErrorCode::model) const { s_.fail(e_, why, code); }
  /// Says which element this is: <joint> 'name'.
  std::string described() const;

  bool has(const char* attribute) const { return holder(attribute) != nullptr; }
  /// Whether the element itself has the attribute.
  bool own(const char* attribute) const { return e_.Attribute(attribute) != nullptr; }

  std::string text(const char* attribute, const std::string& otherwise = {}) const;
  double number(const char* attribute, double otherwise) const;
  /// Returns a number that is not negative. Throws Error(model) for others.
  double positive(const char* attribute, double otherwise) const;
  /// Returns a whole number. Throws Error(syntax) for a fraction, and for numbers beyond 2^31.
  int integer(const char* attribute, int otherwise) const;
  /// Returns `least` to `most` numbers. Throws Error(syntax) if the attribute is missing or has another count.
  std::vector<double> numbers(const char* attribute, std::size_t least, std::size_t most) const;
  Vec3<long double> vector3(const char* attribute, const Vec3<long double>& otherwise = {}) const;
  /// Returns the index of the attribute's word in `words`. Throws Error(syntax) for another word.
  int word(const char* attribute, std::initializer_list<const char*> words, int otherwise) const;
  bool flag(const char* attribute, bool otherwise) const { return word(attribute, {"false", "true"}, otherwise) == 1; }
  /// The sizes of a geom: those of its class, of which the element replaces the first ones.
  std::array<double, 3> size() const;

 private:
  /// The element that has the attribute: this one, or the one in the class; null if none has.
  const XMLElement* holder(const char* attribute) const;

  const Source& s_;
  const XMLElement& e_;
  const ClassValues* inherited_;
};

/// A default class, with all that it inherits. Kinds without values are missing.
struct DefaultClass {
  const XMLElement* element = nullptr;  ///< where the class was defined first
  std::map<std::string, std::shared_ptr<const ClassValues>, std::less<>> kinds;
};

/// All default classes of a model. A nested class begins with the values that its parent has where the nested one is defined.
class Defaults {
 public:
  /// Reads all <default> elements. Throws Error(syntax | model) for classes without names, names that are used twice, and malformed sizes.
  explicit Defaults(const Source& source);
  /// Returns the class with that name, or the main class for an empty name. Throws Error(model) if there is none; the message is about `user`.
  const DefaultClass& find(const std::string& name, const XMLElement& user) const;
  /// Returns the class that an element names, or `otherwise` if it names none.
  const DefaultClass& classOf(const XMLElement& element, const DefaultClass& otherwise) const;
  /// Returns the attributes of an element: its own, and those of the class that it names or, if it names none, of `child_class`.
  Values of(const XMLElement& element, const DefaultClass& child_class) const;

 private:
  void read(const XMLElement& e, const DefaultClass* parent, int depth);
  void add(const XMLElement& values, const std::string& kind, DefaultClass& to) const;

  const Source& s_;
  std::map<std::string, DefaultClass, std::less<>> classes_;
  std::string main_ = "main";
};

}  // namespace dyn::mjcf
