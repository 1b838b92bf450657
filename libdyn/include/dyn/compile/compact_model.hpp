// SPDX-License-Identifier: BSD-2-Clause
// The compiled model, which compile() returns.
#pragma once

#include <dyn/export.hpp>
#include <dyn/spatial/inertia.hpp>

#include <memory>
#include <string>
#include <vector>

namespace dyn {

struct CompactImpl;

/// One joint in the user's numbering: depth first, in the order of the description. Index 0 is the world, named "universe".
struct JointRecord {
  std::string name, type;
  int parent = 0;  ///< the joint that carries this one
  int idx_q = 0, idx_v = 0, nq = 0, nv = 0;
};

/// A frame fixed to a joint's body. Every body of the description has one, welded bodies too; the extra frames follow.
struct FrameRecord {
  std::string name;
  int joint = 0;
  SE3<double> placement;  ///< in the joint's frame
};

/// One line per pass of the compiler, its warnings, and the held bodies.
struct CompileReport {
  std::vector<std::string> passes;
  std::vector<std::string> warnings;
  std::vector<std::string> held;  ///< bodies whose joint could move but is rigid because it is held
};

/// Limits of the whole model; infinite where the description gives none. The limits of dependent joints narrow those of
/// their master. CompileReport::warnings lists position limits that cannot be transferred.
struct ModelLimits {
  std::vector<double> lower, upper;      ///< nq
  std::vector<double> velocity, effort;  ///< nv
};

/// The compiled model: immutable, cheap to copy, shareable between threads.
class DYN_API CompactModel {
 public:
  explicit CompactModel(std::shared_ptr<const CompactImpl> impl);
  /// A move copies, which is as cheap, so no object is ever empty.
  CompactModel(const CompactModel&) = default;
  CompactModel& operator=(const CompactModel&) = default;

  const std::string& name() const;
  int nq() const;
  int nv() const;
  /// Number of joints that can move, plus one for the world.
  int njoints() const;
  const std::vector<JointRecord>& joints() const;
  const std::vector<FrameRecord>& frames() const;
  /// Return the index of a joint or frame by name. Throw Error(argument), which lists similar names, if there is none.
  int jointId(const std::string& name) const;
  int frameId(const std::string& name) const;
  /// The same, but return -1 if there is none.
  int findJoint(const std::string& name) const;
  int findFrame(const std::string& name) const;
  const Vec3<double>& gravity() const;
  double mass() const;  ///< of all moving bodies [kg]
  const ModelLimits& limits() const;
  /// Returns true if the model has dependent joints. Their coordinates are not in q.
  bool follows() const;
  const CompileReport& report() const;
  /// Returns the approximate size in bytes of what algorithms read, names, frames and limits.
  std::size_t bytes() const;

  const CompactImpl& impl() const { return *impl_; }

 private:
  std::shared_ptr<const CompactImpl> impl_;
};

}  // namespace dyn
