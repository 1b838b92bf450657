// SPDX-License-Identifier: BSD-2-Clause
// The constraints of one model, with their names resolved once, and the memory for their forces.
#pragma once

#include <dyn/data/data.hpp>
#include <dyn/joint/registry.hpp>
#include <dyn/model/constraint.hpp>
#include <dyn/owned.hpp>

#include <memory>
#include <vector>

namespace dyn {

struct PackedConstraints;
struct ConstraintDataImpl;

/// The constraints of a model, with all names resolved. Immutable, cheap to copy and shareable between threads, like the model. Rows have the order
/// of the descriptions; the rows of one constraint have the order of its directions that are not free.
class DYN_API ConstraintSet {
 public:
  /// Takes the constraints of the model's own description: closed loops and couplings.
  explicit ConstraintSet(const CompactModel& model);
  /// Takes these constraints; only couplings need `registry`. Throws Error(model | argument | size | joint_type | parameter), naming the constraint,
  /// for example for an unknown frame or joint, a name used twice, two frames of one body, or a joint without freedom.
  ConstraintSet(const CompactModel& model, const std::vector<ConstraintDescription>& constraints, const JointRegistry* registry = nullptr);
  /// Takes the constraints of `base`, with its couplings as resolved there, followed by `more`. Throws as the constructor above.
  ConstraintSet(const ConstraintSet& base, const std::vector<ConstraintDescription>& more, const JointRegistry* registry = nullptr);
  /// Moving copies, which is as cheap, so that no set is ever empty.
  ConstraintSet(const ConstraintSet&) = default;
  ConstraintSet& operator=(const ConstraintSet&) = default;

  /// Returns the model to which the constraints belong.
  const CompactModel& model() const { return model_; }
  /// Returns the total number of rows: the size of lambda.
  int rows() const;
  /// Returns the number of constraints.
  int count() const;
  /// Returns the description, the first row or the number of rows of one constraint. Throws Error(argument) for a number out of range.
  /// @{
  const ConstraintDescription& description(int constraint) const;
  int firstRow(int constraint) const;
  int rows(int constraint) const;
  /// @}

  const PackedConstraints& impl() const { return *impl_; }  ///< implementation, internal to libdyn

 private:
  CompactModel model_;
  std::shared_ptr<const PackedConstraints> impl_;
};

/// How constraint forces are computed.
struct ConstraintSettings {
  /// A row counts as redundant when its remaining pivot of the Delassus matrix is below this fraction of its diagonal's upper bound. For this,
  /// position errors of closed loops must stay below the square root of the fraction, relative to the model's lengths.
  double rank_tolerance = 1e-10;
  /// [1/kg, 1/(kg m^2)] If positive, mu is added to the diagonal of the Delassus matrix, and proximal iterations remove its effect.
  double mu = 0;
  int max_iterations = 20;  ///< limit of proximal iterations
  double tolerance = 0;     ///< [m/s^2, rad/s^2] proximal iterations end when all rows are within this, or improve no further
};

/// Scratch and results of a set of constraints, for one thread. The constructor takes all memory.
class DYN_API ConstraintData {
 public:
  /// Takes the memory that `needs` asks for. Derivatives of constrained dynamics need Need::derivatives.
  explicit ConstraintData(const ConstraintSet& set, Need needs = Need::state);
  ~ConstraintData();
  ConstraintData(ConstraintData&&) noexcept;
  ConstraintData& operator=(ConstraintData&&) noexcept;
  ConstraintData(const ConstraintData&) = delete;
  ConstraintData& operator=(const ConstraintData&) = delete;

  /// Returns the constraints.
  const ConstraintSet& set() const;
  ConstraintSettings settings;  ///< may be changed between calls

  /// Returns the memory taken, in bytes.
  std::size_t bytes() const;
  /// Returns the implementation, which is internal to libdyn.
  /// @{
  ConstraintDataImpl& impl() { return *impl_; }
  const ConstraintDataImpl& impl() const { return *impl_; }
  /// @}

 private:
  Owned<ConstraintDataImpl> impl_;
};

}  // namespace dyn
