// SPDX-License-Identifier: BSD-2-Clause
// Simulator::advance: takes steps, shows states between their ends, and stops at events.
#include "integrate/simulator_impl.hpp"
#include "number_text.hpp"

#include <dyn/error.hpp>

#include <cmath>

namespace dyn {

namespace {

/// Throws Error(argument) unless the times ascend and lie within [from, to].
void checkTimes(double from, double to, const double* times, std::size_t count) {
  double before = from;
  for (std::size_t k = 0; k < count; ++k) {
    if (!(times[k] >= before) || !(times[k] <= to))
      throw Error(ErrorCode::argument, "Simulator::advance: time " + std::to_string(k) + " is " + number(times[k]) +
                                           " s; times ascend from the present one, " + number(from) + " s, to the last, " + number(to) + " s");
    before = times[k];
  }
}

}  // namespace

void Simulator::Impl::show(double t, const double* q, const double* v, const Observer& observer) const {
  const CompactModel& m = equations.model();
  guardCallback("the observer", t, [&] { observer(t, {q, m.nq()}, {v, m.nv()}); });
}

int Simulator::advanceTo(double until, const double* times, std::size_t count, const Observer& observer) {
  Impl& x = *impl_;
  const Work work(x, "Simulator::advance");
  if (!std::isfinite(until) || until < x.now.time)
    throw Error(ErrorCode::argument, "Simulator::advance: to t = " + number(until) + " s, but it is " + number(x.now.time) + " s: time goes forward");
  checkTimes(x.now.time, until, times, count);
  std::size_t shown = 0;
  if (!observer) count = 0;
  while (shown < count && times[shown] == x.now.time) x.show(times[shown++], x.now.q.data(), x.now.v.data(), observer);
  if (const int event = x.tellEvent(); event >= 0) return event;
  x.checkSteps(until);
  while (x.now.time < until) {
    const double planned = x.stepTowards(until);
    const int event = x.events.empty() ? -1 : x.findEvent(planned);
    const double h = x.next.time - x.now.time;
    for (; shown < count && times[shown] < x.next.time; ++shown) {
      x.between((times[shown] - x.now.time) / h, x.shown_q.data(), x.shown_v.data());
      x.show(times[shown], x.shown_q.data(), x.shown_v.data(), observer);
    }
    x.commit();
    for (; shown < count && times[shown] == x.now.time; ++shown) x.show(times[shown], x.now.q.data(), x.now.v.data(), observer);
    x.readEvents(x.now, x.signs);
    if (event >= 0) return event;
  }
  return -1;
}

}  // namespace dyn
