// SPDX-License-Identifier: BSD-2-Clause
#include "compile/compact_impl.hpp"

#include <dyn/compile/compact_model.hpp>
#include <dyn/error.hpp>
#include <dyn/near_names.hpp>

#include <utility>

namespace dyn {

CompactModel::CompactModel(std::shared_ptr<const CompactImpl> impl) : impl_(std::move(impl)) {}

const std::string& CompactModel::name() const { return impl_->name; }
int CompactModel::nq() const { return impl_->nq; }
int CompactModel::nv() const { return impl_->nv; }
int CompactModel::njoints() const { return static_cast<int>(impl_->joints.size()); }
const std::vector<JointRecord>& CompactModel::joints() const { return impl_->joints.vector(); }
const std::vector<FrameRecord>& CompactModel::frames() const { return impl_->frames.vector(); }
const Vec3<double>& CompactModel::gravity() const { return impl_->gravity; }
double CompactModel::mass() const { return impl_->mass; }
bool CompactModel::follows() const { return !impl_->couplings.empty(); }
const ModelLimits& CompactModel::limits() const { return impl_->limits; }
const CompileReport& CompactModel::report() const { return impl_->report; }

namespace {
template <class Records>
int indexOf(const Records& records, const std::string& name) {
  for (std::size_t i = 0; i < records.size(); ++i)
    if (records[i].name == name) return static_cast<int>(i);
  return -1;
}

/// hintFor(): for a name of another kind, what it is.
template <class Records, class HintFor>
int idOf(const char* kind, const Records& records, const std::string& name, HintFor&& hintFor) {
  const int id = indexOf(records, name);
  if (id >= 0) return id;
  const std::string hint = hintFor();
  throw Error(ErrorCode::argument,
              "the model has no " + std::string(kind) + " '" + name + "'" + hint + (hint.empty() ? nearNames(name, namesOf(records)) : ""));
}

/// For a joint's name in the place of a frame's: the frame of the body that the joint moves.
std::string frameHint(const CompactImpl& m, const std::string& name) {
  const int joint = indexOf(m.joints, name);
  if (joint < 0) return "";
  for (const FrameRecord& frame : m.frames)
    if (frame.joint == joint) return ", which is a joint; the frame of the body that it moves is '" + frame.name + "'";
  return "";
}
/// For a frame's name in the place of a joint's: the joint that moves the frame.
std::string jointHint(const CompactImpl& m, const std::string& name) {
  const int frame = indexOf(m.frames, name);
  if (frame < 0) return "";
  if (m.frames[static_cast<std::size_t>(frame)].joint == 0) return ", which is a frame that is fixed to the world";
  return ", which is a frame; the joint that moves it is '" +
         m.joints[static_cast<std::size_t>(m.frames[static_cast<std::size_t>(frame)].joint)].name + "'";
}
}  // namespace

namespace {
template <class T>
std::size_t bytesOf(const std::vector<T>& x) {
  return x.capacity() * sizeof(T);
}
template <class T>
std::size_t bytesOf(const SharedVector<T>& x) {
  return x.bytes();
}
}  // namespace

std::size_t CompactModel::bytes() const {
  const CompactImpl& m = *impl_;
  std::size_t sum = sizeof m + bytesOf(m.index) + bytesOf(m.constants) + bytesOf(m.constants_float) + bytesOf(m.subspaces) +
                    bytesOf(m.subspaces_float) + bytesOf(m.subspace_offset) + bytesOf(m.batches) + bytesOf(m.runs) + bytesOf(m.tree_end) +
                    bytesOf(m.dof_body) + bytesOf(m.dof_end) + bytesOf(m.dof_parent) + bytesOf(m.dof_segment) + bytesOf(m.dof_depth) +
                    bytesOf(m.chains) + bytesOf(m.couplings) + bytesOf(m.q_of_user) + bytesOf(m.v_of_user) + bytesOf(m.damping) +
                    bytesOf(m.friction) + bytesOf(m.armature) + bytesOf(m.joints) + bytesOf(m.user_frame) + bytesOf(m.body_of_joint) +
                    bytesOf(m.frames) + bytesOf(m.frame_body) + bytesOf(m.frame_placement) + bytesOf(m.limits.lower) + bytesOf(m.limits.upper) +
                    bytesOf(m.limits.velocity) + bytesOf(m.limits.effort) + bytesOf(m.described.bodies) + bytesOf(*m.described.skeleton->frames) +
                    bytesOf(*m.described.origins) + bytesOf(m.described.inertias) + bytesOf(m.described.placements) + bytesOf(m.described.damping) +
                    bytesOf(m.described.friction) + bytesOf(m.described.armature);
  for (const TypeBatch& batch : m.batches) sum += bytesOf(batch.bodies) + bytesOf(batch.constants);
  const LaneGroupPlan& plan = m.lane_groups;
  sum += bytesOf(plan.lane_groups) + bytesOf(plan.lane_slots) + bytesOf(plan.batches) + bytesOf(plan.runs) + bytesOf(plan.dof_index) +
         bytesOf(plan.dof_row) + bytesOf(plan.dof_place) + plan.constants.bytes() + bytesOf(plan.armature);
  for (const LaneGroupBatch& batch : plan.batches)
    sum += bytesOf(batch.bodies) + bytesOf(batch.constants) + bytesOf(batch.q_index) + bytesOf(batch.v_index);
  return sum;
}

int CompactModel::findJoint(const std::string& name) const { return indexOf(impl_->joints, name); }
int CompactModel::findFrame(const std::string& name) const { return indexOf(impl_->frames, name); }
int CompactModel::jointId(const std::string& name) const {
  return idOf("joint", impl_->joints, name, [&] { return jointHint(*impl_, name); });
}
int CompactModel::frameId(const std::string& name) const {
  return idOf("frame", impl_->frames, name, [&] { return frameHint(*impl_, name); });
}

}  // namespace dyn
