#include "algorithm/batch_support.hpp"
#include "algorithm/placement.hpp"
#include "at.hpp"

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
  const Failure failure = forBlocks(d, states, d.kernels->lanes, [&](int t, int first, int count, Failure& f) {
    kernels::Block<T> block;
    const bool aba = what == BatchQuantity::aba;
    block.task = what == BatchQuantity::mass_matrix ? kernels::Task::mass_matrix : (aba ? kernels::Task::aba : kernels::Task::rnea);
    readStates<T>(d, t, {q, v, a, aba}, first, count, block);
    block.results[0] = results[0].first + first * rows;
    d.kernels->run(m, d.scratch[at(t)].data(), block);
    noteFailures(q, block, results, first, count, f);
  });
  fail(name, m, failure, q);
  return results[0].first;
}

template <class T>
const T* batchJacobians(const CompactModel& model, BasicBatchData<T>& data, StatesView<T> q, Kind kind, int id, ReferenceFrame reference) {
  const char* names[] = {"computeJointJacobian", "computeFrameJacobian", "computeJointJacobians"};
  BatchImpl<T>& d = data.impl();
  const CompactImpl& m = model.impl();
  checkBatch(names[static_cast<int>(kind)], model, d, q, Need::jacobians, "jacobians");
  checkReference(reference);
  const std::ptrdiff_t rows = 6 * static_cast<std::ptrdiff_t>(m.nv);
  const int states = static_cast<int>(q.cols);
  kernels::FramePoint<double> point;
  if (kind == Kind::all_joints) {
    refuseFollowers(names[static_cast<int>(kind)], m);
  } else {
    const PointOnBody where = kind == Kind::joint ? jointOnBody(model, id) : frameOnBody(model, id);
    point = {where.body, where.placement};
  }
  const Failure failure = forBlocks(d, states, d.kernels->lanes, [&](int t, int first, int count, Failure& f) {
    kernels::Block<T> block;
    block.task = kind == Kind::all_joints ? kernels::Task::joint_jacobians : kernels::Task::frame_jacobian;
    readStates<T>(d, t, {q, {}, {}}, first, count, block);
    block.frame = point;
    block.reference = reference;
    block.results[0] = d.J.data() + first * rows;
    d.kernels->run(m, d.scratch[at(t)].data(), block);
    if (block.not_finite) f.note(first, 0, count);
  });
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
  const Failure failure = forBlocks(d, states, d.kernels->lanes, [&](int t, int first, int count, Failure& f) {
    kernels::Block<T> block;
    block.task = kernels::Task::kinematics;
    readStates<T>(d, t, {q, v, a}, first, count, block);
    block.poses = numbersOf<12>(d, d.poses, 0, first);
    if (v.data) block.velocities = numbersOf<6>(d, d.velocities, 0, first);
    if (a.data) block.accelerations = numbersOf<6>(d, d.accelerations, 0, first);
    d.kernels->run(m, d.scratch[at(t)].data(), block);
    if (block.not_finite) f.note(first, 0, count);
  });
  d.stage = a.given ? KinematicsStage::accelerations : v.given ? KinematicsStage::velocities : KinematicsStage::poses;
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
const BatchImpl<T>& withKinematics(const char* function, const CompactModel& model, const BasicBatchData<T>& data, KinematicsStage stage) {
  detail::checkBatchData(function, model, data.impl(), Need::kinematics, "kinematics");
  checkStage(function, data.impl().stage, stage);
  return data.impl();
}

}  // namespace

template <class T>
SE3<T> framePlacement(const CompactModel& model, const BasicBatchData<T>& data, int frame, int state) {
  const PointOnBody point = frameOnBody(model, frame);
  return poseOfBody(withKinematics("framePlacement", model, data, KinematicsStage::poses), point.body, state) * cast<T>(point.placement);
}
template <class T>
Motion<T> frameVelocity(const CompactModel& model, const BasicBatchData<T>& data, int frame, int state, ReferenceFrame reference) {
  return motionOfFrame(model, withKinematics("frameVelocity", model, data, KinematicsStage::velocities), data.impl().velocities, frame, state,
                       reference);
}
template <class T>
Motion<T> frameAcceleration(const CompactModel& model, const BasicBatchData<T>& data, int frame, int state, ReferenceFrame reference) {
  return motionOfFrame(model, withKinematics("frameAcceleration", model, data, KinematicsStage::accelerations), data.impl().accelerations, frame,
                       state, reference);
}

template SE3<double> framePlacement(const CompactModel&, const BatchData&, int, int);
template SE3<float> framePlacement(const CompactModel&, const BatchDataFloat&, int, int);
template Motion<double> frameVelocity(const CompactModel&, const BatchData&, int, int, ReferenceFrame);
template Motion<float> frameVelocity(const CompactModel&, const BatchDataFloat&, int, int, ReferenceFrame);
template Motion<double> frameAcceleration(const CompactModel&, const BatchData&, int, int, ReferenceFrame);
template Motion<float> frameAcceleration(const CompactModel&, const BatchDataFloat&, int, int, ReferenceFrame);

}  // namespace dyn
