// SPDX-License-Identifier: BSD-2-Clause
// Finds zeros of functions of the state within each step. If one step has several, the first ends the step. Further calls report the events at the
// same time, and the following steps find the later ones.
#include "at.hpp"
#include "integrate/passing.hpp"
#include "integrate/simulator_impl.hpp"

#include <dyn/error.hpp>

namespace dyn {

void Simulator::setEvents(std::vector<Event> events) {
  impl_->requireIdle("Simulator::setEvents");
  for (const Event& event : events)
    if (!event.value) throw Error(ErrorCode::argument, "Simulator::setEvents: the event '" + event.name + "' has no function");
  impl_->events = std::move(events);
  impl_->signs.assign(impl_->events.size(), 0);
  impl_->untold.clear();
  impl_->untold.reserve(impl_->events.size());
  impl_->event_looks.resize(impl_->events.size());
  impl_->readEvents(impl_->now, impl_->signs);
}

double Simulator::Impl::valueOf(const Event& event, double t, const double* q, const double* v) const {
  double value = 0;
  const CompactModel& m = equations.model();
  guardCallback(("the event '" + event.name + "'").c_str(), t, [&] { value = event.value(t, {q, m.nq()}, {v, m.nv()}); });
  return value;
}

void Simulator::Impl::readEvents(const Moment& at, std::vector<int>& sides) const {
  for (std::size_t k = 0; k < events.size(); ++k) {
    const double value = valueOf(events[k], at.time, at.q.data(), at.v.data());
    sides[k] = (value > 0) - (value < 0);
  }
}

bool Simulator::Impl::counts(std::size_t k) const {
  return events[k].direction == Event::Direction::both || (signs[k] < 0) == (events[k].direction == Event::Direction::rising);
}

double Simulator::Impl::onItsSide(std::size_t k, double t, const double* q, const double* v) const {
  const double value = signs[k] * valueOf(events[k], t, q, v);
  // A function that has come to zero counts as having passed it.
  return value == 0 ? -std::numeric_limits<double>::denorm_min() : value;
}

double Simulator::Impl::firstChange(double h, std::size_t& which) {
  lookWithin();
  for (int look = 0; look <= looks; ++look)
    for (std::size_t k = 0; k < events.size(); ++k)
      if (signs[k] != 0) event_looks[k][at(look)] = onItsSide(k, now.time + shareOf(look) * h, looked_q[at(look)].data(), looked_v[at(look)].data());
  double earliest = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < events.size(); ++k) {
    // A change that does not count matters only if the function comes back within the step.
    if (signs[k] == 0 || (!counts(k) && event_looks[k].back() < 0)) continue;
    const double share = firstNegative(event_looks[k], [&](double theta) {
      between(theta, shown_q.data(), shown_v.data());
      return onItsSide(k, now.time + theta * h, shown_q.data(), shown_v.data());
    });
    if (!(share < earliest)) continue;
    earliest = share;
    which = k;
  }
  return earliest;
}

int Simulator::Impl::findEvent(double h) {
  std::size_t first = 0;
  double earliest = firstChange(h, first);
  if (!(earliest <= 1)) return -1;
  const auto changed = [&](std::size_t k) { return signs[k] != 0 && onItsSide(k, next.time, next.q.data(), next.v.data()) < 0; };
  // Where the step ends because a joint comes to rest, its speed is exactly zero, and not just past zero.
  if (!(h == cut && earliest > 1 - soon)) {
    // Take the step again, up to the event. Its end is more accurate than the polynomial, which may pass zero a little too early.
    for (double more = 0x1p-45; earliest < 1; more *= 4) {
      retake(earliest * h);
      if (changed(first)) break;
      earliest = std::min(1.0, earliest + more);
    }
    if (earliest == 1) retake(h);
    whole_step = false;
  }
  if (changed(first) && counts(first)) untold.push_back(static_cast<int>(first));
  for (std::size_t k = 0; k < events.size(); ++k)
    if (k != first && changed(k) && counts(k)) untold.push_back(static_cast<int>(k));
  return tellEvent();
}

int Simulator::Impl::tellEvent() {
  if (untold.empty()) return -1;
  const int event = untold.front();
  untold.erase(untold.begin());
  return event;
}

}  // namespace dyn
