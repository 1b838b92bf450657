// SPDX-License-Identifier: BSD-2-Clause
#include "sha256.hpp"
#include "task.hpp"
#include "tasks/python_process.hpp"

#include <dyn/file.hpp>
#include <dyn/parsers/json.hpp>
#include <dyn/version.hpp>

#include <optional>

namespace dyn::tool::sweep {

namespace {

/// The numbers of the model that a sample changes, as arguments of CompactModel.with_numbers in Python.
nlohmann::json argumentsOf(const ModelNumbers& numbers) {
  nlohmann::json out = nlohmann::json::object();
  if (numbers.gravity) out["gravity"] = flat(*numbers.gravity);
  for (const BodyInertia& x : numbers.inertias) out["inertias"][x.body] = {x.inertia.mass, flat(x.inertia.com), flat(x.inertia.rotational.matrix())};
  const auto ofJoints = [&out](const char* name, const std::vector<JointNumbers>& list) {
    for (const JointNumbers& x : list) out[name][x.joint] = x.values;
  };
  ofJoints("damping", numbers.damping);
  ofJoints("friction", numbers.friction);
  ofJoints("armature", numbers.armature);
  return out;
}

/// The limits that a sample changes, of joint after joint, by the names that JointDescription has for them in Python.
nlohmann::json limitsOf(const Setting& setting, const Inputs& inputs) {
  nlohmann::json out = nlohmann::json::object();
  if (!setting.variation.changesLimits()) return out;
  Model limited = setting.description;
  setting.variation.applyLimits(inputs, limited);
  for (const Quantity& quantity : setting.variation.quantities()) {
    if (!quantity.isLimit()) continue;
    const JointDescription& joint = limited.bodies[static_cast<std::size_t>(quantity.target)].joint;
    out[joint.name] = {{"lower", joint.limits.lower},
                       {"upper", joint.limits.upper},
                       {"velocity_limit", joint.limits.velocity},
                       {"effort_limit", joint.limits.effort}};
  }
  return out;
}

bool isState(const Quantity& quantity) { return quantity.kind <= Quantity::Kind::tau; }

/// The line with which a process begins. Without fields it takes any results.
std::string setupOf(const Setting& setting, const nlohmann::json& fields) {
  const ModelOptions& options = setting.study.options;
  const int nq = setting.model.nq(), nv = setting.model.nv();
  nlohmann::json plugins = nlohmann::json::array();
  nlohmann::json inputs = nlohmann::json::array({{"q", nq}, {"v", nv}, {"a", nv}, {"tau", nv}});
  for (const Quantity& quantity : setting.variation.quantities())
    if (!isState(quantity)) inputs.push_back({quantity.name, quantity.size});
  for (const PluginRecord& plugin : setting.registry.plugins())
    if (plugin.problem.empty()) plugins.push_back(plugin.path);
  const nlohmann::json setup = {{"version", version().number},
                                {"file", setting.study.file},
                                {"function", setting.study.function},
                                {"model", json::write(setting.description)},
                                {"plugins", plugins},
                                {"trust", options.any_plugin ? "any" : "owner_only"},
                                {"lock", options.lock},
                                {"dissipation", options.losses},
                                {"seed", setting.study.seed},
                                {"inputs", inputs},
                                {"reserved", {"failed", "success", "input", "times", "histogram"}},
                                {"fields", fields}};
  return setup.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
}

/// Computes a sample. Returns the line of the answer, after which its numbers follow.
nlohmann::json answerOf(PythonProcess& process, const Setting& setting, const Inputs& inputs) {
  MotionOptions unused = setting.study.options;
  const nlohmann::json numbers =
      setting.variation.changesModel() ? argumentsOf(setting.variation.apply(inputs, setting.description, unused)) : nlohmann::json::object();
  std::vector<double> values;
  for (const Eigen::VectorXd* x : {&inputs.q, &inputs.v, &inputs.a, &inputs.tau}) values.insert(values.end(), x->begin(), x->end());
  auto next = inputs.values.begin();
  for (const Quantity& quantity : setting.variation.quantities()) {
    if (!isState(quantity)) values.insert(values.end(), next, next + quantity.size);
    next += quantity.size;
  }
  return process.ask({{"sample", inputs.sample}, {"numbers", numbers}, {"limits", limitsOf(setting, inputs)}}, values);
}

class PythonTask final : public Task {
 public:
  explicit PythonTask(const Setting& setting) : setting_(setting), size_(numbersOf(setting.python.fields)) {}

  const std::vector<Field>& fields() const override { return setting_.python.fields; }

  void prepare() override {
    if (!process_ || !process_->usable()) process_.emplace(setting_.python.file, setting_.python.setup);
  }

  void run(const Inputs& inputs, double* row) override {
    if (!process_) throw Error(ErrorCode::argument, "interrupted");
    answerOf(*process_, setting_, inputs);
    process_->read(row, size_);
  }

 private:
  const Setting& setting_;
  std::size_t size_;
  std::optional<PythonProcess> process_;
};

}  // namespace

PythonFunction findFunction(const Setting& setting) {
  constexpr std::int64_t most_tried = 100;
  PythonFunction out{setting.study.file, sha256(readFile(setting.study.file)), "", {}};
  const std::string setup = setupOf(setting, nullptr);
  std::optional<PythonProcess> process;
  std::string first_reason;
  for (std::int64_t k = 0; k < std::min(setting.study.samples, most_tried); ++k) {
    if (!process || !process->usable()) process.emplace(out.file, setup);
    try {
      const nlohmann::json fields = answerOf(*process, setting, setting.variation.draw(static_cast<std::uint64_t>(k))).at("fields");
      for (const auto& [name, shape] : fields.items()) out.fields.push_back({name, shape});
      out.setup = setupOf(setting, fields);
      return out;
    } catch (const std::exception& e) {
      if (first_reason.empty()) first_reason = e.what();
    }
  }
  throw Error(ErrorCode::argument, "the function fails for every sample that was tried; for sample 0: " + first_reason, {out.file, 0, ""});
}

std::unique_ptr<Task> pythonTask(const Setting& setting) { return std::make_unique<PythonTask>(setting); }

}  // namespace dyn::tool::sweep
