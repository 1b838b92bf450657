#include <dyn/algorithm/kinematics.hpp>
#include <dyn/error.hpp>
#include <dyn/integrate/contacts.hpp>

#include <cmath>
#include <memory>

namespace dyn {

ContactFinder pointsOnPlane(const CompactModel& model, const std::vector<std::string>& frames, const Vec3<double>& normal, double height,
                            double friction) {
  const double length = std::sqrt(dot(normal, normal));
  if (!(length > 0) || !std::isfinite(length)) throw Error(ErrorCode::argument, "pointsOnPlane: the normal has no direction");
  if (!(friction >= 0) || !std::isfinite(friction))
    throw Error(ErrorCode::argument, "pointsOnPlane: friction is " + std::to_string(friction) + "; it is a number that is not negative");
  if (!std::isfinite(height)) throw Error(ErrorCode::argument, "pointsOnPlane: the height is " + std::to_string(height) + "; it must be finite");
  std::vector<ContactPoint> points;
  for (const std::string& name : frames) {
    ContactPoint point;
    point.id = static_cast<std::int64_t>(points.size());
    point.frame = model.frameId(name);
    if (point.frame < 0) throw Error(ErrorCode::argument, "pointsOnPlane: the model has no frame '" + name + "'");
    point.normal = (1 / length) * normal;
    point.friction = friction;
    points.push_back(point);
  }
  const auto data = std::make_shared<Data>(model);
  return [model, points, data, height](const VectorResult& q, std::vector<ContactPoint>& found) {
    forwardKinematics(model, *data, VectorArg(q.data(), q.size()));
    for (ContactPoint point : points) {
      point.gap = dot(point.normal, framePlacement(model, *data, point.frame).p) - height;
      found.push_back(point);
    }
  };
}

}  // namespace dyn
