// SPDX-License-Identifier: BSD-2-Clause
// FCL's functions for two volumes, where a user chooses them, beside libdyn's own.
#include "geometry/scene.hpp"
#include "support/shared.hpp"

#include <dyn/geometry/contact_finder.hpp>
#include <dyn/parsers/urdf.hpp>

using namespace dyn;
using namespace dyn::test;
namespace g = dyn::geometry;

namespace {

GeometryOptions byFcl(double tolerance = 1e-6) {
  GeometryOptions options;
  options.missing = GeometryOptions::Missing::skip;
  options.narrow = GeometryOptions::Narrow::fcl;
  options.fcl_tolerance = tolerance;
  return options;
}

/// One description compiled for libdyn's functions and for FCL's.
struct Both {
  CompactModel model;
  GeometryModel own, fcl;
  Data data;
  GeometryData own_data, fcl_data;

  static GeometryOptions byOwn() {
    GeometryOptions options = byFcl();
    options.narrow = GeometryOptions::Narrow::own;
    return options;
  }
  explicit Both(const Model& description, double tolerance = 1e-6)
      : model(compile(description, registry())),
        own(compileGeometry(model, description, byOwn())),
        fcl(compileGeometry(model, description, byFcl(tolerance))),
        data(model),
        own_data(own),
        fcl_data(fcl) {}
  void move(const Eigen::VectorXd& q) {
    updateGeometryPlacements(model, data, own, own_data, q);
    updateGeometryPlacements(model, data, fcl, fcl_data, q);
  }
};

constexpr int kinds = 8;
GeometryShape shapeOf(int kind, Random& random) {
  const auto side = [&] { return random.uniform(0.2, 1); };
  switch (kind) {
    case 0:
      return g::Sphere{side()};
    case 1: {
      const double x = side(), y = side();
      return g::Box{{x, y, side()}};
    }
    case 2:
      return g::Capsule{0.3, side()};
    case 3:
      return g::Cylinder{0.3, side()};
    case 4:
      return g::Cone{0.4, side()};
    case 5: {
      g::ConvexHull hull;
      for (int i = 0; i < 12; ++i) hull.points.push_back(random.vector(0.5));
      return hull;
    }
    case 6:
      return heightField(3, 3, {0, 0.1, 0, 0.2, 0.3, 0.1, 0, side(), 0}, -0.5, -0.5, 0.5, 0.5);
    default:
      return g::Voxels{{{{0, 0, 0}, 0.3}, {{0.3, 0, 0}, 0.3}, {{0.1, 0.4, 0.2}, side()}}};
  }
}

/// Compares all queries. FCL's distances of solids of a metre are right to the square root of its tolerance.
void compare(Both& both, double within) {
  const std::vector<Distance> expected = computeDistances(both.own, both.own_data);
  const std::vector<Distance> found = computeDistances(both.fcl, both.fcl_data);
  REQUIRE(found.size() == expected.size());
  std::vector<int> colliding;
  for (std::size_t k = 0; k < found.size(); ++k) {
    const auto pair = static_cast<int>(k);
    const Distance& x = found[k];
    INFO("pair " << k << ": " << expected[k].distance << ", by FCL " << x.distance);
    CHECK(std::fabs(x.distance - expected[k].distance) < within);
    CHECK(std::fabs(length(x.normal) - 1) < 1e-12);
    CHECK(length(x.nearest_b - x.nearest_a - x.distance * x.normal) < within);
    CHECK(computeCollision(both.fcl, both.fcl_data, pair) == (x.distance <= 0));
    if (x.distance <= 0) colliding.push_back(pair);
  }
  CHECK(computeCollisions(both.fcl, both.fcl_data) == colliding);
  CHECK(anyCollision(both.fcl, both.fcl_data) == !colliding.empty());
  CHECK(std::fabs(computeMinimumDistance(both.fcl, both.fcl_data).distance - computeMinimumDistance(both.own, both.own_data).distance) < within);
  std::vector<int> touched;
  for (const Contact& c : computeContacts(both.fcl, both.fcl_data))
    if (touched.empty() || touched.back() != c.pair) touched.push_back(c.pair);
  CHECK(touched == colliding);
}

}  // namespace

TEST_CASE("FCL's functions give the signed distances that libdyn's give, to the root of FCL's tolerance, for each pair of kinds", "[geometry][fcl]") {
  for (const double tolerance : {1e-6, 1e-8})
    for (int i = 0; i < kinds; ++i)
      for (int j = 0; j < kinds; ++j) {
        Random random(static_cast<std::uint64_t>(10 * i + j + 1));
        for (int k = 0; k < 6; ++k) {
          INFO("kinds " << i << " and " << j << ", " << k << ", tolerance " << tolerance);
          Both both(TwoSolids::describe(shapeOf(i, random), random.pose(), shapeOf(j, random)), tolerance);
          SE3<double> pose = random.pose();
          pose.p = random.vector(1.5);
          both.move(configurationOf(pose));
          // EPA fails on round solids that overlap if the tolerance is small.
          if (tolerance < 1e-6 && computeDistance(both.own, both.own_data, 0).distance < 0) continue;
          compare(both, std::sqrt(tolerance));
        }
      }
}

TEST_CASE("FCL's functions answer for robots among obstacles as libdyn's do", "[geometry][fcl]") {
  Random random(3);
  std::vector<Model> models{urdf::load(DYN_SOURCE_DIR "/models/arm.urdf"), urdf::load(DYN_SOURCE_DIR "/models/biped.urdf")};
  Model& biped = models[1];
  for (std::size_t body = 1; body < biped.bodies.size(); ++body)
    biped.addGeometry("on " + biped.bodies[body].name, static_cast<int>(body), random.pose(), someShape(random, 0.2));
  for (Model& m : models)
    for (int k = 0; k < kinds; ++k) m.addGeometry("obstacle" + std::to_string(k), 0, random.pose(), shapeOf(k, random));
  if (!sharedFolder().empty())
    for (const char* robot : {"hyq", "nao", "talos"}) models.push_back(urdf::load(sharedFolder() + "/models/" + robot + ".urdf"));
  for (const Model& description : models) {
    INFO(description.name);
    Both both(description);
    REQUIRE(both.fcl.pairs().size() > 0);
    for (std::uint64_t seed = 0; seed < 3; ++seed) {
      both.move(randomConfiguration(both.model, seed));
      compare(both, 1e-3);
    }
    constexpr int states = 20;
    GeometryBatch batch(both.model, both.fcl, states, 2);
    Eigen::MatrixXd Q(both.model.nq(), states);
    for (int k = 0; k < states; ++k) Q.col(k) = randomConfiguration(both.model, static_cast<std::uint64_t>(k));
    const auto hits = computeCollisions(both.model, batch, Q);
    for (int k = 0; k < states; ++k) {
      updateGeometryPlacements(both.model, both.data, both.fcl, both.fcl_data, Q.col(k));
      CHECK((hits[k] == 1) == anyCollision(both.fcl, both.fcl_data));
    }
  }
}

TEST_CASE("contacts of a simulation come from FCL's functions if the geometry was compiled for them", "[geometry][fcl][contact]") {
  Both both(TwoSolids::describe(g::Box{{2, 2, 2}}, {}, g::Box{{1, 1, 1}}));
  const Eigen::VectorXd q = configurationOf({exp3(Vec3<double>{0, 0, 0.3}), {0.2, 0.1, 1.505}});
  const auto contactsBy = [&](const GeometryModel& geometry) {
    std::vector<ContactPoint> found;
    geometryContacts(both.model, geometry, {.margin = 0.01})(VectorResult(q.data(), q.size()), found);
    return found;
  };
  const std::vector<ContactPoint> own = contactsBy(both.own), fcl = contactsBy(both.fcl);
  REQUIRE(own.size() == 4);
  REQUIRE(fcl.size() == 4);
  for (std::size_t k = 0; k < 4; ++k) {
    CHECK(fcl[k].id == own[k].id);
    CHECK(std::fabs(fcl[k].gap - 0.005) < 1e-5);
    CHECK(length(fcl[k].normal - own[k].normal) < 1e-5);
  }
}

TEST_CASE("a pair that FCL cannot compare is refused by name, with a cure", "[geometry][fcl]") {
  const auto refusal = [](const auto& ask) -> std::string {
    try {
      ask();
    } catch (const Error& e) {
      CHECK(e.code() == ErrorCode::argument);
      return e.what();
    }
    return "no error";
  };
  const Model plane = TwoSolids::describe(g::HalfSpace{}, {}, g::Sphere{1});
  CHECK_THAT(refusal([&] { Both{plane}; }),
             containing("'a' with 'b'") && containing("no distance to a half-space") && containing("large box") && containing("--narrow own"));
  const Model spheres = TwoSolids::describe(g::Sphere{1}, {}, g::Sphere{0.7});
  for (const double tolerance : {0.0, -1.0, std::nan(""), HUGE_VAL})
    CHECK_THAT(refusal([&] { Both(spheres, tolerance); }), containing("fcl_tolerance is ") && containing("positive"));

  // EPA fails on round solids that overlap if its tolerance is small. FCL's library would end the process, and leak its polytope.
  Both both(spheres, 1e-12);
  Random random(1);
  int refused = 0;
  for (int k = 0; k < 100; ++k) {
    both.move(configurationOf({Mat3<double>::identity(), random.vector(1)}));
    const double expected = computeDistance(both.own, both.own_data, 0).distance;
    try {
      const double found = computeDistance(both.fcl, both.fcl_data, 0).distance;
      CHECK(std::fabs(found - expected) < 1e-6);
    } catch (const Error&) {
      ++refused;
      const auto refuses = [&](const auto& ask) { CHECK_THAT(refusal(ask), containing("'a' with 'b'") && containing("fcl_tolerance from 1e-12")); };
      refuses([&] { computeDistance(both.fcl, both.fcl_data, 0); });
      refuses([&] { computeDistances(both.fcl, both.fcl_data); });
      refuses([&] { computeContacts(both.fcl, both.fcl_data); });
      CHECK(computeCollision(both.fcl, both.fcl_data, 0));
    }
  }
  CHECK(refused > 0);
  both.move(configurationOf({Mat3<double>::identity(), {std::nan(""), 0, 0}}));
  CHECK_THAT(refusal([&] { computeDistance(both.fcl, both.fcl_data, 0); }),
             containing("'a' with 'b'") && containing("not finite") && !containing("raise"));
}
