#include "data/data_impl.hpp"

#include <algorithm>
#include <cstring>

namespace dyn {

namespace {

/// Carves arrays out of one block: first with a null base to count, then with the block.
class Arena {
 public:
  explicit Arena(double* base) : base_(base) {}
  template <class T>
  void take(T*& field, std::size_t count) {
    static_assert(sizeof(T) % sizeof(double) == 0 && std::is_trivially_copyable_v<T>);
    if (base_) field = reinterpret_cast<T*>(base_ + used_);
    used_ += count * (sizeof(T) / sizeof(double));
  }
  std::size_t used() const { return used_; }

 private:
  double* base_;
  std::size_t used_ = 0;
};

void carve(DataImpl& d, const CompactImpl& m, Arena& arena) {
  const auto n = static_cast<std::size_t>(m.bodies());
  const auto nqx = static_cast<std::size_t>(m.nqx), nvx = static_cast<std::size_t>(m.nvx), nv = static_cast<std::size_t>(m.nv);
  for (std::size_t b = 0; b < m.batches.size(); ++b) {
    const TypeBatch& batch = m.batches[b];
    BatchMemory& memory = d.batches[b];
    const auto count = static_cast<std::size_t>(batch.count);
    memory.stride = batch.count;
    arena.take(memory.pose, static_cast<std::size_t>(poseSize(batch.shape)) * count);
    if (batch.shape == Shape::dense) {
      arena.take(memory.subspace, static_cast<std::size_t>(6 * batch.nv) * count);
      arena.take(memory.bias, 6 * count);
      arena.take(memory.v, static_cast<std::size_t>(batch.nv) * count);
      arena.take(memory.dual.q, static_cast<std::size_t>(batch.nq) * count);
      arena.take(memory.dual.pose, 12 * count);
      arena.take(memory.dual.subspace, static_cast<std::size_t>(6 * batch.nv) * count);
    }
    if (!batch.contiguous) arena.take(memory.q, static_cast<std::size_t>(batch.nq) * count);
  }
  arena.take(d.rel, n);
  arena.take(d.oM, n);
  arena.take(d.v, n);
  arena.take(d.a, n);
  arena.take(d.w, n);
  arena.take(d.f, n);
  arena.take(d.R, n);
  arena.take(d.r, n);
  arena.take(d.beta, n);
  arena.take(d.IA, n);
  arena.take(d.pA, n);
  arena.take(d.acc, n);
  arena.take(d.mass, n);
  arena.take(d.h, n);
  arena.take(d.Io, n);
  arena.take(d.fext, n);
  arena.take(d.dof, nvx);
  if (!m.couplings.empty()) {
    arena.take(d.qx, nqx);
    arena.take(d.vx, nvx);
    arena.take(d.ax, nvx);
    arena.take(d.taux, nvx);
    arena.take(d.G, m.couplings.size());
    arena.take(d.gamma, m.couplings.size());
  }
  arena.take(d.tau, nv);
  arena.take(d.nle, nv);
  arena.take(d.g, nv);
  arena.take(d.ddq, nvx);
  arena.take(d.zero, std::max<std::size_t>(nvx, 1));
  arena.take(d.Jcom, 3 * nvx);
  arena.take(d.columns, 12 * nvx);
  if (has(d.needs, Need::mass_matrix)) {
    arena.take(d.M, nv * nv);
    if (!m.couplings.empty()) arena.take(d.Mx, nvx * nvx);
  }
}

}  // namespace

Data::Data(const CompactModel& model, Need needs) : impl_(std::make_unique<DataImpl>()) {
  const CompactImpl& m = model.impl();
  impl_->model = &m;
  impl_->keep = std::make_shared<CompactModel>(model);
  impl_->needs = needs;
  impl_->batches.resize(m.batches.size());
  Arena count(nullptr);
  carve(*impl_, m, count);
  impl_->size = count.used();
  impl_->block = std::make_unique<double[]>(impl_->size);  // zeroed
  Arena arena(impl_->block.get());
  carve(*impl_, m, arena);
  impl_->rel[0] = impl_->oM[0] = SE3<double>{};
  impl_->R[0] = Mat3<double>::identity();
}

Data::~Data() = default;
Data::Data(Data&&) noexcept = default;
Data& Data::operator=(Data&&) noexcept = default;

std::size_t Data::bytes() const { return impl_->size * sizeof(double) + impl_->batches.size() * sizeof(BatchMemory) + sizeof(DataImpl); }

}  // namespace dyn
