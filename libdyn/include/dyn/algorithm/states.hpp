// SPDX-License-Identifier: BSD-2-Clause
// The configuration space in many states at once.
#pragma once

#include <dyn/compile/compact_model.hpp>
#include <dyn/data/states.hpp>
#include <dyn/data/views.hpp>

#include <cstdint>

namespace dyn {

namespace detail {
DYN_API void integrateStates(const CompactModel&, StatesView<double> q, StatesView<double> v, const MatrixOut& out);
DYN_API void differenceStates(const CompactModel&, StatesView<double> q0, StatesView<double> q1, const MatrixOut& out);
DYN_API void interpolateStates(const CompactModel&, StatesView<double> q0, StatesView<double> q1, StatesView<double> t, const MatrixOut& out);
DYN_API void normalizeStates(const CompactModel&, StatesView<double> q, const MatrixOut& out);
DYN_API void randomStates(const CompactModel&, std::uint64_t seed, const MatrixOut& out);
}  // namespace detail

/// The functions of the same names (dyn/algorithm/configuration.hpp) for one state per column.
///
/// `out` has one column per state. An argument has as many, or one column that counts for all states. `out` may be an argument that has a column per
/// state. The numbers are the same, bit for bit, as those of single calls. Nothing is allocated. The functions throw Error(size), and
/// Error(argument), which names the state, for a zero quaternion or pair; the results of the other states are right then. O(n) a state.
namespace states {

/// Computes q (+) v, nq x N.
inline void integrate(const CompactModel& model, const detail::StatesArg<double>& Q, const detail::StatesArg<double>& V, const MatrixOut& out) {
  detail::integrateStates(model, Q, V, out);
}
/// Computes the v for which q0 (+) v = q1, nv x N.
inline void difference(const CompactModel& model, const detail::StatesArg<double>& Q0, const detail::StatesArg<double>& Q1, const MatrixOut& out) {
  detail::differenceStates(model, Q0, Q1, out);
}
/// Computes q0 (+) t (q1 (-) q0), nq x N. T has one row, so one configuration each and N times give a path.
inline void interpolate(const CompactModel& model, const detail::StatesArg<double>& Q0, const detail::StatesArg<double>& Q1,
                        const detail::StatesArg<double>& T, const MatrixOut& out) {
  detail::interpolateStates(model, Q0, Q1, T, out);
}
/// Computes q with its quaternions and (cos, sin) pairs scaled to norm one, nq x N.
inline void normalize(const CompactModel& model, const detail::StatesArg<double>& Q, const MatrixOut& out) { detail::normalizeStates(model, Q, out); }
/// Writes a random configuration to each column, nq x N. Column k is that of the seed `seed` + k.
inline void randomConfiguration(const CompactModel& model, std::uint64_t seed, const MatrixOut& out) { detail::randomStates(model, seed, out); }

}  // namespace states

}  // namespace dyn
