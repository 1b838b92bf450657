// SPDX-License-Identifier: BSD-2-Clause
#include "task.hpp"

#include <dyn/algorithm/compute.hpp>

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
  explicit ComputeTask(const Setting& setting) : setting_(setting), model_(setting.model) {
    const std::map<std::string, Function> all = allFunctions();
    const ModelSizes sizes{model_.nv(), model_.njoints(), static_cast<int>(model_.frames().size())};
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
      need_ = need_ | function.algorithm->need;
      std::vector<std::int64_t> shape{sizes.of(output.rows)};
      if (output.columns != Extent::one) shape.push_back(sizes.of(output.columns));
      fields_.push_back({key, shape});
    }
    for (const std::string& name : setting.study.frames) {
      frames_.push_back(model_.frameId(name));
      fields_.push_back({"frames/" + name + "/p", {3}});
      fields_.push_back({"frames/" + name + "/R", {3, 3}});
    }
    if (fields_.empty()) setting.study.value().fail("has neither 'functions' nor 'frames', so that nothing is computed");
    data_.emplace(model_, need_);
  }

  const std::vector<Field>& fields() const override { return fields_; }

  void run(const Inputs& inputs, double* row) override {
    if (setting_.variation.changesModel()) {
      MotionOptions unused = setting_.study.options;
      model_ = setting_.model.withNumbers(setting_.variation.apply(inputs, setting_.description, unused));
      data_.emplace(model_, need_);
    }
    for (const Function& function : functions_) {
      if (function.other) {
        if (function.other->vector && !(model_.mass() > 0)) throw Error(ErrorCode::singular, "the model has no mass, so no centre of mass");
        row = function.other->write(model_, *data_, inputs, row);
        continue;
      }
      const AlgorithmInfo& algorithm = *function.algorithm;
      const MatrixResult x =
          runAlgorithm(model_, *data_, algorithm.algorithm, inputs.q, inputs.v, algorithm.reads('t') ? inputs.tau : inputs.a)(function.k);
      for (Eigen::Index i = 0; i < x.rows(); ++i)
        for (Eigen::Index j = 0; j < x.cols(); ++j) *row++ = x(i, j);
    }
    if (!frames_.empty()) forwardKinematics(model_, *data_, inputs.q);
    for (const int frame : frames_) {
      const SE3<double> X = framePlacement(model_, *data_, frame);
      row = std::copy(X.R.m, X.R.m + 9, put(X.p, row));
    }
  }

 private:
  const Setting& setting_;
  CompactModel model_;
  Need need_ = Need::mass_matrix;  // aba of models with dependent joints takes M, too
  std::optional<Data> data_;
  std::vector<Function> functions_;
  std::vector<int> frames_;
  std::vector<Field> fields_;
};

}  // namespace

std::unique_ptr<Task> computeTask(const Setting& setting) { return std::make_unique<ComputeTask>(setting); }

}  // namespace dyn::tool::sweep
