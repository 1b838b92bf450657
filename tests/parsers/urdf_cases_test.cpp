// SPDX-License-Identifier: BSD-2-Clause
// The parser cases of the reference data: files that must be read, read with a note, or refused.
#include "support/shared.hpp"

#include <dyn/dyn.hpp>
#include <dyn/parsers/urdf.hpp>

#include <filesystem>

using namespace dyn;
using namespace dyn::test;

namespace {

const BodyDescription& bodyNamed(const Model& model, const std::string& name) {
  const int i = model.findBody(name);
  REQUIRE(i >= 0);
  return model.bodies[static_cast<std::size_t>(i)];
}

double massOf(const std::string& path, const char* root) {
  urdf::Options options;
  options.root = root;
  double sum = 0;
  const CompactModel model = compile(urdf::load(path, options), JointRegistry::standard());
  sum = model.mass();
  return sum;
}

void checkNumbers(const std::string& path, const Model& model, const nlohmann::json& check) {
  const CompactModel compact = compile(model, JointRegistry::standard());
  for (const auto& [key, value] : check.items()) {
    INFO(key);
    if (key == "nq") {
      CHECK(compact.nq() == value.get<int>());
    } else if (key == "mass_a") {
      CHECK(bodyNamed(model, "a").inertia.mass == value.get<double>());
    } else if (key == "xyz") {
      const Vec3<double>& p = model.bodies.back().joint.placement.p;
      CHECK(std::vector<double>{p.x, p.y, p.z} == value.get<std::vector<double>>());
    } else if (key == "R22") {
      CHECK(model.bodies.back().joint.placement.R(2, 2) == approx(value.get<double>()).epsilon(1e-15));
    } else if (key == "order") {
      for (std::size_t i = 0; i < value.size(); ++i) CHECK(compact.joints()[i + 1].name == value[i].get<std::string>());
    } else if (key == "mass_fixed") {
      CHECK(massOf(path, "fixed") == value.get<double>());
    } else if (key == "mass_free_flyer") {
      CHECK(massOf(path, "free_flyer") == value.get<double>());
    } else if (key == "plane") {
      // The body may move along x and z but not along y.
      Data data(compact);
      Eigen::VectorXd q = neutral(compact);
      q[0] = 0.3;
      q[1] = 0.7;
      forwardKinematics(compact, data, q);
      CHECK(std::fabs(jointPlacement(compact, data, 1).p.y) < 1e-15);
    } else {
      FAIL("unknown check " << key);
    }
  }
}

}  // namespace

TEST_CASE("every parser case is read, noted or refused as expected", "[parser]") {
  DYN_NEEDS_SHARED();
  const std::string folder = sharedFolder() + "/truth/parse/";
  for (const auto& entry : readJson(folder + "expect.json")) {
    const std::string file = entry["file"], expect = entry["expect"];
    DYNAMIC_SECTION(file) {
      INFO(entry["why"].get<std::string>());
      if (expect == "error") {
        try {
          compile(urdf::load(folder + file), JointRegistry::standard());
          FAIL("was accepted");
        } catch (const Error& e) {
          const std::string message = e.what();
          INFO(message);
          CHECK(message.find(file) != std::string::npos);
        }
        continue;
      }
      const Model model = urdf::load(folder + file);
      const CompactModel compact = compile(model, JointRegistry::standard());
      if (expect == "warn") CHECK(model.notes.size() + compact.report().warnings.size() > 0);
      if (!entry["check"].is_null()) checkNumbers(folder + file, model, entry["check"]);
    }
  }
}

TEST_CASE("all robots of the reference data load and compile", "[parser]") {
  DYN_NEEDS_SHARED();
  for (const auto& file : std::filesystem::directory_iterator(sharedFolder() + "/models")) {
    INFO(file.path().string());
    for (const auto mimic : {urdf::Mimic::coupled, urdf::Mimic::independent}) {
      urdf::Options options;
      options.root = "free_flyer";
      options.mimic = mimic;
      options.inertias = urdf::Inertias::any;  // TIAGo's antennas have inertias that are physically impossible
      const CompactModel model = compile(urdf::load(file.path().string(), options), JointRegistry::standard());
      Data data(model, Need::mass_matrix);
      const Eigen::VectorXd q = randomConfiguration(model, 3), v = Eigen::VectorXd::Constant(model.nv(), 0.3);
      const Eigen::MatrixXd M = crba(model, data, q);
      const Eigen::VectorXd tau = rnea(model, data, q, v, v);
      CHECK(((M * v + nonLinearEffects(model, data, q, v)) - tau).norm() <= 1e-12 * (1 + tau.norm()));
    }
  }
}
