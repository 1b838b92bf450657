// SPDX-License-Identifier: BSD-2-Clause
// Functions beside the catalogue agree with the project's own references: derivatives of motions and of Jacobians, regressors, second derivatives,
// and dynamics of closed loops.
#include "truth/data_sets.hpp"

using namespace dyn;
using namespace dyn::test;

namespace {

void checkFrames(const CompactModel& model, const nlohmann::json& sample, Worst& worst) {
  const Eigen::VectorXd q = vectorOf(sample["q"]), v = vectorOf(sample["v"]), a = vectorOf(sample["a"]);
  Data data(model, Need::derivatives);
  Eigen::MatrixXd dJ(6, model.nv()), v_dq = dJ, v_dv = dJ, a_dq = dJ, a_dv = dJ, a_da = dJ;
  for (const auto& frame : sample["truth"]["frames"]) {
    const int id = model.frameId(frame["link"].get<std::string>());
    const std::pair<const char*, ReferenceFrame> references[] = {
        {"dJ_local", ReferenceFrame::LOCAL}, {"dJ_lwa", ReferenceFrame::LOCAL_WORLD_ALIGNED}, {"dJ_world", ReferenceFrame::WORLD}};
    for (const auto& [key, reference] : references) {
      computeFrameJacobianTimeVariation(model, data, q, v, id, reference, dJ);
      // Terms as large as |J| |v| may cancel, as along a screw of almost constant pitch.
      const std::vector<long double> truth = flatten(frame[key]);
      const long double terms = largest(flatten(frame[std::string(key).substr(1)])) * static_cast<long double>(v.cwiseAbs().maxCoeff());
      worst.check(key, scaledError(rowMajor(dJ), truth, std::vector<long double>(truth.size(), std::max(terms, largest(truth)))), 30);
    }
    computeForwardKinematicsDerivatives(model, data, q, v, a);
    getFrameAccelerationDerivatives(model, data, id, ReferenceFrame::LOCAL, v_dq, a_dq, a_dv, a_da);
    worst.check("v_dq", relativeError(rowMajor(v_dq), flatten(frame["v_dq"])), 100);
    worst.check("a_dq", relativeError(rowMajor(a_dq), flatten(frame["a_dq"])), 100);
    worst.check("a_dv", relativeError(rowMajor(a_dv), flatten(frame["a_dv"])), 100);
    worst.check("a_da", relativeError(rowMajor(a_da), flatten(frame["J_local"])), 15);
    getFrameVelocityDerivatives(model, data, id, ReferenceFrame::LOCAL, v_dq, v_dv);
    worst.check("v_dv", relativeError(rowMajor(v_dv), flatten(frame["J_local"])), 15);
  }
}

void checkCentreOfMass(const CompactModel& model, const nlohmann::json& sample, Worst& worst) {
  const Eigen::VectorXd q = vectorOf(sample["q"]), v = vectorOf(sample["v"]), a = vectorOf(sample["a"]);
  Data data(model, Need::derivatives);
  const nlohmann::json& truth = sample["truth"];
  worst.check("Jcom", relativeError(rowMajor(jacobianCenterOfMass(model, data, q)), flatten(truth["Jcom"])), 15);
  const CenterOfMassDerivatives x = computeCenterOfMassDerivatives(model, data, q, v, a);
  worst.check("vcom_dq", relativeError(rowMajor(x.vcom_dq), flatten(truth["vcom_dq"])), 100);
  worst.check("acom_dq", relativeError(rowMajor(x.acom_dq), flatten(truth["acom_dq"])), 100);
  worst.check("acom_dv", relativeError(rowMajor(x.acom_dv), flatten(truth["acom_dv"])), 100);
}

void checkRegressors(const CompactModel& model, const nlohmann::json& sample, Worst& worst) {
  const Eigen::VectorXd q = vectorOf(sample["q"]), v = vectorOf(sample["v"]), a = vectorOf(sample["a"]);
  Data data(model, Need::derivatives);
  const nlohmann::json& truth = sample["truth"];
  const auto check = [&](const char* key, const auto& found) { worst.check(key, relativeError(rowMajor(found), flatten(truth[key])), 20); };
  check("torque_regressor", computeJointTorqueRegressor(model, data, q, v, a));
  check("kinetic_energy_regressor", computeKineticEnergyRegressor(model, data, q, v));
  check("potential_energy_regressor", computePotentialEnergyRegressor(model, data, q));
}

void checkSecondDerivatives(const CompactModel& model, const nlohmann::json& sample, Worst& worst) {
  const nlohmann::json& truth = sample["truth"];
  const Eigen::VectorXd q = vectorOf(sample["q"]), v = vectorOf(sample["v"]), a = vectorOf(sample["a"]);
  Data data(model, Need::derivatives);
  SecondDerivativeData memory(model);
  const RneaSecondDerivatives x = computeRNEASecondOrderDerivatives(model, data, memory, q, v, a);
  const auto check = [&](const char* key, const TensorResult& tensor) {
    std::vector<double> all;
    for (int k = 0; k < model.nv(); ++k) {
      const std::vector<double> matrix = rowMajor(tensor[k]);
      all.insert(all.end(), matrix.begin(), matrix.end());
    }
    worst.check(key, relativeError(all, flatten(truth[key])), 100);
  };
  check("d2tau_dqdq", x.d2tau_dqdq);
  check("d2tau_dqdv", x.d2tau_dqdv);
  check("d2tau_dvdv", x.d2tau_dvdv);
  check("d2tau_dadq", x.d2tau_dadq);
}

void checkLoops(const CompactModel& model, const nlohmann::json& sample, Worst& worst) {
  const nlohmann::json& truth = sample["truth"];
  const Eigen::VectorXd q = vectorOf(sample["q"]), v = vectorOf(sample["v"]), tau = vectorOf(sample["tau"]);
  Data data(model, Need::derivatives);
  ConstraintData constraints(ConstraintSet(model), Need::derivatives);
  const auto check = [&](const char* key, const std::string& mode, const Eigen::MatrixXd& found, double budget) {
    worst.check(key + mode, relativeError(rowMajor(found), flatten(truth[key])), budget);
  };
  check("loop_J", "", computeConstraintJacobian(model, data, q, constraints), 15);
  check("loop_bias", "", computeConstraintMotion(model, data, q, v, constraints).bias, 30);
  for (const ConstraintMethod method : {ConstraintMethod::articulated, ConstraintMethod::kkt}) {
    const std::string mode = method == ConstraintMethod::kkt ? ", kkt" : "";
    const ConstrainedMotion x = constraintDynamics(model, data, q, v, tau, constraints, method);
    check("loop_ddq", mode, x.ddq, 100);
    check("loop_lambda", mode, x.lambda, 100);
  }
  const ConstraintDynamicsDerivatives x = computeConstraintDynamicsDerivatives(model, data, q, v, tau, constraints);
  check("loop_ddq_dq", "", x.ddq_dq, 100);
  check("loop_ddq_dv", "", x.ddq_dv, 100);
  check("loop_lambda_dq", "", x.lambda_dq, 100);
  check("loop_lambda_dv", "", x.lambda_dv, 100);
}

/// Calls check(model, sample, worst) for each sample that has a reference under this key. There must be one.
template <class Check>
void eachSample(const std::string& key, const Check& check) {
  int found = 0;
  for (const std::string& name : ownSets()) {
    const Set set = load(name);
    Worst worst(name);
    for (const auto& sample : set.document["samples"]) {
      if (!sample["truth"].contains(key)) continue;
      check(set.model, sample, worst);
      ++found;
    }
  }
  CHECK(found > 0);
}

}  // namespace

TEST_CASE("derivatives of frames' motions and Jacobians agree with the references", "[truth]") { eachSample("frames", checkFrames); }
TEST_CASE("derivatives of the centre of mass agree with the references", "[truth]") { eachSample("Jcom", checkCentreOfMass); }
TEST_CASE("regressors agree with the references", "[truth]") { eachSample("torque_regressor", checkRegressors); }
TEST_CASE("second derivatives agree with the references", "[truth]") { eachSample("d2tau_dqdq", checkSecondDerivatives); }
TEST_CASE("closed loops agree with the references", "[truth]") { eachSample("loop_J", checkLoops); }
