// SPDX-License-Identifier: BSD-2-Clause
// Values that a script has made, with their place for messages. Reading them runs no code of the script.
#pragma once

#include "common/reader.hpp"
#include "sandbox.hpp"

#include <dyn/spatial/se3.hpp>

#include <initializer_list>
#include <string>
#include <vector>

namespace dyn::lua {

/// A value at one place of Lua's stack, which it leaves at its end. So values live in nested scopes, the last made ends first.
class Value {
 public:
  /// The result of the script.
  Value(const Sandbox& sandbox, reader::Notes& notes);
  ~Value();
  Value(const Value&) = delete;
  Value& operator=(const Value&) = delete;

  /// Returns an entry of a table, or of the tables that its metatable's __index names; it may be missing. Throws Error(model) if this is no table,
  /// or __index is a function.
  Value operator[](const char* key) const { return {*this, key, 0}; }
  /// Returns an entry of a list, counted from 1 as in Lua.
  Value operator[](int number) const { return {*this, nullptr, number}; }

  bool exists() const;
  bool isTable() const;
  bool isText() const;
  /// Return the value. Throw Error(model) if it is of another kind or missing. Numbers are finite; texts are UTF-8 without control characters.
  /// @{
  double number() const;
  double number(double otherwise) const { return exists() ? number() : otherwise; }
  bool boolean(bool otherwise) const;
  std::string text() const;
  std::string text(const std::string& otherwise) const { return exists() ? text() : otherwise; }
  Vec3<double> vector() const;
  Vec3<double> vector(const Vec3<double>& otherwise) const { return exists() ? vector() : otherwise; }
  std::vector<double> numbers(int count) const;
  Mat3<double> matrix() const;
  /// @}
  /// Returns the pose {r, E} of RBDL: E turns coordinates of the parent into those of the frame, so it is the transpose of the frame's axes.
  SE3<double> pose() const;
  /// Returns the length of a list; 0 if it is missing. Throws Error(model) for a hole, and for an entry that has a name.
  int length() const;
  /// Returns the names of a table's entries, sorted. Throws Error(model) if an entry has none.
  std::vector<std::string> names() const;
  /// Notes entries of the table that are not in the list; `what` is the kind of table.
  void noteOthers(const char* what, std::initializer_list<const char*> known) const;

  /// Returns the line of the table that has this value, or is it.
  Where where() const;
  [[noreturn]] void fail(const std::string& why, ErrorCode code = ErrorCode::model) const;
  reader::Notes& notes() const { return *notes_; }

 private:
  Value(const Value& parent, const char* key, int number);
  void wantTable() const;
  std::string place() const;

  const Sandbox* sandbox_;
  reader::Notes* notes_;
  const Value* parent_ = nullptr;
  const char* key_ = nullptr;
  int number_ = 0;
  int index_ = 1;  ///< on Lua's stack
};

}  // namespace dyn::lua
