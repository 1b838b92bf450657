// SPDX-License-Identifier: BSD-2-Clause
#include "task.hpp"

#include <dyn/geometry/collision.hpp>
#include <dyn/geometry/distance.hpp>

namespace dyn::tool::sweep {

namespace {

class CollideTask final : public Task {
 public:
  explicit CollideTask(const Setting& setting) : model_(setting.model), geometry_(*setting.geometry), data_(model_), placed_(geometry_) {
    if (geometry_.pairs().empty()) setting.study.value().fail("the model has no pairs of volumes to compare", ErrorCode::model);
  }

  const std::vector<Field>& fields() const override {
    static const std::vector<Field> all{{"collides", {}, true}, {"collisions", {}}, {"distance", {}}, {"nearest_pair", {}}};
    return all;
  }

  void run(const Inputs& inputs, double* row) override {
    updateGeometryPlacements(model_, data_, geometry_, placed_, inputs.q);
    const auto collisions = static_cast<double>(computeCollisions(geometry_, placed_).size());
    const Distance least = computeMinimumDistance(geometry_, placed_);
    if (least.pair < 0) throw Error(ErrorCode::argument, "all distances are infinite");
    row[0] = collisions > 0;
    row[1] = collisions;
    row[2] = least.distance;
    row[3] = least.pair;
  }

  Json pairs() const override {
    Json out = Json::array();
    for (const CollisionPair& pair : geometry_.pairs())
      out.push_back({geometry_.geometries()[static_cast<std::size_t>(pair.a)].name, geometry_.geometries()[static_cast<std::size_t>(pair.b)].name});
    return out;
  }

 private:
  CompactModel model_;
  GeometryModel geometry_;
  Data data_;
  GeometryData placed_;
};

}  // namespace

std::unique_ptr<Task> collideTask(const Setting& setting) { return std::make_unique<CollideTask>(setting); }

}  // namespace dyn::tool::sweep
