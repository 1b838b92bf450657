// SPDX-License-Identifier: BSD-2-Clause
// The same error budgets for other ways to compute the same results: batches in double and in float, and operations of generated code.
#include "support/traced.hpp"
#include "truth/data_sets.hpp"

#include <set>

using namespace dyn;
using namespace dyn::test;

namespace {

Eigen::MatrixXd squareOf(const Eigen::VectorXd& x) {
  const auto n = static_cast<Eigen::Index>(std::lround(std::sqrt(static_cast<double>(x.size()))));
  return x.reshaped(n, n);
}

/// Checks all samples of a set as one batch. Float batches start from states and a model that are rounded to floats. Their reference is the double
/// computation from the rounded states, whose error is 10^-8 of a float's rounding.
template <class T>
void checkBatch(const std::string& name) {
  const Set set = load(name);
  const CompactModel& model = set.model;
  const nlohmann::json& samples = set.document["samples"];
  const auto n = static_cast<Eigen::Index>(samples.size());
  using Matrix = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>;
  const auto [q, v, a, tau] = statesOf<T>(set);
  // Products of masses and distances in extreme sets leave no digits of a float, so M is singular there.
  bool regular = std::is_same_v<T, double> || !isExtreme(name), differentiable = true;
  for (const nlohmann::json& sample : samples) {
    regular = regular && sample["truth"].contains("aba_scale");
    differentiable = differentiable && sample["truth"].contains("ddq_dq");
  }
  constexpr bool is_double = std::is_same_v<T, double>;
  const std::string mode = is_double ? ", batch" : ", batch float";
  BasicBatchData<T> batch(model, static_cast<int>(n), Need::derivatives | Need::mass_matrix, 2);
  Data data(model, Need::derivatives);
  Worst worst(name);
  const double unit = is_double ? 1 : 0x1p-24 / 0x1p-53;  // roundoff of T relative to that of double
  const auto column = [](const auto& states, Eigen::Index k) { return Eigen::VectorXd(states.col(k).template cast<double>()); };
  const Matrix forces = rnea(model, batch, q, v, a), M = crba(model, batch, q);
  const Matrix accelerations = regular ? Matrix(aba(model, batch, q, v, tau)) : Matrix();
  for (Eigen::Index k = 0; k < n; ++k) {
    const nlohmann::json& truth = samples[static_cast<std::size_t>(k)]["truth"];
    const Eigen::VectorXd qd = column(q, k), vd = column(v, k), ad = column(a, k), taud = column(tau, k);
    const auto check = [&](const char* key, const Matrix& found, auto&& rounded) {
      nlohmann::json reference = truth;
      if (!is_double) reference[key] = rowMajor(rounded());
      worst.check(key, mode, rowMajor(column(found, k)), reference, unit);
    };
    if (truth.contains("rnea_scale")) check("rnea", forces, [&] { return rnea(model, data, qd, vd, ad); });
    if (truth.contains("M")) check("M", M, [&] { return crba(model, data, qd); });
    if (regular) check("aba", accelerations, [&] { return aba(model, data, qd, vd, taud); });
  }
  if (!is_double || !differentiable) return;
  const auto forward = computeABADerivatives(model, batch, q, v, tau);
  const Matrix ddq_dq = forward.ddq_dq, ddq_dv = forward.ddq_dv, ddq_dtau = forward.ddq_dtau;
  const auto inverse = computeRNEADerivatives(model, batch, q, v, a);
  for (Eigen::Index k = 0; k < n; ++k)
    checkDerivatives(samples[static_cast<std::size_t>(k)],
                     {squareOf(column(inverse.dtau_dq, k)), squareOf(column(inverse.dtau_dv, k)), squareOf(column(inverse.dtau_da, k)),
                      squareOf(column(ddq_dq, k)), squareOf(column(ddq_dv, k)), squareOf(column(ddq_dtau, k))},
                     mode, isExtreme(name), worst);
}

/// The outputs of a traced function at a sample.
std::vector<Eigen::VectorXd> replayed(const TracedFunction& f, const nlohmann::json& sample) {
  std::vector<double> in;
  for (const ArgumentShape& argument : f.inputs) {
    const Eigen::VectorXd x = vectorOf(sample[argument.name]);
    in.insert(in.end(), x.begin(), x.end());
  }
  return byGraph(f, in);
}

void checkTraced(const std::string& name, const TraceOptions& how) {
  const Set set = load(name);
  const std::string mode = how.packable ? ", generated, abreast" : ", generated";
  Worst worst(name);
  const auto traced = [&](const char* function) { return trace(set.model, function, how); };
  const TracedFunction rnea = traced("rnea"), crba = traced("crba"), aba = traced("aba");
  const TracedFunction by_rnea = traced("rnea_derivatives"), by_aba = traced("aba_derivatives");
  for (const auto& sample : set.document["samples"]) {
    const nlohmann::json& truth = sample["truth"];
    if (truth.contains("rnea_scale")) worst.check("rnea", mode, rowMajor(replayed(rnea, sample)[0]), truth);
    if (truth.contains("M")) worst.check("M", mode, rowMajor(replayed(crba, sample)[0]), truth);
    if (truth.contains("aba_scale")) worst.check("aba", mode, rowMajor(replayed(aba, sample)[0]), truth);
    const auto x = replayed(by_rnea, sample), y = replayed(by_aba, sample);
    // Replayed operations are not fused, unlike compiled ones. So all sets are judged relative to the terms that cancel.
    checkDerivatives(sample, {squareOf(x[0]), squareOf(x[1]), squareOf(x[2]), squareOf(y[0]), squareOf(y[1]), squareOf(y[2])}, mode, true, worst);
  }
}

}  // namespace

TEST_CASE("batches are within the same budgets, in double and in float", "[truth]") {
  DYN_NEEDS_SHARED();
  for (const std::string& name : truth_sets) checkBatch<double>(name);
  for (const std::string& name : truth_sets) checkBatch<float>(name);
}

TEST_CASE("operations of generated code are within the same budgets of the project's own references", "[truth]") {
  // Traces refuse dependent joints, and joint types with branches on q.
  const std::set<std::string> refused = {"references/coupled", "references/functions", "references/knee", "references/planar_rail"};
  for (const std::string& name : ownSets())
    if (!refused.contains(name))
      for (const bool packable : {false, true}) checkTraced(name, {.packable = packable});
}

TEST_CASE("operations of generated code are within the same budgets", "[truth]") {
  DYN_NEEDS_SHARED();
  for (const std::string& name : truth_sets)
    if (name != "chain_100" && name != "big_chain_200")  // graphs of millions of operations
      for (const bool packable : {false, true}) checkTraced(name, {.packable = packable});
}
