// SPDX-License-Identifier: BSD-2-Clause
// dyn check: finds what is wrong or suspicious in a model. Exit code 1 when there are errors.
#include "commands.hpp"
#include "condition.hpp"
#include "messages.hpp"
#include "model_options.hpp"
#include "options.hpp"

#include <cstdio>
#include <memory>
#include <unordered_set>

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

/// Checks the mass matrix at q, which messages call `where`.
void checkMassMatrix(const CompactModel& model, const Eigen::VectorXd& q, const std::string& where, Findings& findings) {
  Data data(model, Need::mass_matrix);
  try {
    const Eigen::VectorXd zero = Eigen::VectorXd::Zero(model.nv());
    aba(model, data, q, zero, zero);
  } catch (const Error& e) {
    findings.error("at " + where + ": " + e.what());
    return;
  }
  if (const std::string warning = warningOfCondition(model, q); !warning.empty()) findings.warning("at " + where + " " + warning);
}

/// Checks that the model's named states are within the limits of its joints.
void checkStates(const CompactModel& model, const Model& description, Findings& findings) {
  for (const ConfigurationDescription& state : description.configurations) {
    const std::string name = state.group.empty() ? state.name : state.group + "/" + state.name;
    const Eigen::VectorXd q = namedConfiguration(model, description, name);
    std::unordered_set<std::string> set;
    for (const JointState& joint : state.joints) set.insert(joint.joint);
    for (const JointRecord& joint : model.joints()) {
      bool outside = false;
      for (int k = joint.idx_q; k < joint.idx_q + joint.nq; ++k)
        outside = outside || q[k] < model.limits().lower[static_cast<std::size_t>(k)] || q[k] > model.limits().upper[static_cast<std::size_t>(k)];
      if (outside && set.count(joint.name)) findings.warning("state '" + name + "': joint '" + joint.name + "' is outside of its limits");
    }
  }
}

void checkInertias(const Model& description, Findings& findings) {
  for (const BodyDescription& body : description.bodies) {
    const PhysicalConsistency x = physicalConsistency(body.inertia);
    char margin[32];
    std::snprintf(margin, sizeof margin, "%.3g", x.margin);
    if (!x.consistent) findings.warning("body '" + body.name + "': no body of positive density has its inertia; margin " + margin);
  }
}

struct CheckOptions : ModelOptions {
  std::string named;
};

void runCheck(const CheckOptions& o) {
  Findings findings;
  for (const Error& e : o.problems()) findings.error(e.what());
  if (findings.errors() == 0) {
    try {
      const Model description = o.read();
      for (const std::string& note : description.notes) findings.warning(note);
      const CompactModel model = o.compile(description);
      for (const std::string& warning : model.report().warnings) findings.warning(warning);
      checkInertias(description, findings);
      checkStates(model, description, findings);
      const Eigen::VectorXd q = o.named.empty() ? neutral(model) : namedConfiguration(model, description, o.named);
      checkMassMatrix(model, q, o.named.empty() ? "the neutral configuration" : "the state '" + o.named + "'", findings);
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
  auto o = std::make_shared<CheckOptions>();
  o->add(*sub);
  addNamedState(*sub, o->named, "");
  sub->callback([o] { runCheck(*o); });
}

}  // namespace dyn::tool
