// SPDX-License-Identifier: BSD-2-Clause
// Inertias compared with dense 6x6 matrices, for every scalar type in use.
#include "spatial/samples.hpp"

using namespace dyn;
using namespace dyn::test;

namespace {

template <class S>
ArticulatedInertia<S> articulated(const Inertia<S>& Y) {
  return ArticulatedInertia<S>::rigid(Y.mass, Y.mass * Y.com, Y.rotationalAtOrigin());
}

template <class S>
Matrix6<S> dense(const ArticulatedInertia<S>& Y) {
  Matrix6<S> M;
  M << toEigen(Y.linear), toEigen(Y.coupling), toEigen(Y.coupling).transpose(), toEigen(Y.angular);
  return M;
}

}  // namespace

TEMPLATE_TEST_CASE("inertias are symmetric 6x6 matrices that transform by congruence and add when welded", "[spatial]", float, double, long double) {
  using S = TestType;
  Sample<S> s(4);
  for (int i = 0; i < 20; ++i) {
    const Inertia<S> Y = s.inertia(), Z = s.inertia();
    const SE3<S> aMb = s.pose();
    const Motion<S> v = s.motion();
    const Matrix6<S> M = toEigen(Y), X = actionMatrix6(aMb);
    CHECK_NEAR(M, M.transpose());
    CHECK_NEAR(toEigen(Y * v), M * toEigen(v));
    CHECK_NEAR(toEigen(Y + Z), M + toEigen(Z));
    CHECK_NEAR(toEigen(Y.transformed(aMb)), X.inverse().transpose() * M * X.inverse());
  }
  // The sum of massless bodies must not divide by zero.
  const Inertia<S> nothing = Inertia<S>{} + Inertia<S>{};
  CHECK(nothing.mass == 0);
  CHECK(nothing.com.x == 0);
}

TEMPLATE_TEST_CASE("articulated inertias act, add, shift and project as 6x6 matrices do", "[spatial]", float, double, long double) {
  using S = TestType;
  Sample<S> s(5);
  for (int i = 0; i < 20; ++i) {
    const Inertia<S> Y = s.inertia();
    const ArticulatedInertia<S> A = articulated(Y);
    const Motion<S> v = s.motion();
    CHECK_NEAR(dense(A), toEigen(Y));
    CHECK_NEAR(toEigen(A * v), toEigen(Y) * toEigen(v));
    CHECK_NEAR(dense(A + A), S(2) * toEigen(Y));
    const Vec3<S> r = s.vector();
    CHECK_NEAR(dense(A.shifted(r)), toEigen(Y.transformed({Mat3<S>::identity(), r})));
    const Force<S> W = A * v;
    ArticulatedInertia<S> projected = A;
    projected.subtractSquare(W, S(1) / dot(v, W));
    const Vector6<S> w = toEigen(W);
    CHECK_NEAR(dense(projected), dense(A) - w * w.transpose() / toEigen(v).dot(w));
    CHECK_NEAR(toEigen(projected * v), Vector6<S>::Zero());
  }
}
