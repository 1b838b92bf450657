// SPDX-License-Identifier: BSD-2-Clause
#include "algorithm/support/batch_support.hpp"
#include "algorithm/support/placement.hpp"
#include "at.hpp"
#include "kernels/derivative/tree_factors.hpp"

#include <cmath>

namespace dyn {

namespace detail {

namespace {

const char* nameOf(Need need) {
  return need == Need::mass_matrix ? "mass_matrix" : need == Need::derivatives ? "derivatives" : need == Need::jacobians ? "jacobians" : "kinematics";
}

/// A batch has memory for vectors of nv numbers, for matrices of nv x nv (three of an algorithm), for six or three rows, and for single numbers.
consteval bool batchesHaveMemory() {
  for (const AlgorithmInfo& algorithm : algorithms())
    for (std::size_t k = 0; k < algorithm.outputs.size() && algorithm.batched && algorithm.batch_need != Need::kinematics; ++k) {
      const AlgorithmOutput& output = algorithm.outputs[k];
      if (output.symbol == nullptr) continue;
      const bool columns = output.columns == Extent::one || output.columns == Extent::nv;
      const bool of_bodies = algorithm.algorithm == Algorithm::center_of_mass || algorithm.algorithm == Algorithm::energies;
      if (of_bodies && output.columns == Extent::one) continue;
      if (!columns || (output.rows != Extent::six && output.rows != Extent::three && output.rows != Extent::nv)) return false;
      if (output.rows == Extent::nv && output.columns == Extent::nv && k == 3) return false;
      if (output.rows != Extent::nv && algorithm.batch_need != Need::jacobians && algorithm.batch_need != Need::derivatives) return false;
    }
  return true;
}
static_assert(batchesHaveMemory());

/// Memory for result k of many states. Results of one shape share memory, except those that callers want beside each other.
template <class T>
T* memoryOf(BatchImpl<T>& d, const AlgorithmInfo& algorithm, std::size_t k, std::size_t states) {
  using A = Algorithm;
  const A name = algorithm.algorithm;
  const AlgorithmOutput& output = algorithm.outputs[k];
  if (name == A::center_of_mass) return d.com[k].data();
  if (name == A::energies) return d.energies[k].data();
  if (output.rows == Extent::six || output.rows == Extent::three) return algorithm.batch_need == Need::jacobians ? d.J.data() : d.maps[k].data();
  if (output.columns == Extent::nv) {
    if (name == A::mass_matrix) return d.M.onPaths(states);
    StateMatrices<T>* const matrices[] = {&d.by_q, &d.by_v, &d.by_a};
    return name == A::rnea_derivatives || name == A::coriolis ? matrices[k]->onPaths(states) : matrices[k]->whole();
  }
  return (name == A::nle ? d.nle : name == A::gravity ? d.gravity : name == A::aba || name == A::aba_derivatives ? d.ddq : d.tau).data();
}

/// Whether a call with these arguments computes result k of an algorithm. Only sums over bodies leave results out.
template <class T>
bool computes(Algorithm algorithm, std::size_t k, const StatesView<T>& v, const StatesView<T>& a) {
  if (algorithm == Algorithm::center_of_mass) return k == 0 || (k == 1 ? v.given : a.given);
  return algorithm != Algorithm::energies || k == 1 || v.given;
}

template <class T>
struct Run {
  BatchViews<T> views;
  Failure failure;  ///< fail() throws it
};

/// Runs an algorithm of the catalogue on all states. complete(block, first state) sets what a block needs in addition to states and results.
/// note(block, first, count, failure) notes the states that failed.
template <class T, class Complete, class Note>
Run<T> runAll(const char* name, const CompactModel& model, BasicBatchData<T>& data, const AlgorithmInfo& algorithm, const StatesView<T>& q,
              const StatesView<T>& v, const StatesView<T>& a, Complete&& complete, Note&& note) {
  BatchImpl<T>& d = data.impl();
  const CompactImpl& m = model.impl();
  const bool forward = algorithm.reads('t');
  checkBatch(name, model, d, q, algorithm.batch_need, nameOf(algorithm.batch_need));
  if (v.given) checkStates(name, "v", v, m.nv, q.cols);
  if (a.given) checkStates(name, forward ? "tau" : "a", a, m.nv, q.cols);
  if (isCentroidal(algorithm.algorithm) && (d.massless || (d.models == 0 && !(m.mass > 0))))
    throw Error(ErrorCode::singular, std::string(name) + ": the model has no mass");
  const ModelSizes sizes{m.nv, static_cast<int>(m.joints.size()), static_cast<int>(m.frames.size())};
  StatesOut<T> results[4];
  const bool in_columns = algorithm.batch_need != Need::kinematics;
  for (std::size_t k = 0; k < 4 && in_columns; ++k) {
    const AlgorithmOutput& output = algorithm.outputs[k];
    if (output.symbol == nullptr) break;
    if (!computes(algorithm.algorithm, k, v, a)) continue;
    results[k] = {memoryOf(d, algorithm, k, static_cast<std::size_t>(q.cols)),
                  static_cast<std::ptrdiff_t>(sizes.of(output.rows)) * sizes.of(output.columns)};
  }
  const Failure failure = forBlocks(d, static_cast<int>(q.cols), d.kernels->lanes, [&](int t, int first, int count, Failure& f) {
    kernels::Block<T> block;
    block.algorithm = algorithm.algorithm;
    readStates<T>(d, t, {q, v, a, forward}, first, count, block);
    for (int k = 0; k < 4; ++k) block.results[k] = results[k].first ? results[k].first + first * results[k].rows : nullptr;
    complete(block, first);
    d.kernels->run(chooseModels(d, first, block), d.scratch[at(t)].data(), block);
    if (results[0].first || results[1].first) {
      noteFailures(q, block, results, first, count, f);
    } else {
      note(block, first, count, f);
    }
  });
  BatchViews<T> views{{}, {}, q.cols};
  for (std::size_t k = 0; k < 4; ++k) {
    views.results[k] = results[k].first;
    views.rows[k] = results[k].rows;
  }
  return {views, failure};
}

template <class T, class Complete>
Run<T> runAll(const char* name, const CompactModel& model, BasicBatchData<T>& data, const AlgorithmInfo& algorithm, const StatesView<T>& q,
              const StatesView<T>& v, const StatesView<T>& a, Complete&& complete) {
  return runAll(name, model, data, algorithm, q, v, a, complete, [](const kernels::Block<T>& block, int first, int count, Failure& failure) {
    if (block.not_finite) failure.note(first, 0, count);
  });
}

}  // namespace

template <class T>
BatchViews<T> batchJacobians(const CompactModel& model, BasicBatchData<T>& data, StatesView<T> q, Kind kind, int id, ReferenceFrame reference) {
  const AlgorithmInfo& entry = info(kind == Kind::all_joints ? Algorithm::joint_jacobians : Algorithm::frame_jacobian);
  const char* name = kind == Kind::joint ? "computeJointJacobian" : entry.function;
  checkReference(reference);
  kernels::FramePoint<double> point;
  if (kind == Kind::all_joints) {
    refuseDependentJoints(name, model.impl());
  } else {
    const PointOnBody where = kind == Kind::joint ? jointOnBody(model, id) : frameOnBody(model, id);
    point = {where.body, where.placement};
  }
  const Run<T> run = runAll(name, model, data, entry, q, {}, {}, [&](kernels::Block<T>& block, int) {
    block.frame = point;
    block.reference = reference;
  });
  fail(name, model.impl(), run.failure, q);
  return run.views;
}

template <class T>
void batchKinematics(const CompactModel& model, BasicBatchData<T>& data, StatesView<T> q, StatesView<T> v, StatesView<T> a) {
  BatchImpl<T>& d = data.impl();
  const AlgorithmInfo& entry = info(a.given ? Algorithm::accelerations : v.given ? Algorithm::velocities : Algorithm::placements);
  const Run<T> run = runAll(entry.function, model, data, entry, q, v, a, [&](kernels::Block<T>& block, int first) {
    block.poses = numbersOf<12>(d, d.poses, 0, first);
    if (v.data) block.velocities = numbersOf<6>(d, d.velocities, 0, first);
    if (a.data) block.accelerations = numbersOf<6>(d, d.accelerations, 0, first);
  });
  d.states = static_cast<int>(q.cols);
  d.stage = a.given ? KinematicsStage::accelerations : v.given ? KinematicsStage::velocities : KinematicsStage::poses;
  fail(entry.function, model.impl(), run.failure, q);
}

template <class T>
BatchViews<T> runBatch(const CompactModel& model, BasicBatchData<T>& data, Algorithm algorithm, StatesView<T> q, StatesView<T> v, StatesView<T> a) {
  const AlgorithmInfo& entry = info(algorithm);
  if (algorithm == Algorithm::joint_jacobians) return batchJacobians(model, data, q, Kind::all_joints, 0, ReferenceFrame::WORLD);
  if (entry.batch_need == Need::kinematics) {
    batchKinematics(model, data, q, entry.reads('v') ? v : StatesView<T>(), entry.reads('a') ? a : StatesView<T>());
    return {{}, {}, q.cols};
  }
  if (!entry.batched || entry.reads('f'))
    throw Error(ErrorCode::argument,
                std::string(entry.function) + " does not run in batches by its entry in the catalogue; call the function itself");
  const StatesView<T> third = entry.reads('a') || entry.reads('t') ? a : StatesView<T>();
  const char* const name = algorithm == Algorithm::energies && !v.given ? "computePotentialEnergy" : entry.function;
  const Run<T> run = runAll(name, model, data, entry, q, entry.reads('v') ? v : StatesView<T>(), third, [](kernels::Block<T>&, int) {});
  fail(name, model.impl(), run.failure, q);
  return run.views;
}

namespace {

/// The factors of the block of states that begins with `first`.
template <class T>
T* factorsOf(const BatchImpl<T>& d, int first) {
  return reinterpret_cast<T*>(d.factors.data()) + static_cast<std::ptrdiff_t>(kernels::keptNumbers(*d.model)) * first;
}

}  // namespace

template <class T>
void batchFactors(const CompactModel& model, BasicBatchData<T>& data, StatesView<T> q) {
  constexpr const char* name = "cholesky::decompose";
  refuseDependentJoints(name, model.impl());
  BatchImpl<T>& d = data.impl();
  AlgorithmInfo entry = info(Algorithm::minverse);
  entry.outputs = {};  // the factors stay in the batch
  const auto numbers = static_cast<int>(kernels::keptNumbers(model.impl()));
  const int lanes = d.kernels->lanes;
  const Run<T> run = runAll(
      name, model, data, entry, q, {}, {}, [&](kernels::Block<T>& block, int first) { block.factors = factorsOf(d, first); },
      [&](const kernels::Block<T>& block, int first, int count, Failure& failure) {
        for (int l = 0; block.not_finite && l < count; ++l) {
          T* const factors = factorsOf(d, first) + l;
          bool finite = block.failed[l] == 0;
          for (int k = 0; k < numbers; ++k) {
            finite = finite && std::isfinite(factors[k * lanes]);
            if (block.failed[l] != 0) factors[k * lanes] = std::numeric_limits<T>::quiet_NaN();
          }
          if (!finite && kernels::allFinite(q.data + (first + l) * q.stride, q.rows)) failure.note(first + l, block.failed[l]);
        }
      });
  d.factored = static_cast<int>(q.cols);
  fail(name, model.impl(), run.failure, q);
}

template <class T>
BatchViews<T> batchSolve(const CompactModel& model, BasicBatchData<T>& data, StatesView<T> x) {
  constexpr const char* name = "cholesky::solve";
  BatchImpl<T>& d = data.impl();
  checkBatchData(name, model, d, Need::derivatives, "derivatives");
  if (d.factored == 0) throw Error(ErrorCode::argument, "cholesky::solve: the batch has no factors; call cholesky::decompose first");
  checkStates(name, "b", x, model.nv(), d.factored);
  forBlocks(d, d.factored, d.kernels->lanes, [&](int t, int first, int count, Failure&) {
    kernels::Block<T> block;
    block.a = columns(x, first, count);
    block.results[0] = d.ddq.data() + first * x.rows;
    d.kernels->solve(model.impl(), d.scratch[at(t)].data(), factorsOf(d, first), block);
  });
  return {{d.ddq.data()}, {x.rows}, x.cols};
}

template BatchViews<double> runBatch(const CompactModel&, BatchData&, Algorithm, StatesView<double>, StatesView<double>, StatesView<double>);
template BatchViews<float> runBatch(const CompactModel&, BatchDataFloat&, Algorithm, StatesView<float>, StatesView<float>, StatesView<float>);
template BatchViews<double> batchJacobians(const CompactModel&, BatchData&, StatesView<double>, Kind, int, ReferenceFrame);
template BatchViews<float> batchJacobians(const CompactModel&, BatchDataFloat&, StatesView<float>, Kind, int, ReferenceFrame);
template void batchFactors(const CompactModel&, BatchData&, StatesView<double>);
template void batchFactors(const CompactModel&, BatchDataFloat&, StatesView<float>);
template BatchViews<double> batchSolve(const CompactModel&, BatchData&, StatesView<double>);
template BatchViews<float> batchSolve(const CompactModel&, BatchDataFloat&, StatesView<float>);
template void batchKinematics(const CompactModel&, BatchData&, StatesView<double>, StatesView<double>, StatesView<double>);
template void batchKinematics(const CompactModel&, BatchDataFloat&, StatesView<float>, StatesView<float>, StatesView<float>);

}  // namespace detail

namespace {

template <int N, class T>
void pick(const BatchImpl<T>& d, const PackMemory& memory, int body, int state, T* out) {
  if (state < 0 || state >= d.states)
    throw Error(ErrorCode::argument,
                "state " + std::to_string(state) + " does not exist; the last forwardKinematics had " + std::to_string(d.states));
  const T* from = detail::numbersOf<N>(d, memory, body, state);
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
