// What algorithms over batches share: checks, threads, and models that go state by state.
#pragma once

#include "algorithm/inputs.hpp"
#include "data/batch_impl.hpp"
#include "kernels/evaluate.hpp"

#include <dyn/algorithm/batch.hpp>
#include <dyn/error.hpp>

#include <algorithm>
#include <array>
#include <limits>
#include <string>

namespace dyn::detail {

template <class T>
void checkStates(const char* algorithm, const char* name, const StatesView<T>& x, std::ptrdiff_t rows, std::ptrdiff_t cols) {
  if (x.rows != rows || x.cols != cols)
    throw Error(ErrorCode::size, std::string(algorithm) + ": " + name + " is " + std::to_string(x.rows) + " x " + std::to_string(x.cols) +
                                     ", it must be " + std::to_string(rows) + " x " + std::to_string(cols));
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
}

/// Calls block(thread, first state, count, failure) for all states, each thread a stretch of neighbours.
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

/// Views of v and a may be empty: zeros.
template <class T>
struct StatesIn {
  const StatesView<T>&q, &v, &a;
};

/// Where numbers of each state go: state by state, `rows` apart.
template <class T>
struct StatesOut {
  T* first = nullptr;
  std::ptrdiff_t rows = 0;
};

/// One state of a model with couplings, by an algorithm for one state: compute(data, q, v, a). Returns whether it could be computed.
template <class T, class Compute>
bool computeSingle(const CompactModel& model, BatchImpl<T>& d, int thread, int state, const StatesIn<T>& in, Failure& failure,
                   const Compute& compute) {
  Eigen::VectorXd* columns = &d.columns[static_cast<std::size_t>(3 * thread)];
  const auto read = [&](const StatesView<T>& from, Eigen::VectorXd& to) {
    for (Eigen::Index i = 0; i < to.size(); ++i) to[i] = from.data ? static_cast<double>(from.data[state * from.stride + i]) : 0.0;
    return VectorView{to.data(), to.size()};
  };
  const VectorView qs = read(in.q, columns[0]), vs = read(in.v, columns[1]), as = read(in.a, columns[2]);
  try {
    compute(d.single[static_cast<std::size_t>(thread)], qs, vs, as);
    return true;
  } catch (const Error& e) {
    const int joint = model.jointId(e.where().joint);
    failure.note(state, e.code() == ErrorCode::singular && joint > 0 ? model.impl().body_of_joint[static_cast<std::size_t>(joint)] : 0);
    return false;
  }
}

/// The same where compute(data, q, v, a) returns where the numbers of each result are.
template <class T, std::size_t n, class Compute>
void runSingle(const CompactModel& model, BatchImpl<T>& d, int thread, int state, const StatesIn<T>& in, const StatesOut<T> (&results)[n],
               Failure& failure, const Compute& compute) {
  std::array<const double*, n> found{};
  computeSingle<T>(model, d, thread, state, in, failure,
                   [&](Data& data, const VectorView& q, const VectorView& v, const VectorView& a) { found = compute(data, q, v, a); });
  for (std::size_t k = 0; k < n; ++k)
    for (std::ptrdiff_t i = 0; i < results[k].rows; ++i)
      results[k].first[state * results[k].rows + i] = found[k] ? static_cast<T>(found[k][i]) : std::numeric_limits<T>::quiet_NaN();
}

/// Looks for what went wrong in a block: columns of states whose pivot vanished become NaN. NaN and infinity in q just spread.
template <class T, std::size_t n>
void noteFailures(const StatesView<T>& q, const kernels::Block<T>& block, const StatesOut<T> (&results)[n], int first, int count, Failure& failure) {
  if (!block.not_finite) return;
  for (int l = 0; l < count; ++l) {
    bool finite = true;
    for (const StatesOut<T>& result : results) {
      T* column = result.first + (first + l) * result.rows;
      finite = finite && kernels::allFinite(column, result.rows);
      if (block.failed[l] != 0) std::fill(column, column + result.rows, std::numeric_limits<T>::quiet_NaN());
    }
    if ((!finite || block.failed[l] != 0) && kernels::allFinite(q.data + (first + l) * q.stride, q.rows)) failure.note(first + l, block.failed[l]);
  }
}

}  // namespace dyn::detail
