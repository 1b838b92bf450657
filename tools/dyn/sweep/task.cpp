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
  if (study.task == TaskKind::python) python = findFunction(*this);
}

void Setting::countSamples() {
  if (study.samples > 0) return;
  if (variation.cells() == 1)
    throw Error(ErrorCode::syntax, "has no member 'samples', and no list or grid whose cells could be counted", {study.name, 0, ""});
  study.samples = variation.cells();
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
