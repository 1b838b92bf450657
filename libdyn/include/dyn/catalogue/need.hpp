// SPDX-License-Identifier: BSD-2-Clause
// Memory that is taken only when it is asked for.
#pragma once

namespace dyn {

/// A Need says which results a Data or a BatchData has memory for. Users must ask for results whose memory grows faster than the model.
enum class Need : unsigned {
  state = 0,        ///< everything of size O(n)
  mass_matrix = 1,  ///< M, nv x nv: crba(), and aba() of models with dependent joints
  kinematics = 2,   ///< of a BatchData only: poses, velocities and accelerations of every body in every state
  jacobians = 4,    ///< of a BatchData only: one 6 x nv matrix a state
  derivatives = 8,  ///< nv x nv matrices: derivatives of rnea and aba, inverse and factors of M; mass_matrix comes with it
};
/// Returns the needs of both.
constexpr Need operator|(Need a, Need b) { return static_cast<Need>(static_cast<unsigned>(a) | static_cast<unsigned>(b)); }
/// Returns whether any need of `one` is in the set; false for Need::state.
constexpr bool has(Need set, Need one) { return (static_cast<unsigned>(set) & static_cast<unsigned>(one)) != 0; }

}  // namespace dyn
