// SPDX-License-Identifier: BSD-2-Clause
// The sets of the 25-digit reference data: models, samples, and error budgets. Those in ../shared were made by another program. Those in the folder
// `references` were made by `dyn truth`, so that a clone by itself has some.
#pragma once

#include "errors.hpp"
#include "support/shared.hpp"
#include "support/truth_model.hpp"

#include <dyn/dyn.hpp>
#include <dyn/parsers/urdf.hpp>

#include <iostream>
#include <map>

namespace dyn::test {

using namespace dyn::tool;

inline Eigen::VectorXd vectorOf(const nlohmann::json& x) {
  const auto v = x.get<std::vector<double>>();
  return Eigen::Map<const Eigen::VectorXd>(v.data(), static_cast<Eigen::Index>(v.size()));
}

struct Set {
  Model description;
  CompactModel model;
  nlohmann::json document;
};

/// Loads a set of ../shared by its name, or one of the project's own as "references/NAME".
inline Set load(const std::string& name) {
  const bool own = name.starts_with("references/");
  const std::string shared = own ? "" : sharedFolder(), source = DYN_SOURCE_DIR "/";
  nlohmann::json document = readJson((own ? source + "tests/truth/" : shared + "/truth/data/") + name + ".json");
  const std::string file = document["file"];
  Model model;
  if (file.ends_with(".urdf")) {
    urdf::Options options;
    options.root = document["root"];
    options.mimic = document.value("mimic", "independent") == "coupled" ? urdf::Mimic::coupled : urdf::Mimic::independent;
    model = urdf::load((own ? source : shared + "/models/") + file, options);
  } else {
    model = readTruthModel(readJson(shared + "/truth/" + file));
  }
  CompileOptions options;
  options.dissipation = options.armature = false;
  const CompactModel compiled = compile(model, JointRegistry::standard(), options);
  return {std::move(model), compiled, std::move(document)};
}

/// The states of a set's samples in columns, rounded to T.
template <class T>
struct SampleStates {
  Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic> q, v, a, tau;
};
template <class T>
SampleStates<T> statesOf(const Set& set) {
  const nlohmann::json& samples = set.document["samples"];
  const auto columns = [&](const char* key) {
    Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic> out(vectorOf(samples.at(0).at(key)).size(), static_cast<Eigen::Index>(samples.size()));
    for (Eigen::Index k = 0; k < out.cols(); ++k) out.col(k) = vectorOf(samples[static_cast<std::size_t>(k)][key]).cast<T>();
    return out;
  };
  return {columns("q"), columns("v"), columns("a"), columns("tau")};
}

/// The project's own sets, by name.
inline const std::vector<std::string>& ownSets() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> out;
    for (const auto& entry : std::filesystem::directory_iterator(DYN_SOURCE_DIR "/tests/truth/references"))
      if (entry.path().extension() == ".json") out.push_back("references/" + entry.path().stem().string());
    std::sort(out.begin(), out.end());
    return out;
  }();
  return names;
}

/// The largest error [u] of a result. Errors are relative to the numbers under `scale`, or to the largest number of the result.
struct Budget {
  const char* symbol;  ///< of the catalogue, or none
  const char* key;     ///< of the references
  const char* scale;
  double most;
};
inline constexpr Budget budgets[] = {{"tau", "rnea", "rnea_scale", 10},
                                     {"nle", "nle", "rnea_scale", 10},
                                     {"g", "gravity", "rnea_scale", 10},
                                     {"ddq", "aba", "aba_scale", 4},
                                     {"M", "M", nullptr, 15},
                                     {"J", "J", nullptr, 15},
                                     {"Ag", "Ag", nullptr, 15},
                                     {"dhgdot_da", "Ag", nullptr, 15},
                                     {"hg", "hg", nullptr, 15},
                                     {"dhg", "dhg", nullptr, 30},
                                     {"dAg", "dAg", nullptr, 30},
                                     {"com", "com", nullptr, 20},
                                     {"vcom", "vcom", nullptr, 30},
                                     {"acom", "acom", nullptr, 40},
                                     {"Jcom", "Jcom", nullptr, 15},
                                     {"kinetic_energy", "kinetic_energy", nullptr, 20},
                                     {"potential_energy", "potential_energy", nullptr, 20},
                                     {"Minv", "Minv", nullptr, 100},
                                     {"dtau_dq", "dtau_dq", nullptr, 100},
                                     {"dtau_dv", "dtau_dv", nullptr, 100},
                                     {"ddq_dq", "ddq_dq", nullptr, 100},
                                     {"ddq_dv", "ddq_dv", nullptr, 100},
                                     {"C", "coriolis_matrix", nullptr, 100},
                                     {"dhg_dq", "dhg_dq", nullptr, 100},
                                     {"dhgdot_dq", "dhgdot_dq", nullptr, 100},
                                     {"dhgdot_dv", "dhgdot_dv", nullptr, 100},
                                     {nullptr, "static_torque", nullptr, 15},
                                     {nullptr, "J_local", nullptr, 15},
                                     {nullptr, "vel_local", nullptr, 15},
                                     {nullptr, "acc_local_spatial", nullptr, 30},
                                     {nullptr, "acc_lwa_classical", nullptr, 30}};

inline const Budget& budgetOf(std::string_view key) {
  return *std::find_if(std::begin(budgets), std::end(budgets), [&](const Budget& budget) { return budget.key == key; });
}

/// The error [u] of a result, row after row. `truth` has its reference and its scale.
inline double errorOf(const std::vector<double>& found, const nlohmann::json& truth, const Budget& budget) {
  const std::vector<long double> reference = flatten(truth.at(budget.key));
  return budget.scale ? scaledError(found, reference, flatten(truth.at(budget.scale))) : relativeError(found, reference);
}

/// Three numbers of the linear part, then three of the angular part.
template <class T>
std::vector<double> flatMotion(const Motion<T>& m) {
  return {m.linear.x, m.linear.y, m.linear.z, m.angular.x, m.angular.y, m.angular.z};
}

/// Worst errors of a set by quantity. The destructor prints them if DYN_SHOW_ERRORS is set.
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
  /// Checks a result, row after row, by its budget. A unit is that many roundoffs of a double.
  void check(const std::string& key, const std::string& mode, const std::vector<double>& found, const nlohmann::json& truth, double unit = 1) {
    const Budget& budget = budgetOf(key);
    check(key + mode, errorOf(found, truth, budget) / unit, budget.most);
  }

 private:
  std::string set_;
  std::map<std::string, double> errors_;
};

inline long double largest(const std::vector<long double>& x) {
  long double most = 0;
  for (const long double e : x) most = std::max(most, std::fabs(e));
  return most;
}

/// Tells whether a set was made so that relative errors lose digits: M is close to singular, or the terms of the derivatives cancel almost
/// completely.
inline bool isExtreme(const std::string& set) {
  for (const char* kind : {"chain_", "massratio", "collinear", "free_body", "tinyangle", "pendulum"})
    if (set.find(kind) != std::string::npos) return true;
  return false;
}

/// Computed derivatives, nv x nv each.
struct DerivativesFound {
  Eigen::MatrixXd dtau_dq, dtau_dv, dtau_da, ddq_dq, ddq_dv, ddq_dtau;
};

/// Checks the derivatives for which the sample has references. Relative errors are at most 100 u (15 u for dtau_da, as for M). For extreme sets the
/// other derivatives' errors are relative to the terms that cancel: dtau_dv within 15 u of |M| |v|; derivatives of ddq, as aba, within 4 u of
/// |M^-1| |dtau| and of the scale of ddq; M^-1 within 4 u of |M^-1| |M| |M^-1|. dtau_dq keeps its relative budget of 100 u.
inline void checkDerivatives(const nlohmann::json& sample, const DerivativesFound& x, const std::string& mode, bool extreme, Worst& worst) {
  const nlohmann::json& truth = sample["truth"];
  const long double speed = static_cast<long double>(vectorOf(sample["v"]).cwiseAbs().maxCoeff());
  const auto check = [&](const std::string& key, const Eigen::MatrixXd& found, long double scale, double budget = 4) {
    const std::vector<long double> reference = flatten(truth[key]);
    if (extreme) {
      const std::vector<long double> scales(reference.size(), std::max(scale, largest(reference)));
      worst.check(key + mode + ", by scale", scaledError(rowMajor(found), reference, scales), budget);
    } else {
      worst.check(key, mode, rowMajor(found), truth);
    }
  };
  if (truth.contains("dtau_dq")) {
    worst.check("dtau_dq", mode, rowMajor(x.dtau_dq), truth);
    check("dtau_dv", x.dtau_dv, largest(flatten(truth["M"])) * speed, 15);
    worst.check("M", " beside its derivatives" + mode, rowMajor(x.dtau_da), truth);
  }
  if (!truth.contains("ddq_dq")) return;
  const auto product = [&](const char* key) {
    const std::vector<long double> inverse = flatten(truth["Minv"]), by = flatten(truth[key]);
    const auto n = static_cast<std::size_t>(x.ddq_dq.rows());
    long double most = 0;
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j) {
        long double sum = 0;
        for (std::size_t k = 0; k < n; ++k) sum += std::fabs(inverse[i * n + k] * by[k * n + j]);
        most = std::max(most, sum);
      }
    return most;
  };
  const long double inverse = largest(flatten(truth["Minv"])), inertia = largest(flatten(truth["M"]));
  check("ddq_dq", x.ddq_dq, std::max(product("dtau_dq"), largest(flatten(truth["aba_scale"]))));
  check("ddq_dv", x.ddq_dv, std::max(product("dtau_dv"), inverse * inertia * speed));
  check("Minv", x.ddq_dtau, inverse * inverse * inertia);
}

inline const std::vector<std::string> truth_sets = {"lwr",
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

}  // namespace dyn::test
