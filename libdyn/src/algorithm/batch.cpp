#include "algorithm/batch_support.hpp"
#include "algorithm/placement.hpp"

#include <dyn/algorithm/aba.hpp>
#include <dyn/algorithm/crba.hpp>
#include <dyn/algorithm/rnea.hpp>

namespace dyn {

namespace {

/// N numbers of a body and state, `lanes` apart, in memory by block, body, number, state.
template <int N, class T>
T* numbersOf(const BatchImpl<T>& d, const PackMemory& memory, int body, int state) {
  const int lanes = d.kernels->lanes;
  return reinterpret_cast<T*>(memory.data()) + (static_cast<std::ptrdiff_t>(state / lanes) * d.model->bodies() + body) * N * lanes + state % lanes;
}

}  // namespace

namespace detail {

namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

template <int N, class T>
void put(const BatchImpl<T>& d, const PackMemory& memory, int body, int state, const std::array<double, N>& x) {
  T* to = numbersOf<N>(d, memory, body, state);
  for (std::size_t k = 0; k < N; ++k) to[k * at(d.kernels->lanes)] = static_cast<T>(x[k]);
}

/// Poses and motions of one state's bodies; NaN if it could not be computed.
template <class T>
void putKinematics(const BatchImpl<T>& d, const DataImpl& single, int state, bool computed, bool with_v, bool with_a) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto motion = [&](const Motion<double>& x) {
    return computed ? std::array<double, 6>{x.linear.x, x.linear.y, x.linear.z, x.angular.x, x.angular.y, x.angular.z}
                    : std::array<double, 6>{nan, nan, nan, nan, nan, nan};
  };
  for (int body = 0; body < d.model->bodies(); ++body) {
    std::array<double, 12> pose;
    pose.fill(nan);
    const SE3<double>& oMb = single.oM[body];
    if (computed) {
      std::copy(oMb.R.m, oMb.R.m + 9, pose.begin());
      for (int k = 0; k < 3; ++k) pose[at(9 + k)] = oMb.p[k];
    }
    put<12>(d, d.poses, body, state, pose);
    if (with_v) put<6>(d, d.velocities, body, state, motion(single.v[body]));
    if (with_a) put<6>(d, d.accelerations, body, state, motion(single.a[body]));
  }
}

template <class T>
T* resultOf(BatchImpl<T>& d, BatchQuantity what, int states) {
  switch (what) {
    case BatchQuantity::rnea:
      return d.tau.data();
    case BatchQuantity::nle:
      return d.nle.data();
    case BatchQuantity::gravity:
      return d.gravity.data();
    case BatchQuantity::mass_matrix:
      return d.M.onPaths(at(states));
    default:
      return d.ddq.data();
  }
}

}  // namespace

template <class T>
const T* computeBatch(const CompactModel& model, BasicBatchData<T>& data, BatchQuantity what, StatesView<T> q, StatesView<T> v, StatesView<T> a) {
  const char* names[] = {"rnea", "nonLinearEffects", "generalizedGravity", "crba", "aba"};
  const char* name = names[static_cast<int>(what)];
  BatchImpl<T>& d = data.impl();
  const CompactImpl& m = model.impl();
  checkBatch(name, model, d, q, what == BatchQuantity::mass_matrix ? Need::mass_matrix : Need::state, "mass_matrix");
  if (v.given) checkStates(name, "v", v, m.nv, q.cols);
  if (a.given) checkStates(name, what == BatchQuantity::aba ? "tau" : "a", a, m.nv, q.cols);
  const int states = static_cast<int>(q.cols);
  const std::ptrdiff_t rows = what == BatchQuantity::mass_matrix ? static_cast<std::ptrdiff_t>(m.nv) * m.nv : m.nv;
  const StatesOut<T> results[] = {{resultOf(d, what, states), rows}};
  Failure failure;
  if (!m.couplings.empty()) {
    failure = forBlocks(d, states, 1, [&](int t, int state, int, Failure& f) {
      runSingle<T>(model, d, t, state, {q, v, a}, results, f,
                   [&](Data& single, const VectorView& qs, const VectorView& vs, const VectorView& as) -> std::array<const double*, 1> {
                     if (what == BatchQuantity::mass_matrix) return {crba(model, single, qs)};
                     if (what == BatchQuantity::aba) return {aba(model, single, qs, vs, as, nullptr, 0)};
                     return {rnea(model, single, qs, vs, as, nullptr, 0)};
                   });
    });
  } else {
    failure = forBlocks(d, states, d.kernels->lanes, [&](int t, int first, int count, Failure& f) {
      kernels::Block<T> block;
      block.task =
          what == BatchQuantity::mass_matrix ? kernels::Task::mass_matrix : (what == BatchQuantity::aba ? kernels::Task::aba : kernels::Task::rnea);
      block.q = columns(q, first, count);
      block.v = columns(v, first, count);
      block.a = columns(a, first, count);
      block.results[0] = results[0].first + first * rows;
      block.squares = d.path_squares;
      d.kernels->run(m, d.scratch[at(t)].data(), block);
      noteFailures(q, block, results, first, count, f);
    });
  }
  fail(name, m, failure, q);
  return results[0].first;
}

template <class T>
const T* batchJacobians(const CompactModel& model, BasicBatchData<T>& data, StatesView<T> q, Kind kind, int id, ReferenceFrame reference) {
  const char* names[] = {"computeJointJacobian", "computeFrameJacobian", "computeJointJacobians"};
  BatchImpl<T>& d = data.impl();
  const CompactImpl& m = model.impl();
  checkBatch(names[static_cast<int>(kind)], model, d, q, Need::jacobians, "jacobians");
  const std::ptrdiff_t rows = 6 * static_cast<std::ptrdiff_t>(m.nv);
  const int states = static_cast<int>(q.cols);
  kernels::FramePoint<double> point;
  if (kind == Kind::all_joints) {
    refuseFollowers(names[static_cast<int>(kind)], m);
  } else {
    const PointOnBody where = kind == Kind::joint ? jointOnBody(model, id) : frameOnBody(model, id);
    point = {where.body, where.placement};
  }
  const StatesOut<T> results[] = {{d.J.data(), rows}};
  Failure failure;
  if (!m.couplings.empty()) {
    failure = forBlocks(d, states, 1, [&](int t, int state, int, Failure& f) {
      runSingle<T>(model, d, t, state, {q, {}, {}}, results, f,
                   [&](Data& single, const VectorView& qs, const VectorView&, const VectorView&) -> std::array<const double*, 1> {
                     double* J = single.impl().J;
                     jacobian(model, single, qs, kind, id, reference, MatrixOut(J, 6, m.nv));
                     return {J};
                   });
    });
  } else {
    failure = forBlocks(d, states, d.kernels->lanes, [&](int t, int first, int count, Failure& f) {
      kernels::Block<T> block;
      block.task = kind == Kind::all_joints ? kernels::Task::joint_jacobians : kernels::Task::frame_jacobian;
      block.q = columns(q, first, count);
      block.frame = point;
      block.reference = reference;
      block.results[0] = d.J.data() + first * rows;
      d.kernels->run(m, d.scratch[at(t)].data(), block);
      if (block.not_finite) f.note(first, 0, count);
    });
  }
  fail(names[static_cast<int>(kind)], m, failure, q);
  return d.J.data();
}

template <class T>
void batchKinematics(const CompactModel& model, BasicBatchData<T>& data, StatesView<T> q, StatesView<T> v, StatesView<T> a) {
  BatchImpl<T>& d = data.impl();
  const CompactImpl& m = model.impl();
  checkBatch("forwardKinematics", model, d, q, Need::kinematics, "kinematics");
  if (v.given) checkStates("forwardKinematics", "v", v, m.nv, q.cols);
  if (a.given) checkStates("forwardKinematics", "a", a, m.nv, q.cols);
  const int states = static_cast<int>(q.cols);
  Failure failure;
  if (!m.couplings.empty()) {
    failure = forBlocks(d, states, 1, [&](int t, int state, int, Failure& f) {
      const bool computed =
          computeSingle<T>(model, d, t, state, {q, v, a}, f, [&](Data& single, const VectorView& qs, const VectorView& vs, const VectorView& as) {
            forwardKinematics(model, single, qs, v.given ? &vs : nullptr, a.given ? &as : nullptr);
          });
      putKinematics(d, d.single[at(t)].impl(), state, computed, v.given, a.given);
    });
  } else {
    failure = forBlocks(d, states, d.kernels->lanes, [&](int t, int first, int count, Failure& f) {
      kernels::Block<T> block;
      block.task = kernels::Task::kinematics;
      block.q = columns(q, first, count);
      block.v = columns(v, first, count);
      block.a = columns(a, first, count);
      block.poses = numbersOf<12>(d, d.poses, 0, first);
      if (v.data) block.velocities = numbersOf<6>(d, d.velocities, 0, first);
      if (a.data) block.accelerations = numbersOf<6>(d, d.accelerations, 0, first);
      d.kernels->run(m, d.scratch[at(t)].data(), block);
      if (block.not_finite) f.note(first, 0, count);
    });
  }
  fail("forwardKinematics", m, failure, q);
}

template const double* computeBatch(const CompactModel&, BatchData&, BatchQuantity, StatesView<double>, StatesView<double>, StatesView<double>);
template const float* computeBatch(const CompactModel&, BatchDataFloat&, BatchQuantity, StatesView<float>, StatesView<float>, StatesView<float>);
template const double* batchJacobians(const CompactModel&, BatchData&, StatesView<double>, Kind, int, ReferenceFrame);
template const float* batchJacobians(const CompactModel&, BatchDataFloat&, StatesView<float>, Kind, int, ReferenceFrame);
template void batchKinematics(const CompactModel&, BatchData&, StatesView<double>, StatesView<double>, StatesView<double>);
template void batchKinematics(const CompactModel&, BatchDataFloat&, StatesView<float>, StatesView<float>, StatesView<float>);

}  // namespace detail

namespace {

template <int N, class T>
void pick(const BatchImpl<T>& d, const PackMemory& memory, int body, int state, T* out) {
  if (state < 0 || state >= d.capacity)
    throw Error(ErrorCode::argument, "state " + std::to_string(state) + " does not exist; the batch has " + std::to_string(d.capacity));
  const T* from = numbersOf<N>(d, memory, body, state);
  for (int k = 0; k < N; ++k) out[k] = from[k * d.kernels->lanes];
}

template <class T>
SE3<T> poseOfBody(const BatchImpl<T>& d, int body, int state) {
  T x[12];
  pick<12>(d, d.poses, body, state, x);
  SE3<T> X;
  std::copy(x, x + 9, X.R.m);
  X.p = {x[9], x[10], x[11]};
  return X;
}

template <class T>
Motion<T> motionOfFrame(const CompactModel& model, const BatchImpl<T>& d, const PackMemory& memory, int frame, int state, ReferenceFrame reference) {
  const PointOnBody point = frameOnBody(model, frame);
  T x[6];
  pick<6>(d, memory, point.body, state, x);
  const SE3<T> bMf = cast<T>(point.placement);
  const Motion<T> local = bMf.actInv(Motion<T>{{x[0], x[1], x[2]}, {x[3], x[4], x[5]}});
  return express(local, poseOfBody(d, point.body, state) * bMf, reference);
}

template <class T>
const BatchImpl<T>& withKinematics(const char* function, const CompactModel& model, const BasicBatchData<T>& data) {
  detail::checkBatchData(function, model, data.impl(), Need::kinematics, "kinematics");
  return data.impl();
}

}  // namespace

template <class T>
SE3<T> framePlacement(const CompactModel& model, const BasicBatchData<T>& data, int frame, int state) {
  const PointOnBody point = frameOnBody(model, frame);
  return poseOfBody(withKinematics("framePlacement", model, data), point.body, state) * cast<T>(point.placement);
}
template <class T>
Motion<T> frameVelocity(const CompactModel& model, const BasicBatchData<T>& data, int frame, int state, ReferenceFrame reference) {
  return motionOfFrame(model, withKinematics("frameVelocity", model, data), data.impl().velocities, frame, state, reference);
}
template <class T>
Motion<T> frameAcceleration(const CompactModel& model, const BasicBatchData<T>& data, int frame, int state, ReferenceFrame reference) {
  return motionOfFrame(model, withKinematics("frameAcceleration", model, data), data.impl().accelerations, frame, state, reference);
}

template SE3<double> framePlacement(const CompactModel&, const BatchData&, int, int);
template SE3<float> framePlacement(const CompactModel&, const BatchDataFloat&, int, int);
template Motion<double> frameVelocity(const CompactModel&, const BatchData&, int, int, ReferenceFrame);
template Motion<float> frameVelocity(const CompactModel&, const BatchDataFloat&, int, int, ReferenceFrame);
template Motion<double> frameAcceleration(const CompactModel&, const BatchData&, int, int, ReferenceFrame);
template Motion<float> frameAcceleration(const CompactModel&, const BatchDataFloat&, int, int, ReferenceFrame);

}  // namespace dyn
