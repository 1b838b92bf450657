// SPDX-License-Identifier: BSD-2-Clause
#include "number_text.hpp"

#include <dyn/algorithm/kinematics.hpp>
#include <dyn/error.hpp>
#include <dyn/integrate/contacts.hpp>
#include <dyn/near_names.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

namespace dyn {

ContactFinder pointsOnPlane(const CompactModel& model, const std::vector<std::string>& frames, const Vec3<double>& normal, double height,
                            double friction) {
  const double length = std::sqrt(dot(normal, normal));
  if (!(length > 0) || !std::isfinite(length)) throw Error(ErrorCode::argument, "pointsOnPlane: the normal has no direction");
  if (!(friction >= 0) || !std::isfinite(friction))
    throw Error(ErrorCode::argument, "pointsOnPlane: friction is " + number(friction) + "; it is a number that is not negative");
  if (!std::isfinite(height)) throw Error(ErrorCode::argument, "pointsOnPlane: the height is " + number(height) + "; it must be finite");
  std::vector<ContactPoint> points;
  for (const std::string& name : frames) {
    ContactPoint point;
    point.id = static_cast<std::int64_t>(points.size());
    point.frame = model.findFrame(name);
    if (point.frame < 0)
      throw Error(ErrorCode::argument, "pointsOnPlane: the model has no frame '" + name + "'" + nearNames(name, namesOf(model.frames())));
    point.normal = (1 / length) * normal;
    point.friction = friction;
    points.push_back(point);
  }
  const auto data = std::make_shared<Data>(model);
  const auto gapOf = [model, data, height](const ContactPoint& point) {
    return dot(point.normal, framePlacement(model, *data, point.frame).p) - height;
  };
  const auto find = [model, points, data, gapOf](const VectorResult& q, double, std::vector<ContactPoint>& found) {
    forwardKinematics(model, *data, VectorArg(q.data(), q.size()));
    for (ContactPoint point : points) {
      point.gap = gapOf(point);
      found.push_back(point);
    }
  };
  const auto look = [model, points, data, gapOf](const VectorResult& q, const MatrixResult& velocities, double seconds) {
    Approach out;
    std::vector<double> speeds(points.size(), 0.0);
    for (Eigen::Index k = 0; k < velocities.cols(); ++k) {
      forwardKinematics(model, *data, VectorArg(q.data(), q.size()), VectorArg(velocities.col(k).data(), velocities.rows()));
      for (std::size_t i = 0; i < points.size(); ++i)
        speeds[i] =
            std::max(speeds[i], -dot(points[i].normal, frameVelocity(model, *data, points[i].frame, ReferenceFrame::LOCAL_WORLD_ALIGNED).linear));
    }
    for (std::size_t i = 0; i < points.size(); ++i) out.add(gapOf(points[i]), speeds[i], seconds, std::numeric_limits<double>::infinity());
    return out;
  };
  return {find, look};
}

void Approach::add(double gap, double speed, double seconds, double room) {
  // Velocities change direction and differ a little from the known ones, so the speed gets a reserve.
  speed *= 1.125;
  reach = std::max(reach, 2 * speed * seconds);
  if (!(gap < speed * seconds)) return;
  const double time = gap / speed;
  if (time < 0x1p-10 * seconds && speed * seconds < 0.5 * room) {
    soonest = std::min(soonest, std::max(time, 0.0));
  } else {
    clear = std::min(clear, std::max(time, 0.0));
  }
}

ContactFinder together(const ContactFinder& a, const ContactFinder& b) {
  if (!a || !b) return a ? a : b;
  const auto find = [a, b](const VectorResult& q, double reach, std::vector<ContactPoint>& found) {
    const std::size_t before = found.size();
    a(q, found, reach);
    const std::size_t middle = found.size();
    b(q, found, reach);
    for (std::size_t k = before; k < found.size(); ++k) found[k].id = 2 * found[k].id + (k < middle ? 0 : 1);
  };
  if (!a.looksAhead() || !b.looksAhead()) return {find, nullptr};
  return {find, [a, b](const VectorResult& q, const MatrixResult& velocities, double seconds) {
            const Approach x = a.approach(q, velocities, seconds), y = b.approach(q, velocities, seconds);
            return Approach{std::min(x.clear, y.clear), std::min(x.soonest, y.soonest), std::max(x.reach, y.reach)};
          }};
}

}  // namespace dyn
