// Every algorithm against references of 25 digits that share no code with it, within the project's error budgets.
#include "errors.hpp"
#include "support/shared.hpp"
#include "support/truth_model.hpp"

#include <dyn/dyn.hpp>
#include <dyn/parsers/urdf.hpp>

#include <iostream>
#include <map>

using namespace dyn;
using namespace dyn::test;
using namespace dyn::tool;

namespace {

Eigen::VectorXd vectorOf(const nlohmann::json& x) {
  const auto v = x.get<std::vector<double>>();
  return Eigen::Map<const Eigen::VectorXd>(v.data(), static_cast<Eigen::Index>(v.size()));
}

struct Set {
  CompactModel model;
  nlohmann::json document;
};

Set load(const std::string& name) {
  const std::string shared = sharedFolder();
  nlohmann::json document = readJson(shared + "/truth/data/" + name + ".json");
  const std::string file = document["file"];
  Model model;
  if (file.ends_with(".urdf")) {
    urdf::Options options;
    options.root = document["root"];
    options.mimic = urdf::Mimic::independent;
    model = urdf::load(shared + "/models/" + file, options);
  } else {
    model = readTruthModel(readJson(shared + "/truth/" + file));
  }
  CompileOptions options;
  options.dissipation = false;
  return {compile(model, JointRegistry::standard(), options), document};
}

/// Worst errors of a set, by quantity; printed when DYN_SHOW_ERRORS is set.
class Worst {
 public:
  explicit Worst(std::string set) : set_(std::move(set)) {}
  ~Worst() {
    if (!std::getenv("DYN_SHOW_ERRORS")) return;
    for (const auto& [key, error] : errors_) std::cout << set_ << " " << key << " " << error << " u\n";
  }
  void check(const std::string& key, double error, double budget) {
    errors_[key] = std::max(errors_[key], error);
    INFO(set_ << ": " << key << " is off by " << error << " u, budget " << budget << " u");
    CHECK(error <= budget);
  }

 private:
  std::string set_;
  std::map<std::string, double> errors_;
};

int depthOf(const CompactModel& model, int joint) {
  int depth = 0;
  for (; joint > 0; joint = model.joints()[static_cast<std::size_t>(joint)].parent) ++depth;
  return depth;
}

void checkFrames(const CompactModel& model, Data& data, const Eigen::VectorXd& q, const Eigen::VectorXd& v, const Eigen::VectorXd& a,
                 const nlohmann::json& truth, bool far, Worst& worst) {
  if (!truth.contains("frames")) return;
  Eigen::MatrixXd J(6, model.nv());
  for (const auto& frame : truth["frames"]) {
    const int id = model.frameId(frame["link"].get<std::string>());
    REQUIRE(id >= 0);
    computeFrameJacobian(model, data, q, id, ReferenceFrame::LOCAL, J);
    worst.check("J_local", relativeError(rowMajor(J), flatten(frame["J_local"])), 15);
    computeFrameJacobian(model, data, q, id, ReferenceFrame::LOCAL_WORLD_ALIGNED, J);
    worst.check("J_lwa", relativeError(rowMajor(J), flatten(frame["J_lwa"])), 15);
    computeFrameJacobian(model, data, q, id, ReferenceFrame::WORLD, J);
    worst.check("J_world", relativeError(rowMajor(J), flatten(frame["J_world"])), far ? 100 : 15);
    forwardKinematics(model, data, q, v, a);
    const auto flat = [](const Motion<double>& m) {
      return std::vector<double>{m.linear.x, m.linear.y, m.linear.z, m.angular.x, m.angular.y, m.angular.z};
    };
    worst.check("vel_local", relativeError(flat(frameVelocity(model, data, id, ReferenceFrame::LOCAL)), flatten(frame["vel_local"])), 15);
    worst.check("acc_local_spatial",
                relativeError(flat(frameAcceleration(model, data, id, ReferenceFrame::LOCAL)), flatten(frame["acc_local_spatial"])), 30);
    worst.check(
        "acc_lwa_classical",
        relativeError(flat(frameClassicalAcceleration(model, data, id, ReferenceFrame::LOCAL_WORLD_ALIGNED)), flatten(frame["acc_lwa_classical"])),
        30);
  }
}

long double largest(const std::vector<long double>& x) {
  long double most = 0;
  for (const long double e : x) most = std::max(most, std::fabs(e));
  return most;
}

/// Sets that were made to lose the digits of a relative error: M is close to singular, or what the derivatives are made of cancels to
/// nothing.
bool isExtreme(const std::string& set) {
  for (const char* kind : {"chain_", "massratio", "collinear", "free_body", "tinyangle", "pendulum"})
    if (set.find(kind) != std::string::npos) return true;
  return false;
}

/// Relative errors, at most 100 u; for extreme sets errors by what cancels, at most 4 u, as for aba: for ddq, |M^-1| |dtau| and what a
/// ddq that is right to its own scale brings; for dtau_dv, |M| |v|, 15 u as for M; for M^-1, |M^-1| |M| |M^-1|.
void checkDerivatives(const CompactModel& model, Data& data, const nlohmann::json& sample, bool extreme, Worst& worst) {
  const nlohmann::json& truth = sample["truth"];
  const Eigen::VectorXd q = vectorOf(sample["q"]), v = vectorOf(sample["v"]), a = vectorOf(sample["a"]), tau = vectorOf(sample["tau"]);
  const auto check = [&](const std::string& key, const MatrixResult& x, long double scale, double budget = 4) {
    const std::vector<long double> reference = flatten(truth[key]);
    const double relative = relativeError(rowMajor(x), reference);
    const double scaled = scaledError(rowMajor(x), reference, std::vector<long double>(reference.size(), std::max(scale, largest(reference))));
    if (extreme) {
      worst.check(key + ", by scale", scaled, budget);
    } else {
      worst.check(key, relative, 100);
    }
  };
  if (truth.contains("dtau_dq")) {
    const RneaDerivatives x = computeRNEADerivatives(model, data, q, v, a);
    worst.check("dtau_dq", relativeError(rowMajor(x.dtau_dq), flatten(truth["dtau_dq"])), 100);
    check("dtau_dv", x.dtau_dv, largest(flatten(truth["M"])) * static_cast<long double>(v.cwiseAbs().maxCoeff()), 15);
    worst.check("dtau_da", relativeError(rowMajor(x.dtau_da), flatten(truth["M"])), 15);
  }
  if (!truth.contains("ddq_dq")) return;
  const AbaDerivatives x = computeABADerivatives(model, data, q, v, tau);
  const auto product = [&](const char* key) {
    const std::vector<long double> inverse = flatten(truth["Minv"]), by = flatten(truth[key]);
    const auto n = static_cast<std::size_t>(model.nv());
    long double most = 0;
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j) {
        long double sum = 0;
        for (std::size_t k = 0; k < n; ++k) sum += std::fabs(inverse[i * n + k] * by[k * n + j]);
        most = std::max(most, sum);
      }
    return most;
  };
  const long double inertial = largest(flatten(truth["Minv"])) * largest(flatten(truth["M"])) * static_cast<long double>(v.cwiseAbs().maxCoeff());
  check("ddq_dq", x.ddq_dq, std::max(product("dtau_dq"), largest(flatten(truth["aba_scale"]))));
  check("ddq_dv", x.ddq_dv, std::max(product("dtau_dv"), inertial));
  check("Minv", x.ddq_dtau, largest(flatten(truth["Minv"])) * largest(flatten(truth["Minv"])) * largest(flatten(truth["M"])));
}

void checkSet(const std::string& name) {
  const Set set = load(name);
  const CompactModel& model = set.model;
  REQUIRE(model.nq() == set.document["nq"].get<int>());
  REQUIRE(model.nv() == set.document["nv"].get<int>());
  Data data(model, Need::derivatives);
  Worst worst(name);
  const bool far = name.find("far") != std::string::npos;
  for (const auto& sample : set.document["samples"]) {
    const nlohmann::json& truth = sample["truth"];
    const Eigen::VectorXd q = vectorOf(sample["q"]), v = vectorOf(sample["v"]), a = vectorOf(sample["a"]), tau = vectorOf(sample["tau"]);
    const auto vec = [](const VectorResult& x) { return rowMajor(x); };
    const auto vec3 = [](const Vec3<double>& x) { return std::vector<double>{x.x, x.y, x.z}; };
    if (truth.contains("rnea_scale"))
      worst.check("rnea", scaledError(vec(rnea(model, data, q, v, a)), flatten(truth["rnea"]), flatten(truth["rnea_scale"])), 10);
    if (truth.contains("rnea_scale"))
      worst.check("nle", scaledError(vec(nonLinearEffects(model, data, q, v)), flatten(truth["nle"]), flatten(truth["rnea_scale"])), 10);
    if (truth.contains("gravity"))
      worst.check("gravity", scaledError(vec(generalizedGravity(model, data, q)), flatten(truth["gravity"]), flatten(truth["rnea_scale"])), 10);
    if (truth.contains("M_entries")) {
      const Eigen::MatrixXd M = crba(model, data, q);
      for (const auto& entry : truth["M_entries"]) {
        const double x = M(entry[0].get<int>(), entry[1].get<int>());
        worst.check("M entry", scaledError({x}, flatten(nlohmann::json::array({entry[2]})), flatten(nlohmann::json::array({truth["M_max"]}))), 15);
      }
    }
    if (truth.contains("M")) worst.check("M", relativeError(rowMajor(crba(model, data, q)), flatten(truth["M"])), 15);
    if (truth.contains("aba_scale")) {
      worst.check("aba", scaledError(vec(aba(model, data, q, v, tau)), flatten(truth["aba"]), flatten(truth["aba_scale"])), 4);
      worst.check("aba relative", relativeError(vec(aba(model, data, q, v, tau)), flatten(truth["aba"])), no_match);
    } else if (truth.contains("M_singular")) {
      CHECK_THROWS_AS(aba(model, data, q, v, tau), Error);
    }
    if (truth.contains("kinetic_energy")) {
      worst.check("kinetic_energy", relativeError({computeKineticEnergy(model, data, q, v)}, flatten(truth["kinetic_energy"])), 20);
      const double magnitude = 9.81 * model.mass() * (far ? 1e9 : 1.0);
      const long double potential = flatten(truth["potential_energy"])[0];
      const double off = static_cast<double>(std::fabs(potential - static_cast<long double>(computePotentialEnergy(model, data, q))) / unit_roundoff);
      worst.check("potential_energy", off / std::max(magnitude, static_cast<double>(std::fabs(potential))), 20);
      const CenterOfMass c = centerOfMass(model, data, q, v, a);
      worst.check("com", relativeError(vec3(c.position), flatten(truth["com"])), 20);
      // Velocities of the bodies may cancel in the mean: the yardstick is their sum without signs, |Jcom| |v|.
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
        worst.check("pose", relativeError(flat, reference), std::max(2.0, 2 * std::sqrt(depthOf(model, j))));
      }
    }
    checkFrames(model, data, q, v, a, truth, far, worst);
    checkDerivatives(model, data, sample, isExtreme(name), worst);
  }
}

/// The same quantities, all samples of a set as one batch. Floats start from states, and a model, rounded to floats: their reference is
/// the double computation of the rounded states.
template <class T>
void checkBatch(const std::string& name) {
  const Set set = load(name);
  const CompactModel& model = set.model;
  const nlohmann::json& samples = set.document["samples"];
  const auto n = static_cast<Eigen::Index>(samples.size());
  using Matrix = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>;
  Matrix q(model.nq(), n), v(model.nv(), n), a(model.nv(), n), tau(model.nv(), n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const nlohmann::json& sample = samples[static_cast<std::size_t>(k)];
    q.col(k) = vectorOf(sample["q"]).cast<T>();
    v.col(k) = vectorOf(sample["v"]).cast<T>();
    a.col(k) = vectorOf(sample["a"]).cast<T>();
    tau.col(k) = vectorOf(sample["tau"]).cast<T>();
  }
  constexpr bool is_double = std::is_same_v<T, double>;
  const std::string mode = is_double ? " batch" : " batch float";
  BasicBatchData<T> batch(model, static_cast<int>(n), Need::mass_matrix, 2);
  Data data(model, Need::mass_matrix);
  Worst worst(name);
  const auto numbers = [](const auto& column) {
    std::vector<double> out;
    for (Eigen::Index i = 0; i < column.size(); ++i) out.push_back(static_cast<double>(column[i]));
    return out;
  };
  // In units of T's own rounding.
  const double unit = is_double ? 1 : 0x1p-24 / 0x1p-53;
  const Matrix forces = rnea(model, batch, q, v, a), M = crba(model, batch, q);
  for (Eigen::Index k = 0; k < n; ++k) {
    const nlohmann::json& truth = samples[static_cast<std::size_t>(k)]["truth"];
    const Eigen::VectorXd qd = q.col(k).template cast<double>(), vd = v.col(k).template cast<double>(), ad = a.col(k).template cast<double>();
    const auto reference = [&](const char* key, const std::vector<double>& found) {
      return is_double ? flatten(truth[key]) : std::vector<long double>(found.begin(), found.end());
    };
    if (truth.contains("rnea_scale"))
      worst.check(
          "rnea" + mode,
          scaledError(numbers(forces.col(k)), reference("rnea", rowMajor(rnea(model, data, qd, vd, ad))), flatten(truth["rnea_scale"])) / unit, 10);
    if (truth.contains("M")) {
      const Eigen::MatrixXd single = crba(model, data, qd);
      worst.check("M" + mode, relativeError(numbers(M.col(k)), reference("M", rowMajor(single))) / unit, 15);
    }
  }
  bool regular = true;
  for (const auto& sample : samples) regular = regular && sample["truth"].contains("aba_scale");
  if (!regular || !is_double) return;
  const Matrix accelerations = aba(model, batch, q, v, tau);
  for (Eigen::Index k = 0; k < n; ++k) {
    const nlohmann::json& truth = samples[static_cast<std::size_t>(k)]["truth"];
    worst.check("aba" + mode, scaledError(numbers(accelerations.col(k)), flatten(truth["aba"]), flatten(truth["aba_scale"])), 4);
  }
}

const std::vector<std::string> sets = {"lwr",
                                       "lwr_bigangle",
                                       "lwr_tinyangle",
                                       "hyq",
                                       "hyq_far",
                                       "hyq_fast",
                                       "human",
                                       "talos",
                                       "chain_2",
                                       "chain_10",
                                       "chain_100",
                                       "big_chain_200",
                                       "collinear_1e-8",
                                       "free_body_a",
                                       "free_body_b",
                                       "free_body_c",
                                       "joint_helical",
                                       "joint_planar",
                                       "joint_prismatic",
                                       "joint_translation",
                                       "joint_universal",
                                       "joint_continuous",
                                       "leaf_mass_1e-12",
                                       "massless_links",
                                       "massratio_12",
                                       "pendulum_double",
                                       "pendulum_simple",
                                       "rope_10",
                                       "zoo",
                                       "custom_cam",
                                       "custom_screw"};

}  // namespace

TEST_CASE("batches are within the same budgets, in double and in float", "[truth]") {
  DYN_NEEDS_SHARED();
  for (const std::string& name : sets) checkBatch<double>(name);
  for (const std::string name : {"lwr", "hyq", "human", "talos", "chain_10", "zoo"}) checkBatch<float>(name);
}

TEST_CASE("algorithms are within their error budgets of the 25-digit truth", "[truth]") {
  DYN_NEEDS_SHARED();
  for (const std::string& name : sets) checkSet(name);
}
