// What a Data or BatchData is asked to have room for.
#pragma once

namespace dyn {

/// Results whose memory grows faster than the model are taken only when asked for.
enum class Need : unsigned {
  state = 0,        ///< everything of size O(n)
  mass_matrix = 1,  ///< M, nv x nv: crba(), and aba() of models with coupled joints
  kinematics = 2,   ///< of a BatchData only: poses, velocities and accelerations of every body in every state
  jacobians = 4,    ///< of a BatchData only: one 6 x nv matrix a state
};
constexpr Need operator|(Need a, Need b) { return static_cast<Need>(static_cast<unsigned>(a) | static_cast<unsigned>(b)); }
constexpr bool has(Need set, Need one) { return (static_cast<unsigned>(set) & static_cast<unsigned>(one)) != 0; }

}  // namespace dyn
