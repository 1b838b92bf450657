// SPDX-License-Identifier: BSD-2-Clause
// The project's own references: they cover every algorithm and joint type, and results of every algorithm of the catalogue agree with them, for
// single states and for batches in double and in float.
#include "support/skip.hpp"
#include "truth/data_sets.hpp"

#include <dyn/parsers/load.hpp>

#include <set>

using namespace dyn;
using namespace dyn::test;

namespace {

const Budget* budgetOf(const AlgorithmOutput& output) {
  for (const Budget& budget : budgets)
    if (budget.symbol && output.symbol == std::string_view(budget.symbol)) return &budget;
  return nullptr;
}

/// Whether runAlgorithm() gives the results, so that `budgets` has them. Algorithms that read a frame or external forces have functions of their own.
bool isCalledByEntry(const AlgorithmInfo& algorithm) {
  return algorithm.outputs[0].symbol != nullptr && algorithm.algorithm != Algorithm::placements && !algorithm.reads('f');
}

/// The keys of the references that results of an algorithm are compared with.
std::vector<std::string> keysOf(const AlgorithmInfo& algorithm) {
  switch (algorithm.algorithm) {
    case Algorithm::placements:
      return {"oMi"};
    case Algorithm::velocities:
    case Algorithm::accelerations:
    case Algorithm::frame_jacobian:
      return {"frames"};
    case Algorithm::static_torque:
      return {"static_torque"};
    default:
      break;
  }
  std::vector<std::string> out;
  for (const AlgorithmOutput& output : algorithm.outputs) {
    if (output.symbol == nullptr) break;
    const Budget* budget = budgetOf(output);
    out.push_back(budget ? budget->key : output.symbol);
  }
  return out;
}

template <class T>
void checkBatch(const Set& set, Worst& worst) {
  const CompactModel& model = set.model;
  const nlohmann::json& samples = set.document["samples"];
  const auto n = static_cast<Eigen::Index>(samples.size());
  const ModelSizes sizes{model.nv(), model.njoints(), static_cast<int>(model.frames().size())};
  using Matrix = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>;
  const auto [q, v, a, tau] = statesOf<T>(set);
  // States are floats, so that the references hold for floats, too.
  const SampleStates<double> given = statesOf<double>(set);
  REQUIRE(q.template cast<double>() == given.q);
  REQUIRE(v.template cast<double>() == given.v);
  REQUIRE(a.template cast<double>() == given.a);
  REQUIRE(tau.template cast<double>() == given.tau);
  const std::string mode = std::is_same_v<T, double> ? ", batch" : ", batch float";
  const double unit = std::is_same_v<T, double> ? 1 : 0x1p-24 / 0x1p-53;
  BasicBatchData<T> batch(model, static_cast<int>(n), Need::derivatives | Need::mass_matrix | Need::kinematics | Need::jacobians);
  for (const AlgorithmInfo& algorithm : algorithms()) {
    if (!algorithm.batched || !isCalledByEntry(algorithm)) continue;
    if (algorithm.algorithm == Algorithm::joint_jacobians && model.follows()) continue;
    const auto found = runAlgorithm(model, batch, algorithm.algorithm, q, v, algorithm.reads('t') ? tau : a);
    for (std::size_t k = 0; k < algorithm.outputs.size() && algorithm.outputs[k].symbol != nullptr; ++k) {
      const AlgorithmOutput& output = algorithm.outputs[k];
      const Budget& budget = *budgetOf(output);
      for (Eigen::Index state = 0; state < n; ++state) {
        const Eigen::MatrixXd x = Matrix(found(k).col(state)).template cast<double>().reshaped(sizes.of(output.rows), sizes.of(output.columns));
        worst.check(algorithm.function + (" " + std::string(output.symbol)) + mode,
                    errorOf(rowMajor(x), samples[static_cast<std::size_t>(state)]["truth"], budget) / unit, budget.most);
      }
    }
  }
  forwardKinematics(model, batch, q, v, a);
  for (int state = 0; state < n; ++state)
    for (const auto& frame : samples[static_cast<std::size_t>(state)]["truth"]["frames"]) {
      const int id = model.frameId(frame["link"].get<std::string>());
      worst.check("vel_local", mode, flatMotion(frameVelocity(model, batch, id, state, ReferenceFrame::LOCAL)), frame, unit);
      worst.check("acc_local_spatial", mode, flatMotion(frameAcceleration(model, batch, id, state, ReferenceFrame::LOCAL)), frame, unit);
    }
  for (const auto& frame : samples[0]["truth"]["frames"]) {
    const int id = model.frameId(frame["link"].get<std::string>());
    const Eigen::MatrixXd J =
        Matrix(computeFrameJacobian(model, batch, q, id, ReferenceFrame::LOCAL).col(0)).template cast<double>().reshaped(6, model.nv());
    worst.check("J_local", mode, rowMajor(J), frame, unit);
  }
}

void checkSingle(const Set& set, Worst& worst) {
  const CompactModel& model = set.model;
  Data data(model, Need::derivatives);
  for (const auto& sample : set.document["samples"]) {
    const nlohmann::json& truth = sample["truth"];
    const Eigen::VectorXd q = vectorOf(sample["q"]), v = vectorOf(sample["v"]), a = vectorOf(sample["a"]), tau = vectorOf(sample["tau"]);
    for (const AlgorithmInfo& algorithm : algorithms()) {
      if (!isCalledByEntry(algorithm) || (algorithm.algorithm == Algorithm::joint_jacobians && model.follows())) continue;
      const AlgorithmResults found = runAlgorithm(model, data, algorithm.algorithm, q, v, algorithm.reads('t') ? tau : a);
      for (std::size_t k = 0; k < algorithm.outputs.size() && algorithm.outputs[k].symbol != nullptr; ++k) {
        const Budget& budget = *budgetOf(algorithm.outputs[k]);
        worst.check(algorithm.function + (" " + std::string(algorithm.outputs[k].symbol)), errorOf(rowMajor(found(k)), truth, budget), budget.most);
      }
    }
    ExternalForces forces(static_cast<std::size_t>(model.njoints()));
    const std::vector<long double> fext = flatten(truth["fext"]);
    for (std::size_t j = 0; j < forces.size(); ++j) {
      const auto number = [&](std::size_t c) { return static_cast<double>(fext[6 * j + c]); };
      forces[j] = {{number(0), number(1), number(2)}, {number(3), number(4), number(5)}};
    }
    worst.check("static_torque", "", rowMajor(computeStaticTorque(model, data, q, forces)), truth);
  }
}

void typesOf(const JointDescription& joint, std::set<std::string>& out) {
  out.insert(joint.type);
  out.insert(joint.coupling.type);
  const auto parts = joint.parameters.find("parts");
  if (parts == joint.parameters.end()) return;
  for (const JointDescription& part : std::get<std::vector<JointDescription>>(parts->second)) typesOf(part, out);
}

}  // namespace

TEST_CASE("every algorithm of the catalogue and every joint type has a reference", "[truth]") {
  std::set<std::string> types, keys;
  for (const std::string& name : ownSets()) {
    const Set set = test::load(name);
    for (const BodyDescription& body : set.description.bodies) typesOf(body.joint, types);
    for (const auto& [key, value] : set.document["samples"].at(0)["truth"].items())
      if (!value.empty()) keys.insert(key);
  }
  for (const AlgorithmInfo& algorithm : algorithms()) {
    INFO(algorithm.function << ": define it in tools/dyn/exact_quantities.cpp, and run tools/references");
    CHECK(!keysOf(algorithm).empty());
    for (const std::string& key : keysOf(algorithm)) CHECK(keys.contains(key));
    if (isCalledByEntry(algorithm))
      for (const AlgorithmOutput& output : algorithm.outputs) CHECK((output.symbol == nullptr || budgetOf(output) != nullptr));
  }
  const JointRegistry registry = JointRegistry::standard();
  CHECK(registry.jointTypes().size() > 14);  // DYN_PLUGIN_PATH names the examples
  for (const JointType* type : registry.jointTypes()) {
    INFO(type->info().name << ": define it in tools/dyn/exact_joint.cpp, add it to a model in tests/truth/references, and run tools/references");
    CHECK(types.contains(type->info().name));
  }
  CHECK(types.contains("mimic"));
}

TEST_CASE("every algorithm of the catalogue agrees with the references, for single states", "[truth]") {
  for (const std::string& name : ownSets()) {
    Worst worst(name);
    checkSingle(test::load(name), worst);
  }
}

TEST_CASE("every algorithm of the catalogue agrees with the references, in batches of double and of float", "[truth]") {
  for (const std::string& name : ownSets()) {
    const Set set = test::load(name);
    Worst worst(name);
    checkBatch<double>(set, worst);
    checkBatch<float>(set, worst);
  }
}

TEST_CASE("RBDL's Lua models agree with the references of the same mechanisms in URDF", "[truth][lua]") {
  const std::vector<ModelFormat> formats = modelFormats();
  const auto lua = std::find_if(formats.begin(), formats.end(), [](const ModelFormat& format) { return format.name == "lua"; });
  if (!lua->missing.empty()) DYN_SKIP("this build reads no Lua");
  for (const std::string name : {"arm", "biped"}) {
    Set set = test::load("references/" + name);
    set.description = dyn::load(DYN_SOURCE_DIR "/models/" + name + ".lua", {.root = set.document["root"]});
    set.model = compile(set.description, JointRegistry::standard(), {.dissipation = false, .armature = false});
    Worst worst(name + ".lua");
    checkSingle(set, worst);
  }
}
