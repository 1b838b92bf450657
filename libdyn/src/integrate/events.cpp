// Zeros of functions of the state, looked for between the ends of a step.
#include "integrate/simulator_impl.hpp"

#include <dyn/error.hpp>

namespace dyn {

void Simulator::setEvents(std::vector<Event> events) {
  for (const Event& event : events)
    if (!event.value) throw Error(ErrorCode::argument, "Simulator::setEvents: the event '" + event.name + "' has no function");
  impl_->events = std::move(events);
  impl_->signs.assign(impl_->events.size(), 0);
  impl_->readEvents(impl_->now, impl_->signs);
}

int Simulator::Impl::signOf(const Event& event, double t, const double* q, const double* v) const {
  double value = 0;
  const CompactModel& m = law.model();
  guardCallback(("the event '" + event.name + "'").c_str(), t, [&] { value = event.value(t, {q, m.nq()}, {v, m.nv()}); });
  return (value > 0) - (value < 0);
}

void Simulator::Impl::readEvents(const Moment& at, std::vector<int>& sides) const {
  for (std::size_t k = 0; k < events.size(); ++k) sides[k] = signOf(events[k], at.time, at.q.data(), at.v.data());
}

bool Simulator::Impl::happened(std::size_t k, int sign) const {
  if (signs[k] == 0 || sign == signs[k]) return false;
  return events[k].direction == Event::Direction::both || (signs[k] < 0) == (events[k].direction == Event::Direction::rising);
}

int Simulator::Impl::findEvent(double h) {
  double earliest = 1;
  int found = -1;
  for (std::size_t k = 0; k < events.size(); ++k) {
    if (!happened(k, signOf(events[k], next.time, next.q.data(), next.v.data()))) continue;
    // [low, high] keeps the sign before at low and the sign after at high.
    double low = 0, high = 1;
    while (high - low > 0x1p-45 && low < earliest) {
      const double middle = 0.5 * (low + high);
      const double t = now.time + middle * h;
      between(middle, shown_q.data(), shown_v.data());
      (happened(k, signOf(events[k], t, shown_q.data(), shown_v.data())) ? high : low) = middle;
    }
    if (found < 0 || high < earliest) {
      earliest = high;
      found = static_cast<int>(k);
    }
  }
  if (found < 0) return -1;
  // A speed that has come to zero is there, and not just past it.
  if (h == cut && earliest > 1 - soon) return found;
  // The step once more, as far as that. Its end is nearer the truth than the polynomial, which may be past the zero where it is not yet.
  const auto k = static_cast<std::size_t>(found);
  for (double more = 0x1p-45; earliest < 1; more *= 4) {
    retake(earliest * h);
    if (happened(k, signOf(events[k], next.time, next.q.data(), next.v.data()))) break;
    earliest = std::min(1.0, earliest + more);
  }
  if (earliest == 1) retake(h);
  whole_step = false;
  return found;
}

}  // namespace dyn
