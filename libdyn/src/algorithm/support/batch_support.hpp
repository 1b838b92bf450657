// SPDX-License-Identifier: BSD-2-Clause
// Shared parts of the algorithms over batches: checks, threads, and expanded states of models with couplings.
#pragma once

#include "algorithm/support/dependent_joints.hpp"
#include "algorithm/support/inputs.hpp"
#include "data/batch_impl.hpp"
#include "kernels/body/evaluate.hpp"

#include <dyn/algorithm/batch.hpp>
#include <dyn/error.hpp>

#include <algorithm>
#include <limits>
#include <string>
#include <type_traits>
#include <utility>

namespace dyn::detail {

template <class T>
void checkStates(const char* algorithm, const char* name, const StatesView<T>& x, std::ptrdiff_t rows, std::ptrdiff_t cols) {
  if (x.rows != rows || x.cols != cols)
    throw Error(ErrorCode::size, std::string(algorithm) + ": " + name + " is " + std::to_string(x.rows) + " x " + std::to_string(x.cols) +
                                     ", it must be " + std::to_string(rows) + " x " + std::to_string(cols));
  if (x.data == nullptr && rows * cols > 0) throw Error(ErrorCode::argument, std::string(algorithm) + ": " + name + " is a null pointer");
}

template <class T>
void checkBatchData(const char* algorithm, const CompactModel& model, const BatchImpl<T>& d, Need need, const char* need_name) {
  if (d.model != &model.impl())
    throw Error(ErrorCode::argument, std::string(algorithm) + ": the batch was made for another model; make a BatchData for this one");
  if (need != Need::state && !has(d.needs, need))
    throw Error(ErrorCode::argument, std::string(algorithm) + ": the batch was made without Need::" + need_name);
}

template <class T>
void checkBatch(const char* algorithm, const CompactModel& model, const BatchImpl<T>& d, const StatesView<T>& q, Need need, const char* need_name) {
  checkBatchData(algorithm, model, d, need, need_name);
  if (q.rows != model.nq() || q.cols < 1 || q.cols > d.capacity)
    throw Error(ErrorCode::size, std::string(algorithm) + ": q is " + std::to_string(q.rows) + " x " + std::to_string(q.cols) + ", it must be " +
                                     std::to_string(model.nq()) + " x 1 to " + std::to_string(d.capacity));
  if (q.data == nullptr && q.rows > 0) throw Error(ErrorCode::argument, std::string(algorithm) + ": q is a null pointer");
  if (d.models > 0 && q.cols > d.models)
    throw Error(ErrorCode::size, std::string(algorithm) + ": there are " + std::to_string(q.cols) + " states, and setModels() was given " +
                                     std::to_string(d.models) + " models");
}

/// The first of N numbers of a body at a state, which are `lanes` apart. The memory is ordered by block, body, number, state.
template <int N, class T>
T* numbersOf(const BatchImpl<T>& d, const PackMemory& memory, int body, int state) {
  const int lanes = d.kernels->lanes;
  return reinterpret_cast<T*>(memory.data()) + (static_cast<std::ptrdiff_t>(state / lanes) * d.model->bodies() + body) * N * lanes + state % lanes;
}
/// Returns the model of the block that begins with state `first`. If the states have models of their own, the block gets their inertias.
template <class T>
const CompactImpl& chooseModels(const BatchImpl<T>& d, int first, kernels::Block<T>& block) {
  if (d.models > 0 && d.kernels->lanes > 1) block.inertias = numbersOf<sizeof(InertiaConstants<T>) / sizeof(T)>(d, d.inertias, 0, first);
  return d.by_state.empty() ? *d.model : *d.by_state[static_cast<std::size_t>(first)];
}

/// Calls block(thread, first state, count, failure) for all states. Each thread gets a contiguous run of states. Returns the first failure.
template <class T, class Block>
Failure forBlocks(BatchImpl<T>& d, int states, int lanes, const Block& block) {
  const int blocks = (states + lanes - 1) / lanes, threads = d.workers->count();
  const auto work = [&](int t) {
    Failure& failure = d.failures[static_cast<std::size_t>(t)] = {};
    for (int b = static_cast<int>(static_cast<long>(blocks) * t / threads); b < static_cast<int>(static_cast<long>(blocks) * (t + 1) / threads); ++b)
      block(t, b * lanes, std::min(lanes, states - b * lanes), failure);
  };
  d.workers->run(work);
  Failure first;
  for (const Failure& f : d.failures) first.note(f.state, f.body, f.count);
  return first;
}

template <class T>
kernels::ColumnsIn<T> columns(const StatesView<T>& x, int first, int count) {
  if (x.data == nullptr) return {};
  return {x.data + first * x.stride, x.stride, count, static_cast<int>(x.cols) - first - count};
}

template <class T>
void fail(const char* algorithm, const CompactImpl& m, const Failure& failure, const StatesView<T>& q) {
  if (failure.state == std::numeric_limits<int>::max()) return;
  const auto name = [](int state, const char* what) { return "state " + std::to_string(state) + ": " + what; };
  checkFactors(name(failure.state, algorithm).c_str(), m, failure.body);
  Eigen::VectorXd column(m.nq);
  for (int state = failure.state; state < failure.state + failure.count; ++state) {
    for (int i = 0; i < m.nq; ++i) column[i] = static_cast<double>(q.data[state * q.stride + i]);
    checkConfiguration(name(state, "q").c_str(), m, column.data());
  }
}

/// Empty views stand for zeros. v may be empty only if a is, too.
template <class T>
struct StatesIn {
  const StatesView<T>&q, &v, &a;
  bool forward = false;  ///< forward dynamics: a holds the forces tau
};

/// Where a result goes: one column per state, `rows` apart.
template <class T>
struct StatesOut {
  T* first = nullptr;
  std::ptrdiff_t rows = 0;
};

/// readStates() for a model with couplings. It is not inlined, so that it costs other models nothing.
template <class T>
[[gnu::noinline]] void readExpanded(BatchImpl<T>& d, int thread, const StatesIn<T>& in, int first, int count, kernels::Block<T>& block) {
  const CompactImpl& m = *d.model;
  ExpandedStates<T>& x = d.expanded[static_cast<std::size_t>(thread)];
  const std::size_t n = m.couplings.size(), nqx = static_cast<std::size_t>(m.nqx), nvx = static_cast<std::size_t>(m.nvx);
  const bool accelerates = in.a.data != nullptr && !in.forward;
  for (int l = 0; l < count; ++l) {
    double *given = x.given.data(), *expanded = x.expanded.data();
    const auto user = [&](const StatesView<T>& from, int size) -> const double* {
      const T* column = from.data + (first + l) * from.stride;
      if constexpr (std::is_same_v<T, double>) return column;
      given = std::copy_n(column, size, given);
      return given - size;
    };
    const auto place = [&](std::vector<T>& columns, std::size_t size) -> double* {
      if constexpr (std::is_same_v<T, double>) return columns.data() + size * static_cast<std::size_t>(l);
      return std::exchange(expanded, expanded + size);
    };
    const auto put = [&](const double* from, std::vector<T>& columns, std::size_t size) {
      if constexpr (!std::is_same_v<T, double>)
        std::transform(from, from + size, columns.data() + size * static_cast<std::size_t>(l), [](double number) { return static_cast<T>(number); });
    };
    double *q = place(x.q, nqx), *v = place(x.v, nvx), *a = place(x.a, nvx), *G = place(x.couplings, 3 * n);
    expand(m, user(in.q, m.nq), in.v.data ? user(in.v, m.nv) : nullptr, accelerates ? user(in.a, m.nv) : nullptr, {q, v, a, G, G + n, G + 2 * n});
    put(q, x.q, nqx);
    put(v, x.v, nvx);
    put(a, x.a, nvx);
    put(G, x.couplings, 3 * n);
  }
  block.q = {x.q.data(), m.nqx, count, 0};
  if (in.v.data != nullptr) {
    block.v = {x.v.data(), m.nvx, count, 0};
    block.a = {x.a.data(), m.nvx, count, 0};
  }
  if (in.forward) block.forces = columns(in.a, first, count);
  block.couplings = {x.couplings.data(), static_cast<std::ptrdiff_t>(3 * n), count, 0};
}
/// Sets the states of a block, as its kernels read them. Views that are not given stay null.
template <class T>
void readStates(BatchImpl<T>& d, int thread, const StatesIn<T>& in, int first, int count, kernels::Block<T>& block) {
  if (!d.model->couplings.empty()) return readExpanded<T>(d, thread, in, first, count, block);
  block.q = columns(in.q, first, count);
  block.v = columns(in.v, first, count);
  block.a = columns(in.a, first, count);
}

/// Notes the states of a block that failed. Columns of states whose pivot vanished become NaN. NaN and infinity in q are not failures; they spread.
template <class T, std::size_t n>
void noteFailures(const StatesView<T>& q, const kernels::Block<T>& block, const StatesOut<T> (&results)[n], int first, int count, Failure& failure) {
  if (!block.not_finite) return;
  for (int l = 0; l < count; ++l) {
    bool finite = true;
    for (const StatesOut<T>& result : results) {
      if (result.first == nullptr) continue;
      T* column = result.first + (first + l) * result.rows;
      finite = finite && kernels::allFinite(column, result.rows);
      if (block.failed[l] != 0) std::fill(column, column + result.rows, std::numeric_limits<T>::quiet_NaN());
    }
    if ((!finite || block.failed[l] != 0) && kernels::allFinite(q.data + (first + l) * q.stride, q.rows)) failure.note(first + l, block.failed[l]);
  }
}

}  // namespace dyn::detail
