// SPDX-License-Identifier: BSD-2-Clause
#include "task.hpp"

#include <dyn/algorithm/batch.hpp>
#include <dyn/algorithm/center_of_mass.hpp>

#include <algorithm>
#include <functional>
#include <map>
#include <optional>

namespace dyn::tool::sweep {

namespace {

/// A result that is no output of the catalogue's algorithms.
struct Other {
  const char* key;
  bool vector;  ///< three numbers, otherwise one
  std::function<double*(const CompactModel&, Data&, const Inputs&, double*)> write;
};

double* put(const Vec3<double>& x, double* out) {
  for (const double number : {x.x, x.y, x.z}) *out++ = number;
  return out;
}
double* put(double x, double* out) {
  *out = x;
  return out + 1;
}

const std::vector<Other>& others() {
  static const std::vector<Other> all{
      {"com", true, [](auto& m, auto& d, auto& s, double* out) { return put(centerOfMass(m, d, s.q).position, out); }},
      {"vcom", true, [](auto& m, auto& d, auto& s, double* out) { return put(centerOfMass(m, d, s.q, s.v).velocity, out); }},
      {"acom", true, [](auto& m, auto& d, auto& s, double* out) { return put(centerOfMass(m, d, s.q, s.v, s.a).acceleration, out); }},
      {"kinetic_energy", false, [](auto& m, auto& d, auto& s, double* out) { return put(computeKineticEnergy(m, d, s.q, s.v), out); }},
      {"potential_energy", false, [](auto& m, auto& d, auto& s, double* out) { return put(computePotentialEnergy(m, d, s.q), out); }}};
  return all;
}

/// Output k of an algorithm, or another result.
struct Function {
  const AlgorithmInfo* algorithm = nullptr;
  std::size_t k = 0;
  const Other* other = nullptr;
};

std::map<std::string, Function> allFunctions() {
  std::map<std::string, Function> out;
  for (const AlgorithmInfo& algorithm : algorithms())
    for (std::size_t k = 0; k < algorithm.outputs.size(); ++k)
      if (algorithm.outputs[k].key != nullptr) out[algorithm.outputs[k].key] = {&algorithm, k, nullptr};
  for (const Other& other : others()) out[other.key] = {nullptr, 0, &other};
  return out;
}

class ComputeTask final : public Task {
 public:
  explicit ComputeTask(const Setting& setting)
      : setting_(setting), model_(setting.model), sizes_{model_.nv(), model_.njoints(), static_cast<int>(model_.frames().size())} {
    const std::map<std::string, Function> all = allFunctions();
    for (const std::string& key : setting.study.functions) {
      const auto found = all.find(key);
      std::vector<std::string> names;
      for (const auto& [name, function] : all) names.push_back(name);
      if (found == all.end()) unknownName(setting.study.value()["functions"], "function", key, names);
      const Function& function = found->second;
      functions_.push_back(function);
      if (function.other) {
        fields_.push_back({key, function.other->vector ? std::vector<std::int64_t>{3} : std::vector<std::int64_t>{}});
        continue;
      }
      const AlgorithmOutput& output = function.algorithm->outputs[function.k];
      batch_need_ = batch_need_ | function.algorithm->batch_need;
      std::vector<std::int64_t> shape{sizes_.of(output.rows)};
      if (output.columns != Extent::one) shape.push_back(sizes_.of(output.columns));
      fields_.push_back({key, shape});
    }
    if (!setting.study.frames.empty()) batch_need_ = batch_need_ | Need::kinematics;
    for (const std::string& name : setting.study.frames) {
      frames_.push_back(model_.frameId(name));
      fields_.push_back({"frames/" + name + "/p", {3}});
      fields_.push_back({"frames/" + name + "/R", {3, 3}});
    }
    if (fields_.empty()) setting.study.value().fail("has neither 'functions' nor 'frames', so that nothing is computed");
    // States of one model, and of models that differ in inertias, are computed side by side in the lanes of a register.
    const bool alone = setting.variation.changesModel() && !setting.variation.changesInertiasOnly();
    together_ = alone ? 1 : most_together;
    data_.emplace(model_, need_);
    batch_.emplace(model_, together_, batch_need_);
  }

  const std::vector<Field>& fields() const override { return fields_; }
  std::size_t together() const override { return static_cast<std::size_t>(together_); }

  void run(const Inputs& inputs, double* row) override {
    if (const std::optional<std::string> reason = runAll({&inputs, 1}, {&row, 1})[0]) throw Error(ErrorCode::argument, *reason);
  }

  std::vector<std::optional<std::string>> runAll(std::span<const Inputs> inputs, std::span<double* const> rows) override {
    std::vector<std::optional<std::string>> reasons(inputs.size());
    for (std::size_t first = 0; first < inputs.size(); first += together()) {
      const std::size_t count = std::min(together(), inputs.size() - first);
      try {
        evaluate(inputs.subspan(first, count), rows.subspan(first, count));
      } catch (const std::exception&) {
        // One of them is the reason; each is tried alone.
        for (std::size_t k = first; k < first + count; ++k) {
          try {
            evaluate(inputs.subspan(k, 1), rows.subspan(k, 1));
          } catch (const std::exception& e) {
            reasons[k] = e.what();
          }
        }
      }
    }
    return reasons;
  }

 private:
  static constexpr int most_together = 64;

  /// Computes some samples in one batch. Throws Error if one of them fails.
  void evaluate(std::span<const Inputs> inputs, std::span<double* const> rows) {
    takeModels(inputs);
    const auto n = static_cast<Eigen::Index>(inputs.size());
    Eigen::MatrixXd q(model_.nq(), n), v(model_.nv(), n), a(model_.nv(), n), tau(model_.nv(), n);
    for (Eigen::Index k = 0; k < n; ++k) {
      const Inputs& x = inputs[static_cast<std::size_t>(k)];
      q.col(k) = x.q, v.col(k) = x.v, a.col(k) = x.a, tau.col(k) = x.tau;
    }
    std::vector<double*> next(rows.begin(), rows.end());
    for (const Function& function : functions_) {
      if (function.other) {
        writeOther(*function.other, inputs, next);
        continue;
      }
      const AlgorithmInfo& algorithm = *function.algorithm;
      const auto x = runAlgorithm(model_, *batch_, algorithm.algorithm, q, v, algorithm.reads('t') ? tau : a)(function.k);
      const AlgorithmOutput& output = algorithm.outputs[function.k];
      const Eigen::Index rows_of_one = sizes_.of(output.rows), columns = sizes_.of(output.columns);
      for (Eigen::Index k = 0; k < n; ++k)
        for (Eigen::Index i = 0; i < rows_of_one; ++i)
          for (Eigen::Index j = 0; j < columns; ++j) *next[static_cast<std::size_t>(k)]++ = x(i + rows_of_one * j, k);
    }
    if (!frames_.empty()) forwardKinematics(model_, *batch_, q);
    for (const int frame : frames_)
      for (int k = 0; k < n; ++k) {
        const SE3<double> X = framePlacement(model_, *batch_, frame, k);
        double*& row = next[static_cast<std::size_t>(k)];
        row = std::copy(X.R.m, X.R.m + 9, put(X.p, row));
      }
  }

  void writeOther(const Other& other, std::span<const Inputs> inputs, std::vector<double*>& next) {
    for (std::size_t k = 0; k < inputs.size(); ++k) {
      if (!models_.empty()) data_.emplace(models_[k], need_);
      const CompactModel& model = models_.empty() ? model_ : models_[k];
      if (other.vector && !(model.mass() > 0)) throw Error(ErrorCode::singular, "the model has no mass, so no centre of mass");
      next[k] = other.write(model, *data_, inputs[k], next[k]);
    }
  }

  void takeModels(std::span<const Inputs> inputs) {
    if (!setting_.variation.changesModel()) return;
    MotionOptions unused = setting_.study.options;
    models_.clear();
    for (const Inputs& x : inputs) models_.push_back(setting_.modelOf(x, unused));
    if (setting_.variation.changesInertiasOnly()) {
      batch_->setModels(models_);
    } else {
      model_ = models_[0];
      batch_.emplace(model_, 1, batch_need_);
    }
  }

  const Setting& setting_;
  CompactModel model_;
  ModelSizes sizes_;
  Need need_ = Need::mass_matrix;  // aba of models with dependent joints takes M, too
  Need batch_need_ = Need::mass_matrix;
  int together_ = 1;
  std::optional<Data> data_;
  std::optional<BatchData> batch_;
  std::vector<CompactModel> models_;  ///< of the present samples, if they differ
  std::vector<Function> functions_;
  std::vector<int> frames_;
  std::vector<Field> fields_;
};

}  // namespace

std::unique_ptr<Task> computeTask(const Setting& setting) { return std::make_unique<ComputeTask>(setting); }

}  // namespace dyn::tool::sweep
