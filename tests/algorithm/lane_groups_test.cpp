// SPDX-License-Identifier: BSD-2-Clause
// Lane groups give the same results as one joint after the other. Calls with external forces do not use lane groups in rnea and aba, so forces of
// zero give the results to compare with.
#include "support/catch.hpp"
#include "support/random_model.hpp"
#include "support/registry.hpp"

using namespace dyn;
using namespace dyn::test;

namespace {

bool usesLaneGroups(const CompactModel& model) {
  for (const std::string& line : model.report().passes)
    if (line.find("single states take them") != std::string::npos) return true;
  return false;
}

/// Types whose subspace does not vary with q.
bool staysAsItIs(const std::string& type) {
  const auto names = {"revolute", "continuous", "prismatic", "translation", "spherical", "planar", "free_flyer"};
  return std::find(names.begin(), names.end(), type) != names.end();
}

/// A random tree. Types::many excludes types with a constant dense subspace, which are never in lane groups. In a bush the parent of each body is one
/// of the last few bodies, so there are many limbs. Trunks are chains that branch now and then. Legs are equal limbs of four joints on one trunk.
enum class Growth { bush, trunks, legs };
enum class Types { revolute, rigid, many };
Model grown(Growth growth, int n, std::uint64_t seed, Types wanted) {
  Random random(seed);
  Model model;
  model.gravity = random.vector(10);
  std::vector<const JointType*> types;
  for (const JointType* type : registry().jointTypes()) {
    const std::string name = type->info().name;
    if (name == "revolute" || (wanted == Types::rigid && staysAsItIs(name)) ||
        (wanted == Types::many && name != "helical" && name != "cylindrical" && name != "composite"))
      types.push_back(type);
  }
  std::vector<int> kinds;
  for (int i = 0; i < n; ++i) {
    const int chosen = growth == Growth::legs && i > 4 ? kinds[static_cast<std::size_t>(i - 4)] : random.below(static_cast<int>(types.size()));
    kinds.push_back(chosen);
    const JointTypeInfo& info = types[static_cast<std::size_t>(chosen)]->info();
    JointDescription joint;
    joint.name = "j" + std::to_string(i);
    joint.type = info.name;
    joint.parameters = exampleParameters(info, seed + static_cast<std::uint64_t>(i));
    joint.placement = random.pose();
    const auto nv = static_cast<std::size_t>(degreesOfFreedom(joint, registry()));
    joint.armature.assign(nv, random.uniform(0, 0.1));
    joint.damping.assign(nv, random.uniform(0, 1));
    joint.friction.assign(nv, random.uniform(0, 0.5));
    int parent = growth == Growth::bush ? i - random.below(8) : random.below(6) == 0 ? random.below(i + 1) : i;
    if (growth == Growth::legs) parent = i % 4 == 1 ? 1 : i;
    model.addBody("b" + std::to_string(i), std::max(0, parent), joint, random.inertia());
  }
  return model;
}

CompileOptions withoutLaneGroups() {
  CompileOptions asked;
  asked.lane_groups = false;
  return asked;
}

/// The same model compiled with and without lane groups, and a state.
struct BothWays {
  CompactModel model, without;
  Data data, other;
  Eigen::VectorXd q, v, a;

  BothWays(const Model& described, Random& random)
      : model(compile(described, registry())),
        without(compile(described, registry(), withoutLaneGroups())),
        data(model, Need::derivatives),
        other(without, Need::derivatives) {
    q = integrate(model, neutral(model), Eigen::VectorXd(random.vector(model.nv(), 0.4).array() + 0.8));
    v = random.vector(model.nv(), 1);
    a = random.vector(model.nv(), 1);
  }
};

}  // namespace

TEST_CASE("lane groups give what one body after the other gives", "[lane_groups]") {
  const auto seed = static_cast<std::uint64_t>(GENERATE(range(1, 12)));
  const Growth growth = GENERATE(Growth::bush, Growth::trunks, Growth::legs);
  const bool many_types = seed % 2 == 0;
  const Model described = grown(growth, many_types ? 120 : 30, seed, many_types ? Types::many : Types::revolute);
  const CompactModel model = compile(described, registry());
  Data data(model, Need::mass_matrix), other(model, Need::mass_matrix);
  Random random(seed);
  const Eigen::VectorXd q = integrate(model, neutral(model), Eigen::VectorXd(random.vector(model.nv(), 0.4).array() + 0.8));
  const Eigen::VectorXd v = random.vector(model.nv(), 1), a = random.vector(model.nv(), 1);
  const ExternalForces none(model.joints().size());
  const Eigen::VectorXd tau = rnea(model, data, q, v, a), plain = rnea(model, other, q, v, a, none);
  CHECK((tau - plain).cwiseAbs().maxCoeff() < 1e-13 * plain.cwiseAbs().maxCoeff());
  const Eigen::VectorXd ddq = aba(model, data, q, v, tau), plain_ddq = aba(model, other, q, v, tau, none);
  CHECK((ddq - plain_ddq).cwiseAbs().maxCoeff() < 1e-9 * (1 + plain_ddq.cwiseAbs().maxCoeff()));
  BatchData batch(model, 1, Need::mass_matrix);
  const Eigen::MatrixXd M = crba(model, data, q), plain_M = crba(model, batch, q).reshaped(model.nv(), model.nv());
  CHECK((M - plain_M).cwiseAbs().maxCoeff() < 1e-13 * plain_M.cwiseAbs().maxCoeff());
  CHECK((ddq - a).cwiseAbs().maxCoeff() < 1e-8 * (1 + a.cwiseAbs().maxCoeff()));
  const CompactModel without = compile(described, registry(), withoutLaneGroups());
  CHECK(!usesLaneGroups(without));
  Data plain_data(without);
  CHECK(rnea(without, plain_data, q, v, a, none) == plain);
  CHECK((rnea(without, plain_data, q, v, a) - plain).cwiseAbs().maxCoeff() < 1e-13 * plain.cwiseAbs().maxCoeff());
  CHECK((nonLinearEffects(model, data, q, v) - rnea(model, other, q, v, Eigen::VectorXd::Zero(model.nv()), none)).cwiseAbs().maxCoeff() <
        1e-13 * plain.cwiseAbs().maxCoeff());
}

TEST_CASE("the centroidal map over lane groups is that of one body after the other, and that which has a rate", "[lane_groups]") {
  const auto seed = static_cast<std::uint64_t>(GENERATE(range(1, 12)));
  const Growth growth = GENERATE(Growth::bush, Growth::trunks, Growth::legs);
  Model described = grown(growth, 60, seed, seed % 2 == 0 ? Types::many : Types::revolute);
  for (std::size_t i = 1; i < described.bodies.size(); ++i) {
    JointDescription& joint = described.bodies[i].joint;
    if (described.bodies[i].parent != 0 || seed % 3 == 0) continue;
    joint.type = "free_flyer";
    joint.parameters = {};
    joint.armature = joint.damping = joint.friction = {};
  }
  Random random(seed);
  BothWays ways(described, random);
  auto& [model, without, data, other, q, v, a] = ways;
  const CentroidalMomentum x = ccrba(model, data, q, v), y = ccrba(without, other, q, v);
  const Eigen::MatrixXd Ag = x.Ag, inertia = toEigen(x.inertia);
  const Eigen::VectorXd hg = x.hg;
  const auto same = [](const Eigen::MatrixXd& one, const Eigen::MatrixXd& two) {
    CHECK((one - two).cwiseAbs().maxCoeff() < 1e-13 * (1 + two.cwiseAbs().maxCoeff()));
  };
  same(Ag, y.Ag);
  same(hg, y.hg);
  same(inertia, toEigen(y.inertia));
  const CentroidalRate rate = computeCentroidalMomentumTimeVariation(model, data, q, v, a);
  same(Ag, rate.Ag);
  same(hg, rate.hg);
}

TEST_CASE("derivatives over lane groups are those of one body after the other", "[lane_groups]") {
  const auto seed = static_cast<std::uint64_t>(GENERATE(range(1, 12)));
  const Growth growth = GENERATE(Growth::bush, Growth::trunks, Growth::legs);
  const bool flies = GENERATE(false, true), has_armature = seed % 3 != 0;
  Model described = grown(growth, 60, seed, seed % 2 == 0 ? Types::rigid : Types::revolute);
  if (flies) described.bodies[1].joint.type = "free_flyer", described.bodies[1].joint.parameters = {};
  for (auto& body : described.bodies)
    if (!has_armature || body.joint.type == "free_flyer") body.joint.armature = body.joint.damping = body.joint.friction = {};
  Random random(seed);
  BothWays ways(described, random);
  auto& [model, without, data, other, q, v, a] = ways;
  ExternalForces forces(model.joints().size());
  for (auto& f : forces) f = {random.vector(2.0), random.vector(2.0)};
  const auto same = [](const Eigen::MatrixXd& x, const Eigen::MatrixXd& y) {
    CHECK((x - y).cwiseAbs().maxCoeff() < 1e-12 * (1 + y.cwiseAbs().maxCoeff()));
  };
  const auto check = [&](const auto& x, const auto& y) {
    same(x.dtau_dq, y.dtau_dq);
    same(x.dtau_dv, y.dtau_dv);
    same(x.dtau_da, y.dtau_da);
  };
  check(computeRNEADerivatives(model, data, q, v, a), computeRNEADerivatives(without, other, q, v, a));
  check(computeRNEADerivatives(model, data, q, v, a, forces), computeRNEADerivatives(without, other, q, v, a, forces));
  const CentroidalDerivatives c = computeCentroidalDynamicsDerivatives(model, data, q, v, a);
  const CentroidalDerivatives d = computeCentroidalDynamicsDerivatives(without, other, q, v, a);
  same(c.dhg_dq, d.dhg_dq);
  same(c.dhgdot_dq, d.dhgdot_dq);
  same(c.dhgdot_dv, d.dhgdot_dv);
  same(c.dhgdot_da, d.dhgdot_da);
  const Eigen::MatrixXd inverse = computeMinverse(model, data, q), plain = computeMinverse(without, other, q);
  CHECK((inverse - plain).cwiseAbs().maxCoeff() < 1e-9 * (1 + plain.cwiseAbs().maxCoeff()));
}

TEST_CASE("lane groups are planned for the instruction set of the options, and for no other", "[lane_groups]") {
  const Model model = grown(Growth::legs, 33, 1, Types::revolute);
  CompileOptions options;
  options.instruction_set = "scalar";
  CHECK_FALSE(usesLaneGroups(compile(model, registry(), options)));
  options.instruction_set = "avx2";
  CHECK(usesLaneGroups(compile(model, registry(), options)));
  options.instruction_set = "AVX2";
  CHECK_THROWS_WITH(compile(model, registry(), options), containing("'AVX2' is not known"));
}

TEST_CASE("a chain has no lane groups, a hand of many fingers has", "[lane_groups]") {
  Model chain, hand;
  const Inertia<double> Y{1, {0.1, 0, 0}, {1, 0, 0, 1, 0, 1}};
  for (int i = 0; i < 20; ++i) {
    JointDescription joint;
    joint.name = "j" + std::to_string(i);
    joint.type = "revolute";
    joint.parameters["axis"] = std::vector<double>{0, 1, 0};
    chain.addBody("b" + std::to_string(i), i, joint, Y);
    hand.addBody("b" + std::to_string(i), i % 5 == 0 ? 0 : i, joint, Y);
  }
  CHECK(!usesLaneGroups(compile(chain, registry())));
  const CompactModel fingers = compile(hand, registry());
  for (const std::string& line : fingers.report().passes)
    if (line.rfind("lane groups: 20", 0) == 0)
      CHECK(line.find("20 joints in 5 lane groups of 4; single states take them in rnea, aba") != std::string::npos);
}

TEST_CASE("eight legs alike are in lane groups in all algorithms that know them", "[lane_groups]") {
  const CompactModel model = compile(grown(Growth::legs, 33, 1, Types::revolute), registry());
  const std::vector<std::string>& passes = model.report().passes;
  const auto line = std::find_if(passes.begin(), passes.end(), [](const std::string& x) { return x.rfind("lane groups: 33", 0) == 0; });
  if (line == passes.end()) return;  // the packs of this processor are too narrow
  CHECK(*line == "lane groups: 33 joints in 9 lane groups of 4; single states take them in rnea, aba, crba, minverse, rnea derivatives, ccrba");
}

TEST_CASE("limbs of all depths share lane groups", "[lane_groups]") {
  Model humanoid;
  const auto limb = [&](int parent, int joints) {
    for (int i = 0; i < joints; ++i) {
      JointDescription joint;
      joint.name = "j" + std::to_string(humanoid.bodies.size());
      joint.type = parent == 0 ? "free_flyer" : "revolute";
      if (parent != 0) joint.parameters["axis"] = std::vector<double>{0, 1, 0};
      parent = humanoid.addBody("b" + joint.name, parent, joint, {1, {0.1, 0, 0}, {1, 0, 0, 1, 0, 1}});
    }
    return parent;
  };
  const int pelvis = limb(0, 1);
  limb(pelvis, 6);
  limb(pelvis, 6);
  const int chest = limb(pelvis, 2);
  limb(chest, 2);  // the head uses lanes that the legs leave free
  limb(chest, 8);
  limb(chest, 8);
  const CompactModel model = compile(humanoid, registry());
  for (const std::string& line : model.report().passes)
    if (line.rfind("lane groups: 33", 0) == 0) CHECK(line.find("33 joints in 11 lane groups of 4") != std::string::npos);
}

TEST_CASE("what is singular is named from within a lane group", "[lane_groups]") {
  Model model;
  for (int i = 0; i < 8; ++i) {
    JointDescription joint;
    joint.name = "j" + std::to_string(i);
    joint.type = "revolute";
    joint.parameters["axis"] = std::vector<double>{0, 0, 1};
    model.addBody("b" + std::to_string(i), 0, joint, i == 6 ? Inertia<double>{} : Inertia<double>{1, {}, {1, 0, 0, 1, 0, 1}});
  }
  const CompactModel compact = compile(model, registry());
  Data data(compact);
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(8);
  CHECK_THROWS_WITH(aba(compact, data, zero, zero, zero), containing("'j6'"));
}

TEST_CASE("the mass matrix of arms of any length is that of one joint after the other", "[lane_groups]") {
  for (const int joints : {1, 7, 40}) {
    Model arms;
    for (int arm = 0; arm < 2; ++arm)
      for (int i = 0; i < joints; ++i) {
        JointDescription joint;
        joint.name = "j" + std::to_string(arm) + "_" + std::to_string(i);
        joint.type = "revolute";
        joint.parameters["axis"] = std::vector<double>{0, 1, 0.1 * i};
        joint.placement.p = {0.1, 0.02, 0};
        arms.addBody("b" + joint.name, i == 0 ? 0 : arm * joints + i, joint, {1, {0.1, 0, 0.1 * arm}, {1, 0, 0, 1, 0, 1}});
      }
    const CompactModel model = compile(arms, registry());
    const CompactModel plain = compile(arms, registry(), withoutLaneGroups());
    Data data(model, Need::mass_matrix), plain_data(plain, Need::mass_matrix);
    const Eigen::VectorXd q = randomConfiguration(model, 5);
    const Eigen::MatrixXd expected = crba(plain, plain_data, q);
    INFO(joints);
    CHECK((crba(model, data, q) - expected).cwiseAbs().maxCoeff() < 1e-13 * expected.cwiseAbs().maxCoeff());
  }
}
