// SPDX-License-Identifier: BSD-2-Clause
#include "task.hpp"
#include "trajectory.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace dyn::tool::sweep {

namespace {

constexpr double most_states = 1 << 24;  ///< of one motion

class SimulateTask final : public Task {
 public:
  explicit SimulateTask(const Setting& setting) : setting_(setting), options_(setting.study.options), model_(setting.model) {
    readTimes();
    const std::int64_t nq = model_.nq(), nv = model_.nv(), count = static_cast<std::int64_t>(times_.size());
    const Study& study = setting.study;
    if (study.keeps("initial")) fields_.insert(fields_.end(), {{"q_initial", {nq}}, {"v_initial", {nv}}});
    if (study.keeps("final")) fields_.insert(fields_.end(), {{"q_final", {nq}}, {"v_final", {nv}}});
    if (study.keeps("extremes")) fields_.insert(fields_.end(), {{"q_min", {nq}}, {"q_max", {nq}}, {"v_min", {nv}}, {"v_max", {nv}}});
    if (study.keeps("energy")) fields_.insert(fields_.end(), {{"energy_initial", {}}, {"energy_final", {}}, {"energy_drift", {}}});
    if (study.keeps("counts")) fields_.insert(fields_.end(), {{"steps", {}}, {"touched", {}}, {"impacts", {}}});
    if (study.keeps("trajectory")) fields_.insert(fields_.end(), {{"q", {count, nq}}, {"v", {count, nv}}});
    error_.resize(nv);
    observes_ = study.keeps("extremes") || study.keeps("energy") || study.keeps("trajectory");
    build();
  }

  const std::vector<Field>& fields() const override { return fields_; }
  std::vector<double> times() const override { return setting_.study.keeps("trajectory") ? times_ : std::vector<double>(); }

  void run(const Inputs& inputs, double* row) override {
    start(inputs);
    const Study& study = setting_.study;
    const auto write = [&row](const auto& x) { row = std::copy(x.begin(), x.end(), row); };
    if (study.keeps("initial")) write(simulator_->q()), write(simulator_->v());
    if (observes_) {
      q_min_ = q_max_ = simulator_->q();
      v_min_ = v_max_ = simulator_->v();
      const double energy = simulator_->energy();
      path_q_.clear();
      path_v_.clear();
      double drift = 0;
      const bool energies = study.keeps("energy"), path = study.keeps("trajectory");
      simulator_->advance(options_.time, times_, [&](double, VectorResult q, VectorResult v) {
        q_min_ = q_min_.cwiseMin(q), q_max_ = q_max_.cwiseMax(q);
        v_min_ = v_min_.cwiseMin(v), v_max_ = v_max_.cwiseMax(v);
        if (energies)
          drift = std::max(drift, std::abs(computeKineticEnergy(model_, *data_, q, v) + computePotentialEnergy(model_, *data_, q) - energy));
        if (!path) return;
        path_q_.insert(path_q_.end(), q.begin(), q.end());
        path_v_.insert(path_v_.end(), v.begin(), v.end());
      });
      writeFinal(write);
      if (study.keeps("extremes")) write(q_min_), write(q_max_), write(v_min_), write(v_max_);
      if (energies) write(std::initializer_list<double>{energy, simulator_->energy(), drift});
      writeCounts(write);
      if (path) write(path_q_), write(path_v_);
    } else {
      simulator_->advance(options_.time);
      writeFinal(write);
      writeCounts(write);
    }
  }

  void plot(const Inputs& inputs, const std::string& path) override {
    start(inputs);
    Trajectory trajectory(model_);
    simulator_->advance(options_.time, times_, [&](double t, const VectorResult& q, const VectorResult& v) { trajectory.add(t, q, v, 0); });
    trajectory.plot(path);
  }

 private:
  void readTimes() {
    const double time = options_.time, every = setting_.study.every;
    const double step = every > 0 ? every : std::max(options_.dt, time / 100), count = std::ceil(time / step - 1e-9);
    if (count > most_states)
      throw Error(ErrorCode::argument, "every: a motion has more than " + std::to_string(static_cast<long>(most_states)) + " states",
                  {setting_.study.name, 0, ""});
    for (long k = 0; k < static_cast<long>(count); ++k) times_.push_back(static_cast<double>(k) * step);
    times_.push_back(time);
  }

  /// Makes the simulator for the present options and model.
  void build() {
    const ConstraintSet constraints = options_.constraints(model_);
    constraints_.emplace(constraints);
    simulator_.emplace(constraints, options_.simulator());
    data_.emplace(model_);
    if (const ContactFinder finder = options_.finder(model_, setting_.geometry)) simulator_->setContacts(finder);
    if (setting_.variation.controls())
      simulator_->setController([this](double, const VectorResult& q, const VectorResult& v, const VectorMap& tau) { control(q, v, tau); });
  }

  /// The sample's constant torques, and those of its springs and dampers between the joints and their target.
  void control(const VectorResult& q, const VectorResult& v, VectorMap tau) {
    const Inputs& x = inputs_;
    difference(model_, q, x.target, error_);
    tau = x.tau.array() + x.kp.array() * error_.array() - x.kd.array() * v.array();
    if (!setting_.study.effort_limits) return;
    const Eigen::Map<const Eigen::VectorXd> most(model_.limits().effort.data(), tau.size());
    tau = tau.cwiseMin(most).cwiseMax(-most);
  }

  void start(const Inputs& inputs) {
    inputs_ = inputs;
    if (setting_.variation.changesModel() || setting_.variation.changesOptions()) {
      model_ = setting_.modelOf(inputs, options_);
      build();
    }
    Eigen::VectorXd q = inputs.q, v = inputs.v;
    assembleState(model_, *constraints_, q, v);
    simulator_->reset(q, v);
  }

  template <class Write>
  void writeFinal(const Write& write) {
    if (setting_.study.keeps("final")) write(simulator_->q()), write(simulator_->v());
  }
  template <class Write>
  void writeCounts(const Write& write) {
    const SimulatorStatistics& s = simulator_->statistics();
    if (setting_.study.keeps("counts"))
      write(std::initializer_list<double>{static_cast<double>(s.steps), static_cast<double>(s.touched), static_cast<double>(s.impacts)});
  }

  const Setting& setting_;
  MotionOptions options_;
  CompactModel model_;
  std::optional<ConstraintSet> constraints_;
  std::optional<Simulator> simulator_;
  std::optional<Data> data_;
  std::vector<Field> fields_;
  std::vector<double> times_, path_q_, path_v_;
  Inputs inputs_;  ///< of the present sample
  Eigen::VectorXd error_, q_min_, q_max_, v_min_, v_max_;
  bool observes_ = false;
};

}  // namespace

std::unique_ptr<Task> simulateTask(const Setting& setting) { return std::make_unique<SimulateTask>(setting); }

}  // namespace dyn::tool::sweep
