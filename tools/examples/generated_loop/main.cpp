// SPDX-License-Identifier: BSD-2-Clause
// Compiles rnea of one robot to machine code while the program runs, and calls it in a loop of 1 kHz, as a controller does. Prints how long the
// calls take, how late the loop wakes up, and how many allocations it makes (none). Compares each result with that of the interpreted rnea.
#include <dyn/codegen/native.hpp>
#include <dyn/dyn.hpp>
#include <dyn/parsers/urdf.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <thread>

// Counts allocations. Eigen calls malloc and operator new calls malloc, so the program's own malloc sees both. This works with glibc.
static long allocations = 0;
extern "C" void* __libc_malloc(std::size_t size) noexcept;
extern "C" void* malloc(std::size_t size) noexcept {
  ++allocations;
  return __libc_malloc(size);
}

namespace {

using Clock = std::chrono::steady_clock;

constexpr int cycles = 500;
constexpr std::chrono::milliseconds period{1};

/// Durations in microseconds.
struct Times {
  double sum = 0, worst = 0;
  void add(Clock::duration d) {
    const double us = std::chrono::duration<double, std::micro>(d).count();
    sum += us;
    worst = std::max(worst, us);
  }
  void print(const char* name) const { std::printf("%-12s mean %8.2f us, worst %8.2f us\n", name, sum / cycles, worst); }
};

}  // namespace

int main(int argc, char** argv) try {
  // Before the loop: everything that reads files, compiles or allocates. The compiler runs only if its result is not in the cache yet.
  const dyn::CompactModel model = dyn::compile(dyn::urdf::load(argc > 1 ? argv[1] : "models/arm.urdf"), dyn::JointRegistry::standard());
  const Clock::time_point before = Clock::now();
  const dyn::CompiledModel compiled = dyn::compileNative(model, {"rnea"});
  const dyn::CompiledFunction& generated = compiled.function("rnea");
  std::printf("%s: rnea %s in %.0f ms\n", model.name().c_str(), generated.cached() ? "loaded from the cache" : "compiled",
              std::chrono::duration<double, std::milli>(Clock::now() - before).count());

  dyn::Data data(model);
  const Eigen::VectorXd home = dyn::neutral(model);
  Eigen::VectorXd q = home, v(model.nv()), a(model.nv()), offset(model.nv()), tau(model.nv()), error(model.nv());
  double largest = 0, largest_error = 0;
  Times times_generated, times_interpreted, late;
  if (allocations == 0) {
    std::puts("FAILURE: the program's malloc is not in use");
    return 1;
  }

  // The loop. A real-time program also locks its memory (mlockall) and asks for a real-time priority (sched_setscheduler).
  const long allocations_before = allocations;
  Clock::time_point wake = Clock::now();
  for (int i = 0; i < cycles; ++i) {
    wake += period;
    std::this_thread::sleep_until(wake);
    const Clock::time_point t0 = Clock::now();

    // The desired motion: each joint swings by 0.5 rad, at 2 Hz. The last argument of integrate is the result, so nothing is allocated.
    const double w = 4 * 3.14159265358979, t = 1e-3 * i;
    offset.setConstant(0.5 * std::sin(w * t));
    v.setConstant(0.5 * w * std::cos(w * t));
    a.setConstant(-0.5 * w * w * std::sin(w * t));
    dyn::integrate(model, home, offset, q);

    const Clock::time_point t1 = Clock::now();
    generated({q, v, a}, {tau});
    const Clock::time_point t2 = Clock::now();
    const dyn::VectorResult expected = dyn::rnea(model, data, q, v, a);
    const Clock::time_point t3 = Clock::now();

    late.add(t0 - wake);
    times_generated.add(t2 - t1);
    times_interpreted.add(t3 - t2);
    error = tau - expected;
    largest = std::max(largest, expected.cwiseAbs().maxCoeff());
    largest_error = std::max(largest_error, error.cwiseAbs().maxCoeff());
  }
  const long in_loop = allocations - allocations_before;

  times_generated.print("generated");
  times_interpreted.print("interpreted");
  late.print("wake-up");
  std::printf("%d cycles, %ld allocations in the loop\n", cycles, in_loop);
  std::printf("largest difference %.1e, largest joint force %.3g\n", largest_error, largest);
  const bool good = in_loop == 0 && largest_error < 1e-12 * largest;
  std::puts(good ? "success" : "FAILURE");
  return good ? 0 : 1;
} catch (const std::exception& problem) {
  std::fprintf(stderr, "%s\n", problem.what());
  return 1;
}
