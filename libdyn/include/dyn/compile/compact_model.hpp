// SPDX-License-Identifier: BSD-2-Clause
// The compiled model, which compile() returns.
#pragma once

#include <dyn/compile/numbers.hpp>
#include <dyn/export.hpp>
#include <dyn/spatial/inertia.hpp>

#include <memory>
#include <string>
#include <vector>

namespace dyn {

struct CompactImpl;

/// One joint in the user's numbering: depth first, in the order of the description. Index 0 is the world, named "universe".
struct JointRecord {
  std::string name,  ///< as described
      type;          ///< name of its joint type; empty for the world
  int parent = 0;    ///< the joint that carries this one
  int idx_q = 0,     ///< index of its first coordinate in q
      idx_v = 0,     ///< index of its first velocity in v
      nq = 0,        ///< number of its coordinates in q, which has none of dependent joints
      nv = 0;        ///< number of its degrees of freedom in v, likewise
};

/// A frame fixed to a joint's body. Every body of the description has one, welded bodies too; the extra frames follow.
struct FrameRecord {
  std::string name;       ///< of the body or frame of the description
  int joint = 0;          ///< index of the joint whose body carries it; 0 is the world
  SE3<double> placement;  ///< pose in the joint's frame
};

/// A report of what compile() did and found.
struct CompileReport {
  std::vector<std::string> passes;    ///< a line for each pass of the compiler, after one about what the scene left out
  std::vector<std::string> warnings;  ///< what is legal and likely to be a mistake
  std::vector<std::string> held;      ///< bodies whose joint could move but is rigid because it is held
};

/// Limits of the whole model; infinite where the description gives none. The limits of dependent joints narrow those of their master.
/// CompileReport::warnings lists position limits that cannot be transferred.
struct ModelLimits {
  std::vector<double> lower,     ///< nq lowest positions [rad or m]
      upper;                     ///< nq highest positions [rad or m]
  std::vector<double> velocity,  ///< nv largest speeds [rad/s or m/s]
      effort;                    ///< nv largest forces [N m or N]
};

/// The compiled model: immutable, cheap to copy, shareable between threads.
class DYN_API CompactModel {
 public:
  /// Wraps an implementation. Programs call compile() instead.
  explicit CompactModel(std::shared_ptr<const CompactImpl> impl);
  /// A move copies, which is as cheap, so no object is ever empty.
  CompactModel(const CompactModel&) = default;
  CompactModel& operator=(const CompactModel&) = default;

  /// Returns Model::name.
  const std::string& name() const;
  int nq() const;       ///< number of coordinates, without those of dependent joints
  int nv() const;       ///< number of degrees of freedom, without those of dependent joints
  int njoints() const;  ///< number of joints that can move, plus one for the world
  /// Returns a record of the world and of each joint that can move, dependent joints included.
  const std::vector<JointRecord>& joints() const;
  /// Returns a record of each body of the description, the world first, and of each extra frame.
  const std::vector<FrameRecord>& frames() const;
  /// Return the index of a joint or frame by name. Throw Error(argument), which lists similar names, if there is none. O(n).
  /// @{
  int jointId(const std::string& name) const;
  int frameId(const std::string& name) const;
  /// @}
  /// Return the same index, but -1 if there is none.
  /// @{
  int findJoint(const std::string& name) const;
  int findFrame(const std::string& name) const;
  /// @}
  const Vec3<double>& gravity() const;  ///< in the world [m/s^2]
  double mass() const;                  ///< mass of all moving bodies [kg]
  const ModelLimits& limits() const;    ///< of positions, velocities and forces
  /// Returns true if the model has dependent joints. Their coordinates are not in q.
  bool follows() const;
  const CompileReport& report() const;  ///< the compiler's passes, warnings and held bodies
  /// Returns the approximate size in bytes of what algorithms read, names, frames and limits.
  std::size_t bytes() const;

  /// Returns a model that differs in these numbers of its description only, as compile() would make it from the changed description, to the last
  /// bit. It shares the memory of all else with this model. O(n), a small part of what compile() costs: no joint type is looked up or called. The
  /// first call for a model, and calls that change placements, also compose poses. Numbers do not act that compile() was told to leave out. Throws
  /// Error(argument) for a name that the model does not have and for the placement of a held joint, Error(size | model) for numbers that compile()
  /// refuses.
  CompactModel withNumbers(const ModelNumbers& numbers) const;
  /// The same for inertias of bodies alone.
  CompactModel withInertias(const std::vector<BodyInertia>& inertias) const { return withNumbers({.inertias = inertias}); }
  /// Returns all numbers that withNumbers() can change, depth first. They are those of the description as it was compiled, so bodies that the scene
  /// left out have none. Placements of held joints are not among them.
  ModelNumbers numbers() const;

  const CompactImpl& impl() const { return *impl_; }  ///< implementation, internal to libdyn

 private:
  std::shared_ptr<const CompactImpl> impl_;
};

}  // namespace dyn
