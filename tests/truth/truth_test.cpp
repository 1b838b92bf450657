// SPDX-License-Identifier: BSD-2-Clause
// Every algorithm agrees within the project's error budgets with 25-digit references that share no code with it.
#include "truth/data_sets.hpp"

using namespace dyn;
using namespace dyn::test;

namespace {

/// The axes that a joint turns about, one after the other; one for a joint that is a single rotation or none.
int axesOf(const JointDescription& joint) {
  if (joint.type == "universal") return 2;
  if (joint.type == "spherical_zyx" || joint.type == "ellipsoid" || joint.type.starts_with("function_joint")) return 3;
  if (joint.type != "composite") return 1;
  int axes = 0;
  for (const JointDescription& part : std::get<std::vector<JointDescription>>(joint.parameters.at("parts"))) axes += axesOf(part);
  return axes;
}
/// The axes of all joints on the root path.
int axesTo(const Set& set, int joint) {
  int axes = 0;
  for (; joint > 0; joint = set.model.joints()[static_cast<std::size_t>(joint)].parent) {
    const int body = set.description.findJoint(set.model.joints()[static_cast<std::size_t>(joint)].name);
    axes += axesOf(set.description.bodies.at(static_cast<std::size_t>(body)).joint);
  }
  return axes;
}

void checkFrames(const CompactModel& model, Data& data, const Eigen::VectorXd& q, const Eigen::VectorXd& v, const Eigen::VectorXd& a,
                 const nlohmann::json& truth, bool far, Worst& worst) {
  if (!truth.contains("frames")) return;
  Eigen::MatrixXd J(6, model.nv());
  for (const auto& frame : truth["frames"]) {
    const int id = model.frameId(frame["link"].get<std::string>());
    REQUIRE(id >= 0);
    const double budget = budgetOf("J_local").most;
    computeFrameJacobian(model, data, q, id, ReferenceFrame::LOCAL, J);
    worst.check("J_local", relativeError(rowMajor(J), flatten(frame["J_local"])), budget);
    computeFrameJacobian(model, data, q, id, ReferenceFrame::LOCAL_WORLD_ALIGNED, J);
    worst.check("J_lwa", relativeError(rowMajor(J), flatten(frame["J_lwa"])), budget);
    computeFrameJacobian(model, data, q, id, ReferenceFrame::WORLD, J);
    worst.check("J_world", relativeError(rowMajor(J), flatten(frame["J_world"])), far ? 100 : budget);
    forwardKinematics(model, data, q, v, a);
    worst.check("vel_local", "", flatMotion(frameVelocity(model, data, id, ReferenceFrame::LOCAL)), frame);
    worst.check("acc_local_spatial", "", flatMotion(frameAcceleration(model, data, id, ReferenceFrame::LOCAL)), frame);
    worst.check("acc_lwa_classical", "", flatMotion(frameClassicalAcceleration(model, data, id, ReferenceFrame::LOCAL_WORLD_ALIGNED)), frame);
  }
}

/// Checks poses, motions of frames, energies and the centre of mass.
void checkKinematics(const Set& set, const std::string& name, Worst& worst) {
  const CompactModel& model = set.model;
  Data data(model, Need::derivatives);
  const bool far = name.find("far") != std::string::npos;
  for (const auto& sample : set.document["samples"]) {
    const nlohmann::json& truth = sample["truth"];
    const Eigen::VectorXd q = vectorOf(sample["q"]), v = vectorOf(sample["v"]), a = vectorOf(sample["a"]);
    const auto vec3 = [](const Vec3<double>& x) { return std::vector<double>{x.x, x.y, x.z}; };
    if (truth.contains("kinetic_energy")) {
      worst.check("kinetic_energy", relativeError({computeKineticEnergy(model, data, q, v)}, flatten(truth["kinetic_energy"])), 20);
      const double magnitude = 9.81 * model.mass() * (far ? 1e9 : 1.0);
      const long double potential = flatten(truth["potential_energy"])[0];
      const double off = static_cast<double>(std::fabs(potential - static_cast<long double>(computePotentialEnergy(model, data, q))) / unit_roundoff);
      worst.check("potential_energy", off / std::max(magnitude, static_cast<double>(std::fabs(potential))), 20);
      const CenterOfMass c = centerOfMass(model, data, q, v, a);
      worst.check("com", relativeError(vec3(c.position), flatten(truth["com"])), 20);
      // Velocities of the bodies may cancel in the mean, so the error is relative to their sum without signs, |Jcom| |v|.
      const Eigen::VectorXd terms = Eigen::MatrixXd(jacobianCenterOfMass(model, data, q)).cwiseAbs() * v.cwiseAbs();
      const std::vector<long double> yardstick(3, std::max(static_cast<long double>(terms.maxCoeff()), 1e-300L));
      worst.check("vcom", scaledError(vec3(c.velocity), flatten(truth["vcom"]), yardstick), 10);
      worst.check("acom", relativeError(vec3(c.acceleration), flatten(truth["acom"])), 40);
    }
    if (truth.contains("oMi")) {
      forwardKinematics(model, data, q);
      for (int j = 1; j < model.njoints(); ++j) {
        const SE3<double> X = jointPlacement(model, data, j);
        std::vector<double> flat(X.R.m, X.R.m + 9);
        flat.insert(flat.end(), {X.p.x, X.p.y, X.p.z});
        const auto reference = flatten(truth["oMi"][static_cast<std::size_t>(j) - 1]);
        worst.check("pose", relativeError(flat, reference), 2 * std::sqrt(axesTo(set, j)));
      }
    }
    checkFrames(model, data, q, v, a, truth, far, worst);
  }
}

void checkDynamics(const Set& set, const std::string& name, Worst& worst) {
  const CompactModel& model = set.model;
  Data data(model, Need::derivatives);
  for (const auto& sample : set.document["samples"]) {
    const nlohmann::json& truth = sample["truth"];
    const Eigen::VectorXd q = vectorOf(sample["q"]), v = vectorOf(sample["v"]), a = vectorOf(sample["a"]), tau = vectorOf(sample["tau"]);
    if (truth.contains("rnea_scale")) worst.check("rnea", "", rowMajor(rnea(model, data, q, v, a)), truth);
    if (truth.contains("rnea_scale")) worst.check("nle", "", rowMajor(nonLinearEffects(model, data, q, v)), truth);
    if (truth.contains("gravity")) worst.check("gravity", "", rowMajor(generalizedGravity(model, data, q)), truth);
    if (truth.contains("M_entries")) {
      const Eigen::MatrixXd M = crba(model, data, q);
      for (const auto& entry : truth["M_entries"]) {
        const double x = M(entry[0].get<int>(), entry[1].get<int>());
        worst.check("M entry", scaledError({x}, flatten(nlohmann::json::array({entry[2]})), flatten(nlohmann::json::array({truth["M_max"]}))),
                    budgetOf("M").most);
      }
    }
    if (truth.contains("M")) worst.check("M", "", rowMajor(crba(model, data, q)), truth);
    if (truth.contains("aba_scale")) {
      worst.check("aba", "", rowMajor(aba(model, data, q, v, tau)), truth);
      worst.check("aba relative", relativeError(rowMajor(aba(model, data, q, v, tau)), flatten(truth["aba"])), no_match);
    } else if (truth.contains("M_singular")) {
      CHECK_THROWS_AS(aba(model, data, q, v, tau), Error);
    }
    DerivativesFound found;
    if (truth.contains("dtau_dq")) {
      const RNEADerivatives x = computeRNEADerivatives(model, data, q, v, a);
      found.dtau_dq = x.dtau_dq;
      found.dtau_dv = x.dtau_dv;
      found.dtau_da = x.dtau_da;
    }
    if (truth.contains("ddq_dq")) {
      const ABADerivatives x = computeABADerivatives(model, data, q, v, tau);
      worst.check("aba", " beside its derivatives", rowMajor(x.ddq), truth);
      worst.check("aba beside its derivatives, relative", relativeError(rowMajor(x.ddq), flatten(truth["aba"])), no_match);
      found.ddq_dq = x.ddq_dq;
      found.ddq_dv = x.ddq_dv;
      found.ddq_dtau = x.ddq_dtau;
    }
    checkDerivatives(sample, found, "", isExtreme(name), worst);
  }
}

}  // namespace

TEST_CASE("poses, frames, energies and the centre of mass are within their error budgets of the project's own references", "[truth]") {
  // references_test.cpp checks the dynamics.
  for (const std::string& name : ownSets()) {
    Worst worst(name);
    checkKinematics(load(name), name, worst);
  }
}

TEST_CASE("algorithms are within their error budgets of the 25-digit truth", "[truth]") {
  DYN_NEEDS_SHARED();
  for (const std::string& name : truth_sets) {
    const Set set = load(name);
    REQUIRE(set.model.nq() == set.document["nq"].get<int>());
    REQUIRE(set.model.nv() == set.document["nv"].get<int>());
    Worst worst(name);
    checkKinematics(set, name, worst);
    checkDynamics(set, name, worst);
  }
}
