// SPDX-License-Identifier: BSD-2-Clause
#include "peers/peers.hpp"

#include <dyn/dyn.hpp>

namespace dyn::benchmark::peers {

namespace {

class Libdyn : public Peer {
 public:
  explicit Libdyn(const Robot& robot)
      : model_(*static_cast<const CompactModel*>(robot.compact.get())),
        data_(model_, Need::mass_matrix | Need::derivatives),
        offset_(robot.floating ? 6 : 0),
        q_(model_.nq()),
        v_(model_.nv()),
        a_(model_.nv()) {}
  bool can(Task) const override { return true; }
  void run(Task task, const State& s) override {
    const auto fill = [&](const double* base, int n, const std::vector<double>& joints, Eigen::VectorXd& to) {
      if (offset_ > 0) std::copy_n(base, n, to.data());
      std::copy(joints.begin(), joints.end(), to.data() + (offset_ > 0 ? n : 0));
    };
    fill(s.base_q, 7, s.q, q_);
    if (task != Task::crba && task != Task::minverse) {
      fill(s.base_v, 6, s.v, v_);
      fill(s.base_a, 6, s.a, a_);
    }
    if (task == Task::rnea) result_ = rnea(model_, data_, q_, v_, a_).data();
    if (task == Task::crba) result_ = crba(model_, data_, q_).data();
    if (task == Task::aba) result_ = aba(model_, data_, q_, v_, a_).data();
    if (task == Task::minverse) result_ = computeMinverse(model_, data_, q_).data();
    if (task == Task::rnea_derivatives) result_ = computeRNEADerivatives(model_, data_, q_, v_, a_).dtau_dq.data();
    if (task == Task::aba_derivatives) result_ = computeABADerivatives(model_, data_, q_, v_, a_).ddq_dq.data();
  }
  std::vector<double> result(Task task) const override {
    const Eigen::Index n = model_.nv() - offset_, columns = isMatrix(task) ? model_.nv() : 1;
    Eigen::MatrixXd x = Eigen::Map<const Eigen::MatrixXd>(result_, model_.nv(), columns).bottomRightCorner(n, isMatrix(task) ? n : 1);
    if (isMatrix(task)) x.transposeInPlace();
    return {x.data(), x.data() + x.size()};
  }

  std::vector<std::string> integrators() const override {
    std::vector<std::string> out;
    for (const IntegratorInfo& info : dyn::integrators())
      if (offset_ == 0 && !info.adaptive) out.emplace_back(info.name);
    return out;
  }
  std::vector<double> move(const std::string& integrator, const std::vector<double>& q, double time, int steps) override {
    Simulator s(model_, {.integrator = integratorByName(integrator), .dt = time / steps});
    s.reset(Eigen::Map<const Eigen::VectorXd>(q.data(), model_.nq()), Eigen::VectorXd::Zero(model_.nv()));
    s.advance(time);
    return {s.q().begin(), s.q().end()};
  }

 private:
  CompactModel model_;
  Data data_;
  int offset_;
  Eigen::VectorXd q_, v_, a_;
  const double* result_ = nullptr;
};

}  // namespace

std::unique_ptr<Peer> makeLibdyn(const Robot& robot) { return std::make_unique<Libdyn>(robot); }

}  // namespace dyn::benchmark::peers
