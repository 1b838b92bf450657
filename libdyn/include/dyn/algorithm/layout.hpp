// SPDX-License-Identifier: BSD-2-Clause
// States in the layouts of other libraries.
#pragma once

#include <dyn/compile/compact_model.hpp>
#include <dyn/data/views.hpp>

namespace dyn {

/// The library whose layout of q and v is meant.
///
/// | library   | free flyer q            | free flyer v                     | quaternion | q of a spherical joint          |
/// |-----------|-------------------------|----------------------------------|------------|---------------------------------|
/// | libdyn    | position, quaternion    | linear local, angular local      | x y z w    | in place                        |
/// | Pinocchio | as libdyn               | as libdyn                        | x y z w    | in place                        |
/// | RBDL      | position, x y z ... w   | linear world, angular local      | x y z      | in place, all w at the end of q |
/// | MuJoCo    | position, quaternion    | linear world, angular local      | w x y z    | in place                        |
/// | Drake     | quaternion, position    | angular world, linear world      | w x y z    | in place                        |
///
/// All layouts list q and v joint by joint in the model's order. Coordinates of other joints are copied, except (cos, sin) pairs: RBDL, MuJoCo and
/// Drake have one angle where libdyn and Pinocchio have a pair. These three have the linear velocity of a planar joint in the axes before its
/// motion, and Drake has the angular velocity of a spherical joint in such axes, too.
enum class Layout { pinocchio, rbdl, mujoco, drake };

namespace detail {
DYN_API int layoutSize(const CompactModel&, Layout);
DYN_API void toLayout(const CompactModel&, Layout, VectorView q, VectorView v, double* q_out, double* v_out);
DYN_API void fromLayout(const CompactModel&, Layout, VectorView q_other, VectorView v_other, double* q, double* v);
}  // namespace detail

/// A state in some layout.
struct StateVectors {
  Eigen::VectorXd q,  ///< configuration
      v;              ///< velocities, nv
};

/// Returns the number of entries of q in another layout. v has nv entries in all of them.
inline int layoutNq(const CompactModel& model, Layout layout) { return detail::layoutSize(model, layout); }

/// Converts libdyn's (q, v) to the layout of another library. Quaternions are normalised, except for Layout::pinocchio, which copies q. O(n).
/// Throws Error(size), and Error(argument) for a zero quaternion or (cos, sin) pair.
inline StateVectors toLayout(const CompactModel& model, Layout layout, const VectorArg& q, const VectorArg& v) {
  StateVectors out{Eigen::VectorXd(detail::layoutSize(model, layout)), Eigen::VectorXd(model.nv())};
  detail::toLayout(model, layout, q, v, out.q.data(), out.v.data());
  return out;
}
/// Converts (q, v) from the layout of another library to libdyn's. Quaternions and errors are as for toLayout. O(n).
inline StateVectors fromLayout(const CompactModel& model, Layout layout, const VectorArg& q, const VectorArg& v) {
  StateVectors out{Eigen::VectorXd(model.nq()), Eigen::VectorXd(model.nv())};
  detail::fromLayout(model, layout, q, v, out.q.data(), out.v.data());
  return out;
}

}  // namespace dyn
