// SPDX-License-Identifier: BSD-2-Clause
// Broken and hostile Lua models give an Error that says what is wrong and where. Limits are counted, so these tests depend on no clock.
#include "support/catch.hpp"

#include <dyn/dyn.hpp>
#include <dyn/parsers/lua.hpp>

#include <algorithm>
#include <string>

using namespace dyn;
using namespace dyn::test;

namespace {

Model read(const std::string& text, const LoadOptions& options = {}) { return lua::parse(text, "robot.lua", options); }
/// A model whose second line has these entries of `frames`.
Model frames(const std::string& entries) { return read("return { gravity = { 0, 0, -9.81 }, frames = {\n" + entries + " } }"); }
const std::string base = "{ name = 'a', parent = 'ROOT' },";

}  // namespace

TEST_CASE("a script that is no Lua or fails is refused with its line", "[fault]") {
  CHECK_THROWS_WITH(lua::load("/nowhere/robot.lua"), containing("/nowhere/robot.lua") && containing("does not exist"));
  CHECK_THROWS_WITH(read(""), containing("must end with `return model`"));
  CHECK_THROWS_WITH(read("local a = {\n{"), containing("robot.lua:2"));
  CHECK_THROWS_WITH(read("\n\nerror('stop')"), containing("robot.lua:3") && containing("stop"));
  CHECK_THROWS_WITH(read("error({})"), containing("no text"));
  CHECK_THROWS_WITH(read("\nlocal x = nil\nreturn x.y"), containing("robot.lua:3"));
  CHECK_THROWS_WITH(read("return 5"), containing("must be a table"));
  CHECK_THROWS_WITH(read("error('\\27[31mred')"), containing("?[31mred"));
  CHECK_THROWS_WITH(read("<robot/>"), containing("robot.lua:1"));
  CHECK_THROWS_WITH(read("\x1bLua"), containing("robot.lua"));  // bytecode
}

TEST_CASE("a script reaches no files, system, clock, bytecode, patterns or random numbers", "[fault]") {
  for (const char* name : {"io", "os", "package", "debug", "require", "dofile", "loadfile", "load", "loadstring", "coroutine", "collectgarbage",
                           "string.dump", "string.find", "string.gsub", "string.match", "math.random", "math.randomseed", "table.move", "warn"}) {
    INFO(name);
    CHECK_NOTHROW(read("assert(" + std::string(name) + " == nil) return { frames = { " + base + " } }"));
  }
  const Model model = read("print('hello') return { frames = { " + base + " } }");
  CHECK(std::count(model.notes.begin(), model.notes.end(), "ignored: the script's calls of print") == 1);
}

TEST_CASE("a script that never ends, or catches that it was stopped, is refused", "[fault]") {
  CHECK_THROWS_WITH(read("\nwhile true do end"), containing("robot.lua:2") && containing("100 million instructions"));
  CHECK_THROWS_WITH(read("while true do pcall(function() while true do end end) end"), containing("100 million instructions"));
  CHECK_THROWS_WITH(read("local t = {} for i = 1, 1e5 do t[i] = i end\nwhile true do table.insert(t, 1, 0) table.remove(t, 1) end"),
                    containing("100 million instructions"));
  CHECK_THROWS_WITH(read("local t = {} for i = 1, 1e5 do t[i] = i end\nwhile true do table.sort(t) end"), containing("100 million instructions"));
  CHECK_THROWS_WITH(read("local function f(n) return f(n + 1) end return f(1)"), containing("100 million instructions"));
  CHECK_THROWS_WITH(read("local function f(n) return 1 + f(n) end return f(1)"), containing("overflow"));
}

TEST_CASE("a script that takes much memory is refused", "[fault]") {
  CHECK_THROWS_WITH(read("local t = {}\nfor i = 1, 1e9 do t[i] = { i } end"), containing("robot.lua:2") && containing("memory"));
  CHECK_THROWS_WITH(read("return string.rep('a', 1e9)"), containing("text of more than 4096 bytes"));
  CHECK_THROWS_WITH(read("local s = 'a'\nfor i = 1, 60 do s = s .. s end"), containing("robot.lua:2") && containing("text of more than 4096 bytes"));
  CHECK_THROWS_WITH(read("return ('a'):rep(1e9)"), containing("text of more than 4096 bytes"));
  CHECK_THROWS_WITH(read("local function f(...) return f(1, ...) end\nreturn f()"), containing("arguments"));
  CHECK_THROWS_WITH(read("local t = {} for i = 1, 1000 do t[i] = 1 end return select('#', table.unpack(t))"), containing("at most 200"));
}

TEST_CASE("lists with holes, names in lists, and tables of other kinds are refused", "[fault]") {
  CHECK_THROWS_WITH(frames(base + "\nnil,\n{ name = 'b', parent = 'a' }"), containing("frames") && containing("[2]") && containing("is missing"));
  CHECK_THROWS_WITH(frames("x = " + base), containing("an entry that is called 'x'"));
  CHECK_THROWS_WITH(frames("[0] = " + base), containing("lists begin with 1"));
  CHECK_THROWS_WITH(frames("[1.5] = " + base), containing("of another kind"));
  CHECK_THROWS_WITH(frames("[1e6] = " + base), containing("[1]") && containing("is missing"));
  CHECK_THROWS_WITH(frames("5"), containing("frames[1]") && containing("must be a table"));
  CHECK_THROWS_WITH(read("return { frames = 5 }"), containing("frames") && containing("must be a table"));
  CHECK_THROWS_WITH(read("return { }"), containing("at least one body"));
  CHECK_THROWS_WITH(frames(base + "{ name = 'b', parent = 'a', joint_frame = { r = { 1, nil, 3 } } }"), containing("r") && containing("[2]"));
  CHECK_THROWS_WITH(frames(base + "{ name = 'b', parent = 'a', body = { mass = 'heavy' } }"),
                    containing("frames[2].body.mass") && containing("number"));
}

TEST_CASE("tables that contain themselves, and metatables, do no harm", "[fault]") {
  CHECK_THROWS_WITH(read("local t = {} t.frames = t t[1] = t t.name = 'a' t.parent = t return t"), containing("frames"));
  CHECK_THROWS_WITH(read("return setmetatable({}, { __index = function() error('no') end })"), containing("__index is no table"));
  CHECK_THROWS_WITH(read("local t = {} setmetatable(t, { __index = t }) return t"), containing("metatables"));
  CHECK_NOTHROW(read("return setmetatable({}, { __index = { frames = { " + base + " } }, __len = function() error('no') end })"));
  CHECK_THROWS_WITH(read("return setmetatable({}, { __gc = function() while true do end end })"), containing("finalizers"));
}

TEST_CASE("frames that make no robot are refused with their line", "[fault]") {
  CHECK_THROWS_WITH(frames(base + "\n{ name = 'a', parent = 'ROOT' }"), containing("robot.lua:3") && containing("two frames are called 'a'"));
  CHECK_THROWS_WITH(frames(base + "\n{ name = 'b', parent = 'aa' }"), containing("robot.lua:3") && containing("no frame before"));
  CHECK_THROWS_WITH(frames("{ name = 'b', parent = 'a' }, " + base), containing("parents come first"));
  CHECK_THROWS_WITH(frames("{ name = 'a', parent = 'a' }"), containing("no frame before"));
  CHECK_THROWS_WITH(frames("{ parent = 'ROOT' }"), containing("frames[1].name") && containing("is missing"));
  CHECK_THROWS_WITH(frames("{ name = 'a' }"), containing("frames[1].parent") && containing("is missing"));
  CHECK_THROWS_WITH(frames("{ name = 'universe', parent = 'ROOT' }"), containing("reserved"));
  CHECK_THROWS_WITH(frames("{ name = 'ROOT', parent = 'ROOT' }"), containing("reserved"));
  CHECK_THROWS_WITH(frames("{ name = '', parent = 'ROOT' }"), containing("empty name"));
  CHECK_THROWS_WITH(frames("{ name = 'a\\27[31m', parent = 'ROOT' }"), containing("control characters"));
  CHECK_THROWS_WITH(frames("{ name = 'a\\255', parent = 'ROOT' }"), containing("UTF-8"));
  CHECK_THROWS_WITH(frames("{ name = 'a', parent = 'ROOT', joint_name = 'j' }, { name = 'b', parent = 'a', joint_name = 'j' }"),
                    containing("two joints are called 'j'"));
}

TEST_CASE("joints, rotations and inertias that mean nothing are refused", "[fault]") {
  const auto joint = [](const std::string& text) { return frames(base + "\n{ name = 'b', parent = 'a', joint = " + text + " }"); };
  CHECK_THROWS_WITH(joint("{ { 1, 0, 0, 0, 0 } }"), containing("robot.lua:3") && containing("6 numbers"));
  CHECK_THROWS_WITH(joint("{ { 0, 0, 0, 0, 0, 0 } }"), containing("no direction"));
  CHECK_THROWS_WITH(joint("{ { 0, 0, 2, 0, 0, 0 } }"), containing("length 1"));
  CHECK_THROWS_WITH(joint("{ { 0, 0, 0, 0, 0, 0.5 } }"), containing("length 1"));
  CHECK_THROWS_WITH(joint("{ { 0, 0, 1, 1, 0, 0 } }"), containing("screw moves along its own axis"));
  CHECK_THROWS_WITH(joint("{ { 0, 0, 0/0, 0, 0, 0 } }"), containing("not finite"));
  CHECK_THROWS_WITH(joint("{ 'JointTypeEulerZXY' }"), containing("did you mean") && containing("JointTypeEulerZYX"));
  CHECK_THROWS_WITH(joint("{ 1, 2 }"), containing("must be a table"));
  CHECK_THROWS_WITH(joint("{ {0,0,1,0,0,0}, {0,0,1,0,0,0}, {0,0,1,0,0,0}, {0,0,1,0,0,0}, {0,0,1,0,0,0}, {0,0,1,0,0,0}, {0,0,1,0,0,0} }"),
                    containing("at most 6"));
  const auto with = [](const std::string& text) { return frames(base + "{ name = 'b', parent = 'a', " + text + " }"); };
  CHECK_THROWS_WITH(with("joint_frame = { E = { {1,0,0}, {0,1,0}, {0,0,-1} } }"), containing("joint_frame.E") && containing("no rotation"));
  CHECK_THROWS_WITH(with("joint_frame = { E = { {2,0,0}, {0,1,0}, {0,0,1} } }"), containing("no rotation"));
  CHECK_THROWS_WITH(with("joint_frame = { E = { {1,0,0}, {0,1,0} } }"), containing("3 rows"));
  CHECK_THROWS_WITH(with("body = { mass = -1 }"), containing("mass is negative"));
  CHECK_THROWS_WITH(with("body = { mass = 1/0 }"), containing("not finite"));
  CHECK_THROWS_WITH(with("body = { mass = 1, inertia = { {1,0,0}, {0,-1,0}, {0,0,1} } }"), containing("positive semi-definite"));
  CHECK_NOTHROW(read("return { frames = { { name = 'a', parent = 'ROOT', body = { mass = 1, inertia = { {1,0,0}, {0,-1,0}, {0,0,1} } } } } }",
                     {.inertias = Inertias::any}));
}

TEST_CASE("a chain of 100,000 bodies loads within the limits of instructions and memory", "[fault]") {
  const std::string text =
      "local frames = {}\nfor i = 0, 99999 do frames[i + 1] = { name = 'b' .. i, parent = i == 0 and 'ROOT' or 'b' .. (i - 1),\n"
      "joint = { { 0, 0, 1, 0, 0, 0 } }, joint_frame = { r = { 0, 0, 0.1 }, E = { {1,0,0}, {0,1,0}, {0,0,1} } },\n"
      "body = { mass = 1, com = { 0, 0, 0 }, inertia = { {1,0,0}, {0,1,0}, {0,0,1} } } } end\nreturn { frames = frames }";
  CHECK(read(text).bodies.size() == 100001);
}

TEST_CASE("a root joint applies to one fixed root, and is refused otherwise", "[fault]") {
  const LoadOptions free{.root = "free_flyer"};
  CHECK(read("return { frames = { " + base + " } }", free).bodies[1].joint.type == "free_flyer");
  CHECK_THROWS_WITH(read("return { frames = { { name = 'a', parent = 'ROOT', joint = { { 0, 0, 1, 0, 0, 0 } } } } }", free),
                    containing("does not apply"));
  CHECK_THROWS_WITH(read("return { frames = { " + base + "{ name = 'b', parent = 'ROOT' } } }", free), containing("does not apply"));
}

TEST_CASE("constraints that name nothing or mean nothing are refused", "[fault]") {
  const auto with = [](const std::string& constraint) {
    return read("return { frames = { " + base + "{ name = 'b', parent = 'a', joint = { { 0, 0, 1, 0, 0, 0 } } } }, constraint_sets = { s = {\n" +
                constraint + " } } }");
  };
  const std::string loop = "{ constraint_type = 'loop', predecessor_body = 'a', successor_body = ";
  CHECK_NOTHROW(with(loop + "'b', axis = { 0, 0, 0, 1, 0, 0 } }"));
  CHECK_THROWS_WITH(with(loop + "'c', axis = { 0, 0, 0, 1, 0, 0 } }"), containing("robot.lua:2") && containing("no body 'c'"));
  CHECK_THROWS_WITH(with(loop + "'b' }"), containing("one of axis and axis_sets"));
  CHECK_THROWS_WITH(with(loop + "'b', axis = { 0, 0, 0, 0.6, 0.8, 0 } }"), containing("along one axis"));
  CHECK_THROWS_WITH(with(loop + "'b', axis = { 0, 0, 0, 1, 0, 0 }, enable_stabilization = true, stabilization_coefficient = 0 }"),
                    containing("positive"));
  CHECK_THROWS_WITH(with("{ constraint_type = 'lop' }"), containing("did you mean 'loop'"));
}
