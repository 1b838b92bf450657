// SPDX-License-Identifier: BSD-2-Clause
// Closed loops and stiff springs of the reference data, as models with their forces and initial states.
#pragma once

#include "problems.hpp"
#include "support/registry.hpp"
#include "support/shared.hpp"
#include "support/truth_model.hpp"

#include <dyn/dyn.hpp>

#include <array>
#include <cmath>
#include <functional>
#include <map>

namespace dyn::test {

using Vector = Eigen::VectorXd;

inline double number(const nlohmann::json& x) { return x.is_string() ? std::stod(x.get<std::string>()) : x.get<double>(); }
inline Vector numbers(const nlohmann::json& x) {
  Vector out(static_cast<Eigen::Index>(x.size()));
  for (std::size_t k = 0; k < x.size(); ++k) out[static_cast<Eigen::Index>(k)] = number(x[k]);
  return out;
}
inline nlohmann::json truthFile(const std::string& path) { return readJson(sharedFolder() + "/truth/" + path); }

/// Loops of a reference model. A loop has the rows of a point (3), a revolute joint (5) or a frame (6).
inline std::vector<ConstraintDescription> loopsOf(const nlohmann::json& document) {
  std::vector<ConstraintDescription> out;
  for (const auto& loop : document["loops"]) {
    const auto body = [&](const char* key) {
      const std::string name = loop[key];
      return name == "universe" ? name : name + "_link";
    };
    const auto vector = [&](const char* key) {
      const auto x = loop[key].get<std::vector<double>>();
      return Vec3<double>{x[0], x[1], x[2]};
    };
    std::array<bool, 6> free{};
    const std::string type = loop["type"];
    if (type == "3D") free = {false, false, false, true, true, true};
    if (type == "revolute") {
      const Vec3<double> axis = vector("axis");
      for (int k = 0; k < 3; ++k) free[static_cast<std::size_t>(3 + k)] = axis[k] != 0;
    }
    ConstraintDescription d = closeLoop("loop" + std::to_string(out.size()), body("a"), body("b"), free);
    auto& c = std::get<FrameConstraint>(d.relation);
    c.placement.p = vector("pa");
    c.other_placement.p = vector("pb");
    out.push_back(d);
  }
  return out;
}

/// A mechanism, the forces on it, and its initial state. The constraints are those of the model's description.
struct Mechanism {
  CompactModel model;
  std::function<Vector(const Vector& q, const Vector& v)> force;
  Vector q, v;

  explicit Mechanism(const Model& description)
      : model(compile(description, registry())),
        force([n = model.nv()](const Vector&, const Vector&) { return Vector(Vector::Zero(n)); }),
        q(neutral(model)),
        v(Vector::Zero(model.nv())) {}

  int dof(const std::string& joint) const { return model.joints()[static_cast<std::size_t>(model.jointId(joint))].idx_v; }
};

/// tool::fourBars with an initial velocity: B0, the top of the first crank, moves at 1 m/s to the right. All cranks rotate; couplers keep their
/// direction.
inline Mechanism fourBars(int squares) {
  Mechanism m(tool::fourBars(squares));
  for (const JointRecord& j : m.model.joints()) {
    if (j.nv == 0) continue;
    m.v[j.idx_v] = j.name[1] == 'r' ? -1 : 1;
  }
  return m;
}

/// The mechanism of a file of the reference data, by the file's name.
inline Mechanism bricard(const std::string& name) {
  const nlohmann::json document = truthFile("models/" + name + ".json");
  Model model = readTruthModel(document);
  model.constraints = loopsOf(document);
  return Mechanism(model);
}

/// The reference's order of coordinates.
inline const std::array<const char*, 7> andrews_order{"beta", "theta", "gamma", "phi", "delta", "omega", "epsilon"};

inline Mechanism andrewsSqueezer() {
  // Parameters of the test set for initial value problems (Hairer and Wanner 1996, sec. VII.7).
  constexpr double d = 28e-3, da = 0.0115, e = 0.02, ea = 0.01421, rr = 7e-3, ra = 0.92e-3, ss = 0.035, sa = 0.01874, sb = 0.01043, sc = 0.018,
                   sd = 0.02, ta = 0.02308, tb = 0.00916, u = 0.04, ua = 0.01228, ub = 0.00449, zf = 0.02, zt = 0.04, fa = 0.01421, c0 = 4530,
                   l0 = 0.07785, moment = 0.033;
  const Vec3<double> A{-0.06934, -0.00227, 0}, B{-0.03635, 0.03273, 0}, C{0.014, 0.072, 0};
  const auto plane = [](double m, double I, double x, double y) { return Inertia<double>{m, {x, y, 0}, {0, 0, 0, 0, 0, I}}; };
  Model model;
  model.gravity = {};
  const std::vector<double> z{0, 0, 1};
  const int beta = tool::addBar(model, "beta", 0, z, {}, plane(0.04325, 2.194e-6, ra, 0));
  tool::addBar(model, "theta", beta, z, {rr, 0, 0}, plane(0.00365, 4.410e-7, -da, 0));
  tool::addBar(model, "gamma", 0, z, B, plane(0.02373, 5.255e-6, sa, sb));
  const int delta = tool::addBar(model, "delta", 0, z, A, plane(0.07050, 1.169e-5, ta, tb));
  tool::addBar(model, "phi", delta, z, {zt, 0, 0}, plane(0.00706, 5.667e-7, 0, -(e - ea)));
  const int epsilon = tool::addBar(model, "epsilon", 0, z, A, plane(0.05498, 1.912e-5, ua, -ub));
  tool::addBar(model, "omega", epsilon, z, {0, -u, 0}, plane(0.00706, 5.667e-7, zf - fa, 0));
  const std::pair<const char*, Vec3<double>> ends[] = {{"gamma_link", {0, -ss, 0}}, {"phi_link", {0, -e, 0}}, {"omega_link", {zf, 0, 0}}};
  for (const auto& [body, point] : ends) {
    ConstraintDescription loop = closeLoop(body, "theta_link", body, {false, false, true, true, true, true});
    auto& c = std::get<FrameConstraint>(loop.relation);
    c.placement.p = {-d, 0, 0};
    c.other_placement.p = point;
    c.axes = ConstraintAxes::LOCAL_WORLD_ALIGNED;
    model.constraints.push_back(loop);
  }
  Mechanism m(model);
  const nlohmann::json truth = truthFile("data/ref_andrews.json");
  for (std::size_t k = 0; k < andrews_order.size(); ++k) m.q[m.dof(andrews_order[k])] = number(truth["q0"][k]);
  const int i_beta = m.dof("beta"), i_gamma = m.dof("gamma"), n = m.model.nv();
  m.force = [=](const Vector& q, const Vector&) {
    const double g = q[i_gamma], xd = sd * std::cos(g) + sc * std::sin(g) + B.x - C.x, yd = sd * std::sin(g) - sc * std::cos(g) + B.y - C.y;
    const double length = std::hypot(xd, yd), pull = -c0 * (length - l0) / length;
    Vector tau = Vector::Zero(n);
    tau[i_beta] = moment;
    tau[i_gamma] = pull * (xd * (sc * std::cos(g) - sd * std::sin(g)) + yd * (sd * std::cos(g) + sc * std::sin(g)));
    return tau;
  };
  return m;
}

inline Mechanism flyballGovernor() {
  // The governor has a shaft, a slider on it and two rods with balls. Spring-dampers with rest length 0.5 m connect the slider with the middles of
  // the rods. The mechanism is stiff, with a time scale of 1.5 ms.
  constexpr double K = 8e5, C = 4e4, length = 0.5, middle = 0.5;
  const nlohmann::json document = truthFile("models/flyball.json");
  Model model;
  const auto inertiaOf = [](const nlohmann::json& b) {
    const auto c = b["com"].get<std::vector<double>>();
    const auto I = b.contains("inertia") ? b["inertia"].get<std::vector<double>>() : std::vector<double>(6, 0.0);
    return Inertia<double>{b["mass"].get<double>(), {c[0], c[1], c[2]}, {I[0], I[1], I[2], I[3], I[4], I[5]}};
  };
  std::map<std::string, int> bodies{{"universe", 0}};
  for (const auto& j : document["joints"]) {
    Inertia<double> Y;
    if (j.contains("bodies")) {
      for (const auto& b : j["bodies"]) Y = Y + inertiaOf(b);
    } else {
      Y = inertiaOf(j);
    }
    const std::string name = j["name"];
    bodies[name] = model.addBody(name + "_link", bodies.at(j["parent"]), jointOf(j, "fly"), Y);
  }
  Mechanism m(model);
  const int slider = m.dof("slider");
  const std::array<int, 2> rods{m.dof("rod0"), m.dof("rod1")};
  m.q[slider] = 0.5;
  for (const int rod : rods) m.q[rod] = M_PI / 6;
  m.v[m.dof("shaft")] = 2 * M_PI;
  m.force = [=, n = m.model.nv()](const Vector& q, const Vector& v) {
    Vector tau = Vector::Zero(n);
    for (const int rod : rods) {
      // (x, z) is the vector in the rod's plane from the spring's end at the slider to the middle of the rod; z is up. The spring's end at the slider
      // is as far from the shaft as the rod's pivot.
      const double c = std::cos(q[rod]), s = std::sin(q[rod]), x = middle * c, z = 1 - middle * s - q[slider];
      const double dx = -middle * s * v[rod], dz = -middle * c * v[rod] - v[slider];
      const double l = std::hypot(x, z), pull = K * (l - length) + C * (x * dx + z * dz) / l;
      tau[rod] += -pull / l * (x * -middle * s + z * -middle * c);
      tau[slider] += pull / l * z;
    }
    return tau;
  };
  return m;
}

}  // namespace dyn::test
