// Constraints of one model, looked up once and used from then on; and the memory of their forces.
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

/// Immutable, cheap to copy, shareable between threads, as the model is. Rows follow one another in the order of the descriptions, those of
/// a constraint in the order of its directions that are not free.
class DYN_API ConstraintSet {
 public:
  /// The constraints of the model's own description, loops and couplings.
  explicit ConstraintSet(const CompactModel& model);
  /// These; `registry` is for couplings only. Throws Error(model | argument | joint_type | parameter), naming the constraint: a frame or joint
  /// that is not there, a name used twice, frames of one body, a joint without freedom.
  ConstraintSet(const CompactModel& model, const std::vector<ConstraintDescription>& constraints, const JointRegistry* registry = nullptr);
  /// Those of `base`, whose couplings are as they were looked up, and these after them. Throws as the constructor before.
  ConstraintSet(const ConstraintSet& base, const std::vector<ConstraintDescription>& more, const JointRegistry* registry = nullptr);
  /// Moving copies, which is as cheap: none is ever empty.
  ConstraintSet(const ConstraintSet&) = default;
  ConstraintSet& operator=(const ConstraintSet&) = default;

  const CompactModel& model() const { return model_; }
  /// Of the constraints together: entries of lambda.
  int rows() const;
  int count() const;
  const ConstraintDescription& description(int constraint) const;
  /// Where a constraint's rows begin, and how many there are.
  int firstRow(int constraint) const;
  int rows(int constraint) const;

  const PackedConstraints& impl() const { return *impl_; }

 private:
  CompactModel model_;
  std::shared_ptr<const PackedConstraints> impl_;
};

/// How forces are found.
struct ConstraintSettings {
  /// A row is taken for one that others imply when what is left of its diagonal of the Delassus matrix is below this share of what it could
  /// be. The errors of position that closures have drifted to must be below its root, in the model's own lengths.
  double rank_tolerance = 1e-10;
  /// Above zero [1/kg, 1/(kg m^2)]: the matrix is taken with mu on its diagonal, and proximal iterations take its effect away again.
  double mu = 0;
  int max_iterations = 20;  ///< of these
  double tolerance = 0;     ///< [m/s^2, rad/s^2] they end when all rows keep this, or get no better
};

/// Scratch and results of a set of constraints, for one thread. All memory is taken when it is made.
class DYN_API ConstraintData {
 public:
  /// Need::derivatives for those of constrained dynamics.
  explicit ConstraintData(const ConstraintSet& set, Need needs = Need::state);
  ~ConstraintData();
  ConstraintData(ConstraintData&&) noexcept;
  ConstraintData& operator=(ConstraintData&&) noexcept;
  ConstraintData(const ConstraintData&) = delete;
  ConstraintData& operator=(const ConstraintData&) = delete;

  const ConstraintSet& set() const;
  ConstraintSettings settings;

  /// Bytes taken.
  std::size_t bytes() const;
  ConstraintDataImpl& impl() { return *impl_; }
  const ConstraintDataImpl& impl() const { return *impl_; }

 private:
  Owned<ConstraintDataImpl> impl_;
};

}  // namespace dyn
