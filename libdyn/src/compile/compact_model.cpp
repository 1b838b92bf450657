#include "compile/compact_impl.hpp"

#include <dyn/compile/compact_model.hpp>

#include <utility>

namespace dyn {

CompactModel::CompactModel(std::shared_ptr<const CompactImpl> impl) : impl_(std::move(impl)) {}

const std::string& CompactModel::name() const { return impl_->name; }
int CompactModel::nq() const { return impl_->nq; }
int CompactModel::nv() const { return impl_->nv; }
int CompactModel::njoints() const { return static_cast<int>(impl_->joints.size()); }
const std::vector<JointRecord>& CompactModel::joints() const { return impl_->joints; }
const std::vector<FrameRecord>& CompactModel::frames() const { return impl_->frames; }
const Vec3<double>& CompactModel::gravity() const { return impl_->gravity; }
double CompactModel::mass() const { return impl_->mass; }
const ModelLimits& CompactModel::limits() const { return impl_->limits; }
const CompileReport& CompactModel::report() const { return impl_->report; }

namespace {
template <class Records>
int indexOf(const Records& records, const std::string& name) {
  for (std::size_t i = 0; i < records.size(); ++i)
    if (records[i].name == name) return static_cast<int>(i);
  return -1;
}
}  // namespace

int CompactModel::jointId(const std::string& name) const { return indexOf(impl_->joints, name); }
int CompactModel::frameId(const std::string& name) const { return indexOf(impl_->frames, name); }

}  // namespace dyn
