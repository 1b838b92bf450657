// SPDX-License-Identifier: BSD-2-Clause
#include "pattern/library.hpp"

#include "at.hpp"
#include "compile/compact_impl.hpp"
#include "kernels/body/dissipation.hpp"
#include "pattern/joints.hpp"

#include <dyn/error.hpp>
#include <dyn/spatial/inertia.hpp>

#include <algorithm>

namespace dyn::benchmark {

namespace pattern {

namespace {

/// Joint i moves body i; body 0 is the world.
struct Library {
  struct Factor {
    Wrench U;
    double inverse = 0, u = 0;
  };

  const CompactImpl& m;
  CompactModel keep;
  std::vector<int> parent, idx_v, nv, subtree_nv;
  std::vector<Joint> joints;
  std::vector<Pose> placement;
  std::vector<Inertia<double>> inertia;

  std::vector<Pose> liMi, oMi;
  std::vector<Velocity> v, a;
  std::vector<Wrench> f, F;
  std::vector<Inertia<double>> Ycrb;
  std::vector<ArticulatedInertia<double>> Yaba;
  std::vector<Factor> factors;
  std::vector<double> tau, effective, ddq, M;

  explicit Library(const CompactModel& model);

  template <class Step>
  void visit(int i, Step&& step) {
    std::visit(step, joints[at(i)]);
  }
  int bodies() const { return static_cast<int>(joints.size()); }
  void forwardKinematics(const double* q);
  void rnea(const double* q, const double* vq, const double* aq);
  void crba(const double* q);
  void aba(const double* q, const double* vq, const double* torque);
};

template <template <int> class Aligned, class Unaligned>
Joint oneAxis(const Vector& axis) {
  for (int k = 0; k < 3; ++k) {
    Vector e;
    e[k] = 1;
    if (axis.x != e.x || axis.y != e.y || axis.z != e.z) continue;
    if (k == 0) return Aligned<0>();
    if (k == 1) return Aligned<1>();
    return Aligned<2>();
  }
  Unaligned joint;
  joint.axis = axis;
  return joint;
}
template <int axis>
using Bounded = Revolute<axis, false>;
template <int axis>
using Unbounded = Revolute<axis, true>;

Joint makeJoint(const std::string& type, const Vector& axis, const std::string& name) {
  if (type == "revolute") return oneAxis<Bounded, RevoluteUnaligned<false>>(axis);
  if (type == "continuous") return oneAxis<Unbounded, RevoluteUnaligned<true>>(axis);
  if (type == "prismatic") return oneAxis<Prismatic, PrismaticUnaligned>(axis);
  if (type == "spherical") return Spherical();
  if (type == "free_flyer") return FreeFlyer();
  throw Error(ErrorCode::argument, "the variant library has no joint type '" + type + "'", {"", 0, name});
}

Library::Library(const CompactModel& model) : m(model.impl()), keep(model) {
  if (!m.couplings.empty()) throw Error(ErrorCode::argument, "the variant library has no joints that follow others");
  const std::size_t n = at(m.bodies());
  for (std::vector<int>* numbers : {&parent, &idx_v, &nv, &subtree_nv}) numbers->resize(n);
  joints.resize(n);
  placement.resize(n);
  inertia.resize(n);
  for (int i = 1; i < m.bodies(); ++i) {
    const BodyIndex& x = m.index[at(i)];
    const BodyConstants<double>& c = m.constants[at(i)];
    // The core frames have z along the joint axis. Transform them back to the frames of the model's author.
    const Pose &mine = m.user_frame[at(x.joint)], world{};
    const Pose& parents = x.parent == 0 ? world : m.user_frame[at(m.index[at(x.parent)].joint)];
    Vector axis = mine.R.row(2);
    for (int k = 0; k < 3; ++k)
      if (std::fabs(std::fabs(axis[k]) - 1) < 1e-12) axis = {k == 0 ? axis.x : 0.0, k == 1 ? axis.y : 0.0, k == 2 ? axis.z : 0.0};
    parent[at(i)] = x.parent;
    placement[at(i)] = parents.inverse() * c.placement * mine;
    inertia[at(i)] = Inertia<double>{c.mass, c.com, c.rotational}.transformed(mine.inverse());
    joints[at(i)] = makeJoint(m.batches[at(x.batch)].type->info().name, axis, m.joints[at(x.joint)].name);
    std::visit(
        [&](auto& joint) {
          joint.idx_q = x.idx_q;
          joint.idx_v = x.idx_v;
        },
        joints[at(i)]);
    idx_v[at(i)] = x.idx_v;
    nv[at(i)] = x.nv;
  }
  for (int i = m.bodies() - 1; i > 0; --i) {
    subtree_nv[at(i)] += nv[at(i)];
    subtree_nv[at(parent[at(i)])] += subtree_nv[at(i)];
  }
  liMi.resize(n);
  oMi.resize(n);
  v.resize(n);
  a.resize(n);
  f.resize(n);
  Ycrb.resize(n);
  Yaba.resize(n);
  F.resize(at(m.nv));
  factors.resize(at(m.nv));
  tau.resize(at(m.nv));
  effective = ddq = tau;
  M.resize(at(m.nv) * at(m.nv));
}

void Library::forwardKinematics(const double* q) {
  for (int i = 1; i < bodies(); ++i)
    visit(i, [&](const auto& joint) {
      liMi[at(i)] = joint.place(placement[at(i)], q);
      oMi[at(i)] = parent[at(i)] > 0 ? oMi[at(parent[at(i)])] * liMi[at(i)] : liMi[at(i)];
    });
}

void Library::rnea(const double* q, const double* vq, const double* aq) {
  a[0].linear = -m.gravity;
  for (int i = 1; i < bodies(); ++i)
    visit(i, [&](const auto& joint) {
      const Pose X = joint.place(placement[at(i)], q);
      const Velocity s = joint.times(vq);
      const Velocity vi = X.actInv(v[at(parent[at(i)])]) + s;
      const Velocity ai = X.actInv(a[at(parent[at(i)])]) + joint.times(aq) + vi.cross(s);
      const Inertia<double>& Y = inertia[at(i)];
      liMi[at(i)] = X;
      v[at(i)] = vi;
      a[at(i)] = ai;
      f[at(i)] = Y * ai + crossStar(vi, Y * vi);
    });
  for (int i = bodies() - 1; i > 0; --i)
    visit(i, [&](const auto& joint) {
      joint.project(f[at(i)], tau.data());
      if (parent[at(i)] > 0) f[at(parent[at(i)])] += liMi[at(i)].act(f[at(i)]);
    });
  kernels::addJointForces(m, vq, aq, tau.data());
}

void Library::crba(const double* q) {
  const int n = m.nv;
  for (int i = 1; i < bodies(); ++i)
    visit(i, [&](const auto& joint) {
      liMi[at(i)] = joint.place(placement[at(i)], q);
      Ycrb[at(i)] = inertia[at(i)];
    });
  for (int i = bodies() - 1; i > 0; --i)
    visit(i, [&](const auto& joint) {
      const int first = joint.idx_v, end = first + subtree_nv[at(i)];
      for (int k = 0; k < joint.nv; ++k) F[at(first + k)] = Ycrb[at(i)] * joint.column(k);
      for (int col = first; col < end; ++col) {
        double x[6];
        Wrench& force = F[at(col)];
        for (int k = 0; k < joint.nv; ++k) x[k] = dot(joint.column(k), force);
        for (int k = 0; k < joint.nv; ++k) M[at(col) * at(n) + at(first + k)] = M[at(first + k) * at(n) + at(col)] = x[k];
        if (parent[at(i)] > 0) force = liMi[at(i)].act(force);
      }
      if (parent[at(i)] > 0) Ycrb[at(parent[at(i)])] = Ycrb[at(parent[at(i)])] + Ycrb[at(i)].transformed(liMi[at(i)]);
    });
  for (std::size_t k = 0; k < m.armature.size(); ++k) M[k * at(n) + k] += m.armature[k];
}

/// Y transformed by X: the axes are rotated by R, then the reference point moves by -p.
ArticulatedInertia<double> moved(const ArticulatedInertia<double>& Y, const Pose& X) {
  return ArticulatedInertia<double>{congruence(X.R, Y.linear), X.R * Y.coupling * transpose(X.R), congruence(X.R, Y.angular)}.shifted(X.p);
}

void Library::aba(const double* q, const double* vq, const double* torque) {
  std::copy_n(torque, m.nv, effective.data());
  kernels::addDissipation(m, -1.0, vq, effective.data());
  for (int i = 1; i < bodies(); ++i)
    visit(i, [&](const auto& joint) {
      const Pose X = joint.place(placement[at(i)], q);
      const Velocity s = joint.times(vq);
      const Velocity vi = X.actInv(v[at(parent[at(i)])]) + s;
      const Inertia<double>& Y = inertia[at(i)];
      liMi[at(i)] = X;
      v[at(i)] = vi;
      a[at(i)] = vi.cross(s);
      Yaba[at(i)] = ArticulatedInertia<double>::rigid(Y.mass, Y.mass * Y.com, Y.rotationalAtOrigin());
      f[at(i)] = crossStar(vi, Y * vi);
    });
  for (int i = bodies() - 1; i > 0; --i)
    visit(i, [&](const auto& joint) {
      ArticulatedInertia<double>& Y = Yaba[at(i)];
      for (int k = 0; k < joint.nv; ++k) {
        Factor& factor = factors[at(joint.idx_v + k)];
        const Velocity s = joint.column(k);
        factor.U = Y * s;
        factor.inverse = 1 / (dot(s, factor.U) + (m.armature.empty() ? 0.0 : m.armature[at(joint.idx_v + k)]));
        factor.u = factor.inverse * (effective[at(joint.idx_v + k)] - dot(s, f[at(i)]));
        if (parent[at(i)] == 0 && k + 1 == joint.nv) break;
        Y.subtractSquare(factor.U, factor.inverse);
        f[at(i)] += factor.u * factor.U;
      }
      if (parent[at(i)] == 0) return;
      Yaba[at(parent[at(i)])] += moved(Y, liMi[at(i)]);
      f[at(parent[at(i)])] += liMi[at(i)].act(f[at(i)] + Y * a[at(i)]);
    });
  const Velocity fall{-m.gravity, {}};
  for (int i = 1; i < bodies(); ++i)
    visit(i, [&](const auto& joint) {
      Velocity ai = liMi[at(i)].actInv(parent[at(i)] > 0 ? a[at(parent[at(i)])] : fall) + a[at(i)];
      for (int k = joint.nv - 1; k >= 0; --k) {
        const Factor& factor = factors[at(joint.idx_v + k)];
        const double x = factor.u - factor.inverse * dot(ai, factor.U);
        ddq[at(joint.idx_v + k)] = x;
        ai += x * joint.column(k);
      }
      a[at(i)] = ai;
    });
}

}  // namespace

}  // namespace pattern

Contest patternContest(const CompactModel& model) {
  const auto library = std::make_shared<pattern::Library>(model);
  const int joints = library->bodies() - 1, nv = model.nv();
  const auto add = [&](Contest& contest, const char* algorithm, int passes, const double* result, int size, auto run) {
    contest.contenders.push_back({algorithm, "variant_library", passes * joints,
                                  [library, run](const double* q, const double* v, const double* a) { run(*library, q, v, a); }, result, size});
  };
  Contest contest;
  add(contest, "fk", 1, reinterpret_cast<const double*>(library->oMi.data()), 12 * (joints + 1),
      [](auto& x, const double* q, const double*, const double*) { x.forwardKinematics(q); });
  add(contest, "rnea", 2, library->tau.data(), nv, [](auto& x, const double* q, const double* v, const double* a) { x.rnea(q, v, a); });
  add(contest, "crba", 2, library->M.data(), nv * nv, [](auto& x, const double* q, const double*, const double*) { x.crba(q); });
  add(contest, "aba", 3, library->ddq.data(), nv, [](auto& x, const double* q, const double* v, const double* a) { x.aba(q, v, a); });
  return contest;
}

}  // namespace dyn::benchmark
