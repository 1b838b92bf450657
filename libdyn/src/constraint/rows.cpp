#include "constraint/rows.hpp"

#include "joint/coordinate.hpp"

#include <dyn/lie/so3.hpp>

#include <algorithm>
#include <cmath>

namespace dyn {

namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

using kernels::ConstraintWorkspace;

/// The origin of `body`, from that of `stop`, which is above it; for 0, of the world or of a flying root.
Vec3<double> originFrom(const PackedConstraints& c, const ConstraintWorkspace& x, int body, int stop) {
  Vec3<double> sum;
  for (int k = c.chainOf(body), end = c.chainOf(stop); k != end; k = c.chains[at(k)].parent) sum += x.chains[k].lever;
  return sum;
}

/// The velocity relative to `stop` of the point of `body` at `lever` from its origin.
Motion<double> velocityFrom(const PackedConstraints& c, const ConstraintWorkspace& x, int body, int stop, Vec3<double> lever) {
  Motion<double> sum;
  for (int k = c.chainOf(body), end = c.chainOf(stop); k != end; k = c.chains[at(k)].parent) {
    const Motion<double>& v = x.chains[k].velocity;
    sum.linear += v.linear + cross(v.angular, lever);
    sum.angular += v.angular;
    lever += x.chains[k].lever;
  }
  return sum;
}

/// The rotation that brings b to a, two unit vectors, the shortest way.
Vec3<double> tilt(const Vec3<double>& a, const Vec3<double>& b) {
  const Vec3<double> n = cross(b, a);
  const double sine = std::sqrt(dot(n, n)), cosine = dot(a, b);
  if (sine > 0) return (std::atan2(sine, cosine) / sine) * n;
  if (cosine > 0) return {};
  // Opposite: any axis across leads there.
  const Vec3<double> across = cross(b, std::abs(b.x) < 0.5 ? Vec3<double>{1, 0, 0} : Vec3<double>{0, 1, 0});
  return (M_PI / std::sqrt(dot(across, across))) * across;
}

/// How far the first frame is turned against the second, in directions that are not free: a vector in the axes of both rotations.
Vec3<double> turnedBy(const PackedFrameConstraint& c, const Mat3<double>& first, const Mat3<double>& second) {
  if (c.turnsFreely()) return {};
  for (int k = 0; k < 3; ++k)
    if (c.free[at(3 + k)]) return tilt(first.col(k), second.col(k));
  return second * log3(transpose(second) * first);
}

void locate(const PackedConstraints& all, const ConstraintWorkspace& x, const PackedFrameConstraint& c, bool moves, FrameRows& out) {
  const bool on_world = c.body[1] == 0;
  const kernels::ChainState &own = x.stateOf(all, c.body[0]), &other = x.stateOf(all, c.body[1]);
  const Mat3<double> first = own.R * c.placement[0].R;
  out.lever[0] = own.R * c.placement[0].p;
  out.lever[1] = {};
  out.error = {};
  out.turn = c.common > 0 ? Mat3<double>::identity() : (on_world ? own.tree.R : transpose(other.tree.R) * own.tree.R);
  // The world's own lever is asked for by targets only.
  if (c.common > 0) {
    out.lever[1] = originFrom(all, x, c.body[0], c.common) + out.lever[0] - originFrom(all, x, c.body[1], c.common);
  } else if (!on_world || c.has_target) {
    out.lever[1] = transposeTimes(other.tree.R,
                                  own.tree.act(originFrom(all, x, c.body[0], 0) + out.lever[0]) - other.tree.act(originFrom(all, x, c.body[1], 0)));
  }
  out.relative = {};
  out.w[0] = out.w[1] = {};
  if (moves) {
    out.relative = velocityFrom(all, x, c.body[0], c.common, out.lever[0]);
    out.w[0] = own.w;
    if (!on_world) {
      out.relative -= kernels::turnedBack(out.turn, velocityFrom(all, x, c.body[1], c.common, out.lever[1]));
      out.w[1] = transposeTimes(out.turn, other.w);
    }
  }
  Mat3<double> second;
  if (c.has_target || c.axes == ConstraintAxes::OTHER) second = transpose(out.turn) * (other.R * c.placement[1].R);
  out.axes = c.axes == ConstraintAxes::LOCAL ? first : (c.axes == ConstraintAxes::OTHER ? second : transpose(own.tree.R));
  if (!c.has_target) return;
  const Vec3<double> target = other.R * c.placement[1].p;  // from the second body's origin
  out.error.linear = transposeTimes(out.axes, transposeTimes(out.turn, out.lever[1] - target));
  out.error.angular = transposeTimes(out.axes, turnedBy(c, first, second));
}

/// d/dt of the relative velocity in the constraint's axes, less what the accelerations of the bodies' origins give.
Motion<double> biasOf(const PackedFrameConstraint& c, const FrameRows& x) {
  const Vec3<double>&w1 = x.w[0], &w2 = x.w[1], &V = x.relative.linear;
  Motion<double> bias{cross(w1, cross(w1, x.lever[0])), {}};
  if (c.body[1] > 0) bias.linear = bias.linear - cross(w2, cross(w2, transposeTimes(x.turn, x.lever[1]))) - cross(w2, V);
  // A point that cannot move at all is held by its own acceleration, whatever its axes do.
  const bool point = c.turnsFreely() && c.rows == 3;
  if (c.axes == ConstraintAxes::OTHER || (c.axes == ConstraintAxes::LOCAL && !point)) {
    const Vec3<double>& turning = c.axes == ConstraintAxes::LOCAL ? w1 : w2;
    bias.linear -= cross(turning, V);
    bias.angular -= cross(turning, x.relative.angular);
  }
  return bias;
}

/// What x has in one of the directions 0 to 5 of a constraint's axes.
double along(const Mat3<double>& axes, int direction, const Motion<double>& x) {
  return dot(axes.col(direction % 3), direction < 3 ? x.linear : x.angular);
}

const TypeBatch& batchOf(const CompactImpl& m, int body) { return m.batches[at(m.index[at(body)].batch)]; }
const double* constantsOf(const CompactImpl& m, int body) { return batchOf(m, body).constants.data() + m.index[at(body)].slot; }

/// f and its derivatives at the master's coordinate.
void evaluateCoupling(const CompactImpl& m, const PackedJointCoupling& c, const double* q, double* f) {
  const TypeBatch& batch = batchOf(m, c.master);
  const double x = coordinateOf(*batch.type, constantsOf(m, c.master), batch.count, q + m.index[at(c.master)].idx_q);
  c.type->evaluate(c.constants.data(), static_cast<int>(c.constants.size()), x, f);
}

void differenceOf(const CompactImpl& m, int body, const double* from, const double* to, double* v) {
  const TypeBatch& batch = batchOf(m, body);
  ConfigurationBatch<double> b;
  b.count = 1;
  b.constants = constantsOf(m, body);
  b.constants_stride = batch.count;
  b.q_stride = b.v_stride = 1;
  b.q0 = from;
  b.q1 = to;
  b.v_out = v;
  batch.type->difference(b);
}

}  // namespace

void locateRows(const CompactImpl& m, const PackedConstraints& c, const ConstraintWorkspace& workspace, const double* q, const double* v,
                FrameRows* frames, const RowMotion& rows) {
  for (std::size_t k = 0; k < c.frames.size(); ++k) {
    const PackedFrameConstraint& f = c.frames[k];
    FrameRows& x = frames[k];
    locate(c, workspace, f, v != nullptr, x);
    const Motion<double> bias = v ? biasOf(f, x) : Motion<double>{};
    // Where both bodies move, both fall.
    Motion<double> fall;
    if (f.body[0] == 0 || f.body[1] == 0)
      fall.linear = (f.body[0] > 0 ? 1.0 : -1.0) * transposeTimes(workspace.stateOf(c, f.body[0]).tree.R, m.gravity);
    eachDirection(f, [&](int row, int direction) {
      const double error = direction < 3 ? x.error.linear[direction] : x.error.angular[direction - 3];
      rows.put(row, along(x.axes, direction, x.relative), along(x.axes, direction, bias), error, f.baumgarte);
      rows.fall[row] = along(x.axes, direction, fall);
    });
  }
  for (const PackedJointCoupling& k : c.couplings) {
    double f[4], q_wanted[max_joint_nq], error;
    evaluateCoupling(m, k, q, f);
    const BodyIndex &follower = m.index[at(k.body)], &master = m.index[at(k.master)];
    const double vm = v ? v[master.idx_v] : 0.0;
    setCoordinate(*batchOf(m, k.body).type, constantsOf(m, k.body), batchOf(m, k.body).count, f[0], q_wanted);
    differenceOf(m, k.body, q_wanted, q + follower.idx_q, &error);
    rows.put(k.row, (v ? v[follower.idx_v] : 0.0) - f[1] * vm, -f[2] * vm * vm, error, k.baumgarte);
    rows.fall[k.row] = 0;
  }
  for (const PackedJointLock& k : c.locks) {
    const BodyIndex& x = m.index[at(k.body)];
    double error[max_joint_nv] = {};
    if (!k.configuration.empty()) differenceOf(m, k.body, k.configuration.data(), q + x.idx_q, error);
    for (int r = 0; r < k.rows; ++r) {
      rows.put(k.row + r, v ? v[x.idx_v + r] : 0.0, 0, error[r], k.baumgarte);
      rows.fall[k.row + r] = 0;
    }
  }
}

namespace {

/// Every row's unit force: onBody(f, body, axes, lever) for each body of a constraint between frames, where its forces' axes and point are from
/// the body's origin; onJoint(body, k, row, share of its k-th degree of freedom).
template <class OnBody, class OnJoint>
void eachRowForce(const CompactImpl& m, const PackedConstraints& c, const FrameRows* frames, const double* q, OnBody&& onBody, OnJoint&& onJoint) {
  for (std::size_t k = 0; k < c.frames.size(); ++k) {
    const PackedFrameConstraint& f = c.frames[k];
    const FrameRows& s = frames[k];
    if (f.body[0] > 0) onBody(f, f.body[0], s.axes, s.lever[0]);
    if (f.body[1] > 0) onBody(f, f.body[1], -1.0 * (s.turn * s.axes), s.lever[1]);
  }
  for (const PackedJointCoupling& k : c.couplings) {
    double f[4];
    evaluateCoupling(m, k, q, f);
    onJoint(k.body, 0, k.row, 1.0);
    onJoint(k.master, 0, k.row, -f[1]);
  }
  for (const PackedJointLock& k : c.locks)
    for (int r = 0; r < k.rows; ++r) onJoint(k.body, r, k.row + r, 1.0);
}

}  // namespace

void writeRowForces(const CompactImpl& m, const PackedConstraints& c, const FrameRows* frames, const double* q, ConstraintWorkspace& x) {
  const auto step = [&](int chain) { return x.wholePacks(c.chains[at(chain)].row_end - c.chains[at(chain)].row_begin); };
  for (int k = 0; k < static_cast<int>(c.chains.size()); ++k) std::fill_n(x.forceOf(k), x.components * step(k), 0.0);
  if (c.actsOnJoints()) std::fill_n(x.share, x.room * static_cast<std::ptrdiff_t>(c.dofs.size()), 0.0);
  eachRowForce(
      m, c, frames, q,
      [&](const PackedFrameConstraint& f, int body, const Mat3<double>& axes, const Vec3<double>& lever) {
        const int chain = c.chainOf(body);
        const std::ptrdiff_t next = step(chain);
        double* first = x.forceOf(chain) - c.chains[at(chain)].row_begin;
        const double square = dot(lever, lever);
        eachDirection(f, [&](int row, int direction) {
          double* to = first + row;
          const Vec3<double> d = axes.col(direction % 3);
          if (direction < 3) {
            const Vec3<double> moment = cross(lever, d);
            for (int a = 0; a < 3; ++a) to[a * next] += d[a];
            for (int a = 0; a < 3; ++a) to[(3 + a) * next] += moment[a];
            to[x.reach * next] += square;
          } else {
            for (int a = 0; a < 3; ++a) to[(3 + a) * next] += d[a];
            to[x.reach * next] += 1;
          }
        });
      },
      [&](int body, int k, int row, double share) { x.shareOf(c.bodies[at(c.body_at[at(body)])].dof + k)[row] += share; });
}

void sumRowForces(const CompactImpl& m, const PackedConstraints& c, const FrameRows* frames, const double* q, const double* lambda,
                  Force<double>* bodies, double* shares) {
  std::fill_n(bodies, c.bodies.size(), Force<double>{});
  std::fill_n(shares, c.dofs.size(), 0.0);
  eachRowForce(
      m, c, frames, q,
      [&](const PackedFrameConstraint& f, int body, const Mat3<double>& axes, const Vec3<double>& lever) {
        Force<double>& sum = bodies[c.body_at[at(body)]];
        eachDirection(f, [&](int row, int direction) {
          const Vec3<double> part = lambda[row] * axes.col(direction % 3);
          if (direction < 3) sum += Force<double>{part, cross(lever, part)};
          if (direction >= 3) sum.angular += part;
        });
      },
      [&](int body, int k, int row, double share) { shares[c.bodies[at(c.body_at[at(body)])].dof + k] += lambda[row] * share; });
}

void rowAccelerations(const CompactImpl& m, const PackedConstraints& c, const FrameRows* frames, const double* q, const ConstraintWorkspace& x,
                      double* out) {
  for (std::size_t k = 0; k < c.frames.size(); ++k) {
    const PackedFrameConstraint& f = c.frames[k];
    const FrameRows& s = frames[k];
    const auto seen = [&](int e) {
      const Motion<double>& a = x.stateOf(c, f.body[e]).acceleration;
      return Motion<double>{a.linear + cross(a.angular, s.lever[e]), a.angular};
    };
    Motion<double> relative = seen(0);
    if (f.body[1] > 0) relative -= kernels::turnedBack(s.turn, seen(1));
    eachDirection(f, [&](int row, int direction) { out[row] = along(s.axes, direction, relative); });
  }
  const auto motionOf = [&](int body, int k) { return x.motion[c.bodies[at(c.body_at[at(body)])].dof + k]; };
  for (const PackedJointCoupling& k : c.couplings) {
    double f[4];
    evaluateCoupling(m, k, q, f);
    out[k.row] = motionOf(k.body, 0) - f[1] * motionOf(k.master, 0);
  }
  for (const PackedJointLock& k : c.locks)
    for (int r = 0; r < k.rows; ++r) out[k.row + r] = motionOf(k.body, r);
}

}  // namespace dyn
