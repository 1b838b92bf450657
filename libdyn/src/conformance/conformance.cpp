// SPDX-License-Identifier: BSD-2-Clause
#include "conformance/checks.hpp"

#include <cstdio>

namespace dyn {

namespace conformance {

std::string show(const char* name, const Eigen::VectorXd& x) {
  std::string text = std::string(name) + " = (";
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    char number[32];
    std::snprintf(number, sizeof number, "%s%.6g", i ? ", " : "", x[i]);
    text += number;
  }
  return text + ")";
}

namespace {

/// Why nv does not fit the shape; empty if it does.
std::string shapeProblem(const JointInstance& joint) {
  const auto wants = [&](int nv) {
    return joint.nv == nv || joint.nv == 0 ? std::string() : "its shape has nv = " + std::to_string(nv) + ", it says " + std::to_string(joint.nv);
  };
  switch (joint.shape) {
    case Shape::revolute:
    case Shape::prismatic:
      return wants(1);
    case Shape::spherical:
    case Shape::translation:
    case Shape::planar:
      return wants(3);
    case Shape::free:
      return wants(6);
    case Shape::dense_constant:
    case Shape::dense:
      return "";
  }
  return "it names no shape";
}

/// If the type refuses the parameters, the error says that they may have been made up.
JointProbe probe(const JointType& type, const Parameters& example) {
  try {
    return JointProbe(type, example);
  } catch (const Error& e) {
    throw Error(e.code(), std::string(e.what()) +
                              " (made up from the schema, unless given: a parameter that does not take every value has an `example` "
                              "in its ParameterSpec, or is named, as in --parameters name=1,2)");
  }
}

}  // namespace

}  // namespace conformance

std::vector<ConformanceFinding> checkJointType(const JointType& type, const Parameters& example, const JointRegistry& registry, std::uint64_t seed,
                                               const AllocationCount& allocations, const std::function<void(const char*)>& progress) {
  using namespace conformance;
  Findings findings;
  const auto group = [&](const char* name, const auto& checks) {
    if (progress) progress(name);
    guarded(name, findings, checks);
  };
  group("parameters", [&] {
    const JointProbe joint = probe(type, example);
    const std::string problem = shapeProblem(joint.instance());
    if (!problem.empty()) throw Error(ErrorCode::parameter, problem);
    findings.push_back({"parameters are accepted", true, 0, 0, "nq = " + std::to_string(joint.nq()) + ", nv = " + std::to_string(joint.nv())});
    // A joint that consists of others has no motion of its own.
    if (type.info().structure == Structure::joint) {
      group("motion", [&] { checkMotion(joint, seed, findings); });
      group("configuration", [&] { checkConfiguration(joint, seed + 1, findings); });
      group("calls", [&] { checkCalls(joint, seed + 2, allocations, findings); });
    }
    group("dynamics", [&] { checkDynamics(type, example, registry, seed + 3, findings); });
  });
  return findings;
}

}  // namespace dyn
