// SPDX-License-Identifier: BSD-2-Clause
#include "compile/links.hpp"

#include "at.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace dyn {

void weldLinks(Skeleton& skeleton) {
  std::vector<Link>& links = skeleton.links;
  const std::size_t n = links.size();
  std::vector<int>&carrier = skeleton.carrier, &kept = skeleton.kept;
  std::vector<SE3<long double>>& pose = skeleton.pose;
  carrier.assign(n, 0);
  pose.assign(n, {});
  kept.assign(1, 0);
  for (std::size_t i = 1; i < n; ++i) {
    Link& link = links[i];
    const std::size_t parent = at(link.parent);
    link.placement = pose[parent] * link.placement;
    link.parent = carrier[parent];
    if (link.nv > 0) {
      carrier[i] = static_cast<int>(kept.size());
      kept.push_back(static_cast<int>(i));
    } else {
      carrier[i] = carrier[parent];
      pose[i] = link.placement;
    }
  }
  for (LinkFrame& frame : skeleton.frames) {
    frame.placement = pose[at(frame.body)] * frame.placement;
    frame.body = carrier[at(frame.body)];
  }
  for (std::size_t i = 1; i < kept.size(); ++i) links[i] = links[at(kept[i])];
  links.resize(kept.size());
}

namespace {

/// Replaces x by 0 if it is below the resolution of a rotation in doubles: URDFs say 1.5707963267948966 where they mean a quarter turn.
long double settled(long double x) { return std::fabs(x) < 1e-16L ? 0 : x; }

/// The rotation with the z axis of R that only exchanges axes, if that z axis is one of the parent's axes.
std::optional<Mat3<long double>> exchangeWithZ(const Mat3<long double>& R) {
  const Vec3<long double> z{settled(R(0, 2)), settled(R(1, 2)), settled(R(2, 2))};
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3;
    if (z[next] != 0 || z[(k + 2) % 3] != 0) continue;
    Vec3<long double> x{0, 0, 0};
    x[next] = 1;
    const Vec3<long double> y = cross(z, x);
    return Mat3<long double>{{x.x, y.x, z.x, x.y, y.y, z.y, x.z, y.z, z.z}};
  }
  return std::nullopt;
}

/// Moves the core frame of a joint's motion by X, seen from that frame. The motion of the described body stays the same.
void moveCore(Link& joint, const SE3<long double>& X) {
  joint.before = cast<double>(cast<long double>(joint.before) * X);
  joint.after = cast<double>(X.inverse() * cast<long double>(joint.after));
}
/// A body's described frame, seen from its core frame.
SE3<long double> describedInCore(const Link& body) { return cast<long double>(body.after); }

/// A joint along or about z moves the same in all frames turned about z. The function chooses the one in which the placement only exchanges axes.
/// Returns whether there is one.
bool turnAboutAxis(Link& body) {
  if (body.shape != Shape::revolute && body.shape != Shape::prismatic) return false;
  const Mat3<long double>& R = body.placement.R;
  const auto chosen = exchangeWithZ(R);
  if (!chosen) return false;
  const long double x = settled(dot(R.col(0), chosen->col(0))), y = settled(dot(R.col(1), chosen->col(0))), length = std::hypot(x, y);
  const Mat3<long double> turn{{x / length, -y / length, 0, y / length, x / length, 0, 0, 0, 1}}, described = *chosen * transpose(turn);
  // A placement that was described with few digits is not a rotation to the last digit, and stays as it is.
  for (int i = 0; i < 9; ++i)
    if (!(std::fabs(described.m[i] - R.m[i]) <= 1e-15L)) return false;
  body.placement.R = *chosen;
  moveCore(body, {turn, {}});
  return true;
}

/// A joint about z moves the same wherever its origin is on the axis. The class puts origins where axes cross their parents' axes, so that the joint
/// offsets become zero. Parents come first. An origin moves once, to the first crossing that is possible, and only nearer to the mass that it
/// carries: pivots are read from inertias about the origins, and lose digits if these inertias grow.
class OriginsOnAxes {
 public:
  OriginsOnAxes(const std::vector<Link>& bodies, const ExactInertias& inertias)
      : bodies_(bodies), origins_(bodies.size()), centre_(bodies.size()), settled_(bodies.size()) {
    findCentres(inertias);
    for (std::size_t i = 1; i < bodies.size(); ++i)
      if (bodies[i].parent != 0 && turnsOnly(bodies[i].shape)) meetParent(i);
  }
  std::vector<Origin> take() { return std::move(origins_); }

 private:
  /// Computes where the centres of mass of the described subtrees are along their joints' axes.
  void findCentres(const ExactInertias& inertias) {
    std::vector<long double> mass(bodies_.size());
    std::vector<Vec3<long double>> moment(bodies_.size());
    for (std::size_t i = bodies_.size() - 1; i >= 1; --i) {
      const Link& body = bodies_[i];
      mass[i] += inertias[i].mass;
      moment[i] += inertias[i].mass * inertias[i].com;
      if (mass[i] > 0) centre_[i] = moment[i].z / mass[i];
      const std::size_t parent = at(body.parent);
      mass[parent] += mass[i];
      moment[parent] += body.placement.R * moment[i] + mass[i] * body.placement.p;
    }
  }
  bool slides(std::size_t i) const { return bodies_[i].shape == Shape::revolute && !settled_[i]; }
  bool isNearer(std::size_t i, long double there) const { return there == 0 || std::fabs(there - centre_[i]) < std::fabs(centre_[i]); }
  /// Moves the origins of body i and of its parent to a common point, if they can be moved there.
  void meetParent(std::size_t i) {
    const std::size_t parent = at(bodies_[i].parent);
    const SE3<long double>& placement = bodies_[i].placement;
    Vec3<long double> p = placement.p;
    p.z -= origins_[parent].along;
    const Vec3<long double> z = placement.R.col(2);
    const long double least = 1e-16L * std::sqrt(dot(p, p));
    double own = 0, parents = 0;
    if (slides(parent)) {
      // Axes that are nearly parallel cross far away.
      const long double across = z.x * z.x + z.y * z.y;
      if (slides(i) && across > 0.25L) own = static_cast<double>(-(p.x * z.x + p.y * z.y) / across);
      parents = static_cast<double>(p.z + own * z.z);
    } else if (slides(i)) {
      own = static_cast<double>(-dot(p, z));
    }
    p += own * z;
    p.z -= parents;
    if (std::sqrt(dot(p, p)) > least || !isNearer(i, own) || !isNearer(parent, parents)) return;
    origins_[i].along = own;
    origins_[parent].along += parents;
    settled_[i] = settled_[parent] = origins_[i].met = true;
  }

  const std::vector<Link>& bodies_;
  std::vector<Origin> origins_;
  std::vector<long double> centre_;  ///< where the centre of mass of what the joint carries is on the axis, from the joint's described place
  std::vector<bool> settled_;
};

SE3<long double> alongAxis(const Origin& origin) { return {Mat3<long double>::identity(), {0, 0, origin.along}}; }

}  // namespace

void turnLinks(Skeleton& skeleton) {
  std::vector<Link>& links = skeleton.links;
  for (std::size_t i = 1; i < links.size(); ++i) {
    Link& body = links[i];
    body.placement = describedInCore(links[at(body.parent)]) * body.placement * cast<long double>(body.before);
    if (turnAboutAxis(body)) ++skeleton.along;
    if (body.before.R(2, 2) != 1) ++skeleton.turned;
  }
}

ExactInertias carriedInertias(const Skeleton& skeleton, const ExactInertias& described) {
  ExactInertias out(skeleton.links.size());
  for (std::size_t i = 1; i < described.size(); ++i) {
    const std::size_t carrier = at(skeleton.carrier[i]);
    // Inertias of bodies that are welded to the world have no effect.
    if (carrier == 0) continue;
    if (at(skeleton.kept[carrier]) == i) {
      out[carrier] = described[i];
    } else {
      out[carrier] = out[carrier] + described[i].transformed(skeleton.pose[i]);
    }
  }
  for (std::size_t i = 1; i < out.size(); ++i) out[i] = out[i].transformed(describedInCore(skeleton.links[i]));
  return out;
}

std::vector<Origin> originsOnAxes(const Skeleton& skeleton, const ExactInertias& inertias) { return OriginsOnAxes(skeleton.links, inertias).take(); }

void moveInertias(ExactInertias& inertias, const std::vector<Origin>& origins) {
  for (std::size_t i = 1; i < inertias.size(); ++i)
    if (origins[i].along != 0) inertias[i] = inertias[i].transformed(alongAxis(origins[i]).inverse());
}

void moveLinks(std::vector<Link>& links, std::vector<LinkFrame>& frames, const std::vector<Origin>& origins) {
  for (std::size_t i = 1; i < links.size(); ++i) {
    Link& body = links[i];
    const SE3<long double> there = alongAxis(origins[i]);
    body.placement = body.placement * there;
    body.placement.p.z -= origins[at(body.parent)].along;
    if (origins[i].met) body.placement.p = {};
    if (origins[i].along != 0) moveCore(body, there);
  }
  for (LinkFrame& frame : frames) frame.placement = describedInCore(links[at(frame.body)]) * frame.placement;
}

std::vector<bool> carryInertia(const std::vector<Link>& links, const ExactInertias& inertias) {
  std::vector<bool> carries(links.size(), false);
  for (std::size_t i = links.size() - 1; i >= 1; --i) {
    const Sym3<long double>& I = inertias[i].rotational;
    if (inertias[i].mass > 0 || I.xx > 0 || I.yy > 0 || I.zz > 0) carries[i] = true;
    if (carries[i]) carries[at(links[i].parent)] = true;
  }
  return carries;
}

}  // namespace dyn
