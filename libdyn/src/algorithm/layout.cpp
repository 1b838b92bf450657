// SPDX-License-Identifier: BSD-2-Clause
#include "algorithm/support/inputs.hpp"
#include "at.hpp"

#include <dyn/algorithm/layout.hpp>
#include <dyn/lie/so3.hpp>

#include <algorithm>
#include <cmath>

namespace dyn::detail {

namespace {

/// The kinds of joint coordinates that layouts treat differently.
enum class JointKind { free, spherical, planar, pair, plain };

JointKind kindOf(const TypeBatch& batch) {
  if (batch.shape == Shape::free && batch.nq == 7) return JointKind::free;
  if (batch.shape == Shape::spherical && batch.nq == 4) return JointKind::spherical;
  if (batch.shape == Shape::planar && batch.nq == 4) return JointKind::planar;
  if (batch.shape == Shape::revolute && batch.nq == 2) return JointKind::pair;
  return JointKind::plain;
}

/// The number of coordinates of a joint in the main part of another library's q.
int widthOf(JointKind kind, int nq, Layout layout) {
  if (layout == Layout::pinocchio) return nq;
  switch (kind) {
    case JointKind::free:
      return layout == Layout::rbdl ? 6 : 7;
    case JointKind::spherical:
      return layout == Layout::rbdl ? 3 : 4;
    case JointKind::planar:
      return 3;
    case JointKind::pair:
      return 1;
    case JointKind::plain:
      return nq;
  }
  return nq;
}

/// The number of coordinates in the main part of q. RBDL's w components start there, after all other coordinates.
int mainSize(const CompactImpl& m, Layout layout) {
  int size = 0;
  for (int i = 1; i < m.bodies(); ++i)
    if (m.index[at(i)].user_v >= 0) size += widthOf(kindOf(m.batches[at(m.index[at(i)].batch)]), m.index[at(i)].nq, layout);
  return size;
}

/// Calls f(kind, body, its indices, index into the other q, index of its w) for each joint.
template <class F>
void eachJoint(const CompactImpl& m, Layout layout, F&& f) {
  int iq = 0, iw = mainSize(m, layout);
  for (int i = 1; i < m.bodies(); ++i) {
    const BodyIndex& x = m.index[at(i)];
    if (x.user_v < 0) continue;
    const JointKind kind = kindOf(m.batches[at(x.batch)]);
    f(kind, i, x, iq, iw);
    iq += widthOf(kind, x.nq, layout);
    if (kind == JointKind::free || kind == JointKind::spherical) ++iw;
  }
}

/// Indices of x, y, z, w of a quaternion whose numbers start at `first`. In RBDL, w is at the separate index `w`.
struct QuaternionPlace {
  int x, y, z, w;
};
QuaternionPlace quaternionPlace(Layout layout, int first, int w) {
  switch (layout) {
    case Layout::rbdl:
      return {first, first + 1, first + 2, w};
    case Layout::mujoco:
    case Layout::drake:
      return {first + 1, first + 2, first + 3, first};
    case Layout::pinocchio:
      break;
  }
  return {first, first + 1, first + 2, first + 3};
}

void put(const Vec3<double>& x, double* out) {
  for (int k = 0; k < 3; ++k) out[k] = x[k];
}
Vec3<double> get(const double* x) { return {x[0], x[1], x[2]}; }

/// Throws Error(argument) for four zeros, which are no rotation. NaN and infinity are not errors; they spread to the result.
Quaternion<double> rotationOf(const CompactImpl& m, int body, const double* q, const QuaternionPlace& p) {
  const Quaternion<double> r = Quaternion<double>{q[p.x], q[p.y], q[p.z], q[p.w]}.normalized();
  if (std::isnan(r.w) && std::isfinite(q[p.x] + q[p.y] + q[p.z] + q[p.w])) refuseZero("q", m, body);
  return r;
}

}  // namespace

int layoutSize(const CompactModel& model, Layout layout) {
  const CompactImpl& m = model.impl();
  int quaternions = 0;
  if (layout == Layout::rbdl)
    eachJoint(m, layout,
              [&](JointKind kind, int, const BodyIndex&, int, int) { quaternions += kind == JointKind::free || kind == JointKind::spherical; });
  return mainSize(m, layout) + quaternions;
}

void toLayout(const CompactModel& model, Layout layout, VectorView q, VectorView v, double* q_out, double* v_out) {
  checkSize("toLayout", "q", q, model.nq());
  checkSize("toLayout", "v", v, model.nv());
  checkConfiguration("q", model.impl(), q.data);
  eachJoint(model.impl(), layout, [&](JointKind kind, int, const BodyIndex& x, int iq, int iw) {
    const double* qi = q.data + x.user_q;
    const double* vi = v.data + x.user_v;
    double* vo = v_out + x.user_v;
    std::copy(vi, vi + x.nv, vo);
    if (layout == Layout::pinocchio || kind == JointKind::plain) {
      std::copy(qi, qi + x.nq, q_out + iq);
    } else if (kind == JointKind::pair) {
      q_out[iq] = std::atan2(qi[1], qi[0]);
    } else if (kind == JointKind::planar) {
      q_out[iq] = qi[0];
      q_out[iq + 1] = qi[1];
      q_out[iq + 2] = std::atan2(qi[3], qi[2]);
      const double n = std::hypot(qi[2], qi[3]), c = qi[2] / n, s = qi[3] / n;
      vo[0] = c * vi[0] - s * vi[1];
      vo[1] = s * vi[0] + c * vi[1];
    } else {
      const double* quaternion = kind == JointKind::free ? qi + 3 : qi;
      const Quaternion<double> r = Quaternion<double>{quaternion[0], quaternion[1], quaternion[2], quaternion[3]}.normalized();
      const bool position_last = layout == Layout::drake;
      const int first = kind == JointKind::free && !position_last ? iq + 3 : iq;
      const QuaternionPlace p = quaternionPlace(layout, first, iw);
      q_out[p.x] = r.x;
      q_out[p.y] = r.y;
      q_out[p.z] = r.z;
      q_out[p.w] = r.w;
      if (kind == JointKind::free) {
        std::copy(qi, qi + 3, q_out + (position_last ? iq + 4 : iq));
        const Vec3<double> linear = r.matrix() * get(vi), angular = get(vi + 3);
        put(linear, position_last ? vo + 3 : vo);
        put(position_last ? r.matrix() * angular : angular, position_last ? vo : vo + 3);
      } else if (position_last) {
        put(r.matrix() * get(vi), vo);
      }
    }
  });
}

void fromLayout(const CompactModel& model, Layout layout, VectorView q_other, VectorView v_other, double* q, double* v) {
  checkSize("fromLayout", "q", q_other, layoutSize(model, layout));
  checkSize("fromLayout", "v", v_other, model.nv());
  const CompactImpl& m = model.impl();
  if (layout == Layout::pinocchio) checkConfiguration("q", m, q_other.data);
  eachJoint(m, layout, [&](JointKind kind, int body, const BodyIndex& x, int iq, int iw) {
    double* qi = q + x.user_q;
    double* vi = v + x.user_v;
    const double* vo = v_other.data + x.user_v;
    const double* qo = q_other.data;
    std::copy(vo, vo + x.nv, vi);
    if (layout == Layout::pinocchio || kind == JointKind::plain) {
      std::copy(qo + iq, qo + iq + x.nq, qi);
    } else if (kind == JointKind::pair) {
      qi[0] = std::cos(qo[iq]);
      qi[1] = std::sin(qo[iq]);
    } else if (kind == JointKind::planar) {
      const double c = std::cos(qo[iq + 2]), s = std::sin(qo[iq + 2]);
      qi[0] = qo[iq];
      qi[1] = qo[iq + 1];
      qi[2] = c;
      qi[3] = s;
      vi[0] = c * vo[0] + s * vo[1];
      vi[1] = c * vo[1] - s * vo[0];
    } else {
      const bool position_last = layout == Layout::drake;
      const int first = kind == JointKind::free && !position_last ? iq + 3 : iq;
      const QuaternionPlace p = quaternionPlace(layout, first, iw);
      const Quaternion<double> r = rotationOf(m, body, qo, p);
      double* quaternion = kind == JointKind::free ? qi + 3 : qi;
      quaternion[0] = r.x;
      quaternion[1] = r.y;
      quaternion[2] = r.z;
      quaternion[3] = r.w;
      if (kind == JointKind::free) {
        const double* position = qo + (position_last ? iq + 4 : iq);
        std::copy(position, position + 3, qi);
        const Vec3<double> linear = get(position_last ? vo + 3 : vo), angular = get(position_last ? vo : vo + 3);
        put(transposeTimes(r.matrix(), linear), vi);
        put(position_last ? transposeTimes(r.matrix(), angular) : angular, vi + 3);
      } else if (position_last) {
        put(transposeTimes(r.matrix(), get(vo)), vi);
      }
    }
  });
}

}  // namespace dyn::detail
