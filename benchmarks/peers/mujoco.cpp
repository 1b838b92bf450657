// SPDX-License-Identifier: BSD-2-Clause
// MuJoCo: passes the tree as MJCF and calls MuJoCo's stages one by one, without contacts and constraints.
#include "peers/peers.hpp"

#include <Eigen/Geometry>

#include <mujoco/mujoco.h>
#include <unistd.h>

#include <cstdio>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace dyn::benchmark::peers {

namespace {

std::string numbers(std::initializer_list<double> x) {
  std::ostringstream out;
  out.precision(17);
  for (const double number : x) out << number << ' ';
  return out.str();
}

void writeBody(const Robot& robot, std::size_t i, std::ostream& out) {
  const Link& link = robot.links[i];
  Eigen::Matrix3d R;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) R(r, c) = link.placement.R(r, c);
  const Eigen::Quaterniond turn(R);
  const Vec3<double>&p = link.placement.p, &com = link.inertia.com;
  const Sym3<double>& I = link.inertia.rotational;
  out << "<body pos='" << numbers({p.x, p.y, p.z}) << "' quat='" << numbers({turn.w(), turn.x(), turn.y(), turn.z()}) << "'><inertial mass='"
      << numbers({link.inertia.mass}) << "' pos='" << numbers({com.x, com.y, com.z}) << "' fullinertia='"
      << numbers({I.xx, I.yy, I.zz, I.xy, I.xz, I.yz}) << "'/>";
  if (link.motion == Motion::floating) {
    out << "<freejoint/>";
  } else {
    out << "<joint axis='0 0 1' type='" << (link.motion == Motion::revolute ? "hinge" : "slide") << "'/>";
  }
  for (std::size_t child = i + 1; child < robot.links.size(); ++child)
    if (robot.links[child].parent == static_cast<int>(i)) writeBody(robot, child, out);
  out << "</body>";
}

mjModel* load(const Robot& robot) {
  char file[] = "/tmp/libdyn-peer-XXXXXX.xml";
  const int descriptor = mkstemps(file, 4);
  if (descriptor < 0) throw std::runtime_error("no temporary file");
  close(descriptor);
  std::ofstream out(file);
  const Vec3<double>& g = robot.gravity;
  out << "<mujoco><compiler angle='radian' boundmass='0' boundinertia='0'/><option gravity='" << numbers({g.x, g.y, g.z})
      << "'><flag constraint='disable'/></option><worldbody>";
  for (std::size_t i = 1; i < robot.links.size(); ++i)
    if (robot.links[i].parent == 0) writeBody(robot, i, out);
  out << "</worldbody></mujoco>\n";
  out.close();
  char problem[1000] = "";
  mjModel* model = mj_loadXML(file, nullptr, problem, sizeof problem);
  std::remove(file);
  if (model == nullptr) throw std::runtime_error(problem);
  return model;
}

class Mujoco : public Peer {
 public:
  explicit Mujoco(const Robot& robot) : model_(load(robot)), data_(mj_makeData(model_)), floating_(robot.floating), tau_(model_->nv) {}
  ~Mujoco() override {
    mj_deleteData(data_);
    mj_deleteModel(model_);
  }
  Mujoco(const Mujoco&) = delete;
  Mujoco& operator=(const Mujoco&) = delete;

  bool can(Task task) const override { return isBasic(task); }
  void run(Task task, const State& s) override {
    const int nq = floating_ ? 7 : 0, nv = floating_ ? 6 : 0;
    if (floating_) {
      std::copy_n(s.base_q, 3, data_->qpos);
      data_->qpos[3] = s.base_q[6];
      std::copy_n(s.base_q + 3, 3, data_->qpos + 4);
      std::copy_n(s.base_v, 6, data_->qvel);
      std::copy_n(s.base_a, 6, data_->qacc);
    }
    std::copy(s.q.begin(), s.q.end(), data_->qpos + nq);
    mj_kinematics(model_, data_);
    mj_comPos(model_, data_);
    if (task == Task::crba) return mj_crb(model_, data_);
    std::copy(s.v.begin(), s.v.end(), data_->qvel + nv);
    mj_comVel(model_, data_);
    if (task == Task::rnea) {
      std::copy(s.a.begin(), s.a.end(), data_->qacc + nv);
      return mj_rne(model_, data_, 1, tau_.data());
    }
    mj_crb(model_, data_);
    mj_factorM(model_, data_);
    mj_rne(model_, data_, 0, data_->qfrc_bias);
    for (int k = 0; k < model_->nv; ++k)
      tau_[static_cast<std::size_t>(k)] = (k < nv ? s.base_a[k] : s.a[static_cast<std::size_t>(k - nv)]) - data_->qfrc_bias[k];
    mj_solveM(model_, data_, data_->qacc, tau_.data(), 1);
  }
  std::vector<double> result(Task task) const override {
    const int nv = model_->nv, first = floating_ ? 6 : 0;
    if (task == Task::rnea) return {tau_.begin() + first, tau_.end()};
    if (task == Task::aba) return {data_->qacc + first, data_->qacc + nv};
    std::vector<double> full(static_cast<std::size_t>(nv) * static_cast<std::size_t>(nv)), M;
    mj_fullM(model_, full.data(), data_->qM);
    for (int i = first; i < nv; ++i)
      for (int j = first; j < nv; ++j) M.push_back(full[static_cast<std::size_t>(i * nv + j)]);
    return M;
  }

  std::vector<std::string> integrators() const override {
    std::vector<std::string> out;
    if (!floating_)
      for (const auto& method : methods) out.emplace_back(method.name);
    return out;
  }
  std::vector<double> move(const std::string& integrator, const std::vector<double>& q, double time, int steps) override {
    for (const auto& method : methods)
      if (integrator == method.name) model_->opt.integrator = method.number;
    model_->opt.timestep = time / steps;
    mj_resetData(model_, data_);
    std::copy(q.begin(), q.end(), data_->qpos);
    for (int k = 0; k < steps; ++k) mj_step(model_, data_);
    return {data_->qpos, data_->qpos + model_->nq};
  }

 private:
  struct Method {
    const char* name;
    int number;
  };
  static constexpr Method methods[] = {{"Euler", mjINT_EULER}, {"implicit", mjINT_IMPLICIT}, {"RK4", mjINT_RK4}};

  mjModel* model_;
  mjData* data_;
  bool floating_;
  std::vector<double> tau_;
};

}  // namespace

}  // namespace dyn::benchmark::peers

dyn::benchmark::peers::Peer* makePeer(const dyn::benchmark::peers::Robot& robot) { return new dyn::benchmark::peers::Mujoco(robot); }
