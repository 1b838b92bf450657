// SPDX-License-Identifier: BSD-2-Clause
#include "table.hpp"

#include "common/characters.hpp"

#include <lua.hpp>

#include <algorithm>
#include <cmath>

namespace dyn::lua {

Value::Value(const Sandbox& sandbox, reader::Notes& notes) : sandbox_(&sandbox), notes_(&notes) {}

Value::Value(const Value& parent, const char* key, int number)
    : sandbox_(parent.sandbox_), notes_(parent.notes_), parent_(&parent), key_(key), number_(number) {
  lua_State* L = sandbox_->state();
  parent.wantTable();
  if (lua_checkstack(L, 6) == 0) parent.fail("is nested too deep");
  index_ = lua_gettop(L) + 1;
  if (key == nullptr) {
    lua_rawgeti(L, parent.index_, number);
    return;
  }
  constexpr int longest_chain = 16;
  lua_pushvalue(L, parent.index_);  // the table that is asked
  for (int k = 0; k < longest_chain; ++k) {
    lua_pushstring(L, key);
    lua_rawget(L, index_);
    if (!lua_isnil(L, -1) || lua_getmetatable(L, index_) == 0) {
      lua_replace(L, index_);
      return;
    }
    lua_pushstring(L, "__index");
    lua_rawget(L, -2);
    const int kind = lua_type(L, -1);
    if (kind == LUA_TNIL) {
      lua_settop(L, index_);
      lua_pushnil(L);
      lua_replace(L, index_);
      return;
    }
    if (kind != LUA_TTABLE) {
      lua_settop(L, index_ - 1);
      parent.fail("has a metatable whose __index is no table; write the entries into the table itself");
    }
    lua_replace(L, index_);
    lua_settop(L, index_);
  }
  lua_settop(L, index_ - 1);
  parent.fail("has a chain of metatables that is too long");
}

Value::~Value() { lua_settop(sandbox_->state(), index_ - 1); }

bool Value::exists() const { return !lua_isnil(sandbox_->state(), index_); }
bool Value::isTable() const { return lua_istable(sandbox_->state(), index_); }
bool Value::isText() const { return lua_type(sandbox_->state(), index_) == LUA_TSTRING; }

std::string Value::place() const {
  if (parent_ == nullptr) return {};
  const std::string before = parent_->place();
  if (key_ == nullptr) return before + "[" + std::to_string(number_) + "]";
  return before.empty() ? printable(key_) : before + "." + printable(key_);
}

Where Value::where() const {
  for (const Value* value = this; value != nullptr; value = value->parent_)
    if (value->isTable())
      if (const int line = sandbox_->lineOf(lua_topointer(sandbox_->state(), value->index_)); line > 0) return {sandbox_->file(), line, ""};
  return {sandbox_->file(), 0, ""};
}

void Value::fail(const std::string& why, ErrorCode code) const {
  const std::string at = place();
  throw Error(code, (at.empty() ? "the model" : at) + ": " + why, where());
}

void Value::wantTable() const {
  if (!isTable()) fail(exists() ? "must be a table" : "is missing");
}

double Value::number() const {
  lua_State* L = sandbox_->state();
  if (lua_type(L, index_) != LUA_TNUMBER) fail(exists() ? "must be a number" : "is missing");
  const double x = lua_tonumber(L, index_);
  if (!std::isfinite(x)) fail("is not finite");
  return x;
}

bool Value::boolean(bool otherwise) const {
  if (!exists()) return otherwise;
  if (!lua_isboolean(sandbox_->state(), index_)) fail("must be true or false");
  return lua_toboolean(sandbox_->state(), index_) != 0;
}

std::string Value::text() const {
  if (!isText()) fail(exists() ? "must be a text" : "is missing");
  std::size_t length = 0;
  const char* text = lua_tolstring(sandbox_->state(), index_, &length);
  if (!isPlainText({text, length}) || std::char_traits<char>::find(text, length, '\n') != nullptr)
    fail("is not one line of UTF-8 without control characters");
  return {text, length};
}

std::vector<double> Value::numbers(int count) const {
  wantTable();
  if (const int n = length(); n != count) fail("must have " + std::to_string(count) + " numbers, it has " + std::to_string(n));
  std::vector<double> out;
  for (int k = 1; k <= count; ++k) out.push_back((*this)[k].number());
  return out;
}

Vec3<double> Value::vector() const {
  const std::vector<double> x = numbers(3);
  return {x[0], x[1], x[2]};
}

Mat3<double> Value::matrix() const {
  wantTable();
  if (const int n = length(); n != 3) fail("must have 3 rows, it has " + std::to_string(n));
  Mat3<double> out;
  for (int i = 0; i < 3; ++i) {
    const Vec3<double> row = (*this)[i + 1].vector();
    for (int j = 0; j < 3; ++j) out(i, j) = row[j];
  }
  return out;
}

SE3<double> Value::pose() const {
  SE3<double> out;
  if (!exists()) return out;
  out.p = (*this)["r"].vector(Vec3<double>{});
  if (const Value E = (*this)["E"]; E.exists()) out.R = reader::nearestRotation(transpose(E.matrix()), E.place(), E.where());
  return out;
}

int Value::length() const {
  if (!exists()) return 0;
  wantTable();
  lua_State* L = sandbox_->state();
  lua_Integer count = 0, last = 0;
  lua_pushnil(L);
  while (lua_next(L, index_) != 0) {
    lua_pop(L, 1);
    if (!lua_isinteger(L, -1)) {
      std::string name = lua_type(L, -1) == LUA_TSTRING ? "'" + printable(lua_tostring(L, -1)) + "'" : "of another kind";
      lua_pop(L, 1);
      fail("is a list, but has an entry that is called " + name + "; Lua keeps no order of names");
    }
    ++count;
    last = std::max(last, lua_tointeger(L, -1));
    if (lua_tointeger(L, -1) < 1) last = INT64_MAX;
  }
  if (last == INT64_MAX) fail("is a list with an entry before [1]; lists begin with 1");
  if (last != count) {
    lua_Integer hole = 1;
    for (; lua_rawgeti(L, index_, hole) != LUA_TNIL; ++hole) lua_pop(L, 1);
    lua_pop(L, 1);
    fail("has a hole: entry [" + std::to_string(hole) + "] of " + std::to_string(last) + " is missing");
  }
  if (count > 10'000'000) fail("has too many entries");
  return static_cast<int>(count);
}

std::vector<std::string> Value::names() const {
  wantTable();
  lua_State* L = sandbox_->state();
  std::vector<std::string> out;
  lua_pushnil(L);
  while (lua_next(L, index_) != 0) {
    lua_pop(L, 1);
    std::size_t length = 0;
    const char* name = lua_type(L, -1) == LUA_TSTRING ? lua_tolstring(L, -1, &length) : nullptr;
    if (name == nullptr || !isPlainText({name, length})) {
      lua_pop(L, 1);
      fail("has an entry without a name");
    }
    out.emplace_back(name, length);
  }
  std::sort(out.begin(), out.end());
  return out;
}

void Value::noteOthers(const char* what, std::initializer_list<const char*> known) const {
  if (!isTable()) return;
  lua_State* L = sandbox_->state();
  std::vector<std::string> others;
  lua_pushnil(L);
  while (lua_next(L, index_) != 0) {
    lua_pop(L, 1);
    const std::string key = lua_type(L, -1) == LUA_TSTRING ? lua_tostring(L, -1) : "[number]";
    if (std::find(known.begin(), known.end(), key) == known.end()) others.push_back(printable(key).substr(0, 60));
  }
  std::sort(others.begin(), others.end());
  for (const std::string& key : others) notes_->add("ignored: " + key + " of a " + what, where().line);
}

}  // namespace dyn::lua
