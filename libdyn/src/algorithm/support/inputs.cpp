// SPDX-License-Identifier: BSD-2-Clause
#include "algorithm/support/inputs.hpp"

#include "algorithm/support/dependent_joints.hpp"
#include "at.hpp"
#include "kernels/body/dissipation.hpp"
#include "kernels/body/evaluate.hpp"
#include "kernels/isa/table.hpp"

#include <dyn/error.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

namespace dyn {

namespace {

/// Returns x. If x lies in memory of results, copies it to `place` and returns the copy.
const double* copies(const VectorView& x, const PackMemory& results, const PackMemory* more, double* place) {
  const auto isIn = [&](const PackMemory& memory) {
    return reinterpret_cast<std::uintptr_t>(x.data) - reinterpret_cast<std::uintptr_t>(memory.data()) < memory.bytes();
  };
  if (!isIn(results) && !(more && isIn(*more))) return x.data;
  std::copy_n(x.data, x.size, place);
  return place;
}

void spread(const SharedVector<int>& target, const double* user, double* expanded) {
  for (std::size_t k = 0; k < target.size(); ++k) expanded[target[k]] = user[k];
}

std::string nameOf(Need need) { return need == Need::derivatives ? "Need::derivatives" : "Need::mass_matrix"; }

// Exceptions are thrown in functions of their own. The checks stay short enough to be inlined.
[[noreturn, gnu::cold]] void refuseSize(const char* algorithm, const char* name, std::ptrdiff_t size, int wanted) {
  if (size == wanted) throw Error(ErrorCode::argument, std::string(algorithm) + ": " + name + " is a null pointer");
  throw Error(ErrorCode::size,
              std::string(algorithm) + ": " + name + " has " + std::to_string(size) + " entries, the model wants " + std::to_string(wanted));
}
[[noreturn, gnu::cold]] void refuseOtherModel(const char* algorithm) {
  throw Error(ErrorCode::argument, std::string(algorithm) + ": data was made for another model; make a Data for this one");
}
[[noreturn, gnu::cold]] void refuseWithout(const char* algorithm, Need need) {
  throw Error(ErrorCode::argument,
              std::string(algorithm) + ": data was made without " + nameOf(need) + "; make it as Data(model, " + nameOf(need) + ")");
}

}  // namespace

void expand(const CompactImpl& m, const double* q, const double* v, const double* a, const ExpandedState& out) {
  spread(m.q_of_user, q, out.q);
  if (v) {
    spread(m.v_of_user, v, out.v);
    for (std::size_t k = 0; k < m.v_of_user.size(); ++k) out.a[m.v_of_user[k]] = a ? a[k] : 0;
  }
  Coordinates coordinates;
  for (std::size_t k = 0; k < m.couplings.size(); ++k) {
    const PackedCoupling& c = m.couplings[k];
    const BodyIndex &dependent = m.index[at(c.body)], &master = m.index[at(c.master)];
    double f[4];
    evaluateCoupling(m, c, coordinates, out.q, f);
    setCoordinate(m, c.body, coordinates, f[0], out.q + dependent.idx_q);
    out.G[k] = f[1];
    out.dG[k] = f[2];
    out.ddG[k] = f[3];
    if (!v) continue;
    const double rate = out.v[master.idx_v];
    out.v[dependent.idx_v] = f[1] * rate;
    out.a[dependent.idx_v] = f[1] * out.a[master.idx_v] + f[2] * rate * rate;
  }
}

void checkSize(const char* algorithm, const char* name, VectorView x, int wanted) {
  if (x.size != wanted || (x.data == nullptr && wanted > 0)) refuseSize(algorithm, name, x.size, wanted);
}

void checkShape(const char* algorithm, const char* name, const MatrixOut& x, int rows, int cols) {
  if (x.rows() != rows || x.cols() != cols)
    throw Error(ErrorCode::size, std::string(algorithm) + ": " + name + " is " + std::to_string(x.rows()) + " x " + std::to_string(x.cols()) +
                                     ", it must be " + std::to_string(rows) + " x " + std::to_string(cols));
  if (x.column(0) == nullptr && rows * cols > 0) throw Error(ErrorCode::argument, std::string(algorithm) + ": " + name + " is a null pointer");
}

void checkData(const char* algorithm, const CompactModel& model, const Data& data, Need need) {
  const DataImpl& d = data.impl();
  if (d.model != &model.impl()) refuseOtherModel(algorithm);
  if (need != Need::state && !has(d.needs, need)) refuseWithout(algorithm, need);
}

void checkStage(const char* function, KinematicsStage found, KinematicsStage wanted) {
  if (found >= wanted) return;
  static constexpr const char* names[] = {"", "poses", "velocities", "accelerations", "derivatives of its kinematics"};
  static constexpr const char* calls[] = {"", "forwardKinematics(model, data, q)", "forwardKinematics(model, data, q, v)",
                                          "forwardKinematics(model, data, q, v, a)", "computeForwardKinematicsDerivatives(model, data, q, v, a)"};
  throw Error(ErrorCode::argument, std::string(function) + ": the data has no " + names[static_cast<std::size_t>(wanted)] + " yet; call " +
                                       calls[static_cast<std::size_t>(wanted)] + " first");
}

void copyAliasedArguments(Data& data, const Arguments& arguments, const PackMemory* more) {
  DataImpl& d = data.impl();
  const auto keep = [&](VectorView* x, int size, double* place) {
    if (x && x->size == size) x->data = copies(*x, d.block, more, place);
  };
  keep(arguments.q, d.model->nq, d.copied_q);
  keep(arguments.v, d.model->nv, d.copied_v);
  keep(arguments.a, d.model->nv, d.copied_a);
  keep(arguments.tau, d.model->nv, d.copied_tau);
}

Inputs readInputs(const char* algorithm, const CompactModel& model, Data& data, VectorView q, const VectorView* v, const VectorView* a) {
  checkData(algorithm, model, data);
  const CompactImpl& m = model.impl();
  DataImpl& d = data.impl();
  checkSize(algorithm, "q", q, m.nq);
  if (v) checkSize(algorithm, "v", *v, m.nv);
  if (a) checkSize(algorithm, "a", *a, m.nv);
  const double* user_q = copies(q, d.block, nullptr, d.copied_q);
  if (m.couplings.empty()) {
    const auto of = [&](const VectorView* x, double* place) { return x ? copies(*x, d.block, nullptr, place) : d.zero; };
    return {user_q, of(v, d.copied_v), of(a, d.copied_a), user_q};
  }
  expand(m, q.data, v ? v->data : nullptr, a ? a->data : nullptr, {d.qx, d.vx, d.ax, d.G, d.dG, d.ddG});
  return {d.qx, v ? d.vx : d.zero, v ? d.ax : d.zero, user_q};
}

void refuseDependentJoints(const char* algorithm, const CompactImpl& m) {
  if (!m.couplings.empty())
    throw Error(ErrorCode::argument,
                std::string(algorithm) +
                    ": the model has dependent joints (joints that follow others), which this algorithm does not support; load the model "
                    "with these joints independent");
}

void refuseZero(const char* argument, const CompactImpl& m, int i) {
  throw Error(ErrorCode::argument,
              std::string(argument) +
                  ": the quaternion, (cos, sin) pair or unit vector of a joint is zero, which stands for no rotation; neutral() gives the identity",
              {"", 0, m.joints[at(m.index[at(i)].joint)].name});
}

void checkFactors(const char* algorithm, const CompactImpl& m, int failed_body, const double* q) {
  if (failed_body == 0 || (q && !kernels::allFinite(q, m.nqx))) return;
  refuseSingular(algorithm, m, failed_body, q);
}

void checkConfiguration(const char* argument, const CompactImpl& m, const double* q) {
  for (int i = 1; i < m.bodies(); ++i) {
    const BodyIndex& x = m.index[at(i)];
    if (x.user_v < 0 || x.nq == x.nv) continue;
    const TypeBatch& batch = m.batches[at(x.batch)];
    double normal[max_joint_nq];
    normalizeJoint(batch.placeOf(x.slot), q + x.user_q, normal);
    if (std::any_of(normal, normal + x.nq, [](double c) { return std::isnan(c); }) && kernels::allFinite(q + x.user_q, x.nq))
      refuseZero(argument, m, i);
  }
}

namespace {
/// Types with more coordinates than velocities normalise their coordinates. If these are zero, the pose is NaN, and this throws Error(argument).
void checkRotations(const CompactImpl& m, const TypeBatch& batch, const JointMemory<double>& memory, const double* q) {
  for (int k = 0; k < batch.count; ++k) {
    double sum = 0;
    for (int c = 0; c < poseSize(batch.shape); ++c) sum += memory.pose[c * memory.stride + k];
    if (!std::isnan(sum)) continue;
    const int body = batch.bodies[at(k)];
    if (kernels::allFinite(q + m.index[at(body)].idx_q, batch.nq)) refuseZero("q", m, body);
  }
}
}  // namespace

void evaluateJoints(const CompactImpl& m, DataImpl& d, const double* q, const double* v) {
  kernels::active().single.evaluate(m, d, q, v);
  for (std::size_t b = 0; b < m.batches.size(); ++b)
    if (m.batches[b].nq != m.batches[b].nv) checkRotations(m, m.batches[b], d.joints[b], q);
}

void evaluateSubspaceRates(const CompactImpl& m, DataImpl& d, const double* q, const double* v) {
  for (std::size_t b = 0; b < m.batches.size(); ++b) {
    const TypeBatch& batch = m.batches[b];
    const DualMemory& memory = d.dual[b];
    if (batch.shape != Shape::dense) continue;
    for (int k = 0; k < batch.count; ++k) {
      const BodyIndex& x = m.index[at(batch.bodies[at(k)])];
      for (int c = 0; c < batch.nq; ++c) memory.q[c * batch.count + k] = q[x.idx_q + c];
      for (int c = 0; c < batch.nv; ++c) memory.subspace[c * batch.count + k] = v[x.idx_v + c];
    }
    kernels::coordinateRates(batch, 0, batch.count, 1, memory.q, memory.subspace, memory.pose);
    for (int i = 0; i < batch.nq * batch.count; ++i) memory.q[i].d = memory.pose[i].v;
    JointBatch<Dual<double>> call;
    call.count = batch.count;
    call.constants = batch.constants.data();
    call.constant_count = batch.constant_count;
    call.constants_stride = call.stride = call.q_stride = batch.count;
    call.q = memory.q;
    call.pose = memory.pose;
    call.subspace = memory.subspace;
    batch.type->kinematics(call);
  }
}

Motion<double> subspaceRate(const CompactImpl& m, const DataImpl& d, int i, int k) {
  const BodyIndex& x = m.index[at(i)];
  const TypeBatch& batch = m.batches[at(x.batch)];
  if (batch.shape != Shape::dense) return {};
  const Dual<double>* S = d.dual[at(x.batch)].subspace + 6 * k * batch.count + x.slot;
  Motion<double> rate;
  for (int r = 0; r < 3; ++r) {
    rate.linear[r] = S[r * batch.count].d;
    rate.angular[r] = S[(3 + r) * batch.count].d;
  }
  return rate;
}

const double* lessDissipation(const CompactImpl& m, DataImpl& d, const double* tau, const double* v) {
  if (m.damping.empty() && m.friction.empty()) return tau;
  std::copy(tau, tau + m.nv, d.tau);
  kernels::addDissipation(m, -1.0, v, d.tau);
  return d.tau;
}

void reduceForces(const CompactImpl& m, const DataImpl& d, double* expanded, double* user) {
  if (m.couplings.empty()) {
    if (expanded != user) std::copy(expanded, expanded + m.nv, user);
    return;
  }
  const kernels::DependentJoints<double> dependents = dependentsOf(m, d);
  dependents.foldForces(expanded);
  dependents.keep(1, expanded, user);
}

}  // namespace dyn
