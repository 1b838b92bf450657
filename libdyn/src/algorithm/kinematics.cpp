#include "algorithm/inputs.hpp"
#include "kernels/sweep.hpp"

#include <dyn/algorithm/kinematics.hpp>
#include <dyn/error.hpp>

#include <algorithm>
#include <string>

namespace dyn {

namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

struct FrameOnBody {
  int body;
  const SE3<double>& placement;
};

FrameOnBody frameOf(const CompactModel& model, int frame) {
  const CompactImpl& m = model.impl();
  if (frame < 0 || frame >= static_cast<int>(m.frames.size()))
    throw Error(ErrorCode::argument, "frame " + std::to_string(frame) + " does not exist; the model has " + std::to_string(m.frames.size()));
  return {m.frame_body[at(frame)], m.frame_placement[at(frame)]};
}

void placeInWorld(const CompactImpl& m, DataImpl& d, int i) {
  const BodyIndex& x = m.index[at(i)];
  const SE3<double>& parent = d.oM[x.parent];
  d.oM[i] = {kernels::composedRotation(parent.R, d.rel[i].R, x.depth), parent.act(d.rel[i].p)};
}

/// A motion given in the frame's axes at its origin, expressed as asked.
Motion<double> express(const Motion<double>& local, const SE3<double>& oMf, ReferenceFrame reference) {
  switch (reference) {
    case ReferenceFrame::LOCAL:
      return local;
    case ReferenceFrame::WORLD:
      return oMf.act(local);
    case ReferenceFrame::LOCAL_WORLD_ALIGNED:
      return {oMf.R * local.linear, oMf.R * local.angular};
  }
  return local;
}

}  // namespace

namespace detail {

void wantSize(const char* algorithm, const char* name, std::ptrdiff_t rows, std::ptrdiff_t cols, std::ptrdiff_t want_rows, std::ptrdiff_t want_cols) {
  if (rows != want_rows || cols != want_cols)
    throw Error(ErrorCode::size, std::string(algorithm) + ": " + name + " is " + std::to_string(rows) + " x " + std::to_string(cols) +
                                     ", it must be " + std::to_string(want_rows) + " x " + std::to_string(want_cols));
}

void forwardKinematics(const CompactModel& model, Data& data, VectorView q, const VectorView* v, const VectorView* a) {
  const Inputs in = readInputs("forwardKinematics", model, data, q, v, a);
  const CompactImpl& m = model.impl();
  DataImpl& d = data.impl();
  evaluateJoints(m, d, in.q, v ? in.v : nullptr);
  d.v[0] = d.a[0] = {};
  kernels::forward(m, d, [&]<class Joint>(const Joint& joint, int i, int iv) {
    const int p = m.index[at(i)].parent;
    SE3<double>& rel = d.rel[i];
    kernels::placeInParent(joint, m.constants[at(i)].placement, rel);
    placeInWorld(m, d, i);
    if (!v) return;
    const Motion<double> s = joint.times(in.v + iv);
    const Motion<double> carried = rel.actInv(d.v[p]);
    d.v[i] = carried + s;
    if (!a) return;
    Motion<double> ds = joint.times(in.a + iv) + carried.cross(s);
    if constexpr (Joint::has_bias) ds += joint.bias();
    d.a[i] = rel.actInv(d.a[p]) + ds;
  });
}

namespace {

/// Walks from a frame to the world, joint by joint. At each joint: the frame's origin x as seen from the moving body, the rotation Q
/// from the body's axes into the frame's, and their rates. Everything is local, so the base's distance does not matter.
struct Walk {
  Mat3<double> Q;       ///< frame axes from body axes
  Vec3<double> x;       ///< frame origin in body axes
  Motion<double> rate;  ///< velocity of the frame relative to the body: of its origin, and angular, body axes
};

/// Columns of one joint seen from the frame: S moved to the frame's origin.
Motion<double> seen(const Walk& walk, const Motion<double>& S) { return {walk.Q * (S.linear + cross(S.angular, walk.x)), walk.Q * S.angular}; }

/// Their time derivative, where dS is the derivative of S in the body's axes.
Motion<double> seenRate(const Walk& walk, const Motion<double>& S, const Motion<double>& dS) {
  const Vec3<double>& w = walk.rate.angular;
  const Vec3<double> lever = S.linear + cross(S.angular, walk.x);
  return {walk.Q * (dS.linear + cross(dS.angular, walk.x) + cross(S.angular, walk.rate.linear) - cross(w, lever)),
          walk.Q * (dS.angular - cross(w, S.angular))};
}

/// Calls column(k, S, dS) for each degree of freedom that moves the frame, from it to the world.
template <class Column>
void walkSupports(const CompactImpl& m, const DataImpl& d, const FrameOnBody& frame, const double* v, Walk& walk, Column&& column) {
  walk = {transpose(frame.placement.R), frame.placement.p, {}};
  for (int i = frame.body; i > 0; i = m.index[at(i)].parent) {
    const BodyIndex& x = m.index[at(i)];
    const TypeBatch& batch = m.batches[at(x.batch)];
    const Run here{batch.shape, batch.nv, i, 1, x.batch, x.slot};
    kernels::withShape<double>(batch.shape, batch.nv, [&]<class Joint>() {
      const kernels::Slot<double> slot = kernels::slotOf(m, d, here, 0);
      const Joint joint(slot);
      for (int k = 0; k < Joint::nv; ++k) column(i, x.idx_v + k, k, joint.column(k));
      const SE3<double>& rel = d.rel[i];
      if (v) {
        const Motion<double> s = joint.times(v + x.idx_v);
        walk.rate = {rel.R * (s.linear + cross(s.angular, walk.x) + walk.rate.linear), rel.R * (s.angular + walk.rate.angular)};
      }
      walk.x = rel.act(walk.x);
      walk.Q = walk.Q * transpose(rel.R);
    });
  }
}

/// d.rel and d.oM.
void place(const CompactImpl& m, DataImpl& d) {
  kernels::forward(m, d, [&]<class Joint>(const Joint& joint, int i, int) {
    kernels::placeInParent(joint, m.constants[at(i)].placement, d.rel[i]);
    placeInWorld(m, d, i);
  });
}

/// Columns of the expanded coordinates into the user's: a follower's column is added to its master's.
/// With rates in `expanded` and the columns themselves in `base`, d(G J) = G dJ + dG J.
void reduceColumns(const CompactImpl& m, const DataImpl& d, double* expanded, double* base, double* user) {
  for (std::size_t k = m.couplings.size(); k-- > 0;) {
    const int s = m.index[at(m.couplings[k].body)].idx_v, t = m.index[at(m.couplings[k].master)].idx_v;
    const double vm = d.vx[t], dG = base && vm != 0 ? d.gamma[k] / vm : 0.0;
    for (int r = 0; r < 6; ++r) {
      expanded[6 * t + r] += d.G[k] * expanded[6 * s + r] + (base ? dG * base[6 * s + r] : 0.0);
      if (base) base[6 * t + r] += d.G[k] * base[6 * s + r];
    }
  }
  for (std::size_t k = 0; k < m.v_of_user.size(); ++k)
    for (std::size_t r = 0; r < 6; ++r) user[6 * k + r] = expanded[6 * at(m.v_of_user[k]) + r];
}

void write(const Motion<double>& c, double* out) {
  for (int r = 0; r < 3; ++r) {
    out[r] = c.linear[r];
    out[3 + r] = c.angular[r];
  }
}

}  // namespace

void frameJacobian(const CompactModel& model, Data& data, VectorView q, int frame, ReferenceFrame reference, double* J) {
  const FrameOnBody f = frameOf(model, frame);
  const CompactImpl& m = model.impl();
  DataImpl& d = data.impl();
  const Inputs in = readInputs("computeFrameJacobian", model, data, q, nullptr, nullptr);
  evaluateJoints(m, d, in.q, nullptr);
  place(m, d);
  double* out = m.couplings.empty() ? J : d.columns;
  std::fill(out, out + 6 * m.nvx, 0.0);
  Walk walk;
  // Each reference has one chain of rotations between the joint and where the column is expressed, never two.
  walkSupports(m, d, f, nullptr, walk, [&](int i, int iv, int, const Motion<double>& S) {
    const SE3<double>& oMi = d.oM[i];
    Motion<double> column;
    switch (reference) {
      case ReferenceFrame::LOCAL:
        column = seen(walk, S);
        break;
      case ReferenceFrame::WORLD:
        column = oMi.act(S);
        break;
      case ReferenceFrame::LOCAL_WORLD_ALIGNED:
        column = {oMi.R * (S.linear + cross(S.angular, walk.x)), oMi.R * S.angular};
        break;
    }
    write(column, out + 6 * iv);
  });
  if (!m.couplings.empty()) reduceColumns(m, d, out, nullptr, J);
}

void frameJacobianTimeVariation(const CompactModel& model, Data& data, VectorView q, VectorView v, int frame, ReferenceFrame reference, double* dJ) {
  const FrameOnBody f = frameOf(model, frame);
  const CompactImpl& m = model.impl();
  DataImpl& d = data.impl();
  const Inputs in = readInputs("computeFrameJacobianTimeVariation", model, data, q, &v, nullptr);
  evaluateJoints(m, d, in.q, in.v);
  evaluateSubspaceRates(m, d, in.q, in.v);
  place(m, d);
  const SE3<double> oMf = d.oM[f.body] * f.placement;
  // The frame's own velocity, by which LOCAL differs from the other two, sums up along the same walk; so two walks.
  double* base = m.couplings.empty() ? d.columns : d.columns + 6 * m.nvx;
  double* out = m.couplings.empty() ? dJ : d.columns;
  std::fill(out, out + 6 * m.nvx, 0.0);
  std::fill(base, base + 6 * m.nvx, 0.0);
  Walk walk;
  Motion<double> vf;
  walkSupports(m, d, f, in.v, walk, [&](int, int iv, int, const Motion<double>& S) {
    const Motion<double> c = seen(walk, S);
    write(c, base + 6 * iv);
    vf += in.v[iv] * c;
  });
  walkSupports(m, d, f, in.v, walk, [&](int i, int iv, int k, const Motion<double>& S) {
    Motion<double> rate = seenRate(walk, S, subspaceRate(m, d, i, k));
    const Motion<double> c = seen(walk, S);
    // d/dt of (X c) = X (dc + v x c) for the transform X into the reference: all of v for WORLD, its rotation for LOCAL_WORLD_ALIGNED.
    if (reference == ReferenceFrame::WORLD) rate += vf.cross(c);
    if (reference == ReferenceFrame::LOCAL_WORLD_ALIGNED) rate += Motion<double>{cross(vf.angular, c.linear), cross(vf.angular, c.angular)};
    write(express(rate, oMf, reference), out + 6 * iv);
    write(express(c, oMf, reference), base + 6 * iv);
  });
  if (!m.couplings.empty()) reduceColumns(m, d, out, base, dJ);
}

}  // namespace detail

SE3<double> jointPlacement(const CompactModel& model, const Data& data, int joint) {
  const CompactImpl& m = model.impl();
  if (joint < 0 || joint >= model.njoints()) throw Error(ErrorCode::argument, "joint " + std::to_string(joint) + " does not exist");
  return data.impl().oM[m.body_of_joint[at(joint)]] * m.user_frame[at(joint)];
}

SE3<double> framePlacement(const CompactModel& model, const Data& data, int frame) {
  const FrameOnBody f = frameOf(model, frame);
  return data.impl().oM[f.body] * f.placement;
}

Motion<double> frameVelocity(const CompactModel& model, const Data& data, int frame, ReferenceFrame reference) {
  const FrameOnBody f = frameOf(model, frame);
  return express(f.placement.actInv(data.impl().v[f.body]), data.impl().oM[f.body] * f.placement, reference);
}

Motion<double> frameAcceleration(const CompactModel& model, const Data& data, int frame, ReferenceFrame reference) {
  const FrameOnBody f = frameOf(model, frame);
  return express(f.placement.actInv(data.impl().a[f.body]), data.impl().oM[f.body] * f.placement, reference);
}

Motion<double> frameClassicalAcceleration(const CompactModel& model, const Data& data, int frame, ReferenceFrame reference) {
  if (reference == ReferenceFrame::WORLD)
    throw Error(ErrorCode::argument,
                "frameClassicalAcceleration: the acceleration of the frame's origin has no WORLD form; use LOCAL or LOCAL_WORLD_ALIGNED");
  const FrameOnBody f = frameOf(model, frame);
  const Motion<double> v = f.placement.actInv(data.impl().v[f.body]);
  Motion<double> a = f.placement.actInv(data.impl().a[f.body]);
  a.linear += cross(v.angular, v.linear);
  return express(a, data.impl().oM[f.body] * f.placement, reference);
}

}  // namespace dyn
