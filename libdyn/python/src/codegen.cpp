// SPDX-License-Identifier: BSD-2-Clause
// Generated code: source text, and machine code that is compiled and loaded while the program runs.
#include "evaluation.hpp"
#include "objects.hpp"

#include <dyn/codegen/casadi.hpp>
#include <dyn/codegen/native.hpp>

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <optional>

namespace dyn::python {

namespace {

/// A compiled function, and how it was compiled.
struct Native {
  CompiledFunction function;
  int lanes;
  bool single_precision;

  template <class T>
  py::object evaluate(const py::args& arguments) const {
    Evaluation<T> evaluation(function.name(), function.inputs(), function.outputs(), arguments);
    evaluation.run(lanes, [this](const void* const* in, void* const* out) { function.call(in, out); });
    return evaluation.results();
  }
  py::object operator()(const py::args& arguments) const { return single_precision ? evaluate<float>(arguments) : evaluate<double>(arguments); }
};

/// Returns whether all arguments are arrays of one dimension, so that they are one state.
bool areVectors(PyObject* const* arguments, Py_ssize_t count) {
  return std::all_of(arguments, arguments + count,
                     [](PyObject* x) { return py::isinstance<py::array>(x) && py::reinterpret_borrow<py::array>(x).ndim() == 1; });
}

/// Calls a function of one state in double, whose arguments are vectors. Null with a Python error on failure.
PyObject* callOne(const CompiledFunction& f, PyObject* const* arguments) {
  constexpr std::size_t most = 8;
  const std::size_t inputs = f.inputs().size(), outputs = f.outputs().size();
  VectorInput vectors[most];
  const void* in[most];
  for (std::size_t k = 0; k < inputs; ++k) {
    const ArgumentShape& shape = f.inputs()[k];
    if (!vectors[k].read(arguments[k], f.name().c_str(), shape.name.c_str())) return nullptr;
    const VectorView x = vectors[k].view();
    if (x.size != shape.size())
      throw Error(ErrorCode::size,
                  f.name() + ": " + shape.name + " has " + std::to_string(x.size) + " entries, and must have " + std::to_string(shape.size()));
    in[k] = x.data;
  }
  int size = 0;
  for (const ArgumentShape& shape : f.outputs()) size += shape.size();
  std::vector<double> numbers(static_cast<std::size_t>(size));
  void* out[most];
  double* to = numbers.data();
  for (std::size_t k = 0; k < outputs; ++k) {
    out[k] = to;
    to += f.outputs()[k].size();
  }
  f.call(in, out);
  const auto array = [&](std::size_t k) { return newArray(static_cast<const double*>(out[k]), f.outputs()[k].rows, f.outputs()[k].columns); };
  if (outputs == 1) return array(0);
  PyObject* const all = PyTuple_New(static_cast<Py_ssize_t>(outputs));
  for (std::size_t k = 0; all != nullptr && k < outputs; ++k) {
    PyObject* const one = array(k);
    if (one == nullptr) {
      Py_DECREF(all);
      return nullptr;
    }
    PyTuple_SET_ITEM(all, static_cast<Py_ssize_t>(k), one);
  }
  return all;
}

/// CompiledFunction.__call__. It uses C's calling convention of Python directly, because pybind11's costs more than the function of a small robot.
PyObject* callNative(PyObject* self, PyObject* const* arguments, Py_ssize_t count) {
  const Native* const native = pointerTo<Native>(self, "CompiledFunction", "self");
  if (native == nullptr) return nullptr;
  try {
    const CompiledFunction& f = native->function;
    const bool plain = !native->single_precision && native->lanes == 1 && f.inputs().size() <= 8 && f.outputs().size() <= 8;
    if (plain && count == static_cast<Py_ssize_t>(f.inputs().size()) && areVectors(arguments, count)) return callOne(f, arguments);
    py::tuple all(static_cast<std::size_t>(count));
    for (Py_ssize_t k = 0; k < count; ++k) all[static_cast<std::size_t>(k)] = py::reinterpret_borrow<py::object>(arguments[k]);
    return (*native)(py::args(all)).release().ptr();
  } catch (...) {
    return fail();
  }
}

struct NativeModel {
  CompiledModel model;
  int lanes;
  bool single_precision;

  Native native(const CompiledFunction& f) const { return {f, lanes, single_precision}; }
};

NativeOptions nativeOptions(bool single_precision, int lanes, const std::optional<std::filesystem::path>& cache, const std::string& compiler,
                            const std::optional<std::vector<std::string>>& flags, double seconds, std::size_t operations,
                            const std::optional<py::function>& progress) {
  NativeOptions options;
  options.single_precision = single_precision;
  options.lanes = lanes;
  if (cache) options.cache = cache->string();
  options.compiler = compiler;
  if (flags) options.flags = *flags;
  options.seconds = seconds;
  options.operations = operations;
  if (progress)
    options.progress = [&f = *progress](const std::string& line) {
      const py::gil_scoped_acquire locked;
      f(line);
    };
  return options;
}

template <class... Functions>
NativeModel compiled(const NativeOptions& options, const Functions&... functions) {
  const py::gil_scoped_release unlocked;
  return {compileNative(functions..., options), options.lanes, options.single_precision};
}

void addSource(py::module_& m) {
  py::class_<Source>(m, "Source", "C source of functions, in three parts.")
      .def_readonly("types", &Source::types, "The definition of the number type dyn_real.")
      .def_readonly("declarations", &Source::declarations, "Declarations, with comments on the shapes of arguments.")
      .def_readonly("definitions", &Source::definitions, "The functions' bodies and what they need.")
      .def_readonly("steps", &Source::steps, "The number of operations of each function.")
      .def("header", &Source::header, "Returns a header for programs that call the functions.")
      .def(
          "code", [](const Source& s, const std::optional<std::string>& header) { return header ? s.code(*header) : s.code(); },
          py::arg("header") = py::none(), "Returns the functions as a source that includes the header by this name, or that stands alone.");
  const SourceOptions standard;
  const py::arg functions("functions");
  m.def(
      "write_source",
      [](const std::vector<TracedFunction>& f, bool single_precision, int lanes, int piece, const std::string& prefix) {
        return writeSource(f, {single_precision, lanes, piece, prefix});
      },
      functions, py::kw_only(), py::arg("single_precision") = standard.single_precision, py::arg("lanes") = standard.lanes,
      py::arg("piece") = standard.piece, py::arg("prefix") = standard.prefix,
      "Writes traced functions as C99: void PREFIXname(const double* q, ..., double* tau, ...), inputs, then outputs; returns a Source.\n\n"
      "lanes: states that one call computes side by side, 1, 2, 4 ... 64; an argument of n numbers is then x[n][lanes]. piece: most steps in one C\n"
      "function.");
  m.def("write_casadi_source", &writeCasadiSource, functions, py::arg("jacobians") = true,
        "Returns C source of traced functions, with their Jacobians, that casadi.external() loads when it is compiled to a shared object.");
}

}  // namespace

void addCodegen(py::module_& m) {
  addSource(m);
  py::class_<Native> function(m, "CompiledFunction",
                              "Machine code of a function. Call it with a vector for each input, or with a state a row. Any thread may call it;\n"
                              "calls with rows release the interpreter's lock.");
  function
      .def_property_readonly(
          "name", [](const Native& x) { return x.function.name(); }, "The name of the function.")
      .def_property_readonly(
          "inputs", [](const Native& x) { return x.function.inputs(); }, "The shapes of the inputs.")
      .def_property_readonly(
          "outputs", [](const Native& x) { return x.function.outputs(); }, "The shapes of the outputs.")
      .def_property_readonly(
          "cached", [](const Native& x) { return x.function.cached(); }, "Whether the code came from the cache.")
      .def_readonly("lanes", &Native::lanes, "The number of states that the code computes side by side.")
      .def("__repr__", [](const Native& x) { return "<libdyn.CompiledFunction " + x.function.name() + ">"; });
  static PyMethodDef call = {
      "__call__", reinterpret_cast<PyCFunction>(reinterpret_cast<void (*)()>(&callNative)), METH_FASTCALL,
      "__call__(self: libdyn.CompiledFunction, *inputs: numpy.ndarray[numpy.float64]) -> object\n\n"
      "Returns the output, or a tuple of all outputs; they have one more dimension, the state, for rows of states. Values are not checked: the\n"
      "function gives nan or infinity for zero quaternions and zero pivots."};
  PyObject* const method = PyDescr_NewMethod(typeOf<Native>(), &call);
  if (method == nullptr) throw py::error_already_set();
  function.attr("__call__") = py::reinterpret_steal<py::object>(method);
  py::class_<NativeModel>(m, "CompiledModel", "Compiled functions by name.")
      .def_property_readonly(
          "functions",
          [](const NativeModel& x) {
            std::vector<Native> out;
            for (const CompiledFunction& f : x.model.functions()) out.push_back(x.native(f));
            return out;
          },
          "All functions, in the order in which they were asked for.")
      .def(
          "function", [](const NativeModel& x, const std::string& name) { return x.native(x.model.function(name)); }, py::arg("name"),
          "Returns the function of this name.")
      .def(
          "__getitem__", [](const NativeModel& x, const std::string& name) { return x.native(x.model.function(name)); }, py::arg("name"));

  const NativeOptions standard;
  const py::arg functions("functions");
  const py::arg_v single_precision("single_precision", standard.single_precision), lanes("lanes", standard.lanes), cache("cache", py::none()),
      compiler("compiler", standard.compiler), flags("flags", py::none()), seconds("seconds", standard.seconds),
      operations("operations", standard.operations), progress("progress", py::none());
  using Path = std::optional<std::filesystem::path>;
  using Flags = std::optional<std::vector<std::string>>;
  using MaybeFunction = std::optional<py::function>;
  m.def(
      "compile_native",
      [](const CompactModel& model, const std::vector<std::string>& names, bool single, int width, const Path& folder, const std::string& cc,
         const Flags& words, double limit, std::size_t most,
         const MaybeFunction& tell) { return compiled(nativeOptions(single, width, folder, cc, words, limit, most, tell), model, names); },
      py::arg("model"), functions, py::kw_only(), single_precision, lanes, cache, compiler, flags, seconds, operations, progress,
      "Compiles functions by the system's compiler, given by trace()'s names or already traced; returns a CompiledModel.\n\n"
      "single_precision: float32. lanes: states side by side, 1, 2, 4 ... 64; more are faster for batches. cache: the folder of compiled functions;\n"
      "without it $LIBDYN_CACHE, $XDG_CACHE_HOME/libdyn or ~/.cache/libdyn. compiler: a program; without it $CC or cc. flags: of the compiler.\n"
      "seconds: a compiler that runs longer for one function is stopped. operations: a function with more of them is refused. progress: a function\n"
      "that is called with a line of text about what is done next.");
  m.def(
      "compile_native",
      [](const std::vector<TracedFunction>& f, bool single, int width, const Path& folder, const std::string& cc, const Flags& words, double limit,
         std::size_t most, const MaybeFunction& tell) { return compiled(nativeOptions(single, width, folder, cc, words, limit, most, tell), f); },
      functions, py::kw_only(), single_precision, lanes, cache, compiler, flags, seconds, operations, progress);
}

}  // namespace dyn::python
