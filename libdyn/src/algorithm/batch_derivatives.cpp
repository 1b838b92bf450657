#include "algorithm/batch_support.hpp"

#include <dyn/algorithm/batch_derivatives.hpp>

namespace dyn::detail {

namespace {

const char* nameOf(BatchDerivatives what) {
  switch (what) {
    case BatchDerivatives::rnea:
      return "computeRNEADerivatives";
    case BatchDerivatives::aba:
      return "computeABADerivatives";
    case BatchDerivatives::minverse:
      return "computeMinverse";
    case BatchDerivatives::coriolis:
      return "computeCoriolisMatrix";
    case BatchDerivatives::centroidal_map:
      return "ccrba";
    case BatchDerivatives::centroidal_rate:
      return "computeCentroidalMomentumTimeVariation";
    default:
      return "computeCentroidalDynamicsDerivatives";
  }
}

kernels::Task taskOf(BatchDerivatives what) {
  return static_cast<kernels::Task>(static_cast<int>(kernels::Task::rnea_derivatives) + static_cast<int>(what));
}

}  // namespace

template <class T>
BatchDerivativeViews<T> batchDerivatives(const CompactModel& model, BasicBatchData<T>& data, BatchDerivatives what, StatesView<T> q, StatesView<T> v,
                                         StatesView<T> a) {
  const char* name = nameOf(what);
  BatchImpl<T>& d = data.impl();
  const CompactImpl& m = model.impl();
  checkBatch(name, model, d, q, Need::derivatives, "derivatives");
  if (v.given) checkStates(name, "v", v, m.nv, q.cols);
  if (a.given) checkStates(name, what == BatchDerivatives::aba ? "tau" : "a", a, m.nv, q.cols);
  if (what >= BatchDerivatives::centroidal_map && !(m.mass > 0)) throw Error(ErrorCode::singular, std::string(name) + ": the model has no mass");
  const std::ptrdiff_t n = m.nv, square = n * n, map = 6 * n;
  StatesOut<T> results[4];
  const auto set = [&](StatesOut<T> first, StatesOut<T> second = {}, StatesOut<T> third = {}, StatesOut<T> fourth = {}) {
    const StatesOut<T> all[] = {first, second, third, fourth};
    std::copy(all, all + 4, results);
  };
  const bool on_paths = what == BatchDerivatives::rnea || what == BatchDerivatives::coriolis;
  const auto matrices = [&](StateMatrices<T>& of) -> StatesOut<T> {
    return {on_paths ? of.onPaths(static_cast<std::size_t>(q.cols)) : of.whole(), square};
  };
  switch (what) {
    case BatchDerivatives::rnea:
      set(matrices(d.by_q), matrices(d.by_v), matrices(d.by_a));
      break;
    case BatchDerivatives::aba:
      set(matrices(d.by_q), matrices(d.by_v), matrices(d.by_a), {d.ddq.data(), n});
      break;
    case BatchDerivatives::minverse:
    case BatchDerivatives::coriolis:
      set(matrices(d.by_a));
      break;
    case BatchDerivatives::centroidal_map:
      set({d.maps[0].data(), 6}, {d.maps[2].data(), map});
      break;
    case BatchDerivatives::centroidal_rate:
      set({d.maps[0].data(), 6}, {d.maps[1].data(), 6}, {d.maps[2].data(), map}, {d.maps[3].data(), map});
      break;
    case BatchDerivatives::centroidal_derivatives:
      set({d.maps[0].data(), map}, {d.maps[1].data(), map}, {d.maps[2].data(), map}, {d.maps[3].data(), map});
  }
  const int states = static_cast<int>(q.cols);
  const Failure failure = forBlocks(d, states, d.kernels->lanes, [&](int t, int first, int count, Failure& f) {
    kernels::Block<T> block;
    block.task = taskOf(what);
    readStates<T>(d, t, {q, v, a, what == BatchDerivatives::aba}, first, count, block);
    for (int k = 0; k < 4; ++k) block.results[k] = results[k].first ? results[k].first + first * results[k].rows : nullptr;
    d.kernels->run(m, d.scratch[static_cast<std::size_t>(t)].data(), block);
    noteFailures(q, block, results, first, count, f);
  });
  fail(name, m, failure, q);
  return {{results[0].first, results[1].first, results[2].first, results[3].first}, q.cols};
}

template BatchDerivativeViews<double> batchDerivatives(const CompactModel&, BatchData&, BatchDerivatives, StatesView<double>, StatesView<double>,
                                                       StatesView<double>);
template BatchDerivativeViews<float> batchDerivatives(const CompactModel&, BatchDataFloat&, BatchDerivatives, StatesView<float>, StatesView<float>,
                                                      StatesView<float>);

}  // namespace dyn::detail
