// SPDX-License-Identifier: BSD-2-Clause
// dyn check: finds what is wrong or suspicious in a model. Exit code 1 when there are errors.
#include "commands.hpp"
#include "condition.hpp"
#include "messages.hpp"
#include "model_options.hpp"

#include <cstdio>
#include <memory>

namespace dyn::tool {

namespace {

class Findings {
 public:
  void error(const std::string& text) {
    std::fprintf(stderr, "%s %s\n", styled(stderr, Style::error, "error:").c_str(), text.c_str());
    ++errors_;
  }
  void warning(const std::string& text) {
    std::printf("%s %s\n", styled(stdout, Style::warning, "warning:").c_str(), text.c_str());
    ++warnings_;
  }
  int errors() const { return errors_; }
  int warnings() const { return warnings_; }

 private:
  int errors_ = 0, warnings_ = 0;
};

void checkMassMatrix(const CompactModel& model, Findings& findings) {
  Data data(model, Need::mass_matrix);
  const Eigen::VectorXd q = neutral(model);
  try {
    const Eigen::VectorXd zero = Eigen::VectorXd::Zero(model.nv());
    aba(model, data, q, zero, zero);
  } catch (const Error& e) {
    findings.error(std::string("at the neutral configuration: ") + e.what());
    return;
  }
  if (const std::string warning = warningOfCondition(model, q); !warning.empty()) findings.warning("at the neutral configuration " + warning);
}

void checkInertias(const Model& description, Findings& findings) {
  for (const BodyDescription& body : description.bodies) {
    const PhysicalConsistency x = physicalConsistency(body.inertia);
    char margin[32];
    std::snprintf(margin, sizeof margin, "%.3g", x.margin);
    if (!x.consistent) findings.warning("body '" + body.name + "': no body of positive density has its inertia; margin " + margin);
  }
}

void runCheck(const ModelOptions& o) {
  Findings findings;
  for (const Error& e : o.problems()) findings.error(e.what());
  if (findings.errors() == 0) {
    try {
      const Model description = o.read();
      for (const std::string& note : description.notes) findings.warning(note);
      const CompactModel model = o.compile(description);
      for (const std::string& warning : model.report().warnings) findings.warning(warning);
      checkInertias(description, findings);
      checkMassMatrix(model, findings);
    } catch (const Error& e) {
      findings.error(e.what());
    }
  }
  std::printf("%d errors, %d warnings\n", findings.errors(), findings.warnings());
  if (findings.errors() > 0) throw ExitCode{1};
}

}  // namespace

void addCheck(CLI::App& app) {
  CLI::App* sub = addCommand(app, "check", "lints a model; exit code 1 on errors");
  auto o = std::make_shared<ModelOptions>();
  o->add(*sub);
  sub->callback([o] { runCheck(*o); });
}

}  // namespace dyn::tool
