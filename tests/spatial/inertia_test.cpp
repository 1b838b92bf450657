// SPDX-License-Identifier: BSD-2-Clause
// Inertias compared with dense 6x6 matrices, for every scalar type in use.
#include "spatial/samples.hpp"

using namespace dyn;
using namespace dyn::test;

namespace {

using dyn::test::dense;

template <class S>
ArticulatedInertia<S> articulated(const Inertia<S>& Y) {
  return ArticulatedInertia<S>::rigid(Y.mass, Y.mass * Y.com, Y.rotationalAtOrigin());
}

template <class S>
Dense dense(const ArticulatedInertia<S>& Y) {
  Dense M(6, 6);
  M << dense(Y.linear), dense(Y.coupling), dense(Y.coupling).transpose(), dense(Y.angular);
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
    const Dense M = dense(Y), X = dense(actionMatrix6(aMb));
    CHECK_NEAR(M, M.transpose());
    CHECK_NEAR(dense(Y * v), M * dense(v));
    CHECK_NEAR(dense(Y + Z), M + dense(Z));
    CHECK_NEAR(dense(Y.transformed(aMb)), X.inverse().transpose() * M * X.inverse());
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
    CHECK_NEAR(dense(A), dense(Y));
    CHECK_NEAR(dense(A * v), dense(Y) * dense(v));
    CHECK_NEAR(dense(A + A), 2 * dense(Y));
    const Vec3<S> r = s.vector();
    CHECK_NEAR(dense(A.shifted(r)), dense(Y.transformed({Mat3<S>::identity(), r})));
    const Force<S> W = A * v;
    ArticulatedInertia<S> projected = A;
    projected.subtractSquare(W, S(1) / dot(v, W));
    const Dense w = dense(W);
    CHECK_NEAR(dense(projected), dense(A) - w * w.transpose() / (dense(v).transpose() * w)(0, 0));
    CHECK_NEAR(dense(projected * v), Dense::Zero(6, 1));
  }
}
