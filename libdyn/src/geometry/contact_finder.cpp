// SPDX-License-Identifier: BSD-2-Clause
#include "at.hpp"
#include "geometry/narrow/manifold.hpp"
#include "geometry/queries.hpp"
#include "number_text.hpp"

#include <dyn/algorithm/kinematics.hpp>
#include <dyn/geometry/contact_finder.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

namespace dyn {

namespace {

constexpr std::size_t most = 8;  ///< contacts of a pair in which a volume has many pieces

[[noreturn]] void refuse(const std::string& what) { throw Error(ErrorCode::argument, "geometryContacts: " + what); }

void checkFriction(double friction) {
  if (!(friction >= 0) || !std::isfinite(friction)) refuse("friction is " + number(friction) + "; it is a number that is not negative");
}

class Finder {
 public:
  Finder(const CompactModel& model, const GeometryModel& geometry, const GeometryContactOptions& options)
      : model_(model), geometry_(geometry), margin_(options.margin), data_(model), placed_(geometry, 0) {
    if (!(margin_ >= 0) || !std::isfinite(margin_)) refuse("the margin is " + number(margin_) + "; it is a number that is not negative");
    for (const GeometryRecord& r : geometry.geometries()) {
      const int frame = r.joint == 0 ? 0 : model.findFrame(r.body);
      if (frame < 0) refuse("the model has no frame of the body '" + r.body + "' that '" + r.name + "' is on");
      frames_.push_back(frame);
      in_frame_.push_back(r.joint == 0 ? r.placement : model.frames()[at(frame)].placement.inverse() * r.placement);
    }
    of_joint_.resize(model.joints().size());
    for (std::size_t g = 0; g < geometry.geometries().size(); ++g) of_joint_[at(geometry.geometries()[g].joint)].push_back(static_cast<int>(g));
    checkFriction(options.friction);
    friction_.assign(geometry.pairs().size(), options.friction);
    std::vector<int> corners;
    for (const auto& volume : geometry.impl().volumes) {
      corners.push_back(0);
      for (int k = 0; k < volume->pieces(); ++k) corners.back() = std::max(corners.back(), cornerIds(volume->piece(k)));
    }
    std::int64_t next = 0;
    for (const auto& [a, b] : geometry.impl().pairs) {
      ids_.push_back({next, {std::max(corners[at(a)], corners[at(b)])}});
      next += ids_.back().ids.count() * geometry.impl().volumes[at(a)]->pieces() * geometry.impl().volumes[at(b)]->pieces();
    }
    for (const PairFriction& p : options.pairs) setFriction(p);
  }

  void find(const VectorResult& q, double reach, std::vector<ContactPoint>& found) {
    const GeometryImpl& m = geometry_.impl();
    GeometryDataImpl& d = placed_.impl();
    const double within = std::max(margin_, reach);
    d.margin = within;
    updateGeometryPlacements(model_, data_, geometry_, placed_, VectorArg(q.data(), q.size()));
    for (const int pair : nearPairs(m, d)) {
      if (sphereBound(m, d, pair) > within) continue;
      const PlacedPair p = placed(m, d, pair);
      const auto [a, b] = m.pairs[at(pair)];
      // Held joints may join both geometries to one rigid body; forces within it do nothing.
      if (m.records[at(a)].joint == m.records[at(b)].joint) continue;
      if (!p.a.bounded() && !p.b.bounded()) continue;
      points_.clear();
      p.contacts(within, [&](const NearPieces& x) {
        Separation s = x.s;
        s.on_a -= x.center;
        s.on_b -= x.center;
        const auto& [first_of_pair, ids] = ids_[at(pair)];
        const Manifold touching = manifold(x.a, x.b, x.aMb, s, ids);
        const std::int64_t first = first_of_pair + ids.count() * p.b.pieces() * x.number[0] + ids.count() * x.number[1];
        for (int k = 0; k < touching.count; ++k) {
          const TouchingPoint& t = touching.points[k];
          if (t.gap <= within) points_.push_back({x.center + t.on_a, s.normal, t.gap, first + t.id});
        }
        return true;
      });
      if (!p.a.single() || !p.b.single()) thinOut();
      if (isCovered(pair, p)) continue;
      for (const Found& x : points_) found.push_back(contact(pair, p, x));
    }
  }

  Approach look(const VectorResult& q, const MatrixResult& velocities, double seconds) {
    const GeometryImpl& m = geometry_.impl();
    GeometryDataImpl& d = placed_.impl();
    const auto states = static_cast<std::size_t>(velocities.cols());
    motions_.resize(states * m.records.size());
    double fastest = 0;
    for (std::size_t k = 0; k < states; ++k) {
      const auto column = static_cast<Eigen::Index>(k);
      forwardKinematics(model_, data_, VectorArg(q.data(), q.size()), VectorArg(velocities.col(column).data(), velocities.rows()));
      for (const int g : m.moving) {
        PieceMotion& x = motions_[k * m.records.size() + at(g)];
        x = motionOf(g);
        fastest = std::max(fastest, norm(x.centre) + x.turning);
      }
    }
    // Two geometries may move towards each other, and the box of each grows by this margin.
    d.margin = 1.25 * fastest * seconds;
    updateGeometryPlacements(model_, data_, geometry_, placed_);
    Approach out;
    for (const int pair : nearPairs(m, d)) {
      const auto [a, b] = m.pairs[at(pair)];
      if (m.records[at(a)].joint == m.records[at(b)].joint) continue;
      const PlacedPair p = placed(m, d, pair);
      if (p.a.empty() || p.b.empty() || (!p.a.bounded() && !p.b.bounded())) continue;
      double fastest_of_pair = 0;  // bound for any normal
      for (std::size_t k = 0; k < states; ++k) {
        const PieceMotion &x = motions_[k * m.records.size() + at(a)], &y = motions_[k * m.records.size() + at(b)];
        fastest_of_pair = std::max(fastest_of_pair, norm(y.centre - x.centre) + x.turning + y.turning);
      }
      const double within = 1.25 * fastest_of_pair * seconds;
      if (sphereBound(m, d, pair) > within) continue;
      const Separation s = p.nearest(within);
      if (!(s.distance < within)) continue;
      const Vec3<double> normal = p.oMa.R * s.normal;
      double speed = 0;
      for (std::size_t k = 0; k < states; ++k) {
        const PieceMotion &x = motions_[k * m.records.size() + at(a)], &y = motions_[k * m.records.size() + at(b)];
        speed = std::max(speed, dot(normal, x.centre - y.centre) + x.turning + y.turning);
      }
      out.add(s.distance, speed, seconds, roomOf(p.a) + roomOf(p.b));
    }
    // A body that touches something may be thrown at something else, so the reach covers more than the present motion.
    out.reach = std::max(out.reach, 4 * fastest * seconds);
    return out;
  }

 private:
  /// True if the contacts found for a pair lie on a seam: another volume of the same body adjoins the touched surface from outside. The body has
  /// no surface there.
  bool isCovered(int pair, const PlacedPair& p) const {
    if (points_.empty()) return false;
    Vec3<double> middle, normal;
    for (const Found& x : points_) {
      middle += (1.0 / static_cast<double>(points_.size())) * (x.on_a + 0.5 * x.gap * x.normal);
      normal += x.normal;
    }
    const double length = norm(normal);
    if (!(length > 0)) return false;
    const Vec3<double> at_middle = p.oMa.act(middle), away = (1 / length) * (p.oMa.R * normal);
    const auto [a, b] = geometry_.impl().pairs[at(pair)];
    return covers(a, b, at_middle, away) || covers(b, a, at_middle, -away);
  }
  /// True if a point just outside the surface of geometry `of` lies in another volume of the same body that is also checked against `other`.
  bool covers(int of, int other, const Vec3<double>& point, const Vec3<double>& outwards) const {
    const GeometryImpl& m = geometry_.impl();
    const GeometryDataImpl& d = placed_.impl();
    const int joint = m.records[at(of)].joint;
    static const Volume probe = Volume::solid(Convex{});
    for (const int g : of_joint_[at(joint)]) {
      const Volume& volume = *m.volumes[at(g)];
      if (g == of || !volume.bounded() || m.pairOf(g, other) < 0) continue;
      const double size = std::min(volume.radius(), m.volumes[at(of)]->bounded() ? m.volumes[at(of)]->radius() : volume.radius());
      const Vec3<double> before = point + 1e-4 * size * outwards;
      if (norm(before - d.center[at(g)]) > volume.radius() + size) continue;
      const SE3<double> there{Mat3<double>::identity(), d.placement[at(g)].actInv(before)};
      // libdyn's own functions: the probe is smaller than FCL's tolerance.
      if (nearest(volume, probe, there, {}, size).distance < 1e-5 * size) return true;
    }
    return false;
  }

  /// Velocity of the centre of a volume's bounding sphere in the world, and an upper bound of the speed of its points relative to that centre.
  struct PieceMotion {
    Vec3<double> centre;
    double turning = 0;
  };
  PieceMotion motionOf(int g) const {
    const GeometryRecord& r = geometry_.geometries()[at(g)];
    const Volume& volume = *geometry_.impl().volumes[at(g)];
    if (r.joint == 0) return {};
    const Motion<double> v = jointVelocity(model_, data_, r.joint, ReferenceFrame::LOCAL_WORLD_ALIGNED);
    const Vec3<double> centre =
        jointPlacement(model_, data_, r.joint).R * (volume.bounded() ? r.placement.act(volume.bounds().center()) : r.placement.p);
    // The margin is round: a rotation moves the surface no more than it moves the core.
    const double radius = !volume.bounded() ? 0 : volume.single() ? volume.radius() - volume.piece(0).margin : volume.radius();
    return {v.linear + cross(v.angular, centre), norm(v.angular) * std::max(radius, 0.0)};
  }
  /// Half of the shortest side of the volume's bounding box [m]; infinite for a half-space.
  static double roomOf(const Volume& volume) {
    if (!volume.bounded()) return std::numeric_limits<double>::infinity();
    const Vec3<double> half = volume.bounds().half();
    return std::min({half.x, half.y, half.z});
  }

  /// Contact ids of a pair of geometries. Each pair of pieces has its own range of ids; the ranges follow one another.
  struct PairIds {
    std::int64_t first;
    TouchingIds ids;  ///< sized for the piece with the most corner names
  };
  /// A contact point in the axes of geometry a.
  struct Found {
    Vec3<double> on_a, normal;
    double gap;
    std::int64_t id;
  };

  void setFriction(const PairFriction& p) {
    checkFriction(p.friction);
    bool any = false;
    for (std::size_t k = 0; k < friction_.size(); ++k) {
      const CollisionPair& pair = geometry_.pairs()[k];
      const auto called = [&](int geometry, const std::string& name) {
        const GeometryRecord& r = geometry_.geometries()[at(geometry)];
        return r.name == name || r.body == name;
      };
      const bool meant = (called(pair.a, p.names.a) && called(pair.b, p.names.b)) || (called(pair.a, p.names.b) && called(pair.b, p.names.a));
      if (meant) friction_[k] = p.friction;
      any = any || meant;
    }
    if (!any) refuse("no pair is of '" + p.names.a + "' and '" + p.names.b + "'");
  }

  /// Keeps at most `most` points of a pair with many pieces: first the point farthest from their mean, then repeatedly the point farthest from
  /// all chosen ones. The point with the smallest gap is always kept.
  void thinOut() {
    if (points_.empty()) return;
    Vec3<double> middle;
    for (const Found& x : points_) middle += (1.0 / static_cast<double>(points_.size())) * x.on_a;
    const auto farther = [&](const Found& x, const Found& y) { return norm(x.on_a - middle) < norm(y.on_a - middle); };
    const auto lower = [](const Found& x, const Found& y) { return x.gap < y.gap; };
    const Found lowest = *std::min_element(points_.begin(), points_.end(), lower);
    std::iter_swap(points_.begin(), std::max_element(points_.begin(), points_.end(), farther));
    std::size_t chosen = 1;
    for (; chosen < std::min(most, points_.size()); ++chosen) {
      double farthest = 0;
      std::size_t next = chosen;
      for (std::size_t k = chosen; k < points_.size(); ++k) {
        double nearest = std::numeric_limits<double>::infinity();
        for (std::size_t c = 0; c < chosen; ++c) nearest = std::min(nearest, norm(points_[k].on_a - points_[c].on_a));
        if (nearest > farthest) farthest = nearest, next = k;
      }
      if (farthest == 0) break;  // pieces share corners
      std::swap(points_[chosen], points_[next]);
    }
    points_.resize(chosen);
    if (lower(lowest, *std::min_element(points_.begin(), points_.end(), lower))) points_.back() = lowest;
  }

  /// The contact point belongs to a body that moves (a, if it moves), and the surface to the other body.
  ContactPoint contact(int pair, const PlacedPair& p, const Found& x) const {
    const auto [a, b] = geometry_.impl().pairs[at(pair)];
    const Vec3<double> on_b = p.aMb.actInv(x.on_a + x.gap * x.normal), normal_b = transposeTimes(p.aMb.R, x.normal);
    const bool of_a = frames_[at(a)] != 0;
    const auto mine = at(of_a ? a : b), other = at(of_a ? b : a);
    ContactPoint point;
    point.id = x.id;
    point.frame = frames_[mine];
    point.point = in_frame_[mine].act(of_a ? x.on_a : on_b);
    point.other = frames_[other];
    point.normal = in_frame_[other].R * (of_a ? -normal_b : x.normal);
    point.gap = x.gap;
    point.friction = friction_[at(pair)];
    return point;
  }

  CompactModel model_;
  GeometryModel geometry_;
  double margin_;
  Data data_;
  GeometryData placed_;
  std::vector<int> frames_;            ///< by geometry
  std::vector<SE3<double>> in_frame_;  ///< by geometry: its pose in that frame
  std::vector<double> friction_;       ///< by pair
  std::vector<PairIds> ids_;           ///< by pair
  std::vector<Found> points_;
  std::vector<std::vector<int>> of_joint_;  ///< geometries, by joint
  std::vector<PieceMotion> motions_;        ///< by velocity, then by geometry; zero for static geometries
};

}  // namespace

ContactFinder geometryContacts(const CompactModel& model, const GeometryModel& geometry, const GeometryContactOptions& options) {
  const auto finder = std::make_shared<Finder>(model, geometry, options);
  return {[finder](const VectorResult& q, double reach, std::vector<ContactPoint>& found) { finder->find(q, reach, found); },
          [finder](const VectorResult& q, const MatrixResult& velocities, double seconds) { return finder->look(q, velocities, seconds); }};
}

}  // namespace dyn
