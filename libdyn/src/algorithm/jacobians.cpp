#include "algorithm/inputs.hpp"
#include "algorithm/placement.hpp"
#include "kernels/sweep.hpp"
#include "kernels/table.hpp"

#include <dyn/algorithm/jacobians.hpp>

#include <algorithm>

namespace dyn {

namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

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
void walkSupports(const CompactImpl& m, DataImpl& d, const PointOnBody& frame, const double* v, Walk& walk, Column&& column) {
  const kernels::Bodies<double> bodies{m, d};
  walk = {transpose(frame.placement.R), frame.placement.p, {}};
  for (int i = frame.body; i > 0; i = m.index[at(i)].parent) {
    const BodyIndex& x = m.index[at(i)];
    const TypeBatch& batch = m.batches[at(x.batch)];
    const Run here{batch.shape, batch.nv, i, 1, x.batch, x.slot};
    kernels::withShape<double>(batch.shape, batch.nv, [&]<class Joint>() {
      const kernels::Slot<double> slot = bodies.slotOf(here, 0);
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

/// d.rel and d.oM of joints that have been evaluated.
void place(const CompactImpl& m, DataImpl& d) { kernels::active().single.forwardKinematics(m, d, nullptr, nullptr); }

/// Columns of the expanded coordinates into the user's: a follower's column is added to its master's.
/// With rates in `expanded` and the columns themselves in `base`, d(G J) = G dJ + dG J.
void foldColumns(const CompactImpl& m, const DataImpl& d, double* expanded, double* base, const MatrixOut& user) {
  for (std::size_t k = m.couplings.size(); k-- > 0;) {
    const int s = m.index[at(m.couplings[k].body)].idx_v, t = m.index[at(m.couplings[k].master)].idx_v;
    const double vm = d.vx[t], dG = base && vm != 0 ? d.gamma[k] / vm : 0.0;
    for (int r = 0; r < 6; ++r) {
      expanded[6 * t + r] += d.G[k] * expanded[6 * s + r] + (base ? dG * base[6 * s + r] : 0.0);
      if (base) base[6 * t + r] += d.G[k] * base[6 * s + r];
    }
  }
  for (int k = 0; k < m.nv; ++k) std::copy_n(expanded + 6 * m.v_of_user[at(k)], 6, user.column(k));
}

void write(const Motion<double>& c, double* out) {
  for (int r = 0; r < 3; ++r) {
    out[r] = c.linear[r];
    out[3 + r] = c.angular[r];
  }
}

/// Writes J from joints that have been evaluated and placed.
void writeJacobian(const CompactImpl& m, DataImpl& d, const PointOnBody& point, ReferenceFrame reference, const MatrixOut& J) {
  const bool coupled = !m.couplings.empty();
  const MatrixOut out = coupled ? MatrixOut(d.columns, 6, m.nvx) : J;
  for (int k = 0; k < m.nvx; ++k) std::fill_n(out.column(k), 6, 0.0);
  Walk walk;
  // Each reference has one chain of rotations between the joint and where the column is expressed, never two.
  walkSupports(m, d, point, nullptr, walk, [&](int i, int iv, int, const Motion<double>& S) {
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
    write(column, out.column(iv));
  });
  if (coupled) foldColumns(m, d, d.columns, nullptr, J);
}

PointOnBody pointOf(const CompactModel& model, detail::Kind kind, int id) {
  return kind == detail::Kind::joint ? jointOnBody(model, id) : frameOnBody(model, id);
}

}  // namespace

namespace detail {

void jacobian(const CompactModel& model, Data& data, VectorView q, Kind kind, int id, ReferenceFrame reference, const MatrixOut& J) {
  const PointOnBody point = pointOf(model, kind, id);
  const char* algorithm = kind == Kind::joint ? "computeJointJacobian" : "computeFrameJacobian";
  checkShape(algorithm, "J", J, 6, model.nv());
  const Inputs in = readInputs(algorithm, model, data, q, nullptr, nullptr);
  evaluateJoints(model.impl(), data.impl(), in.q, nullptr);
  place(model.impl(), data.impl());
  writeJacobian(model.impl(), data.impl(), point, reference, J);
}

void jacobianTimeVariation(const CompactModel& model, Data& data, VectorView q, VectorView v, Kind kind, int id, ReferenceFrame reference,
                           const MatrixOut& dJ) {
  const PointOnBody point = pointOf(model, kind, id);
  const char* algorithm = kind == Kind::joint ? "computeJointJacobianTimeVariation" : "computeFrameJacobianTimeVariation";
  checkShape(algorithm, "dJ", dJ, 6, model.nv());
  const CompactImpl& m = model.impl();
  DataImpl& d = data.impl();
  const Inputs in = readInputs(algorithm, model, data, q, &v, nullptr);
  evaluateJoints(m, d, in.q, in.v);
  evaluateSubspaceRates(m, d, in.q, in.v);
  place(m, d);
  const SE3<double> oMf = d.oM[point.body] * point.placement;
  // The frame's own velocity, by which LOCAL differs from the other two, sums up along the same walk; so two walks.
  double *base = d.columns + 6 * m.nvx, *rates = d.columns;
  const bool coupled = !m.couplings.empty();
  const MatrixOut out = coupled ? MatrixOut(rates, 6, m.nvx) : dJ;
  for (int k = 0; k < m.nvx; ++k) std::fill_n(out.column(k), 6, 0.0);
  std::fill_n(base, 6 * m.nvx, 0.0);
  Walk walk;
  Motion<double> vf;
  walkSupports(m, d, point, in.v, walk, [&](int, int iv, int, const Motion<double>& S) { vf += in.v[iv] * seen(walk, S); });
  walkSupports(m, d, point, in.v, walk, [&](int i, int iv, int k, const Motion<double>& S) {
    Motion<double> rate = seenRate(walk, S, subspaceRate(m, d, i, k));
    const Motion<double> c = seen(walk, S);
    // d/dt of (X c) = X (dc + v x c) for the transform X into the reference: all of v for WORLD, its rotation for LOCAL_WORLD_ALIGNED.
    if (reference == ReferenceFrame::WORLD) rate += vf.cross(c);
    if (reference == ReferenceFrame::LOCAL_WORLD_ALIGNED) rate += Motion<double>{cross(vf.angular, c.linear), cross(vf.angular, c.angular)};
    write(express(rate, oMf, reference), out.column(iv));
    write(express(c, oMf, reference), base + 6 * iv);
  });
  if (coupled) foldColumns(m, d, rates, base, dJ);
}

}  // namespace detail

void getJointJacobian(const CompactModel& model, Data& data, int joint, ReferenceFrame reference, const MatrixOut& J) {
  checkData("getJointJacobian", model, data);
  checkShape("getJointJacobian", "J", J, 6, model.nv());
  writeJacobian(model.impl(), data.impl(), jointOnBody(model, joint), reference, J);
}

void getFrameJacobian(const CompactModel& model, Data& data, int frame, ReferenceFrame reference, const MatrixOut& J) {
  checkData("getFrameJacobian", model, data);
  checkShape("getFrameJacobian", "J", J, 6, model.nv());
  writeJacobian(model.impl(), data.impl(), frameOnBody(model, frame), reference, J);
}

}  // namespace dyn
