// SPDX-License-Identifier: BSD-2-Clause
#include "exact_bodies.hpp"

#include <algorithm>

namespace dyn::tool {

namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// The pose of a body's joint, when the coordinates move in this way.
Series poseOf(const ExactBody& body, const std::vector<TimeSeries>& q) {
  const TimeSeries* own = q.data() + body.q;
  if (body.coefficients.empty()) return body.joint.pose(own);
  const TimeSeries x = polynomial(body.coefficients, *own);
  return body.joint.pose(&x);
}

}  // namespace

Vec momentOf(const ExactBody& body, const Series& x) {
  const Mat &R0 = x.R[0], &R1 = x.R[1], &I = body.inertia;
  return (R1 * I * R0.transpose() + R0 * I * R1.transpose()) * x.omega() + R0 * I * R0.transpose() * x.alpha();
}

ExactBodies::ExactBodies(const Model& description, const CompactModel& model)
    : bodies(description.bodies.size()), carried(at(model.njoints())), gravity(vec(description.gravity)), nv(model.nv()) {
  for (int j = 1; j < model.njoints(); ++j) carried[at(j)] = at(description.findJoint(model.joints()[at(j)].name));
  for (std::size_t i = 1; i < bodies.size(); ++i) {
    const BodyDescription& from = description.bodies[i];
    const JointDescription& joint = from.joint;
    ExactBody& body = bodies[i];
    body.joint = exactJoint(joint);
    body.placement = exactPlacement(joint.placement);
    body.name = from.name;
    body.parent = from.parent;
    body.moves = body.joint.nv > 0 || bodies[at(from.parent)].moves;
    body.mass = Real(from.inertia.mass);
    body.com = vec(from.inertia.com);
    for (int r = 0; r < 3; ++r)
      body.inertia.col(r) = vec(from.inertia.rotational * Vec3<double>{r == 0 ? 1.0 : 0.0, r == 1 ? 1.0 : 0.0, r == 2 ? 1.0 : 0.0});
    if (body.joint.nv == 0) continue;
    const bool depends = !joint.coupling.type.empty();
    if (depends) {
      if (joint.coupling.type != "mimic") refuse(joint, "has no definition of the coupling type '" + joint.coupling.type + "'");
      const int master = description.findJoint(joint.coupling.master);
      const auto leads = [](const JointDescription& other) { return other.coupling.type.empty() && exactJoint(other).nq == 1; };
      if (master < 0 || !leads(description.bodies[at(master)].joint) || body.joint.nq != 1)
        refuse(joint, "knows only joints of one coordinate that depend on an independent joint of one coordinate");
      body.coefficients = std::get<std::vector<double>>(joint.coupling.parameters.at("coefficients"));
    }
    const int id = model.findJoint(depends ? joint.coupling.master : joint.name);
    if (id < 0) refuse(joint, "finds no joint of this name in the compiled model");
    body.q = model.joints()[at(id)].idx_q;
    body.v = model.joints()[at(id)].idx_v;
  }
}

bool ExactBodies::follows() const {
  return std::any_of(bodies.begin(), bodies.end(), [](const ExactBody& body) { return !body.coefficients.empty(); });
}

std::vector<TimeSeries> ExactBodies::coordinates(const VectorR& q, const VectorR& v, const VectorR& a) const {
  std::vector<TimeSeries> out(at(static_cast<int>(q.size())));
  for (const ExactBody& body : bodies) {
    if (body.joint.nv == 0 || !body.coefficients.empty()) continue;
    const std::vector<TimeSeries> own = body.joint.move(q.data() + body.q, v.data() + body.v, a.data() + body.v);
    std::copy(own.begin(), own.end(), out.begin() + body.q);
  }
  return out;
}

Place ExactBodies::place(const VectorR& q) const {
  Place out{q, std::vector<Place::Joint>(bodies.size())};
  const VectorR still = VectorR::Zero(nv);
  for (std::size_t i = 1; i < bodies.size(); ++i) {
    const ExactBody& body = bodies[i];
    Place::Joint& joint = out.joints[i];
    const ExactJoint& mover = body.joint;
    const int n = body.freedom();
    const auto series = [&](int d, int e) {
      VectorR v = still;
      if (d >= 0) v[body.v + d] += Real(1);
      if (e >= 0) v[body.v + e] += Real(1);
      std::vector<TimeSeries> x(at(static_cast<int>(q.size())));
      if (!body.coefficients.empty()) {
        x[at(body.q)] = TimeSeries(q[body.q], v[body.v]);
      } else if (mover.nv > 0) {
        const std::vector<TimeSeries> own = mover.move(q.data() + body.q, v.data() + body.v, still.data() + body.v);
        std::copy(own.begin(), own.end(), x.begin() + body.q);
      }
      return poseOf(body, x);
    };
    joint.second.resize(at(n * n));
    std::vector<Series> along;
    for (int d = 0; d < n; ++d) {
      along.push_back(series(d, -1));
      joint.first.push_back({along.back().R[1], along.back().p[1]});
    }
    const Series rest = n > 0 ? along.front() : series(-1, -1);
    joint.at = {rest.R[0], rest.p[0]};
    // Second derivatives are quadratic in the velocities: those by two of them follow from three motions.
    for (int d = 0; d < n; ++d)
      for (int e = 0; e <= d; ++e) {
        Place::Own& by = joint.second[at(d * n + e)];
        if (d == e) {
          by = {along[at(d)].R[2], along[at(d)].p[2]};
        } else {
          const Series both = series(d, e);
          by = {(both.R[2] - along[at(d)].R[2] - along[at(e)].R[2]) / Real(2), (both.p[2] - along[at(d)].p[2] - along[at(e)].p[2]) / Real(2)};
          joint.second[at(e * n + d)] = by;
        }
      }
  }
  return out;
}

Place ExactBodies::moved(const Place& from, const VectorR& v, const Real& h) const {
  const std::vector<TimeSeries> x = coordinates(from.q, v, VectorR::Zero(nv));
  VectorR q = from.q;
  for (std::size_t k = 0; k < x.size(); ++k) q[static_cast<Eigen::Index>(k)] += h * (x[k].c[1] + h / Real(2) * x[k].c[2]);
  return place(q);
}

Series ExactBodies::own(std::size_t i, const Place& place, const VectorR& v, const VectorR& a) const {
  const Place::Joint& joint = place.joints[i];
  const int n = bodies[i].freedom();
  const Real* const velocity = v.data() + bodies[i].v;
  Series out = Series::constant(joint.at.R, joint.at.p);
  for (int d = 0; d < n; ++d) {
    const Real &vd = velocity[d], &ad = a[bodies[i].v + d];
    if (ad != Real(0)) {
      out.R[2] += ad * joint.first[at(d)].R;
      out.p[2] += ad * joint.first[at(d)].p;
    }
    if (vd == Real(0)) continue;
    out.R[1] += vd * joint.first[at(d)].R;
    out.p[1] += vd * joint.first[at(d)].p;
    for (int e = 0; e < n; ++e) {
      if (velocity[e] == Real(0)) continue;
      out.R[2] += vd * velocity[e] * joint.second[at(d * n + e)].R;
      out.p[2] += vd * velocity[e] * joint.second[at(d * n + e)].p;
    }
  }
  return out;
}

std::vector<Series> ExactBodies::motions(const Place& place, const VectorR& v, const VectorR& a) const {
  std::vector<Series> out(bodies.size(), Series::identity());
  for (std::size_t i = 1; i < bodies.size(); ++i) out[i] = out[at(bodies[i].parent)] * bodies[i].placement * own(i, place, v, a);
  return out;
}

BodyJacobians ExactBodies::jacobians(const Place& place, bool of_origins) const {
  BodyJacobians out{std::vector<MatrixR>(bodies.size(), MatrixR::Zero(3, nv)), {}};
  out.angular = out.linear;
  const VectorR still = VectorR::Zero(nv);
  for (int k = 0; k < nv; ++k) {
    const std::vector<Series> moved = motions(place, VectorR::Unit(nv, k), still);
    for (std::size_t i = 1; i < bodies.size(); ++i) {
      out.linear[i].col(k) = of_origins ? moved[i].p[1] : moved[i].p[1] + moved[i].R[1] * bodies[i].com;
      out.angular[i].col(k) = moved[i].omega();
    }
  }
  return out;
}

VectorR ExactBodies::rnea(const Place& place, const VectorR& v, const VectorR& a, const BodyJacobians& J) const {
  const std::vector<Series> x = motions(place, v, a);
  VectorR tau = VectorR::Zero(nv);
  for (std::size_t i = 1; i < bodies.size(); ++i) {
    const ExactBody& body = bodies[i];
    if (body.mass == 0 && body.inertia.isZero()) continue;
    const Vec force = body.mass * (x[i].p[2] + x[i].R[2] * body.com - gravity);
    tau += J.linear[i].transpose() * force + J.angular[i].transpose() * momentOf(body, x[i]);
  }
  return tau;
}

MatrixR ExactBodies::massMatrix(const Place& place, const BodyJacobians& J) const {
  const std::vector<Series> x = motions(place, VectorR::Zero(nv), VectorR::Zero(nv));
  MatrixR M = MatrixR::Zero(nv, nv);
  for (std::size_t i = 1; i < bodies.size(); ++i) {
    const Mat I = x[i].R[0] * bodies[i].inertia * x[i].R[0].transpose();
    M += bodies[i].mass * (J.linear[i].transpose() * J.linear[i]) + J.angular[i].transpose() * I * J.angular[i];
  }
  return M;
}

std::vector<MatrixR> ExactBodies::byConfiguration(const Place& at, const OfPlace& f, const Real& h) const {
  std::vector<MatrixR> out;
  for (int k = 0; k < nv; ++k) out.push_back(alongMotion(at, VectorR::Unit(nv, k), f, h));
  return out;
}

MatrixR ExactBodies::alongMotion(const Place& at, const VectorR& v, const OfPlace& f, const Real& h) const {
  return (f(moved(at, v, h)) - f(moved(at, v, -h))) / (Real(2) * h);
}

std::vector<MatrixR> byVector(const VectorR& x, const std::function<MatrixR(const VectorR&)>& f, const Real& h) {
  std::vector<MatrixR> out;
  for (Eigen::Index k = 0; k < x.size(); ++k) {
    const VectorR d = h * VectorR::Unit(x.size(), k);
    out.push_back((f(x + d) - f(x - d)) / (Real(2) * h));
  }
  return out;
}

std::vector<double> ExactBodies::scale(const Place& place, const VectorR& v, const VectorR& a) const {
  std::vector<double> out(at(nv), 0.0);
  struct Bound {
    double force = 0, turn = 0, w = 0;  ///< bounds of acceleration and angular acceleration; size of the angular velocity
  };
  std::vector<Bound> bound(bodies.size());
  std::vector<double> reach(bodies.size(), 0.0);  ///< distance from the parent's origin to the joint's
  const std::vector<Series> x = motions(place, v, a);
  bound[0].force = length(gravity);
  for (std::size_t i = 1; i < bodies.size(); ++i) {
    const ExactBody& body = bodies[i];
    const Bound& up = bound[at(body.parent)];
    const Series joint = own(i, place, v, a);
    reach[i] = length(body.placement.p[0] + body.placement.R[0] * joint.p[0]);
    const double r = body.parent == 0 ? 0 : reach[i];  // the world neither turns nor moves
    bound[i] = {up.force + (up.turn + up.w * up.w) * r + 2 * up.w * length(joint.p[1]) + length(joint.p[2]),
                up.turn + up.w * length(joint.omega()) + length(joint.alpha()), length(x[i].omega())};
    const double turning = bound[i].turn + bound[i].w * bound[i].w, com = length(body.com);
    const double force = static_cast<double>(body.mass) * (bound[i].force + turning * com);
    const double moment = static_cast<double>(body.inertia.norm()) * turning;
    double arm = com;  // a bound of the distance from the joint's moved origin to the centre of mass
    for (std::size_t k = i; k > 0; k = at(bodies[k].parent)) {
      for (int d = 0; d < bodies[k].freedom(); ++d) {
        const Place::Own& along = place.joints[k].first[at(d)];
        const double slide = length(along.p), turn = length(uncross(along.R * place.joints[k].at.R.transpose()));
        out[at(bodies[k].v + d)] += slide * force + turn * (arm * force + moment);
      }
      arm += reach[k];
    }
  }
  return out;
}

}  // namespace dyn::tool
