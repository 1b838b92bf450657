// SPDX-License-Identifier: BSD-2-Clause
// Steps with contacts. Impacts are located in time and answered with an impulse. Lasting contacts take steps at velocity level, which are of first
// order (Moreau 1988; Stewart and Trinkle 1996).
#include "at.hpp"
#include "integrate/simulator_impl.hpp"

#include <algorithm>
#include <cmath>

namespace dyn {

namespace {

using Gap = Unilateral::Gap;

bool has(const std::vector<std::int64_t>& keys, std::int64_t key) { return std::find(keys.begin(), keys.end(), key) != keys.end(); }

}  // namespace

void Simulator::Impl::glide(double share, double* q, double* v) {
  shown_u = share * contact_u;
  VectorMap(v, contact_v.size()) = contact_v;
  unilateral->chart().pointInHeldAxes(now.q.data(), shown_u.data(), v, q);
  for (std::size_t k = 0; k < stopped.size(); ++k)
    if (stopped[k]) v[unilateral->rubbing()[k].dof] = 0;
}

void Simulator::Impl::between(double theta, double* q, double* v) {
  if (!contact_step) return stepper->between(theta, now, next, q, v);
  glide(theta, q, v);
}

void Simulator::Impl::lookWithin() {
  looked_q[0] = now.q;
  looked_v[0] = now.v;
  for (int look = 1; look < looks; ++look) between(shareOf(look), looked_q[at(look)].data(), looked_v[at(look)].data());
  looked_q[looks] = next.q;
  looked_v[looks] = next.v;
}

double Simulator::Impl::lowestGap(double theta, double h) {
  between(theta, shown_q.data(), shown_v.data());
  double lowest = std::numeric_limits<double>::infinity();
  for (const Gap& gap : unilateral->look(now.time + theta * h, shown_q.data()))
    if (has(closing, gap.key)) lowest = std::min(lowest, gap.value);
  return lowest;
}

double Simulator::Impl::firstLimit() {
  double first = std::numeric_limits<double>::infinity();
  if (unilateral->limits() == 0) return first;
  lookWithin();
  for (int k = 0; k < unilateral->limits(); ++k) {
    Looks gaps;
    for (int look = 0; look <= looks; ++look) gaps[at(look)] = unilateral->limitGap(k, looked_q[at(look)].data());
    // A joint that starts beyond a limit and returns has not passed the limit.
    const auto left = std::find_if(gaps.begin(), gaps.end(), [](double gap) { return gap >= 0; });
    if (left == gaps.end()) continue;
    std::fill(gaps.begin(), left, *left);
    first = std::min(first, firstNegative(gaps, [&](double theta) {
                       between(theta, shown_q.data(), shown_v.data());
                       return unilateral->limitGap(k, shown_q.data());
                     }));
  }
  return first;
}

double Simulator::Impl::firstContact(double h, bool& near) {
  constexpr double infinity = std::numeric_limits<double>::infinity(), arrived = 0x1p-30;
  constexpr int most_looks = 256;
  near = true;
  if (!unilateral->looksAhead()) return infinity;
  // Steps of adaptive methods may be long: velocities within them may lie outside the range of those at the ends.
  const int samples = infoOf(options.integrator).adaptive ? looks : 1;
  velocities.resize(now.v.size(), samples + 1);
  velocities.col(0) = now.v;
  for (int k = 1; k < samples; ++k) {
    between(static_cast<double>(k) / samples, shown_q.data(), shown_v.data());
    velocities.col(k) = shown_v;
  }
  velocities.col(samples) = next.v;
  double share = 0;
  for (int look = 0; look < most_looks; ++look) {
    if (look > 0) between(share, shown_q.data(), shown_v.data());
    const double left = (1 - share) * h;
    const Approach x = unilateral->approach(now.time + share * h, look == 0 ? now.q.data() : shown_q.data(), velocities, left);
    if (look == 0) {
      unilateral->setReach(x.reach);
      near = std::isfinite(x.soonest);
    }
    const double clear = look == 0 ? x.clear : std::min(x.clear, x.soonest);
    if (clear >= left) return infinity;
    share += clear / h;
    if (clear < arrived * h) return std::min(share, 1.0);
  }
  near = true;
  return infinity;
}

double Simulator::Impl::touch(double h) {
  const double whole = h;
  bool near = true;
  double share = unilateral->hasFinder() ? firstContact(h, near) : std::numeric_limits<double>::infinity();
  if (share > 1 && !near && unilateral->limits() == 0) {
    touching.clear();
    return comeToRest(h);
  }
  gaps_after = unilateral->look(next.time, next.q.data());
  const auto anyClosed = [&] { return std::any_of(gaps_after.begin(), gaps_after.end(), [](const Gap& gap) { return !(gap.value >= 0); }); };
  if (share > 1 && !anyClosed()) share = firstLimit();
  // If a limit or contact is passed within the step, the step ends where it is passed.
  if (share < 1) {
    bool first = true;
    for (double more = 0x1p-30; first || (share < 1 && !anyClosed()); more *= 4) {
      first = false;
      share = std::min(1.0, share + more);
      h = share * whole;
      stepBy(h, now.time + h);
      project();
      whole_step = false;
      gaps_after = unilateral->look(next.time, next.q.data());
    }
  }
  if (!anyClosed()) {
    touching.clear();
    return comeToRest(h);
  }
  gaps_before = unilateral->look(now.time, now.q.data());
  between(0.5, shown_q.data(), shown_v.data());
  gaps_halfway = unilateral->look(now.time + 0.5 * h, shown_q.data());
  closing.clear();
  closing_pairs.clear();
  bool impact = false;
  double speed = 0;
  for (const Gap& gap : gaps_after) {
    if (gap.value >= 0) continue;
    // A parabola of the gap over time gives its closing speed, and how soon it would close again after a rebound. If the finder does not know the
    // contact at all three times, the velocities give both.
    const Gap *at_start = Unilateral::find(gaps_before, gap.key), *at_half = Unilateral::find(gaps_halfway, gap.key);
    double start = 1, a = 0, closing_speed = 0;
    if (at_start && at_half) {
      start = at_start->value;
      a = 4 * (gap.value - 2 * at_half->value + start) / (h * h);
      const double v = (gap.value - start) / h - 0.5 * a * h;
      closing_speed = std::sqrt(std::max(0.0, v * v - 2 * a * start));
    } else {
      unilateral->look(next.time, next.q.data());
      closing_speed = std::max(0.0, unilateral->closingSpeed(gap.key, next.q.data(), next.v.data()));
      a = (closing_speed - unilateral->closingSpeed(gap.key, next.q.data(), now.v.data())) / h;
    }
    // A rebound that is over within a step does not count: the contact rests.
    const bool rebounds = start > 0 && options.restitution * closing_speed > std::abs(a) * std::min(whole, options.dt);
    if (impact && !rebounds) continue;
    if (rebounds && !impact) {
      closing.clear();
      closing_pairs.clear();
    }
    impact = impact || rebounds;
    closing.push_back(gap.key);
    closing_pairs.push_back(gap.pair);
    speed = std::max(speed, closing_speed);
  }
  return impact ? collide(h, speed) : rest(h);
}

double Simulator::Impl::collide(double h, double speed) {
  double low = 0, high = 1;
  while (high - low > 0x1p-40) {
    const double middle = 0.5 * (low + high);
    (lowestGap(middle, h) < 0 ? high : low) = middle;
  }
  if (low == 0) return rest(h);
  const double part = low * h;
  stepBy(part, now.time + part);
  project();
  whole_step = false;
  const double rested = comeToRest(part);
  if (rested < part) return rested;
  // All contacts with a negligible gap take part in the impact.
  const double near = 1e-6 * options.dt * speed;
  unilateral->look(next.time, next.q.data());
  unilateral->choose([&](const Gap& gap) { return gap.value <= near; });
  if (!unilateral->anyChosen()) return part;
  const double* v = unilateral->impact(equations, next.time, next.q.data(), next.v.data(), options.restitution);
  after_impact = VectorResult(v, next.v.size());
  has_impact = true;
  closing.clear();
  for (const Gap& gap : unilateral->look(next.time, next.q.data()))
    if (gap.value <= near) closing.push_back(gap.key);
  countTouched(closing);
  ++equations.statistics.impacts;
  return part;
}

void Simulator::Impl::countTouched(const std::vector<std::int64_t>& now_touching) {
  for (const std::int64_t key : now_touching)
    if (!has(touching, key)) ++equations.statistics.touched;
  touching = now_touching;
}

void Simulator::Impl::findLost(const std::vector<Gap>& seen) {
  lost.clear();
  for (std::size_t k = 0; k < closing.size(); ++k)
    if (Unilateral::find(seen, closing[k]) == nullptr) lost.push_back(closing_pairs[k]);
}

double Simulator::Impl::rest(double h) {
  // Adaptive steps may be long. A contact step is of first order, so it is at most dt long.
  const double part = h <= (1 + slack) * options.dt ? h : options.dt, end = part == h ? next.time : now.time + part;
  whole_step = whole_step && part == h;
  constexpr int most_rounds = 8;
  for (int round = 0; round < most_rounds; ++round) {
    findLost(unilateral->look(now.time, now.q.data()));
    unilateral->choose([&](const Gap& gap) { return has(closing, gap.key) || has(lost, gap.pair); }, resting);
    if (!unilateral->anyChosen()) break;  // the finder reported it only later in the step: the next step will see it
    contact_v = VectorResult(unilateral->step(equations, now.time, now.q.data(), now.v.data(), part), next.v.size());
    contact_u = unilateral->displacement();
    unilateral->markHeld(stopped);
    glide(1, next.q.data(), next.v.data());
    next.time = end;
    next.has_acceleration = false;
    contact_step = true;
    const std::size_t known = closing.size();
    for (const Gap& gap : unilateral->look(end, next.q.data()))
      if (gap.value < 0 && !has(closing, gap.key)) {
        closing.push_back(gap.key);
        closing_pairs.push_back(gap.pair);
      }
    // Friction does not reverse a joint's motion: a joint that would reverse rests.
    const bool turns = markTurned(next.v);
    for (std::size_t k = 0; turns && k < turned.size(); ++k) resting[k] = resting[k] || turned[k];
    if (closing.size() == known && !turns) break;
  }
  checkFinite(next, part);
  project();
  ++equations.statistics.contact_steps;
  if (contact_step) countTouched(closing);
  return contact_step ? part : h;
}

}  // namespace dyn
