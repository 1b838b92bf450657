// What compile() returns: immutable, cheap to copy, shareable between threads.
#pragma once

#include <dyn/export.hpp>
#include <dyn/spatial/inertia.hpp>

#include <memory>
#include <string>
#include <vector>

namespace dyn {

struct CompactImpl;

/// One joint as the user numbers them: depth first, in the order of the description. Index 0 is the universe.
struct JointRecord {
  std::string name, type;
  int parent = 0;  ///< joint that carries this one
  int idx_q = 0, idx_v = 0, nq = 0, nv = 0;
};

/// A frame fixed to a joint's body: every body of the description, welded ones too, and the extra frames.
struct FrameRecord {
  std::string name;
  int joint = 0;
  SE3<double> placement;  ///< in the joint's frame
};

/// One line per pass of the compiler, and what it found odd.
struct CompileReport {
  std::vector<std::string> passes;
  std::vector<std::string> warnings;
  std::vector<std::string> held;  ///< bodies whose joint could move, and is rigid because it is held
};

/// Limits of the whole model; infinite where the description gives none. Those of joints that follow others are within those of the leading ones.
struct ModelLimits {
  std::vector<double> lower, upper;      ///< nq
  std::vector<double> velocity, effort;  ///< nv
};

class DYN_API CompactModel {
 public:
  explicit CompactModel(std::shared_ptr<const CompactImpl> impl);
  /// Moving copies, which is as cheap: none is ever empty.
  CompactModel(const CompactModel&) = default;
  CompactModel& operator=(const CompactModel&) = default;

  const std::string& name() const;
  int nq() const;
  int nv() const;
  /// Joints with their motion, the universe included.
  int njoints() const;
  const std::vector<JointRecord>& joints() const;
  const std::vector<FrameRecord>& frames() const;
  /// Index of a joint or frame by name. Throws Error(argument) with the names that are like it if there is none.
  int jointId(const std::string& name) const;
  int frameId(const std::string& name) const;
  /// The same; -1 if there is none.
  int findJoint(const std::string& name) const;
  int findFrame(const std::string& name) const;
  const Vec3<double>& gravity() const;
  double mass() const;  ///< of everything that moves [kg]
  const ModelLimits& limits() const;
  /// Whether joints follow others, and are not among the coordinates.
  bool follows() const;
  const CompileReport& report() const;
  /// Bytes taken, by and large: what algorithms read, names, frames and limits.
  std::size_t bytes() const;

  const CompactImpl& impl() const { return *impl_; }

 private:
  std::shared_ptr<const CompactImpl> impl_;
};

}  // namespace dyn
