// SPDX-License-Identifier: BSD-2-Clause
// Spatial algebra compared with dense 6x6 matrices, for every scalar type in use.
#include "spatial/samples.hpp"

#include <dyn/scalar/dual.hpp>

#include <Eigen/Geometry>

using namespace dyn;
using namespace dyn::test;

namespace {

/// v x as a 6x6 matrix that acts on motions. Its negative transpose acts on forces.
template <class S>
Dense crossMatrix(const Motion<S>& v) {
  Dense X = Dense::Zero(6, 6);
  X.topLeftCorner(3, 3) = X.bottomRightCorner(3, 3) = dense(skew(v.angular));
  X.topRightCorner(3, 3) = dense(skew(v.linear));
  return X;
}

}  // namespace

TEMPLATE_TEST_CASE("poses compose, invert and act as homogeneous matrices do", "[spatial]", float, double, long double) {
  using S = TestType;
  Sample<S> s(1);
  for (int i = 0; i < 20; ++i) {
    const SE3<S> a = s.pose(), b = s.pose();
    const Vec3<S> x = s.vector();
    CHECK_NEAR(dense(a * b), dense(a) * dense(b));
    CHECK_NEAR(dense(a.inverse()), dense(a).inverse());
    CHECK_NEAR(dense(a.act(x)), (dense(a) * homogeneous(dense(x))).topRows(3));
    CHECK_NEAR(dense(a.actInv(a.act(x))), dense(x));
  }
}

TEMPLATE_TEST_CASE("motions and forces transform by dual 6x6 matrices, and power is invariant", "[spatial]", float, double, long double) {
  using S = TestType;
  Sample<S> s(2);
  for (int i = 0; i < 20; ++i) {
    const SE3<S> aMb = s.pose();
    const Dense X = dense(actionMatrix6(aMb));
    const Motion<S> v = s.motion();
    const Force<S> f = s.force();
    CHECK_NEAR(dense(aMb.act(v)), X * dense(v));
    CHECK_NEAR(dense(aMb.actInv(v)), X.inverse() * dense(v));
    CHECK_NEAR(dense(aMb.act(f)), X.inverse().transpose() * dense(f));
    CHECK_NEAR(dense(aMb.actInv(f)), X.transpose() * dense(f));
    CHECK(std::fabs(dot(aMb.act(v), aMb.act(f)) - dot(v, f)) < tolerance<S>);
  }
}

TEMPLATE_TEST_CASE("cross products are the 6x6 ones, dual to each other, and obey Jacobi's identity", "[spatial]", float, double, long double) {
  using S = TestType;
  Sample<S> s(3);
  for (int i = 0; i < 20; ++i) {
    const Motion<S> u = s.motion(), v = s.motion(), w = s.motion();
    const Force<S> f = s.force();
    CHECK_NEAR(dense(u.cross(v)), crossMatrix(u) * dense(v));
    CHECK_NEAR(dense(crossStar(u, f)), -crossMatrix(u).transpose() * dense(f));
    CHECK(std::fabs(dot(u.cross(v), f) + dot(v, crossStar(u, f))) < tolerance<S>);
    CHECK_NEAR(dense(u.cross(v.cross(w))) + dense(v.cross(w.cross(u))), -dense(w.cross(u.cross(v))));
    const SE3<S> X = s.pose();
    CHECK_NEAR(dense(X.act(u.cross(v))), dense(X.act(u).cross(X.act(v))));
  }
}

TEST_CASE("poses carry derivatives: a dual pose moves with its velocity", "[spatial]") {
  using S = double;
  using D = Dual<double>;
  Sample<double> s(6);
  for (int i = 0; i < 10; ++i) {
    const SE3<double> X = s.pose();
    const Motion<double> v = s.motion();
    // With X(t) = X exp(v t) the point x moves with v.linear + v.angular x x in the body's axes.
    Motion<D> step;
    for (int k = 0; k < 3; ++k) {
      step.linear[k] = D(0, v.linear[k]);
      step.angular[k] = D(0, v.angular[k]);
    }
    const SE3<D> moving = cast<D>(X) * exp6(step);
    const Vec3<double> x = s.vector(), rate = X.R * (v.linear + cross(v.angular, x));
    const Vec3<D> y = moving.act(Vec3<D>{D(x.x), D(x.y), D(x.z)});
    for (int k = 0; k < 3; ++k) {
      CHECK(y[k].v == approx(X.act(x)[k]).margin(1e-15));
      CHECK(y[k].d == approx(rate[k]).margin(1e-14));
    }
    CHECK_NEAR(dense(fromEigen3(toEigen(x))), dense(x));
    CHECK_NEAR(dense(rotationFromEigen(toEigen(X.R))), dense(X.R));
  }
}
