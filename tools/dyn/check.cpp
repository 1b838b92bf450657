// dyn check: finds what is wrong or suspicious in a model. Exit code 1 when there are errors.
#include <cmath>
#include <memory>

#include "commands.hpp"
#include "model_options.hpp"

namespace dyn::tool {

namespace {

class Findings {
 public:
  void error(const std::string& text) {
    std::printf("error: %s\n", text.c_str());
    ++errors_;
  }
  void warning(const std::string& text) {
    std::printf("warning: %s\n", text.c_str());
    ++warnings_;
  }
  int errors() const { return errors_; }
  int warnings() const { return warnings_; }

 private:
  int errors_ = 0, warnings_ = 0;
};

void checkLimits(const CompactModel& model, const Model& description, Findings& findings) {
  for (std::size_t i = 1; i < description.bodies.size(); ++i) {
    const JointDescription& j = description.bodies[i].joint;
    const int id = model.jointId(j.name);
    if (id < 0) continue;
    const JointRecord& r = model.joints()[static_cast<std::size_t>(id)];
    if (r.nq == 1 && j.limits.lower.empty() && j.coupling.type.empty())
      findings.warning("joint '" + j.name + "' (" + j.type + ") has no position limits");
  }
}

void checkMimic(const Model& description, Findings& findings) {
  for (const BodyDescription& body : description.bodies) {
    const Coupling& c = body.joint.coupling;
    if (c.type.empty()) continue;
    const int master = description.findJoint(c.master);
    if (master > 0 && !description.bodies[static_cast<std::size_t>(master)].joint.coupling.type.empty())
      findings.warning("joint '" + body.joint.name + "' mimics '" + c.master + "', which mimics another joint itself");
  }
}

void checkMassMatrix(const CompactModel& model, Findings& findings) {
  Data data(model, Need::mass_matrix);
  try {
    const Eigen::VectorXd q = neutral(model), zero = Eigen::VectorXd::Zero(model.nv());
    aba(model, data, q, zero, zero);
  } catch (const Error& e) {
    findings.error(std::string("at the neutral configuration: ") + e.what());
  }
}

void run(const ModelOptions& o) {
  Findings findings;
  try {
    const Model description = o.description();
    for (const std::string& note : description.notes) findings.warning(note);
    const CompactModel model = dyn::compile(description, o.registry(), o.compileOptions());
    for (const std::string& warning : model.report().warnings) findings.warning(warning);
    checkLimits(model, description, findings);
    checkMimic(description, findings);
    checkMassMatrix(model, findings);
  } catch (const Error& e) {
    findings.error(e.what());
  }
  std::printf("%d errors, %d warnings\n", findings.errors(), findings.warnings());
  if (findings.errors() > 0) throw ExitCode{1};
}

}  // namespace

void addCheck(CLI::App& app) {
  CLI::App* sub = app.add_subcommand("check", "lints a model; exit code 1 on errors");
  auto o = std::make_shared<ModelOptions>();
  o->add(*sub);
  sub->callback([o] { run(*o); });
}

}  // namespace dyn::tool
