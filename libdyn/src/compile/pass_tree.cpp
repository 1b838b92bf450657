// SPDX-License-Identifier: BSD-2-Clause
// The passes that order, remove and move bodies (order, weld, canonicalise), and the pass that inspects the result.
#include "at.hpp"
#include "compile/compact_impl.hpp"
#include "compile/draft.hpp"

#include <algorithm>
#include <cmath>

namespace dyn {

namespace {

/// Puts bodies into the order of `old_of_new` and renumbers every reference to them. Bodies that are not in it are dropped, so nothing may refer to
/// them.
void renumber(Draft& draft, const std::vector<int>& old_of_new) {
  std::vector<int> new_of_old(draft.bodies.size(), -1);
  std::vector<DraftBody> bodies;
  bodies.reserve(old_of_new.size());
  for (std::size_t i = 0; i < old_of_new.size(); ++i) {
    new_of_old[at(old_of_new[i])] = static_cast<int>(i);
    bodies.push_back(std::move(draft.bodies[at(old_of_new[i])]));
  }
  for (std::size_t i = 1; i < bodies.size(); ++i) {
    bodies[i].parent = new_of_old[at(bodies[i].parent)];
    if (bodies[i].coupling) bodies[i].coupling->master = new_of_old[at(bodies[i].coupling->master)];
  }
  for (DraftFrame& frame : draft.frames) frame.body = new_of_old[at(frame.body)];
  draft.bodies = std::move(bodies);
}

}  // namespace

void orderDepthFirst(Draft& draft) {
  const std::size_t n = draft.bodies.size();
  // Children stay in description order. A stack replaces recursion, because chains may be long.
  std::vector<std::vector<int>> children(n);
  for (std::size_t i = n - 1; i >= 1; --i) children[at(draft.bodies[i].parent)].push_back(static_cast<int>(i));
  std::vector<int> order, stack{0};
  order.reserve(n);
  while (!stack.empty()) {
    const int i = stack.back();
    stack.pop_back();
    order.push_back(i);
    stack.insert(stack.end(), children[at(i)].begin(), children[at(i)].end());
  }
  renumber(draft, order);
  // Every body is a frame of its own, in this order; the described extra frames follow.
  std::vector<DraftFrame> frames;
  for (std::size_t i = 0; i < n; ++i)
    if (i == 0 || draft.bodies[i].last_part) frames.push_back({draft.bodies[i].name, static_cast<int>(i), {}});
  frames.insert(frames.end(), draft.frames.begin(), draft.frames.end());
  draft.frames = std::move(frames);
  draft.report.passes.push_back("order: depth first, " + std::to_string(draft.frames.size()) + " frames");
}

void weld(Draft& draft) {
  const std::size_t n = draft.bodies.size();
  std::vector<int> carrier(n), kept{0};   // the moving body that carries each body
  std::vector<SE3<long double>> pose(n);  // its pose in that body's frame
  for (std::size_t i = 1; i < n; ++i) {
    DraftBody& body = draft.bodies[i];
    const std::size_t parent = at(body.parent);
    if (body.instance.nv > 0) {
      body.placement = pose[parent] * body.placement;
      body.parent = carrier[parent];
      carrier[i] = static_cast<int>(i);
      kept.push_back(static_cast<int>(i));
    } else {
      carrier[i] = carrier[parent];
      pose[i] = pose[parent] * body.placement;
      // Inertias of bodies that are welded to the world have no effect.
      if (carrier[i] != 0) {
        DraftBody& to = draft.bodies[at(carrier[i])];
        to.inertia = to.inertia + body.inertia.transformed(pose[i]);
      }
    }
  }
  for (DraftFrame& frame : draft.frames) {
    frame.placement = pose[at(frame.body)] * frame.placement;
    frame.body = carrier[at(frame.body)];
  }
  renumber(draft, kept);
  draft.report.passes.push_back("weld: " + std::to_string(n - kept.size()) + " bodies welded to others, " + std::to_string(kept.size() - 1) +
                                " move");
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
void moveCore(JointInstance& joint, const SE3<long double>& X) {
  joint.before = cast<double>(cast<long double>(joint.before) * X);
  joint.after = cast<double>(X.inverse() * cast<long double>(joint.after));
}
/// A body's described frame, seen from its core frame.
SE3<long double> describedInCore(const DraftBody& body) { return cast<long double>(body.instance.after); }

/// A joint along or about z moves the same in all frames turned about z. The function chooses the one in which the placement only exchanges axes.
/// Returns whether there is one.
bool turnAboutAxis(DraftBody& body) {
  if (body.instance.shape != Shape::revolute && body.instance.shape != Shape::prismatic) return false;
  const Mat3<long double>& R = body.placement.R;
  const auto chosen = exchangeWithZ(R);
  if (!chosen) return false;
  const long double x = settled(dot(R.col(0), chosen->col(0))), y = settled(dot(R.col(1), chosen->col(0))), length = std::hypot(x, y);
  const Mat3<long double> turn{{x / length, -y / length, 0, y / length, x / length, 0, 0, 0, 1}}, described = *chosen * transpose(turn);
  // A placement that was described with few digits is not a rotation to the last digit, and stays as it is.
  for (int i = 0; i < 9; ++i)
    if (!(std::fabs(described.m[i] - R.m[i]) <= 1e-15L)) return false;
  body.placement.R = *chosen;
  moveCore(body.instance, {turn, {}});
  return true;
}

/// A joint about z moves the same wherever its origin is on the axis. The class puts origins where axes cross their parents' axes, so that the joint
/// offsets become zero. Parents come first. An origin moves once, to the first crossing that is possible, and only nearer to the mass that it
/// carries: pivots are read from inertias about the origins, and lose digits if these inertias grow.
class OriginsOnAxes {
 public:
  explicit OriginsOnAxes(std::vector<DraftBody>& bodies)
      : bodies_(bodies), along_(bodies.size()), centre_(bodies.size()), settled_(bodies.size()), met_(bodies.size()) {
    findCentres();
    for (std::size_t i = 1; i < bodies.size(); ++i)
      if (bodies[i].parent != 0 && turnsOnly(bodies[i].instance.shape)) meetParent(i);
  }
  /// Moves the origins. Returns how many joint offsets became zero.
  int put() {
    for (std::size_t i = 1; i < bodies_.size(); ++i) {
      DraftBody& body = bodies_[i];
      const SE3<long double> there{Mat3<long double>::identity(), {0, 0, along_[i]}};
      body.placement = body.placement * there;
      body.placement.p.z -= along_[at(body.parent)];
      if (met_[i]) body.placement.p = {};
      if (along_[i] == 0) continue;
      body.inertia = body.inertia.transformed(there.inverse());
      moveCore(body.instance, there);
    }
    return static_cast<int>(std::count(met_.begin(), met_.end(), true));
  }

 private:
  /// Computes where the centres of mass of the described subtrees are along their joints' axes.
  void findCentres() {
    std::vector<long double> mass(bodies_.size());
    std::vector<Vec3<long double>> moment(bodies_.size());
    for (std::size_t i = bodies_.size() - 1; i >= 1; --i) {
      const DraftBody& body = bodies_[i];
      mass[i] += body.inertia.mass;
      moment[i] += body.inertia.mass * body.inertia.com;
      if (mass[i] > 0) centre_[i] = moment[i].z / mass[i];
      const std::size_t parent = at(body.parent);
      mass[parent] += mass[i];
      moment[parent] += body.placement.R * moment[i] + mass[i] * body.placement.p;
    }
  }
  bool slides(std::size_t i) const { return bodies_[i].instance.shape == Shape::revolute && !settled_[i]; }
  bool isNearer(std::size_t i, long double there) const { return there == 0 || std::fabs(there - centre_[i]) < std::fabs(centre_[i]); }
  /// Moves the origins of body i and of its parent to a common point, if they can be moved there.
  void meetParent(std::size_t i) {
    const std::size_t parent = at(bodies_[i].parent);
    const SE3<long double>& placement = bodies_[i].placement;
    Vec3<long double> p = placement.p;
    p.z -= along_[parent];
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
    along_[i] = own;
    along_[parent] += parents;
    settled_[i] = settled_[parent] = met_[i] = true;
  }

  std::vector<DraftBody>& bodies_;
  std::vector<long double> along_;   ///< where the origin is on the axis, from its described place
  std::vector<long double> centre_;  ///< the same for the centre of mass of what the joint carries
  std::vector<bool> settled_, met_;
};

}  // namespace

void canonicalise(Draft& draft) {
  int turned = 0, along = 0;
  for (std::size_t i = 1; i < draft.bodies.size(); ++i) {
    DraftBody& body = draft.bodies[i];
    body.placement = describedInCore(draft.bodies[at(body.parent)]) * body.placement * cast<long double>(body.instance.before);
    if (turnAboutAxis(body)) ++along;
    body.inertia = body.inertia.transformed(describedInCore(body));
    const Mat3<double>& R = body.instance.before.R;
    if (R(2, 2) != 1) ++turned;
  }
  const int met = OriginsOnAxes(draft.bodies).put();
  for (DraftFrame& frame : draft.frames) frame.placement = describedInCore(draft.bodies[at(frame.body)]) * frame.placement;
  draft.report.passes.push_back("canonicalise: " + std::to_string(turned) + " joint axes turned onto z, " + std::to_string(along) +
                                " along axes of their parents, " + std::to_string(met) + " origins where they cross");
}

void inspect(Draft& draft) {
  std::vector<bool> carries(draft.bodies.size(), false);
  for (std::size_t i = draft.bodies.size() - 1; i >= 1; --i) {
    const DraftBody& body = draft.bodies[i];
    const Sym3<long double>& I = body.inertia.rotational;
    if (body.inertia.mass > 0 || I.xx > 0 || I.yy > 0 || I.zz > 0) carries[i] = true;
    if (carries[i]) carries[at(body.parent)] = true;
  }
  for (std::size_t i = 1; i < draft.bodies.size(); ++i) {
    const DraftBody& body = draft.bodies[i];
    const bool armature = std::any_of(body.joint.armature.begin(), body.joint.armature.end(), [](double x) { return x > 0; });
    if (!carries[i] && !armature && !body.coupling)
      draft.report.warnings.push_back("joint '" + body.joint.name +
                                      "' moves nothing that has mass: the mass matrix is singular, forward dynamics will refuse");
  }
}

}  // namespace dyn
