// Every result and intermediate of one state. All memory is taken when it is made.
#pragma once

#include <dyn/compile/compact_model.hpp>
#include <dyn/data/views.hpp>
#include <dyn/owned.hpp>

namespace dyn {

struct DataImpl;

/// Results whose memory grows faster than the model are taken only when asked for.
enum class Need : unsigned {
  state = 0,        ///< everything of size O(n)
  mass_matrix = 1,  ///< M, nv x nv: crba(), and aba() of models with coupled joints
  kinematics = 2,   ///< of a BatchData only: poses, velocities and accelerations of every body in every state
  jacobians = 4,    ///< of a BatchData only: one 6 x nv matrix a state
  derivatives = 8,  ///< nv x nv matrices: derivatives of rnea and aba, inverse and factors of M; mass_matrix comes with it
};
constexpr Need operator|(Need a, Need b) { return static_cast<Need>(static_cast<unsigned>(a) | static_cast<unsigned>(b)); }
constexpr bool has(Need set, Need one) { return (static_cast<unsigned>(set) & static_cast<unsigned>(one)) != 0; }

/// Scratch and results for one thread. Belongs to the model it was made for. Calls that throw, and numbers that are not finite, leave nothing
/// behind: the next call gives what it would give with new Data.
class DYN_API Data {
 public:
  explicit Data(const CompactModel& model, Need needs = Need::state);
  ~Data();
  Data(Data&&) noexcept;
  Data& operator=(Data&&) noexcept;
  Data(const Data&) = delete;
  Data& operator=(const Data&) = delete;

  /// Bytes taken.
  std::size_t bytes() const;

  DataImpl& impl() { return *impl_; }
  const DataImpl& impl() const { return *impl_; }

 private:
  Owned<DataImpl> impl_;
};

}  // namespace dyn
