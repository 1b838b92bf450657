// SPDX-License-Identifier: BSD-2-Clause
// Signed distances of all pairs of solids compared with closed forms and with the definition.
#include "geometry/oracle.hpp"
#include "geometry/scene.hpp"

using namespace dyn;
using namespace dyn::test;
namespace g = dyn::geometry;

namespace {

enum Kind { sphere, box, capsule, cylinder, cone, hull, kinds };
const char* const names[] = {"sphere", "box", "capsule", "cylinder", "cone", "hull"};

/// A random solid. Its sides are of the given size, times powers of ten with exponents in [-ratio, ratio].
GeometryShape randomShape(int kind, Random& random, double size, double ratio = 0) {
  const auto side = [&] {
    const double factor = random.uniform(0.2, 2);  // a statement of its own, because compilers choose the order within products
    return size * factor * std::pow(10, ratio > 0 ? random.uniform(-ratio, ratio) : 0);
  };
  switch (kind) {
    case sphere:
      return g::Sphere{side() / 2};
    case box:
      return g::Box{{side(), side(), side()}};
    case capsule:
      return g::Capsule{side() / 2, side()};
    case cylinder:
      return g::Cylinder{side() / 2, side()};
    case cone:
      return g::Cone{side() / 2, side()};
    default: {
      const double x = side() / 2, y = side() / 2, z = side() / 2;
      return g::ConvexHull{{{x, 0, 0}, {-x, 0, 0}, {0, y, 0}, {0, -y, 0}, {0, 0, z}, {0, 0, -z}}};
    }
  }
}

bool curved(const GeometryShape& x) { return std::holds_alternative<g::Cylinder>(x) || std::holds_alternative<g::Cone>(x); }

/// The signed distance in closed form, if this pair of kinds has one.
std::optional<Wide> closedForm(const Placed& a, const Placed& b) {
  for (const auto& [x, y] : {std::pair(&a, &b), std::pair(&b, &a)}) {
    const auto* ball = std::get_if<g::Sphere>(&x->shape);
    if (ball == nullptr) continue;
    if (!std::holds_alternative<g::ConvexHull>(y->shape)) return outside(*y, x->pose.p) - ball->radius;
  }
  if (curved(a.shape) || curved(b.shape)) return std::nullopt;
  Wide margin = 0;
  for (const Placed* x : {&a, &b}) {
    if (const auto* c = std::get_if<g::Capsule>(&x->shape)) margin += c->radius;
    if (const auto* s = std::get_if<g::Sphere>(&x->shape)) margin += s->radius;
  }
  return ofPolytopes(polytopeOf(a), polytopeOf(b)) - margin;
}

struct Situation {
  const char* name;
  double size;
  double spread;     ///< of positions, relative to size
  bool aligned;      ///< the axes of both solids are parallel
  double ratio = 0;  ///< exponent of ten by which sides may differ from size
};

constexpr Situation situations[] = {{"apart", 1, 3, false},
                                    {"near", 1, 1, false},
                                    {"deep inside", 1, 0.1, false},
                                    {"concentric", 1, 0, false},
                                    {"axes parallel", 1, 1, true},
                                    {"concentric, axes parallel", 1, 0, true},
                                    {"a nanometre", 1e-9, 1, false},
                                    {"a thousand kilometres", 1e6, 1, false},
                                    {"slender, flat, large and small", 1, 1, false, 2}};

void check(const GeometryShape& a, const SE3<double>& at, const GeometryShape& b, const SE3<double>& pose, double size) {
  TwoSolids scene(a, at, b);
  const Distance found = scene.distance(pose);
  const SE3<double> there = geometryPlacement(scene.geometry, scene.geometry_data, 1);
  const Placed pa{a, cast<Wide>(at)}, pb{b, cast<Wide>(there)};
  // Tolerances relative to the solids' size. The search is exact to rounding where it ends at corners, sides and faces. For cylinders and cones that
  // overlap it ends at 1e-8.
  const double rounding = 1e-14 * size, search = 2e-8 * size;
  const std::optional<Wide> closed = closedForm(pa, pb);
  if (closed) {
    CHECK(std::fabs(static_cast<double>(found.distance - *closed)) <= (curved(a) || curved(b) ? search : rounding));
  } else {
    // No direction separates the solids farther. The nearest points below show that they are not nearer.
    CHECK(mostParted(pa, pb) <= found.distance + search);
  }
  // The normal separates the two by just that distance. The nearest points are in the solids and that far apart.
  CHECK(std::fabs(dot(found.normal, found.normal) - 1) < 1e-14);
  CHECK(std::fabs(static_cast<double>(parted(pa, pb, wide(found.normal)) - found.distance)) <= 5 * search);
  const Vec3<double> gap = found.nearest_b - found.nearest_a - found.distance * found.normal;
  CHECK(std::sqrt(dot(gap, gap)) <= rounding);
  CHECK(outside(pa, wide(found.nearest_a)) <= 1e-6 * size);
  CHECK(outside(pb, wide(found.nearest_b)) <= 1e-6 * size);
}

}  // namespace

TEST_CASE("signed distances are those of the closed forms and of the definition, whatever the pair, place and size", "[geometry]") {
  for (int i = 0; i < kinds; ++i) {
    for (int j = 0; j < kinds; ++j) {
      for (const Situation& s : situations) {
        const bool closed = i == sphere || j == sphere || (i != cylinder && i != cone && j != cylinder && j != cone);
        Random random(static_cast<std::uint64_t>(1000 * i + 100 * j + 1));
        for (int k = 0; k < (closed ? 40 : 6); ++k) {
          INFO(names[i] << " and " << names[j] << ", " << s.name << ", " << k);
          const GeometryShape a = randomShape(i, random, s.size, s.ratio), b = randomShape(j, random, s.size, s.ratio);
          SE3<double> at = random.pose(), pose = random.pose();
          at.p = s.size * at.p;
          if (s.aligned) pose.R = at.R;
          pose.p = at.p + (s.size * s.spread) * random.vector(1);
          check(a, at, b, pose, s.size * std::pow(10, s.ratio));
        }
      }
    }
  }
}

TEST_CASE("cones that overlap where the polytope between them sees a rim that meets itself", "[geometry]") {
  const g::Cone a{0.34529661629649566, 0.49208674310294868}, b{0.43293555638207643, 0.72456103412901218};
  check(a, {}, b,
        {{{-0.027792734691945709, 0.70772970366199128, -0.70593642097065179, -0.32209789382111753, -0.67488333661991395, -0.66391673329475009,
           -0.94629832013712434, 0.20892857274026047, 0.24671510046686362}},
         {0.39938430806459418, 0.37367492763902982, -0.12246388526513553}},
        1);
  check(a, {}, b,
        {{{-0.12560842028729738, 0.73373826316013702, -0.66772051483212325, -0.41707944834891447, -0.64973841491973561, -0.63551925694077516,
           -0.90014846470895848, 0.19866593405094721, 0.38763976592936134}},
         {0.3863626813813138, 0.36422513666327994, -0.17520849547210593}},
        1);
  check(a, {}, b,
        {{{-0.27334604591711648, 0.028993428722695613, -0.96147871545467933, -0.27631300254728469, -0.9597862798127772, 0.049612717184753963,
           -0.92137563664597866, 0.2792305108222457, 0.27036504585683063}},
         {0.44741202090467203, 0.24857760279108621, -0.16031249556531468}},
        1);
}

TEST_CASE("solids that touch have no distance", "[geometry]") {
  for (int i = 0; i < kinds; ++i) {
    for (int j = 0; j < kinds; ++j) {
      Random random(static_cast<std::uint64_t>(i * kinds + j));
      INFO(names[i] << " and " << names[j]);
      for (int k = 0; k < 5; ++k) {
        const GeometryShape a = randomShape(i, random, 1), b = randomShape(j, random, 1);
        SE3<double> pose = random.pose();
        pose.p = 3 * random.vector(1);
        TwoSolids scene(a, {}, b);
        // Moves the second solid along the normal to contact, and a little more or less.
        const Distance before = scene.distance(pose);
        for (const double more : {0.0, 1e-15, -1e-15, 1e-12, -1e-12, 1e-9, -1e-9, 1e-6, -1e-6}) {
          SE3<double> touching = pose;
          touching.p -= (before.distance - more) * before.normal;
          const double d = scene.distance(touching).distance;
          INFO(before.distance << " " << more);
          // When the second solid is pushed in along the normal of a corner, the two may slip past each other.
          CHECK(d >= more - 2e-8);
          CHECK(d <= std::fabs(more) + 2e-8);
        }
      }
    }
  }
}

TEST_CASE("signed distance changes no faster than the solids move, through contact and inside", "[geometry]") {
  for (int i = 0; i < kinds; ++i) {
    for (int j = i; j < kinds; ++j) {
      Random random(static_cast<std::uint64_t>(i * kinds + j));
      INFO(names[i] << " and " << names[j]);
      const GeometryShape a = randomShape(i, random, 1), b = randomShape(j, random, 1);
      TwoSolids scene(a, {}, b);
      SE3<double> pose = random.pose();
      const Vec3<double> direction = random.vector(1), from = (4 / std::sqrt(dot(direction, direction))) * direction, to = -from;
      const int steps = 500;
      double last = 0;
      bool apart = false, inside = false;
      for (int k = 0; k <= steps; ++k) {
        pose.p = from + (static_cast<double>(k) / steps) * (to - from);
        const double d = scene.distance(pose).distance;
        const double moved = std::sqrt(dot(to - from, to - from)) / steps;
        if (k > 0) CHECK(std::fabs(d - last) <= moved + 2e-8);
        apart = apart || d > 0;
        inside = inside || d < 0;
        last = d;
      }
      CHECK(apart);
      CHECK(inside);
    }
  }
}

TEST_CASE("round solids in special places", "[geometry]") {
  struct Case {
    const char* name;
    GeometryShape a, b;
    SE3<double> pose;
    double distance;
  };
  const Mat3<double> about_x = exp3(Vec3<double>{std::acos(-1.0) / 2, 0, 0}), over = exp3(Vec3<double>{std::acos(-1.0), 0, 0}),
                     I = Mat3<double>::identity();
  const g::Cylinder c1{0.3, 1}, c2{0.2, 0.8};
  const g::Cone k1{0.3, 0.4}, k2{0.6, 0.8};
  const Case cases[] = {
      {"cylinders side by side", c1, c2, {I, {0.7, 0, 0.1}}, 0.2},
      {"cylinders one on the other", c1, c2, {I, {0.1, 0, 1}}, 0.1},
      {"cylinders crossing over", c1, c2, {about_x, {0.9, 0, 0.1}}, 0.4},
      {"cylinders, one inside of the other", c1, c2, {I, {}}, -0.5},
      {"flat cylinders, one inside of the other", g::Cylinder{2, 0.1}, g::Cylinder{1, 0.3}, {I, {}}, -0.2},
      {"cones tip to tip", k1, k2, {over, {0, 0, 0.7}}, 0.1},
      {"cone on a cylinder", c1, k1, {I, {0, 0, 0.8}}, 0.1},
      {"cone's tip in a box", g::Box{{1, 1, 1}}, k1, {over, {0, 0, 0.65}}, -0.05},
      {"capsule beside a cylinder", c1, g::Capsule{0.1, 0.5}, {I, {0.6, 0, 0}}, 0.2},
      {"capsule within a cylinder", c1, g::Capsule{0.1, 0.5}, {I, {}}, -0.4},
  };
  for (const Case& c : cases) {
    INFO(c.name);
    TwoSolids scene(c.a, {}, c.b);
    CHECK(scene.distance(c.pose).distance == approx(c.distance).margin(1e-9));
  }
}

TEST_CASE("half-spaces are as far as the deepest point", "[geometry]") {
  for (int kind = 0; kind < kinds; ++kind) {
    Random random(static_cast<std::uint64_t>(kind) + 5);
    for (int k = 0; k < 20; ++k) {
      const GeometryShape b = randomShape(kind, random, 1);
      const g::HalfSpace plane{random.vector(1), random.uniform()};
      const SE3<double> at = random.pose(), pose = random.pose();
      TwoSolids scene(plane, at, b);
      const Distance d = scene.distance(pose);
      const V3 n = cast<Wide>(at.R) * unit(wide(plane.normal));
      const Wide offset = plane.offset / length(wide(plane.normal)) + dot(n, wide(at.p));
      const Placed placed{b, cast<Wide>(geometryPlacement(scene.geometry, scene.geometry_data, 1))};
      CHECK(std::fabs(static_cast<double>(d.distance - (dot(n, support(placed, -n)) - offset))) < 1e-14);
      CHECK(computeCollision(scene.geometry, scene.geometry_data, 0) == (d.distance <= 0));
      const Vec3<double> gap = d.nearest_b - d.nearest_a - d.distance * d.normal;
      CHECK(std::sqrt(dot(gap, gap)) < 1e-14);
    }
  }
}

TEST_CASE("normals of solids that nearly touch are those of the features that meet", "[distance]") {
  // A small solid lies over a large floor, with gaps down to rounding. The normal must be the floor's, however few digits the gap has.
  Random random(31);
  for (const double floor_size : {1.5, 30.0, 700.0})
    for (const GeometryShape& small : {GeometryShape(g::Box{{0.2, 0.3, 0.1}}), GeometryShape(g::Cylinder{0.07, 0.3}),
                                       GeometryShape(g::Cone{0.1, 0.2}), GeometryShape(g::Capsule{0.05, 0.2})})
      for (const double gap : {1e-6, 1e-9, 1e-11, 1e-13, 1e-15, 0.0, -1e-13, -1e-10}) {
        const SE3<double> tilted = random.pose();
        TwoSolids s(g::Box{{floor_size, floor_size, 0.5}}, tilted, small);
        const double half = std::holds_alternative<g::Box>(small)        ? 0.05
                            : std::holds_alternative<g::Cylinder>(small) ? 0.15
                            : std::holds_alternative<g::Cone>(small)     ? 0.1
                                                                         : 0.15;
        const SE3<double> on_floor{exp3(Vec3<double>{0, 0, random.uniform(-3, 3)}),
                                   {random.uniform(-0.4, 0.4) * floor_size, random.uniform(-0.4, 0.4) * floor_size, 0.25 + half + gap}};
        const Distance x = s.distance(tilted * on_floor);
        const Vec3<double> up = tilted.R * Vec3<double>{0, 0, 1};
        CAPTURE(floor_size, small.index(), gap, x.distance);
        CHECK(length(x.normal - up) < 1e-10);
        CHECK(std::abs(x.distance - gap) < 1e-14 * (10 + floor_size));
      }
}

TEST_CASE("a cylinder or a cone that touches a box along its side is straight above it", "[distance]") {
  Random random(32);
  for (int k = 0; k < 300; ++k) {
    const double radius = random.uniform(0.02, 0.3), long_side = random.uniform(0.1, 0.8);
    const SE3<double> tilted = random.pose();
    TwoSolids s(g::Box{{3, 2, 0.4}}, tilted, g::Cylinder{radius, long_side});
    const double gap = std::array{0.0, 1e-14, -1e-14, 1e-12, 1e-10, -1e-11}[static_cast<std::size_t>(k % 6)];
    // The cylinder lies on the box: its axis is the box's x axis rotated about z.
    const SE3<double> lying{exp3(Vec3<double>{0, 0, random.uniform(-3, 3)}) * exp3(Vec3<double>{0, M_PI / 2, 0}),
                            {random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3), 0.2 + radius + gap}};
    const Distance x = s.distance(tilted * lying);
    CAPTURE(k, radius, long_side, gap, x.distance);
    CHECK(length(x.normal - tilted.R * Vec3<double>{0, 0, 1}) < 1e-6);
    CHECK(std::abs(x.distance - gap) < 1e-12);
  }
}

TEST_CASE("nearest points are on both solids where the one's centre is the other's corner, end or tip", "[distance]") {
  struct Case {
    GeometryShape other;
    Vec3<double> feature;
  };
  g::ConvexHull tetrahedron;
  tetrahedron.points = {{0, 0, 0.4}, {0.3, 0, 0}, {-0.2, 0.2, 0}, {-0.2, -0.2, 0}};
  const std::vector<Case> cases = {{g::Capsule{0.1, 0.6}, {0, 0, 0.3}},
                                   {g::Box{{0.4, 0.6, 0.8}}, {0.2, 0.3, 0.4}},
                                   {g::Cone{0.2, 0.5}, {0, 0, 0.25}},
                                   {tetrahedron, {0, 0, 0.4}},
                                   {g::Cylinder{0.2, 0.5}, {0.2, 0, 0.25}}};
  for (const double radius : {0.0, 0.05})
    for (const Case& c : cases) {
      CAPTURE(radius, c.other.index());
      // The sphere and the feature of the other solid are both at the world's origin. Both orders of the pair are tested.
      const SE3<double> turned{exp3(Vec3<double>{0.3, -0.2, 0.5}), {}}, there{turned.R, -(turned.R * c.feature)};
      const double margin = std::holds_alternative<g::Capsule>(c.other) ? 0.1 : 0;
      for (const bool sphere_first : {true, false}) {
        TwoSolids s(sphere_first ? GeometryShape(g::Sphere{radius}) : c.other, sphere_first ? SE3<double>{} : there,
                    sphere_first ? c.other : GeometryShape(g::Sphere{radius}));
        const Distance x = s.distance(sphere_first ? there : SE3<double>{});
        const Vec3<double>&of_sphere = sphere_first ? x.nearest_a : x.nearest_b, &of_other = sphere_first ? x.nearest_b : x.nearest_a;
        CHECK(std::abs(x.distance + radius + margin) < 1e-12);
        CHECK(length(of_sphere) < radius + 1e-12);
        CHECK(length(of_other) < margin + 1e-12);
        CHECK(length((x.nearest_b - x.nearest_a) - x.distance * x.normal) < 1e-12);
      }
    }
}
