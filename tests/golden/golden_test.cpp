// SPDX-License-Identifier: BSD-2-Clause
// Results for real robots, by the public API, compared with results of another library in extended precision (shared/golden).
#include "errors.hpp"
#include "support/shared.hpp"

#include <dyn/dyn.hpp>
#include <dyn/parsers/urdf.hpp>

using namespace dyn;
using namespace dyn::test;
using namespace dyn::tool;

namespace {

Eigen::VectorXd vectorOf(const nlohmann::json& x) {
  const auto v = x.get<std::vector<double>>();
  return Eigen::Map<const Eigen::VectorXd>(v.data(), static_cast<Eigen::Index>(v.size()));
}

std::vector<double> flat(const Motion<double>& m) { return {m.linear.x, m.linear.y, m.linear.z, m.angular.x, m.angular.y, m.angular.z}; }

/// Checks max |x - x*| <= 5 e max |x*|, where e is the error that the reference library makes in double (at least an ulp or two).
class Checker {
 public:
  Checker(std::string robot, const nlohmann::json& double_rel_err) : robot_(std::move(robot)), errors_(double_rel_err) {}
  void operator()(const nlohmann::json& sample, const std::string& key, const std::vector<double>& x) const {
    const double stated = errors_.contains(key) ? errors_[key].get<double>() : 1e-15;
    const double error = relativeError(x, flatten(sample[key])) * 0x1p-53;
    INFO(robot_ << " " << key << ": relative error " << error << ", the file states " << stated);
    if (std::getenv("DYN_SHOW_ERRORS") && error > 3 * std::max(stated, 3e-16))
      WARN(robot_ << " " << key << ": " << error << ", the file states " << stated);
    CHECK(error <= 5 * std::max(stated, 3e-16));
  }

 private:
  std::string robot_;
  const nlohmann::json& errors_;
};

void checkFrames(const CompactModel& model, Data& data, const nlohmann::json& document, const nlohmann::json& s, const Checker& check) {
  const Eigen::VectorXd q = vectorOf(s["q"]), v = vectorOf(s["v"]), a = vectorOf(s["a"]);
  Eigen::MatrixXd J(6, model.nv());
  for (std::size_t f = 0; f < document["jacobian_frames"].size(); ++f) {
    const std::string prefix = "frame" + std::to_string(f) + "_";
    const int frame = model.frameId(document["jacobian_frames"][f]["name"].get<std::string>());
    REQUIRE(frame >= 0);
    const std::pair<const char*, ReferenceFrame> references[] = {
        {"local", ReferenceFrame::LOCAL}, {"local_world_aligned", ReferenceFrame::LOCAL_WORLD_ALIGNED}, {"world", ReferenceFrame::WORLD}};
    for (const auto& [name, reference] : references) {
      computeFrameJacobian(model, data, q, frame, reference, J);
      check(s, prefix + "J_" + name, rowMajor(J));
      if (!s.contains(prefix + "dJ_" + name)) continue;
      computeFrameJacobianTimeVariation(model, data, q, v, frame, reference, J);
      check(s, prefix + "dJ_" + name, rowMajor(J));
    }
    forwardKinematics(model, data, q, v, a);
    check(s, prefix + "velocity_local", flat(frameVelocity(model, data, frame, ReferenceFrame::LOCAL)));
    check(s, prefix + "acceleration_local_spatial", flat(frameAcceleration(model, data, frame, ReferenceFrame::LOCAL)));
    check(s, prefix + "acceleration_world_aligned_classical",
          flat(frameClassicalAcceleration(model, data, frame, ReferenceFrame::LOCAL_WORLD_ALIGNED)));
  }
}

void checkDerivatives(const CompactModel& model, Data& data, const nlohmann::json& s, const Checker& check) {
  const Eigen::VectorXd q = vectorOf(s["q"]), v = vectorOf(s["v"]), a = vectorOf(s["a"]), tau = vectorOf(s["tau"]);
  check(s, "Minv", rowMajor(computeMinverse(model, data, q)));
  const RNEADerivatives x = computeRNEADerivatives(model, data, q, v, a);
  check(s, "dtau_dq", rowMajor(x.dtau_dq));
  check(s, "dtau_dv", rowMajor(x.dtau_dv));
  const ABADerivatives y = computeABADerivatives(model, data, q, v, tau);
  check(s, "ddq_dq", rowMajor(y.ddq_dq));
  check(s, "ddq_dv", rowMajor(y.ddq_dv));
  check(s, "coriolis_matrix", rowMajor(computeCoriolisMatrix(model, data, q, v)));
  const CentroidalMomentum h = ccrba(model, data, q, v);
  check(s, "hg", rowMajor(h.hg));
  check(s, "Ag", rowMajor(h.Ag));
  const CentroidalRate rate = computeCentroidalMomentumTimeVariation(model, data, q, v, a);
  check(s, "dAg", rowMajor(rate.dAg));
  check(s, "dhg", rowMajor(rate.dhg));
  const CentroidalDerivatives c = computeCentroidalDynamicsDerivatives(model, data, q, v, a);
  check(s, "dhg_dq", rowMajor(c.dhg_dq));
  check(s, "dhgdot_dq", rowMajor(c.dhgdot_dq));
  check(s, "dhgdot_dv", rowMajor(c.dhgdot_dv));
  check(s, "dhgdot_da", rowMajor(c.dhgdot_da));
}

void checkContacts(const CompactModel& model, Data& data, const nlohmann::json& contacts, const nlohmann::json& s, const Checker& check) {
  std::vector<ConstraintDescription> descriptions;
  for (const nlohmann::json& frame : contacts["frames"])
    descriptions.push_back(contacts["dim"] == 6 ? frameContact(frame["name"].get<std::string>()) : pointContact(frame["name"].get<std::string>()));
  ConstraintData feet(ConstraintSet(model, descriptions));
  const Eigen::VectorXd q = vectorOf(s["q"]), v = vectorOf(s["v"]), tau = vectorOf(s["tau"]);
  for (const ConstraintMethod method : {ConstraintMethod::articulated, ConstraintMethod::kkt}) {
    const ConstrainedMotion x = constraintDynamics(model, data, q, v, tau, feet, method);
    check(s, "contact_ddq", rowMajor(x.ddq));
    check(s, "contact_lambda", rowMajor(x.lambda));
  }
  check(s, "contact_J", rowMajor(computeConstraintJacobian(model, data, q, feet)));
  check(s, "contact_gamma", rowMajor(computeConstraintMotion(model, data, q, v, feet).bias));
  for (const auto& [restitution, name] : {std::pair(0.0, "impulse_"), std::pair(0.5, "impulse_restitution_0.5_")}) {
    const ConstrainedImpact x = impulseDynamics(model, data, q, v, restitution, feet);
    check(s, std::string(name) + "v_after", rowMajor(x.v_after));
    check(s, std::string(name) + "lambda", rowMajor(x.impulse));
  }
}

}  // namespace

TEST_CASE("robots agree with the golden data", "[golden]") {
  DYN_NEEDS_SHARED();
  const std::string robot = GENERATE(as<std::string>{}, "lwr", "hyq", "human", "atlas", "talos");
  const nlohmann::json document = readJson(sharedFolder() + "/golden/" + robot + ".json");
  urdf::Options options;
  options.root = document["root"];
  options.mimic = urdf::Mimic::independent;
  CompileOptions compile_options;
  compile_options.dissipation = false;
  const CompactModel model =
      compile(urdf::load(sharedFolder() + "/models/" + document["file"].get<std::string>(), options), JointRegistry::standard(), compile_options);

  REQUIRE(model.nq() == document["nq"].get<int>());
  REQUIRE(model.njoints() == static_cast<int>(document["joints"].size()) + 1);
  for (std::size_t j = 0; j < document["joints"].size(); ++j) {
    const JointRecord& r = model.joints()[j + 1];
    CHECK(r.name == document["joints"][j]["name"].get<std::string>());
    CHECK(r.idx_q == document["joints"][j]["idx_q"].get<int>());
    CHECK(r.idx_v == document["joints"][j]["idx_v"].get<int>());
    CHECK(model.joints()[static_cast<std::size_t>(r.parent)].name == document["joints"][j]["parent"].get<std::string>());
  }

  Data data(model, Need::derivatives);
  const Checker check(robot, document["double_rel_err"]);
  for (const nlohmann::json& s : document["samples"]) {
    const Eigen::VectorXd q = vectorOf(s["q"]), v = vectorOf(s["v"]), a = vectorOf(s["a"]), tau = vectorOf(s["tau"]);
    const auto vec = [](const VectorResult& x) { return rowMajor(x); };
    const auto vec3 = [](const Vec3<double>& x) { return std::vector<double>{x.x, x.y, x.z}; };
    check(s, "rnea", vec(rnea(model, data, q, v, a)));
    check(s, "nle", vec(nonLinearEffects(model, data, q, v)));
    check(s, "gravity_torque", vec(generalizedGravity(model, data, q)));
    check(s, "M", rowMajor(crba(model, data, q)));
    check(s, "aba", vec(aba(model, data, q, v, tau)));
    const CenterOfMass c = centerOfMass(model, data, q, v, a);
    check(s, "com", vec3(c.position));
    check(s, "vcom", vec3(c.velocity));
    check(s, "acom", vec3(c.acceleration));
    check(s, "Jcom", rowMajor(jacobianCenterOfMass(model, data, q)));
    check(s, "kinetic_energy", {computeKineticEnergy(model, data, q, v)});
    check(s, "potential_energy", {computePotentialEnergy(model, data, q)});
    checkFrames(model, data, document, s, check);
    checkDerivatives(model, data, s, check);
    if (!document["contacts"]["frames"].empty()) checkContacts(model, data, document["contacts"], s, check);
    forwardKinematics(model, data, q);
    for (const nlohmann::json& frame : s["oMf"]) {
      const int id = model.frameId(frame["name"].get<std::string>());
      REQUIRE(id >= 0);
      const SE3<double> X = framePlacement(model, data, id);
      check(frame, "R", std::vector<double>(X.R.m, X.R.m + 9));
      check(frame, "p", vec3(X.p));
    }
  }
}
