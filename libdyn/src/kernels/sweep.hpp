// Walking the runs of a model, parents first or children first, with the joint of each body at hand.
#pragma once

#include "data/data_impl.hpp"
#include "kernels/shapes.hpp"

namespace dyn::kernels {

inline Slot<double> slotOf(const CompactImpl& m, const DataImpl& d, const Run& run, int k) {
  const BatchMemory& b = d.batches[static_cast<std::size_t>(run.batch)];
  const int i = run.slot + k;
  if (run.shape == Shape::dense_constant) {
    const int offset = m.subspace_offset[static_cast<std::size_t>(run.first + k)];
    return {b.pose + i, m.subspaces.data() + offset, 1, nullptr, b.stride};
  }
  return {b.pose + i, b.subspace ? b.subspace + i : nullptr, b.stride, b.bias ? b.bias + i : nullptr, b.stride};
}

/// body(joint, i, idx_v): joint is one of the shapes, i the body.
template <class Body>
void forward(const CompactImpl& m, const DataImpl& d, Body&& body) {
  for (const Run& run : m.runs)
    withShape<double>(run.shape, run.nv, [&]<class Joint>() {
      const int v0 = m.index[static_cast<std::size_t>(run.first)].idx_v;
      for (int k = 0; k < run.count; ++k) {
        const Slot<double> slot = slotOf(m, d, run, k);
        body(Joint(slot), run.first + k, v0 + k * Joint::nv);
      }
    });
}

template <class Body>
void backward(const CompactImpl& m, const DataImpl& d, Body&& body) {
  for (auto run = m.runs.rbegin(); run != m.runs.rend(); ++run)
    withShape<double>(run->shape, run->nv, [&]<class Joint>() {
      const int v0 = m.index[static_cast<std::size_t>(run->first)].idx_v;
      for (int k = run->count - 1; k >= 0; --k) {
        const Slot<double> slot = slotOf(m, d, *run, k);
        body(Joint(slot), run->first + k, v0 + k * Joint::nv);
      }
    });
}

/// Pose of body i in its parent's frame, written where the other sweeps read it.
template <class Joint>
void placeInParent(const Joint& joint, const SE3<double>& placement, SE3<double>& rel) {
  rel.R = joint.rotate(placement.R);
  rel.p = placement.p;
  if constexpr (Joint::moves_origin) rel.p += placement.R * joint.translation();
}

/// A matrix that rounding has moved off the rotations, brought back: one Newton step of the polar decomposition (Higham 1986).
template <class S>
Mat3<S> orthonormalized(const Mat3<S>& R) {
  return S(0.5) * (R * (S(3) * Mat3<S>::identity() - transpose(R) * R));
}

/// R_parent R_rel. Long products drift off the rotations, and inertias turned by them grow or shrink; every 16 joints that is undone.
inline Mat3<double> composedRotation(const Mat3<double>& parent, const Mat3<double>& rel, int depth) {
  const Mat3<double> R = parent * rel;
  return depth % 16 == 0 ? orthonormalized(R) : R;
}

}  // namespace dyn::kernels
