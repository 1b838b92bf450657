#include "algorithm/inputs.hpp"
#include "algorithm/placement.hpp"
#include "data/batch_impl.hpp"
#include "kernels/evaluate.hpp"

#include <dyn/algorithm/aba.hpp>
#include <dyn/algorithm/batch.hpp>
#include <dyn/algorithm/crba.hpp>
#include <dyn/algorithm/rnea.hpp>
#include <dyn/error.hpp>

#include <algorithm>
#include <limits>
#include <string>

namespace dyn {

namespace detail {

namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

template <class T>
void checkStates(const char* algorithm, const char* name, const StatesView<T>& x, std::ptrdiff_t rows, std::ptrdiff_t cols) {
  if (x.rows != rows || x.cols != cols)
    throw Error(ErrorCode::size, std::string(algorithm) + ": " + name + " is " + std::to_string(x.rows) + " x " + std::to_string(x.cols) +
                                     ", it must be " + std::to_string(rows) + " x " + std::to_string(cols));
}

template <class T>
void checkBatch(const char* algorithm, const CompactModel& model, const BatchImpl<T>& d, const StatesView<T>& q, Need need, const char* need_name) {
  if (d.model != &model.impl())
    throw Error(ErrorCode::argument, std::string(algorithm) + ": the batch was made for another model; make a BatchData for this one");
  if (need != Need::state && !has(d.needs, need))
    throw Error(ErrorCode::argument, std::string(algorithm) + ": the batch was made without Need::" + need_name);
  if (q.rows != model.nq() || q.cols < 1 || q.cols > d.capacity)
    throw Error(ErrorCode::size, std::string(algorithm) + ": q is " + std::to_string(q.rows) + " x " + std::to_string(q.cols) + ", it must be " +
                                     std::to_string(model.nq()) + " x 1 to " + std::to_string(d.capacity));
}

/// The first state, in order, that something is wrong with.
struct Failure {
  int state = std::numeric_limits<int>::max();
  int body = 0;   ///< whose pivot vanished; 0: q may be no configuration
  int count = 1;  ///< it is this state or one of those after it
  void note(int s, int b, int n = 1) {
    if (s < state) *this = {s, b, n};
  }
};

/// Calls block(thread, first state, count, failure) for all states, each thread a stretch of neighbours.
template <class T, class Block>
Failure forBlocks(BatchImpl<T>& d, int states, int lanes, const Block& block) {
  const int blocks = (states + lanes - 1) / lanes, threads = d.workers->count();
  Failure failures[256];
  const auto work = [&](int t) {
    for (int b = static_cast<int>(static_cast<long>(blocks) * t / threads); b < static_cast<int>(static_cast<long>(blocks) * (t + 1) / threads); ++b)
      block(t, b * lanes, std::min(lanes, states - b * lanes), failures[std::min(t, 255)]);
  };
  d.workers->run(work);
  Failure first;
  for (int t = 0; t < std::min(threads, 256); ++t) first.note(failures[t].state, failures[t].body, failures[t].count);
  return first;
}

template <class T>
kernels::ColumnsIn<T> columns(const StatesView<T>& x, int first, int count) {
  if (x.data == nullptr) return {};
  return {x.data + first * x.stride, x.stride, count, first + count < x.cols};
}

template <class T>
void fail(const CompactImpl& m, const Failure& failure, const StatesView<T>& q) {
  if (failure.state == std::numeric_limits<int>::max()) return;
  const auto name = [](int state, const char* what) { return "state " + std::to_string(state) + ": " + what; };
  if (failure.body != 0) refuseSingular(name(failure.state, "aba").c_str(), m.joints[at(m.index[at(failure.body)].joint)].name);
  Eigen::VectorXd column(m.nq);
  for (int state = failure.state; state < failure.state + failure.count; ++state) {
    for (int i = 0; i < m.nq; ++i) column[i] = static_cast<double>(q.data[state * q.stride + i]);
    checkConfiguration(name(state, "q").c_str(), m, column.data());
  }
}

template <class T>
T* resultOf(BatchImpl<T>& d, BatchQuantity what) {
  switch (what) {
    case BatchQuantity::rnea:
      return d.tau.data();
    case BatchQuantity::nle:
      return d.nle.data();
    case BatchQuantity::gravity:
      return d.gravity.data();
    case BatchQuantity::mass_matrix:
      return d.M.data();
    default:
      return d.ddq.data();
  }
}

/// Views of v and a may be empty: zeros.
template <class T>
struct StatesIn {
  const StatesView<T>&q, &v, &a;
};

/// One state of a model with couplings, by an algorithm for one state: compute(data, q, v, a) returns where its `rows` numbers are.
template <class T, class Compute>
void runSingle(const CompactModel& model, BatchImpl<T>& d, int thread, int state, const StatesIn<T>& in, T* result, std::ptrdiff_t rows,
               Failure& failure, const Compute& compute) {
  Eigen::VectorXd* columns = &d.columns[at(3 * thread)];
  const auto read = [&](const StatesView<T>& from, Eigen::VectorXd& to) {
    for (Eigen::Index i = 0; i < to.size(); ++i) to[i] = from.data ? static_cast<double>(from.data[state * from.stride + i]) : 0.0;
    return VectorView{to.data(), to.size()};
  };
  const VectorView qs = read(in.q, columns[0]), vs = read(in.v, columns[1]), as = read(in.a, columns[2]);
  const double* found = nullptr;
  try {
    found = compute(d.single[at(thread)], qs, vs, as);
  } catch (const Error& e) {
    const int joint = model.jointId(e.where().joint);
    failure.note(state, e.code() == ErrorCode::singular && joint > 0 ? model.impl().body_of_joint[at(joint)] : 0);
  }
  T* out = result + state * rows;
  for (std::ptrdiff_t i = 0; i < rows; ++i) out[i] = found ? static_cast<T>(found[i]) : std::numeric_limits<T>::quiet_NaN();
}

}  // namespace

template <class T>
const T* computeBatch(const CompactModel& model, BasicBatchData<T>& data, BatchQuantity what, StatesView<T> q, StatesView<T> v, StatesView<T> a) {
  const char* names[] = {"rnea", "nonLinearEffects", "generalizedGravity", "crba", "aba"};
  const char* name = names[static_cast<int>(what)];
  BatchImpl<T>& d = data.impl();
  const CompactImpl& m = model.impl();
  checkBatch(name, model, d, q, what == BatchQuantity::mass_matrix ? Need::mass_matrix : Need::state, "mass_matrix");
  if (v.data) checkStates(name, "v", v, m.nv, q.cols);
  if (a.data) checkStates(name, what == BatchQuantity::aba ? "tau" : "a", a, m.nv, q.cols);
  const int states = static_cast<int>(q.cols);
  const std::ptrdiff_t rows = what == BatchQuantity::mass_matrix ? static_cast<std::ptrdiff_t>(m.nv) * m.nv : m.nv;
  T* result = resultOf(d, what);
  Failure failure;
  if (!m.couplings.empty()) {
    failure = forBlocks(d, states, 1, [&](int t, int state, int, Failure& f) {
      runSingle<T>(model, d, t, state, {q, v, a}, result, rows, f,
                   [&](Data& single, const VectorView& qs, const VectorView& vs, const VectorView& as) {
                     if (what == BatchQuantity::mass_matrix) return crba(model, single, qs);
                     if (what == BatchQuantity::aba) return aba(model, single, qs, vs, as, nullptr, 0);
                     return rnea(model, single, qs, vs, as, nullptr, 0);
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
      block.result = result + first * rows;
      d.kernels->run(m, d.scratch[at(t)].data(), block);
      if (!block.not_finite) return;
      for (int l = 0; l < count; ++l) {
        T* column = block.result + l * rows;
        const bool finite = kernels::allFinite(column, rows);
        if (block.failed[l] != 0) std::fill(column, column + rows, std::numeric_limits<T>::quiet_NaN());
        if (!finite || block.failed[l] != 0) f.note(first + l, block.failed[l]);
      }
    });
  }
  fail(m, failure, q);
  return result;
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
  Failure failure;
  if (!m.couplings.empty()) {
    failure = forBlocks(d, states, 1, [&](int t, int state, int, Failure& f) {
      runSingle<T>(model, d, t, state, {q, {}, {}}, d.J.data(), rows, f,
                   [&](Data& single, const VectorView& qs, const VectorView&, const VectorView&) {
                     double* J = single.impl().J;
                     jacobian(model, single, qs, kind, id, reference, MatrixOut(J, 6, m.nv));
                     return J;
                   });
    });
  } else {
    failure = forBlocks(d, states, d.kernels->lanes, [&](int t, int first, int count, Failure& f) {
      kernels::Block<T> block;
      block.task = kind == Kind::all_joints ? kernels::Task::joint_jacobians : kernels::Task::frame_jacobian;
      block.q = columns(q, first, count);
      block.frame = point;
      block.reference = reference;
      block.result = d.J.data() + first * rows;
      d.kernels->run(m, d.scratch[at(t)].data(), block);
      if (block.not_finite) f.note(first, 0, count);
    });
  }
  fail(m, failure, q);
  return d.J.data();
}

template <class T>
void batchKinematics(const CompactModel& model, BasicBatchData<T>& data, StatesView<T> q, StatesView<T> v, StatesView<T> a) {
  BatchImpl<T>& d = data.impl();
  const CompactImpl& m = model.impl();
  checkBatch("forwardKinematics", model, d, q, Need::kinematics, "kinematics");
  if (v.data) checkStates("forwardKinematics", "v", v, m.nv, q.cols);
  if (a.data) checkStates("forwardKinematics", "a", a, m.nv, q.cols);
  if (!m.couplings.empty())
    throw Error(ErrorCode::argument, "forwardKinematics of a batch: the model has joints that follow others; compute its states one by one");
  const int lanes = d.kernels->lanes;
  const std::ptrdiff_t block_numbers = static_cast<std::ptrdiff_t>(m.bodies()) * lanes;
  const Failure failure = forBlocks(d, static_cast<int>(q.cols), lanes, [&](int t, int first, int count, Failure& f) {
    const std::ptrdiff_t offset = first / lanes * block_numbers;
    kernels::Block<T> block;
    block.task = kernels::Task::kinematics;
    block.q = columns(q, first, count);
    block.v = columns(v, first, count);
    block.a = columns(a, first, count);
    block.poses = reinterpret_cast<T*>(d.poses.data()) + 12 * offset;
    if (v.data) block.velocities = reinterpret_cast<T*>(d.velocities.data()) + 6 * offset;
    if (a.data) block.accelerations = reinterpret_cast<T*>(d.accelerations.data()) + 6 * offset;
    d.kernels->run(m, d.scratch[at(t)].data(), block);
    if (block.not_finite) f.note(first, 0, count);
  });
  fail(m, failure, q);
}

template const double* computeBatch(const CompactModel&, BatchData&, BatchQuantity, StatesView<double>, StatesView<double>, StatesView<double>);
template const float* computeBatch(const CompactModel&, BatchDataFloat&, BatchQuantity, StatesView<float>, StatesView<float>, StatesView<float>);
template const double* batchJacobians(const CompactModel&, BatchData&, StatesView<double>, Kind, int, ReferenceFrame);
template const float* batchJacobians(const CompactModel&, BatchDataFloat&, StatesView<float>, Kind, int, ReferenceFrame);
template void batchKinematics(const CompactModel&, BatchData&, StatesView<double>, StatesView<double>, StatesView<double>);
template void batchKinematics(const CompactModel&, BatchDataFloat&, StatesView<float>, StatesView<float>, StatesView<float>);

}  // namespace detail

namespace {

/// N numbers of a body and state out of memory by block, body, number, state.
template <int N, class T>
void pick(const BatchImpl<T>& d, const PackMemory& memory, int body, int state, T* out) {
  if (state < 0 || state >= d.capacity)
    throw Error(ErrorCode::argument, "state " + std::to_string(state) + " does not exist; the batch has " + std::to_string(d.capacity));
  const int lanes = d.kernels->lanes;
  const T* from =
      reinterpret_cast<const T*>(memory.data()) + (static_cast<std::ptrdiff_t>(state / lanes) * d.model->bodies() + body) * N * lanes + state % lanes;
  for (int k = 0; k < N; ++k) out[k] = from[k * lanes];
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
const BatchImpl<T>& withKinematics(const BasicBatchData<T>& data) {
  if (!has(data.impl().needs, Need::kinematics)) throw Error(ErrorCode::argument, "the batch was made without Need::kinematics");
  return data.impl();
}

}  // namespace

template <class T>
SE3<T> framePlacement(const CompactModel& model, const BasicBatchData<T>& data, int frame, int state) {
  const PointOnBody point = frameOnBody(model, frame);
  return poseOfBody(withKinematics(data), point.body, state) * cast<T>(point.placement);
}
template <class T>
Motion<T> frameVelocity(const CompactModel& model, const BasicBatchData<T>& data, int frame, int state, ReferenceFrame reference) {
  return motionOfFrame(model, withKinematics(data), data.impl().velocities, frame, state, reference);
}
template <class T>
Motion<T> frameAcceleration(const CompactModel& model, const BasicBatchData<T>& data, int frame, int state, ReferenceFrame reference) {
  return motionOfFrame(model, withKinematics(data), data.impl().accelerations, frame, state, reference);
}

template SE3<double> framePlacement(const CompactModel&, const BatchData&, int, int);
template SE3<float> framePlacement(const CompactModel&, const BatchDataFloat&, int, int);
template Motion<double> frameVelocity(const CompactModel&, const BatchData&, int, int, ReferenceFrame);
template Motion<float> frameVelocity(const CompactModel&, const BatchDataFloat&, int, int, ReferenceFrame);
template Motion<double> frameAcceleration(const CompactModel&, const BatchData&, int, int, ReferenceFrame);
template Motion<float> frameAcceleration(const CompactModel&, const BatchDataFloat&, int, int, ReferenceFrame);

}  // namespace dyn
