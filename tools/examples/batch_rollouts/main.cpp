// SPDX-License-Identifier: BSD-2-Clause
// Rolls out 1000 random control sequences of a robot side by side, as sampling-based MPC does, and picks the one that comes closest to a goal.
// Each step calls aba once for all rollouts. Prints the states per second and the best cost, and checks the best rollout against single-state calls.
#include <dyn/dyn.hpp>
#include <dyn/parsers/urdf.hpp>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <random>
#include <vector>

namespace {

constexpr int rollouts = 1000, steps = 50, pieces = 5;  // a sequence is constant over each of its five pieces
constexpr double dt = 0.01;                             // [s]

/// Cost of one state: its distance from the goal, and its speed. `error` is scratch of nv numbers.
double cost(const dyn::CompactModel& model, const double* q, const double* v, const Eigen::VectorXd& goal, Eigen::VectorXd& error) {
  dyn::difference(model, {q, model.nq()}, goal, error);
  return error.squaredNorm() + 0.01 * Eigen::Map<const Eigen::VectorXd>(v, model.nv()).squaredNorm();
}

}  // namespace

int main(int argc, char** argv) try {
  const dyn::CompactModel model = dyn::compile(dyn::urdf::load(argc > 1 ? argv[1] : "models/arm.urdf"), dyn::JointRegistry::standard());
  const int nq = model.nq(), nv = model.nv();
  const Eigen::VectorXd start = dyn::neutral(model), rest = Eigen::VectorXd::Zero(nv);
  const Eigen::VectorXd goal = dyn::integrate(model, start, Eigen::VectorXd::Constant(nv, 0.3));

  // Samples joint accelerations, and turns them into joint forces by rnea at the start. So each joint gets forces of its own size. Rollout 0 has no
  // noise: it holds the robot against gravity. Need::mass_matrix is for aba of robots with mimic joints; others need Need::state only.
  dyn::Data data(model, dyn::Need::mass_matrix);
  std::mt19937 generator(1);
  std::normal_distribution<double> noise(0, 3);
  std::vector<Eigen::MatrixXd> tau(pieces, Eigen::MatrixXd(nv, rollouts));
  Eigen::VectorXd a(nv);
  for (Eigen::MatrixXd& piece : tau)
    for (int k = 0; k < rollouts; ++k) {
      for (double& x : a) x = k == 0 ? 0 : noise(generator);
      piece.col(k) = dyn::rnea(model, data, start, rest, a);
    }

  // Rolls out. Column k of each matrix belongs to rollout k. The constructor of the batch takes all memory.
  dyn::BatchData batch(model, rollouts, dyn::Need::mass_matrix, /*threads=*/1);
  Eigen::MatrixXd Q = start.replicate(1, rollouts), V = rest.replicate(1, rollouts), step(nv, rollouts);
  Eigen::VectorXd costs = Eigen::VectorXd::Zero(rollouts), error(nv);
  const auto begin = std::chrono::steady_clock::now();
  for (int i = 0; i < steps; ++i) {
    V += dt * dyn::aba(model, batch, Q, V, tau[static_cast<std::size_t>(i * pieces / steps)]);
    step = dt * V;
    for (int k = 0; k < rollouts; ++k) {
      dyn::integrate(model, Q.col(k), step.col(k), Q.col(k));  // in place
      costs[k] += dt * cost(model, Q.col(k).data(), V.col(k).data(), goal, error);
    }
  }
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  int best = 0;
  costs.minCoeff(&best);

  // Computes the best rollout once more, state by state.
  Eigen::VectorXd q = start, v = rest, dq(nv);
  double single = 0;
  for (int i = 0; i < steps; ++i) {
    v += dt * dyn::aba(model, data, q, v, tau[static_cast<std::size_t>(i * pieces / steps)].col(best));
    dq = dt * v;
    dyn::integrate(model, q, dq, q);
    single += dt * cost(model, q.data(), v.data(), goal, error);
  }
  const double apart = dyn::distance(model, q, Q.col(best)) + (v - V.col(best)).norm();

  std::printf("robot: %s, nq %d, nv %d\n", model.name().c_str(), nq, nv);
  std::printf("%d rollouts of %d steps in %.1f ms: %.2f million states per second, %d states per instruction\n", rollouts, steps, 1e3 * seconds,
              rollouts * steps / seconds / 1e6, batch.lanes());
  std::printf("best rollout %d: cost %.4f; without noise: cost %.4f\n", best, costs[best], costs[0]);
  std::printf("difference of its last state from single-state calls: %.1e\n", apart);
  const bool good = costs[best] < costs[0] && apart < 1e-9 && std::abs(single - costs[best]) < 1e-9;
  std::puts(good ? "success" : "FAILURE");
  return good ? 0 : 1;
} catch (const std::exception& problem) {
  std::fprintf(stderr, "%s\n", problem.what());
  return 1;
}
