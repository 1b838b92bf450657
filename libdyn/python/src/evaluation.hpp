// SPDX-License-Identifier: BSD-2-Clause
// Calls of generated functions with numpy's arrays: one state, or a state a row.
#pragma once

#include "arrays.hpp"

#include <dyn/codegen/trace.hpp>
#include <dyn/error.hpp>

#include <pybind11/numpy.h>

#include <algorithm>
#include <string>
#include <type_traits>
#include <vector>

namespace dyn::python {

/// Arguments and results of one call of a function of T. A vector among rows of states counts for all states.
template <class T>
class Evaluation {
 public:
  /// Reads the arguments. Throws TypeError for something that is no array of numbers, Error(size) for wrong numbers and sizes of arguments.
  Evaluation(const std::string& name, const std::vector<ArgumentShape>& inputs, const std::vector<ArgumentShape>& outputs, const py::args& arguments)
      : outputs_(outputs) {
    if (arguments.size() != inputs.size())
      throw Error(ErrorCode::size,
                  name + " takes " + std::to_string(inputs.size()) + " arguments, and " + std::to_string(arguments.size()) + " were given");
    for (std::size_t k = 0; k < inputs.size(); ++k) {
      Array& x = arrays_.emplace_back(Array::ensure(arguments[k]));
      if (!x) throw py::type_error(name + ": " + inputs[k].name + " must be an array of numbers, not " + kindOf(arguments[k]));
      const py::ssize_t size = inputs[k].size();
      const bool rows = x.ndim() == 2;
      const bool fits = (x.ndim() == 1 || rows) && x.shape(x.ndim() - 1) == size;
      if (!fits || (rows && states_ >= 0 && x.shape(0) != states_))
        throw Error(ErrorCode::size, name + ": " + inputs[k].name + " has the shape " + py::str(x.attr("shape")).cast<std::string>() +
                                         "; it must be (" + std::to_string(size) + ",) or (" +
                                         (states_ >= 0 ? std::to_string(states_) : std::string("states")) + ", " + std::to_string(size) + ")");
      if (rows) states_ = x.shape(0);
      input_.push_back({x.data(), rows ? size : 0});
      sizes_.push_back(size);
    }
    for (const ArgumentShape& output : outputs) results_.emplace_back(static_cast<std::size_t>(states() * output.size()));
  }

  py::ssize_t states() const { return std::max<py::ssize_t>(states_, 0) + (states_ < 0); }
  bool batch() const { return states_ >= 0; }
  const T* input(std::size_t k, py::ssize_t state) const { return input_[k].first + state * input_[k].step; }
  T* output(std::size_t k, py::ssize_t state) { return results_[k].data() + state * outputs_[k].size(); }

  /// Argument k, a state a column.
  detail::StatesView<T> view(std::size_t k) const { return {input_[k].first, sizes_[k], input_[k].step == 0 ? 1 : states(), sizes_[k], true}; }
  /// Calls function(in, out), with a pointer to each argument and result, for packs of `lanes` states. For one lane the arguments are passed where
  /// they lie. For more, number i of an argument is at [i * lanes + lane], and the last pack may repeat its last state.
  template <class Function>
  void run(int lanes, const Function& function) {
    std::vector<const void*> in(input_.size());
    std::vector<void*> out(outputs_.size());
    const py::gil_scoped_release unlocked;
    if (lanes == 1) {
      for (py::ssize_t state = 0; state < states(); ++state) {
        for (std::size_t k = 0; k < in.size(); ++k) in[k] = input(k, state);
        for (std::size_t k = 0; k < out.size(); ++k) out[k] = output(k, state);
        function(in.data(), out.data());
      }
      return;
    }
    std::vector<std::vector<T>> packed_in(in.size()), packed_out(out.size());
    for (std::size_t k = 0; k < in.size(); ++k) in[k] = (packed_in[k] = std::vector<T>(static_cast<std::size_t>(sizes_[k] * lanes))).data();
    for (std::size_t k = 0; k < out.size(); ++k)
      out[k] = (packed_out[k] = std::vector<T>(static_cast<std::size_t>(outputs_[k].size() * lanes))).data();
    for (py::ssize_t first = 0; first < states(); first += lanes) {
      const py::ssize_t count = std::min<py::ssize_t>(lanes, states() - first);
      for (std::size_t k = 0; k < in.size(); ++k)
        for (int lane = 0; lane < lanes; ++lane) {
          const T* const from = input(k, first + std::min<py::ssize_t>(lane, count - 1));
          for (py::ssize_t i = 0; i < sizes_[k]; ++i) packed_in[k][static_cast<std::size_t>(i * lanes + lane)] = from[i];
        }
      function(in.data(), out.data());
      for (std::size_t k = 0; k < out.size(); ++k)
        for (py::ssize_t lane = 0; lane < count; ++lane)
          for (int i = 0; i < outputs_[k].size(); ++i) output(k, first + lane)[i] = packed_out[k][static_cast<std::size_t>(i * lanes + lane)];
    }
  }

  /// Returns result k as a new array: a vector, or a matrix if it has several columns; with one more dimension, the state, for rows of states.
  py::object result(std::size_t k) {
    const ArgumentShape& shape = outputs_[k];
    const py::object rows = owned(newArrayOfStates(results_[k].data(), states(), shape.rows, shape.columns));
    return batch() ? rows : rows[py::int_(0)];
  }
  /// Returns the only result, or a tuple of all.
  py::object results() {
    if (outputs_.size() == 1) return result(0);
    py::tuple all(outputs_.size());
    for (std::size_t k = 0; k < outputs_.size(); ++k) all[k] = result(k);
    return all;
  }

 private:
  // Doubles are rounded to floats, as they must; other conversions lose nothing.
  using Array = py::array_t<T, py::array::c_style | (std::is_same_v<T, float> ? py::array::forcecast : 0)>;
  struct Input {
    const T* first;
    py::ssize_t step;
  };

  static std::string kindOf(const py::handle& x) {
    if (py::isinstance<py::array>(x)) return "an array of dtype " + py::str(x.attr("dtype")).cast<std::string>();
    return py::repr(py::type::of(x)).cast<std::string>();
  }
  static py::object owned(PyObject* array) {
    if (array == nullptr) throw py::error_already_set();
    return py::reinterpret_steal<py::object>(array);
  }

  const std::vector<ArgumentShape>& outputs_;
  std::vector<Array> arrays_;
  std::vector<Input> input_;
  std::vector<py::ssize_t> sizes_;
  std::vector<std::vector<T>> results_;
  py::ssize_t states_ = -1;  ///< -1: no argument has rows
};

/// Calls a traced function by running its graph.
py::object evaluated(const TracedFunction& f, const py::args& arguments);

}  // namespace dyn::python
