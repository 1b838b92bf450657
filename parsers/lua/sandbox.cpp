// SPDX-License-Identifier: BSD-2-Clause
#include "sandbox.hpp"

#include "common/characters.hpp"

#include <lua.hpp>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <utility>

namespace dyn::lua {

namespace {

constexpr int instructions_per_hook = 100;
constexpr std::size_t line_bytes = 48;  ///< that the line of a table takes

Sandbox& sandboxOf(lua_State* L) {
  void* self = nullptr;
  lua_getallocf(L, &self);
  return *static_cast<Sandbox*>(self);
}

/// Returns the line of the script that runs, or that called the library function which runs; 0 if there is none.
int currentLine(lua_State* L) {
  lua_Debug record;
  for (int level = 0; level < 2; ++level)
    if (lua_getstack(L, level, &record) != 0 && lua_getinfo(L, "l", &record) != 0 && record.currentline > 0) return record.currentline;
  return 0;
}

int ignorePrint(lua_State* L) {
  sandboxOf(L).notePrinting();
  return 0;
}

/// setmetatable without finalizers, which run where no hook counts.
int setMetatable(lua_State* L) {
  if (lua_istable(L, 2)) {
    lua_pushliteral(L, "__gc");
    if (lua_rawget(L, 2) != LUA_TNIL) luaL_error(L, "a model has no finalizers (__gc)");
    lua_pop(L, 1);
  }
  const int arguments = lua_gettop(L);
  lua_pushvalue(L, lua_upvalueindex(1));
  lua_insert(L, 1);
  lua_call(L, arguments, 1);
  return 1;
}

/// string.rep, which otherwise fills a buffer of any size before a text is made of it.
int repeat(lua_State* L) {
  std::size_t length = 0;
  luaL_checklstring(L, 1, &length);
  const lua_Integer times = luaL_checkinteger(L, 2);
  if (lua_gettop(L) > 2) luaL_error(L, "string.rep has no separator in a model");
  if (times > 0 && length * static_cast<std::size_t>(std::min<lua_Integer>(times, Limits::text + 1)) > Limits::text)
    luaL_error(L, "makes a text of more than %d bytes", static_cast<int>(Limits::text));
  lua_pushvalue(L, lua_upvalueindex(1));
  lua_insert(L, 1);
  lua_call(L, 2, 1);
  return 1;
}

/// A function of the table library, which works on many entries in one instruction. Upvalues: the function, entries of work per entry of the table.
int charged(lua_State* L) {
  const int arguments = lua_gettop(L);
  luaL_checktype(L, 1, LUA_TTABLE);
  const lua_Integer factor = lua_tointeger(L, lua_upvalueindex(2));
  // Appending and removing the last entry move no others.
  const bool at_end = lua_tointeger(L, lua_upvalueindex(3)) == arguments;
  if (!at_end) sandboxOf(L).charge(L, factor * (1 + static_cast<std::int64_t>(lua_rawlen(L, 1))));
  lua_pushvalue(L, lua_upvalueindex(1));
  lua_insert(L, 1);
  lua_call(L, arguments, LUA_MULTRET);
  return lua_gettop(L);
}

int unpack(lua_State* L) {
  luaL_checktype(L, 1, LUA_TTABLE);
  if (lua_gettop(L) > 1 || lua_rawlen(L, 1) > 200) luaL_error(L, "table.unpack takes one list of at most 200 entries in a model");
  lua_pushvalue(L, lua_upvalueindex(1));
  lua_insert(L, 1);
  lua_call(L, 1, LUA_MULTRET);
  return lua_gettop(L);
}

/// Replaces the function `name` of the library on top of the stack by a wrapper, whose first upvalue is the function.
void wrap(lua_State* L, const char* name, lua_CFunction wrapper, int factor = 1, int arguments_at_end = -1) {
  lua_getfield(L, -1, name);
  lua_pushinteger(L, factor);
  lua_pushinteger(L, arguments_at_end);
  lua_pushcclosure(L, wrapper, 3);
  lua_setfield(L, -2, name);
}

void drop(lua_State* L, std::initializer_list<const char*> names) {
  for (const char* name : names) {
    lua_pushnil(L);
    lua_setfield(L, -2, name);
  }
}

}  // namespace

void* Sandbox::allocate(void* self, void* block, std::size_t old_size, std::size_t size) noexcept {
  auto& sandbox = *static_cast<Sandbox*>(self);
  const std::size_t before = block == nullptr ? 0 : old_size;
  if (size == 0) {
    std::free(block);
    sandbox.used_ -= before;
    return nullptr;
  }
  if (sandbox.running_) {
    // Where there is no block yet, old_size is the kind of object that Lua makes (Lua 5.4 manual, lua_Alloc).
    const char* exceeded = nullptr;
    if (block == nullptr && old_size == LUA_TSTRING && size > Limits::text + 64) exceeded = "makes a text of more than 4096 bytes";
    if (sandbox.used_ - before + size > Limits::memory) exceeded = "takes more than 512 MiB of memory";
    if (exceeded != nullptr) {
      sandbox.exceeded_ = exceeded;
      sandbox.exceeded_line_ = currentLine(sandbox.L_);
      return nullptr;
    }
  }
  void* out = std::realloc(block, size);
  if (out == nullptr) return nullptr;
  sandbox.used_ += size - before;
  if (sandbox.running_ && block == nullptr && old_size == LUA_TTABLE) {
    try {
      const std::size_t known = sandbox.lines_.size();
      sandbox.lines_[out] = currentLine(sandbox.L_);
      if (sandbox.lines_.size() > known) sandbox.used_ += line_bytes;
      sandbox.latest_ = out;
    } catch (...) {  // no memory for a line, which only messages need
    }
  }
  return out;
}

void Sandbox::charge(lua_State* L, std::int64_t instructions) {
  left_ -= instructions;
  if (left_ >= 0) return;
  // From now on every instruction fails, so that no pcall of the script goes on.
  lua_sethook(L, hook, LUA_MASKCOUNT, 1);
  if (left_ + instructions >= 0) exceeded_line_ = currentLine(L);
  exceeded_ = "executes more than 100 million instructions; does a loop never end?";
  luaL_error(L, "%s", exceeded_);
}

void Sandbox::hook(lua_State* L, lua_Debug* record) {
  Sandbox& sandbox = sandboxOf(L);
  if (record->event == LUA_HOOKLINE) {
    // Lua counts the `{` of a table to the line of the word before it. The next line that runs is that of the table's first entry.
    if (sandbox.latest_ != nullptr) sandbox.lines_[sandbox.latest_] = record->currentline;
    sandbox.latest_ = nullptr;
    return;
  }
  sandbox.charge(L, instructions_per_hook);
  if (lua_getlocal(L, record, -Limits::arguments) != nullptr) luaL_error(L, "a call has more than %d arguments", Limits::arguments);
}

int Sandbox::panic(lua_State* L) { throw Error(ErrorCode::memory, "there is no memory to read its tables", {sandboxOf(L).file_, 0, ""}); }

void Sandbox::openLibraries() {
  const std::pair<const char*, lua_CFunction> libraries[] = {
      {LUA_GNAME, luaopen_base}, {LUA_MATHLIBNAME, luaopen_math}, {LUA_STRLIBNAME, luaopen_string}, {LUA_TABLIBNAME, luaopen_table}};
  for (const auto& [name, open] : libraries) {
    luaL_requiref(L_, name, open, 1);
    lua_pop(L_, 1);
  }
  lua_pushglobaltable(L_);
  drop(L_, {"dofile", "loadfile", "load", "collectgarbage", "warn"});
  lua_pushcfunction(L_, ignorePrint);
  lua_setfield(L_, -2, "print");
  wrap(L_, "setmetatable", setMetatable);
  // A model is the same whenever it is read.
  lua_getfield(L_, -1, LUA_MATHLIBNAME);
  drop(L_, {"random", "randomseed"});
  // A pattern can take exponential time within one instruction.
  lua_getfield(L_, -2, LUA_STRLIBNAME);
  drop(L_, {"dump", "find", "match", "gmatch", "gsub", "pack", "packsize", "unpack"});
  wrap(L_, "rep", repeat);
  lua_getfield(L_, -3, LUA_TABLIBNAME);
  drop(L_, {"move"});
  wrap(L_, "insert", charged, 1, 2);
  wrap(L_, "remove", charged, 1, 1);
  wrap(L_, "concat", charged, 4);
  wrap(L_, "sort", charged, 50);
  wrap(L_, "unpack", unpack);
  // The registry keeps the libraries as they are loaded; scripts do not see it.
  lua_settop(L_, 0);
}

Sandbox::Sandbox(const std::string& text, std::string file) : file_(std::move(file)) {
  L_ = lua_newstate(allocate, this);
  if (L_ == nullptr) throw Error(ErrorCode::memory, "there is no memory to run it", {file_, 0, ""});
  lua_atpanic(L_, panic);
  try {
    openLibraries();
    running_ = true;
    lua_sethook(L_, hook, LUA_MASKCOUNT | LUA_MASKLINE, instructions_per_hook);
    int status = luaL_loadbufferx(L_, text.data(), text.size(), "=model", "t");
    if (status == LUA_OK) status = lua_pcall(L_, 0, 1, 0);
    running_ = false;
    if (status != LUA_OK) fail(status);
    lua_gc(L_, LUA_GCSTOP);
  } catch (...) {
    running_ = false;
    lua_close(L_);
    throw;
  }
}

Sandbox::~Sandbox() { lua_close(L_); }

int Sandbox::lineOf(const void* table) const {
  const auto found = lines_.find(table);
  return found == lines_.end() ? 0 : found->second;
}

/// Throws the error on top of the stack. Lua's own messages begin with "model:LINE: ".
void Sandbox::fail(int status) const {
  if (exceeded_ != nullptr && (status == LUA_ERRMEM || left_ < 0))
    throw Error(ErrorCode::syntax, std::string("the script ") + exceeded_, {file_, exceeded_line_, ""});
  std::size_t length = 0;
  const char* text = lua_type(L_, -1) == LUA_TSTRING ? lua_tolstring(L_, -1, &length) : nullptr;
  if (text == nullptr) throw Error(ErrorCode::syntax, "the script fails with an error that is no text", {file_, 0, ""});
  std::string message(text, length);
  int line = 0;
  if (message.starts_with("model:")) {
    const char* first = message.data() + 6;
    const auto [end, problem] = std::from_chars(first, message.data() + message.size(), line);
    if (problem == std::errc() && end - message.data() + 2 <= static_cast<std::ptrdiff_t>(message.size()) && end[0] == ':' && end[1] == ' ')
      message.erase(0, static_cast<std::size_t>(end - message.data()) + 2);
  }
  throw Error(ErrorCode::syntax, "is no Lua that makes a model: " + printable(message), {file_, line, ""});
}

}  // namespace dyn::lua
