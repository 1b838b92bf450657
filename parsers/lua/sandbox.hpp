// SPDX-License-Identifier: BSD-2-Clause
// Runs a Lua script with limits that are counted: instructions by a hook, bytes by the allocator. No clock decides.
#pragma once

#include <dyn/error.hpp>

#include <cstddef>
#include <cstdint>
#include <string>
#include <unordered_map>

struct lua_Debug;
struct lua_State;

namespace dyn::lua {

/// Most that a script may do. A model of 10^5 bodies needs about a tenth of the instructions and half of the memory.
struct Limits {
  static constexpr std::int64_t instructions = 100'000'000;
  static constexpr std::size_t memory = std::size_t{512} << 20;  ///< bytes
  static constexpr std::size_t text = 4096;                      ///< bytes of one text
  static constexpr int arguments = 1000;                         ///< of one call
};

/// The state of a script that has run. It offers Lua's functions without files, system, bytecode, coroutines, patterns and random numbers.
class Sandbox {
 public:
  /// Runs a text; messages call it `file`. Its result is at index 1 of the stack. Throws Error(syntax) with the line if it is no Lua, fails or
  /// exceeds a limit.
  Sandbox(const std::string& text, std::string file);
  ~Sandbox();
  Sandbox(const Sandbox&) = delete;
  Sandbox& operator=(const Sandbox&) = delete;

  lua_State* state() const { return L_; }
  const std::string& file() const { return file_; }
  /// Returns the line of a table's constructor, or of its first entry if that is on a line of its own; 0 if it is unknown.
  int lineOf(const void* table) const;
  /// Whether the script called print, which does nothing.
  bool printed() const { return printed_; }

  /// Counts work of library functions, which the hook does not see. Raises a Lua error beyond the limit.
  void charge(lua_State* L, std::int64_t instructions);
  void notePrinting() { printed_ = true; }

 private:
  static void* allocate(void* self, void* block, std::size_t old_size, std::size_t size) noexcept;
  static void hook(lua_State* L, lua_Debug* record);
  static int panic(lua_State* L);
  void openLibraries();
  [[noreturn]] void fail(int status) const;

  std::string file_;
  lua_State* L_ = nullptr;
  bool running_ = false;  ///< limits hold only while the script runs
  std::int64_t left_ = Limits::instructions;
  std::size_t used_ = 0;            ///< bytes
  const char* exceeded_ = nullptr;  ///< the limit that was exceeded
  int exceeded_line_ = 0;
  bool printed_ = false;
  std::unordered_map<const void*, int> lines_;  ///< of tables
  const void* latest_ = nullptr;                ///< the table that was made last, if no other line has run since
};

}  // namespace dyn::lua
