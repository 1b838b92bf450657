// SPDX-License-Identifier: BSD-2-Clause
// Every method converges to the true motion with its theoretical order.
#include "integrate/problems.hpp"
#include "support/random_model.hpp"

#include <limits>

using namespace dyn;
using namespace dyn::test;

namespace {

/// The order of convergence from the errors at dt and dt / 2. At these steps the leading error term must dominate higher terms and rounding.
double orderOf(const CompactModel& model, Integrator integrator, const State& start, const State& end, double dt) {
  const double coarse = errorAt(model, {.integrator = integrator, .dt = dt}, start, end);
  const double fine = errorAt(model, {.integrator = integrator, .dt = dt / 2}, start, end);
  INFO(infoOf(integrator).name << ": errors " << coarse << ", " << fine);
  CHECK(fine > 1e-13);
  return std::log2(coarse / fine);
}

/// Steps at which the leading term of each method's error dominates, for problems with time scales of about a second.
double stepFor(Integrator integrator) {
  switch (integrator) {
    case Integrator::explicit_euler:
    case Integrator::semi_implicit_euler:
      return 0x1p-12;
    case Integrator::rk4:
    case Integrator::implicit_midpoint:
    case Integrator::variational:
      return 0x1p-8;
    case Integrator::gauss6:
      return 0x1p-4;
    case Integrator::radau5:
      return 0x1p-6;
    case Integrator::dormand_prince:
      break;
  }
  return 0;
}

}  // namespace

TEST_CASE("orders of convergence on the double pendulum are those of theory", "[orders]") {
  DYN_NEEDS_SHARED();
  const CompactModel model = compile(tool::pendulum(2), registry());
  const std::vector<State> reference = pendulumReference(false);
  for (const IntegratorInfo& info : integrators()) {
    if (info.adaptive) continue;
    const double order = orderOf(model, info.integrator, reference[0], reference[1], stepFor(info.integrator));
    INFO(info.name);
    CHECK(std::abs(order - info.order) < 0.05 * info.order);
  }
}

TEST_CASE("orders of convergence in the attitude of a free body are those of theory", "[orders]") {
  DYN_NEEDS_SHARED();
  const bool top = GENERATE(false, true);
  const CompactModel model = compile(top ? tool::heavyTop() : tool::freeBody(), registry());
  const std::vector<State> reference = rigidReference(top ? "heavy_top" : "torque_free");
  for (const IntegratorInfo& info : integrators()) {
    if (info.adaptive) continue;
    // The top spins 30 times as fast as the free body. The free body is compared at 10 s.
    const double dt = stepFor(info.integrator) * (top ? 1.0 / 16 : info.order > 2 ? 8 : 1);
    const double order = orderOf(model, info.integrator, reference[0], reference[top ? 1 : 2], dt);
    INFO(info.name << (top ? ", top" : ", free body"));
    CHECK(std::abs(order - info.order) < 0.05 * info.order);
  }
}
