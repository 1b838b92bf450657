// SPDX-License-Identifier: BSD-2-Clause
#include "oracle.hpp"

#include "exact.hpp"
#include "gragg.hpp"

#include <dyn/error.hpp>

#include <Eigen/LU>

#include <functional>

namespace dyn::tool {

namespace {

enum class Kind { fixed, turning, circle, sliding, ball, flying, translating };

/// A joint. Its own motion is R exp(cross(turn t + turn' t^2 / 2)) and p + slide t + slide' t^2 / 2; in a free joint, slide turns with the body.
struct Joint {
  Kind kind = Kind::fixed;
  Vec axis = Vec::Zero();
  Series placement;
  int parent = 0, q = 0, v = 0, nv = 0;

  Mat inertia = Mat::Zero();  ///< about the centre of mass
  Vec com = Vec::Zero();
  Real mass = 0;
};

/// The joints' own poses at a configuration, in the joint frames.
struct Place {
  std::vector<Mat> R;
  std::vector<Vec> p;
};

constexpr double difference_step = 1e-17;

}  // namespace

struct Oracle::Impl {
  std::vector<Joint> joints;
  Vec gravity;
  int nv = 0;

  /// The joint's own pose (R, p) at its coordinates in q.
  void placeJoint(const Joint& j, const VectorR& q, Mat& R, Vec& p) const {
    R = Mat::Identity();
    p = Vec::Zero();
    switch (j.kind) {
      case Kind::fixed:
        break;
      case Kind::turning:
        R = rotation(j.axis, cos(q[j.q]), sin(q[j.q]));
        break;
      case Kind::circle: {
        const Real n = sqrt(q[j.q] * q[j.q] + q[j.q + 1] * q[j.q + 1]);
        R = rotation(j.axis, q[j.q] / n, q[j.q + 1] / n);
        break;
      }
      case Kind::sliding:
        p = q[j.q] * j.axis;
        break;
      case Kind::ball:
        R = rotation(VectorR(q.segment(j.q, 4)));
        break;
      case Kind::flying:
        p = q.segment<3>(j.q);
        R = rotation(VectorR(q.segment(j.q + 3, 4)));
        break;
      case Kind::translating:
        p = q.segment<3>(j.q);
        break;
    }
  }
  Place place(const VectorR& x) const {
    Place at{std::vector<Mat>(joints.size()), std::vector<Vec>(joints.size())};
    for (std::size_t i = 1; i < joints.size(); ++i) placeJoint(joints[i], x, at.R[i], at.p[i]);
    return at;
  }

  /// Angular and linear velocity of a joint, both in its moving frame.
  void rates(const Joint& j, const VectorR& v, Vec& turn, Vec& slide) const {
    turn = slide = Vec::Zero();
    if (j.kind == Kind::turning || j.kind == Kind::circle) turn = v[j.v] * j.axis;
    if (j.kind == Kind::sliding) slide = v[j.v] * j.axis;
    if (j.kind == Kind::ball) turn = v.segment<3>(j.v);
    if (j.kind == Kind::translating || j.kind == Kind::flying) slide = v.segment<3>(j.v);
    if (j.kind == Kind::flying) turn = v.segment<3>(j.v + 3);
  }

  Series motion(std::size_t i, const Place& at, const VectorR& v, const VectorR& a) const {
    const Joint& j = joints[i];
    Vec w, s, dw, ds;
    rates(j, v, w, s);
    rates(j, a, dw, ds);
    const Mat &R = at.R[i], W = cross(w), RW = R * W;
    // The linear velocity of a free body turns with it. No other joint turns and slides at once.
    Series out;
    out.R = {R, RW, RW * W + R * cross(dw)};
    out.p = {at.p[i], R * s, RW * s + R * ds};
    return j.placement * out;
  }
  std::vector<Series> motions(const Place& at, const VectorR& v, const VectorR& a) const {
    std::vector<Series> out(joints.size(), Series::constant(Mat::Identity(), Vec::Zero()));
    for (std::size_t i = 1; i < joints.size(); ++i) out[i] = out[static_cast<std::size_t>(joints[i].parent)] * motion(i, at, v, a);
    return out;
  }

  /// Columns: velocities of the centres of mass and angular velocities of the bodies, for unit joint velocities.
  struct Jacobians {
    std::vector<Eigen::Matrix<Real, 3, Eigen::Dynamic>> linear, angular;
  };
  Jacobians jacobians(const Place& at) const {
    Jacobians out{std::vector<Eigen::Matrix<Real, 3, Eigen::Dynamic>>(joints.size(), Eigen::Matrix<Real, 3, Eigen::Dynamic>::Zero(3, nv)), {}};
    out.angular = out.linear;
    const VectorR still = VectorR::Zero(nv);
    VectorR v = still;
    for (int k = 0; k < nv; ++k) {
      v[k] = 1;
      const std::vector<Series> moved = motions(at, v, still);
      v[k] = 0;
      for (std::size_t i = 1; i < joints.size(); ++i) {
        out.linear[i].col(k) = moved[i].p[1] + moved[i].R[1] * joints[i].com;
        out.angular[i].col(k) = moved[i].omega();
      }
    }
    return out;
  }

  VectorR rnea(const Place& at, const VectorR& v, const VectorR& a, const Jacobians& J) const {
    const std::vector<Series> x = motions(at, v, a);
    VectorR tau = VectorR::Zero(nv);
    for (std::size_t i = 1; i < joints.size(); ++i) {
      const Joint& j = joints[i];
      if (j.mass == 0 && j.inertia.isZero(Real(0))) continue;
      const Vec force = j.mass * (x[i].p[2] + x[i].R[2] * j.com - gravity);
      const Vec w = x[i].omega();
      const Mat &R0 = x[i].R[0], &R1 = x[i].R[1];
      // d/dt (R I R^T w), by the product rule on the series.
      const Vec moment = (R1 * j.inertia * R0.transpose() + R0 * j.inertia * R1.transpose()) * w + R0 * j.inertia * R0.transpose() * x[i].alpha();
      tau += J.linear[i].transpose() * force + J.angular[i].transpose() * moment;
    }
    return tau;
  }

  MatrixR massMatrix(const Place& at, const Jacobians& J) const {
    const std::vector<Series> x = motions(at, VectorR::Zero(nv), VectorR::Zero(nv));
    MatrixR M = MatrixR::Zero(nv, nv);
    for (std::size_t i = 1; i < joints.size(); ++i) {
      const Mat I = x[i].R[0] * joints[i].inertia * x[i].R[0].transpose();
      M += joints[i].mass * (J.linear[i].transpose() * J.linear[i]) + J.angular[i].transpose() * I * J.angular[i];
    }
    return M;
  }

  /// Upper bounds of the summands of each torque. Doubles suffice, as the digits of a scale do not matter.
  std::vector<double> scale(const Place& at, const VectorR& v, const VectorR& a) const {
    std::vector<double> out(static_cast<std::size_t>(nv), 0.0);
    struct Bound {
      double force = 0, turn = 0, w = 0;  ///< bounds of acceleration and angular acceleration; size of the angular velocity
    };
    std::vector<Bound> bound(joints.size());
    std::vector<double> reach(joints.size(), 0.0);  ///< distance from the parent's origin to the joint's
    const std::vector<Series> x = motions(at, v, a);
    bound[0].force = length(gravity);
    for (std::size_t i = 1; i < joints.size(); ++i) {
      const Joint& j = joints[i];
      const Bound& up = bound[static_cast<std::size_t>(j.parent)];
      Vec w, s, dw, ds;
      rates(j, v, w, s);
      rates(j, a, dw, ds);
      reach[i] = length(j.placement.p[0] + j.placement.R[0] * at.p[i]);
      const double r = j.parent == 0 ? 0 : reach[i];  // the world neither turns nor moves
      bound[i] = {up.force + (up.turn + up.w * up.w) * r + 2 * up.w * length(s) + length(ds), up.turn + up.w * length(w) + length(dw),
                  length(x[i].omega())};
      const double turning = bound[i].turn + bound[i].w * bound[i].w, com = length(j.com);
      const double force = static_cast<double>(j.mass) * (bound[i].force + turning * com);
      const double moment = static_cast<double>(j.inertia.norm()) * turning;
      double lever = com;
      for (std::size_t k = i; k > 0; k = static_cast<std::size_t>(joints[k].parent)) {
        const Joint& on = joints[k];
        // The joint's own displacement lies between its frame and the body's.
        const double own = lever + (on.kind == Kind::sliding || on.kind == Kind::translating ? length(at.p[k]) : 0.0);
        for (int d = 0; d < on.nv; ++d) {
          const bool slides = on.kind == Kind::sliding || on.kind == Kind::translating || (on.kind == Kind::flying && d < 3);
          out[static_cast<std::size_t>(on.v + d)] += slides ? force : own * force + moment;
        }
        lever += reach[k];
      }
    }
    return out;
  }

  /// The time derivative of y = (q, v) in free motion: dq/dt in the joints' coordinates, and M^-1 (- nle).
  VectorR rate(const VectorR& y, int nq) const {
    const VectorR q = y.head(nq), v = y.tail(nv), still = VectorR::Zero(nv);
    const Place at = place(q);
    const Jacobians J = jacobians(at);
    VectorR out = VectorR::Zero(y.size());
    out.tail(nv) = Eigen::PartialPivLU<MatrixR>(massMatrix(at, J)).solve(-rnea(at, v, still, J));
    for (std::size_t i = 1; i < joints.size(); ++i) {
      const Joint& j = joints[i];
      const auto turnQuaternion = [&](int first, const Vec& w) {
        const Vec im = q.segment<3>(first);
        out.segment<3>(first) = (q[first + 3] * w + cross(im) * w) / Real(2);
        out[first + 3] = -im.dot(w) / Real(2);
      };
      switch (j.kind) {
        case Kind::fixed:
          break;
        case Kind::turning:
        case Kind::sliding:
          out[j.q] = v[j.v];
          break;
        case Kind::circle:
          out[j.q] = -q[j.q + 1] * v[j.v];
          out[j.q + 1] = q[j.q] * v[j.v];
          break;
        case Kind::ball:
          turnQuaternion(j.q, v.segment<3>(j.v));
          break;
        case Kind::flying:
          out.segment<3>(j.q) = at.R[i] * v.segment<3>(j.v);
          turnQuaternion(j.q + 3, v.segment<3>(j.v + 3));
          break;
        case Kind::translating:
          out.segment<3>(j.q) = v.segment<3>(j.v);
          break;
      }
    }
    return out;
  }

  /// Column k of either is the derivative of f along the k-th direction: of the configuration, or of the velocity.
  MatrixR byConfiguration(const Place& at, const std::function<VectorR(const Place&)>& f) const {
    MatrixR out(nv, nv);
    for (std::size_t i = 1; i < joints.size(); ++i)
      for (int d = 0; d < joints[i].nv; ++d) {
        VectorR values[2];
        for (const int side : {0, 1}) {
          Place moved = at;
          VectorR v = VectorR::Zero(nv);
          v[joints[i].v + d] = Real(side == 0 ? difference_step : -difference_step);
          Vec w, s;
          rates(joints[i], v, w, s);
          const Mat W = cross(w);
          // The exponential is taken to second order. The terms left out cancel, or are as small as the difference's own error.
          moved.p[i] += at.R[i] * s;
          moved.R[i] = at.R[i] * (Mat::Identity() + W + (W * W) / Real(2));
          values[side] = f(moved);
        }
        out.col(joints[i].v + d) = (values[0] - values[1]) / Real(2 * difference_step);
      }
    return out;
  }
  MatrixR byVelocity(const VectorR& v, const std::function<VectorR(const VectorR&)>& f) const {
    MatrixR out(nv, nv);
    for (int k = 0; k < nv; ++k) {
      VectorR more = v, less = v;
      more[k] += Real(difference_step);
      less[k] -= Real(difference_step);
      out.col(k) = (f(more) - f(less)) / Real(2 * difference_step);
    }
    return out;
  }
};

Oracle::Oracle(const Model& description, const CompactModel& model) : impl_(std::make_unique<Impl>()) {
  impl_->gravity = vec(description.gravity);
  impl_->nv = model.nv();
  impl_->joints.resize(description.bodies.size());
  for (std::size_t i = 1; i < description.bodies.size(); ++i) {
    const BodyDescription& body = description.bodies[i];
    Joint& j = impl_->joints[i];
    const std::string& type = body.joint.type;
    const auto refuse = [&](const std::string& why) {
      throw Error(ErrorCode::joint_type, "the fifty-digit reference " + why, {{}, 0, body.joint.name});
    };
    if (!body.joint.coupling.type.empty()) refuse("knows no joints that follow others");
    if (type == "revolute")
      j.kind = Kind::turning;
    else if (type == "continuous")
      j.kind = Kind::circle;
    else if (type == "prismatic")
      j.kind = Kind::sliding;
    else if (type == "spherical")
      j.kind = Kind::ball;
    else if (type == "free_flyer")
      j.kind = Kind::flying;
    else if (type == "translation")
      j.kind = Kind::translating;
    else if (type != "fixed")
      refuse("has no definition of the joint type '" + type + "'");
    if (j.kind == Kind::turning || j.kind == Kind::circle || j.kind == Kind::sliding) {
      j.axis = Vec(Real(0), Real(0), Real(1));
      const auto found = body.joint.parameters.find("axis");
      if (found != body.joint.parameters.end()) {
        const auto& axis = std::get<std::vector<double>>(found->second);
        j.axis = Vec(Real(axis.at(0)), Real(axis.at(1)), Real(axis.at(2)));
      }
      j.axis /= j.axis.norm();
    }
    Mat R;
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) R(r, c) = Real(body.joint.placement.R(r, c));
    j.placement = Series::constant(R, vec(body.joint.placement.p));
    j.parent = body.parent;
    const Inertia<double>& Y = body.inertia;
    const Sym3<double>& I = Y.rotational;
    j.mass = Real(Y.mass);
    j.com = vec(Y.com);
    for (int r = 0; r < 3; ++r) {
      const Vec3<double> column = I * Vec3<double>{r == 0 ? 1.0 : 0.0, r == 1 ? 1.0 : 0.0, r == 2 ? 1.0 : 0.0};
      j.inertia.col(r) = vec(column);
    }
    if (j.kind == Kind::fixed) continue;
    const int id = model.findJoint(body.joint.name);
    if (id < 0) refuse("finds no joint of this name in the compiled model");
    const JointRecord& record = model.joints()[static_cast<std::size_t>(id)];
    j.q = record.idx_q;
    j.v = record.idx_v;
    j.nv = record.nv;
  }
}

Oracle::~Oracle() = default;

TruthSample Oracle::evaluate(const State& state, bool derivatives) const {
  const Impl& x = *impl_;
  const int n = x.nv;
  const Place at = x.place(exact(state.q));
  const VectorR v = exact(state.v), a = exact(state.a), tau = exact(state.tau), still = VectorR::Zero(n);
  const Impl::Jacobians J = x.jacobians(at);
  const MatrixR M = x.massMatrix(at, J);
  const VectorR nle = x.rnea(at, v, still, J);
  const Eigen::PartialPivLU<MatrixR> solver(M);
  const VectorR ddq = solver.solve(tau - nle);
  const MatrixR Minv = solver.inverse();

  TruthSample out{state, {}};
  out.truth["rnea"] = rounded(x.rnea(at, v, a, J));
  out.truth["nle"] = rounded(nle);
  out.truth["gravity"] = rounded(x.rnea(at, still, still, J));
  out.truth["M"] = rounded(M);
  out.truth["aba"] = rounded(ddq);
  const std::vector<double> scale = x.scale(at, v, a), moved = x.scale(at, v, ddq);
  out.truth["rnea_scale"].assign(scale.begin(), scale.end());
  for (int i = 0; i < n; ++i) {
    double sum = 0;
    for (int k = 0; k < n; ++k) sum += static_cast<double>(abs(Minv(i, k))) * (moved[static_cast<std::size_t>(k)] + std::abs(state.tau[k]));
    out.truth["aba_scale"].push_back(sum);
  }
  if (!derivatives) return out;
  const auto inverseDynamics = [&](const VectorR& acceleration) {
    return [&x, &v, acceleration](const Place& moved_to) { return x.rnea(moved_to, v, acceleration, x.jacobians(moved_to)); };
  };
  const MatrixR by_v = x.byVelocity(v, [&](const VectorR& w) { return x.rnea(at, w, a, J); });
  out.truth["dtau_dq"] = rounded(x.byConfiguration(at, inverseDynamics(a)));
  out.truth["dtau_dv"] = rounded(by_v);
  // These follow by differentiating M ddq + nle = tau.
  out.truth["ddq_dq"] = rounded(-Minv * x.byConfiguration(at, inverseDynamics(ddq)));
  out.truth["ddq_dv"] = rounded(-Minv * by_v);
  out.truth["Minv"] = rounded(Minv);
  return out;
}

State Oracle::move(const State& start, double time, int steps) const {
  const auto nq = static_cast<int>(start.q.size());
  VectorR y(nq + impl_->nv);
  y << exact(start.q), exact(start.v);
  const Real h = Real(time) / Real(steps);
  for (int k = 0; k < steps; ++k) y = extrapolate<8>(y, h, [&](const VectorR& x) { return impl_->rate(x, nq); });
  State end = start;
  for (int k = 0; k < nq; ++k) end.q[k] = static_cast<double>(y[k]);
  for (int k = 0; k < impl_->nv; ++k) end.v[k] = static_cast<double>(y[nq + k]);
  return end;
}

}  // namespace dyn::tool
