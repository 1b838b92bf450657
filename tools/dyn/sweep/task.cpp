// SPDX-License-Identifier: BSD-2-Clause
#include "task.hpp"

namespace dyn::tool::sweep {

std::size_t Field::size() const {
  std::size_t product = 1;
  for (const std::int64_t n : shape) product *= static_cast<std::size_t>(n);
  return product;
}

std::size_t numbersOf(const std::vector<Field>& fields) {
  std::size_t sum = 0;
  for (const Field& field : fields) sum += field.size();
  return sum;
}

Setting::Setting(Study given)
    : study(std::move(given)),
      description(study.description()),
      registry(study.options.registry()),
      model(study.options.compile(description, registry)),
      variation(study, description, model) {
  countSamples();
  const MotionOptions& options = study.options;
  if (study.task == TaskKind::collide || (study.task == TaskKind::simulate && options.touching))
    geometry = compileGeometry(model, description, options.volumes.geometry());
  if (study.task == TaskKind::python) python = findFunction(*this);
}

CompactModel Setting::modelOf(const Inputs& inputs, MotionOptions& options) const {
  const ModelNumbers numbers = variation.apply(inputs, description, options);
  if (!variation.changesModel()) return model;
  if (!variation.changesLimits()) return model.withNumbers(numbers);
  Model limited = description;
  variation.applyLimits(inputs, limited);
  return compile(limited, registry, study.options.compileOptions()).withNumbers(numbers);
}

void Setting::countSamples() {
  if (study.samples > 0) return;
  if (variation.cells() == 1)
    throw Error(ErrorCode::syntax, "has no member 'samples', and no list or grid whose cells could be counted", {study.name, 0, ""});
  study.samples = variation.cells();
}

std::vector<std::optional<std::string>> Task::runAll(std::span<const Inputs> inputs, std::span<double* const> rows) {
  std::vector<std::optional<std::string>> reasons(inputs.size());
  for (std::size_t k = 0; k < inputs.size(); ++k) {
    try {
      run(inputs[k], rows[k]);
    } catch (const std::exception& e) {
      reasons[k] = e.what();
    }
  }
  return reasons;
}

void Task::plot(const Inputs&, const std::string&) { throw Error(ErrorCode::argument, "only samples of the task simulate have a motion to draw"); }

std::unique_ptr<Task> makeTask(const Setting& setting) {
  switch (setting.study.task) {
    case TaskKind::simulate:
      return simulateTask(setting);
    case TaskKind::compute:
      return computeTask(setting);
    case TaskKind::collide:
      return collideTask(setting);
    case TaskKind::python:
      return pythonTask(setting);
  }
  return nullptr;
}

}  // namespace dyn::tool::sweep
