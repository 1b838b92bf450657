// Motion subspace and bias from the pose map alone, by forward-mode differentiation.
//
// With the pose (R, p) along q(t), in the moving frame: S v = (R^T p', vee(R^T R')), and its derivative at constant v is
// (R^T p'' + R'^T p', vee(R^T R'')); R'^T R' is symmetric and drops out of vee.
#pragma once

#include <dyn/scalar/dual.hpp>
#include <dyn/spatial/se3.hpp>

namespace dyn::sdk {

template <class T>
SE3<T> valuePart(const SE3<Dual<T>>& X) {
  SE3<T> Y;
  for (int i = 0; i < 9; ++i) Y.R.m[i] = X.R.m[i].v;
  Y.p = {X.p.x.v, X.p.y.v, X.p.z.v};
  return Y;
}

template <class T>
SE3<T> derivativePart(const SE3<Dual<T>>& X) {
  SE3<T> Y;
  for (int i = 0; i < 9; ++i) Y.R.m[i] = X.R.m[i].d;
  Y.p = {X.p.x.d, X.p.y.d, X.p.z.d};
  return Y;
}

/// Column k of S at q for a joint with nq = nv and v = dq/dt. `pose` maps n scalars of any kind to an SE3 of that kind.
template <int N, class S, class Pose>
Motion<S> subspaceColumn(const Pose& pose, const S* q, int k) {
  Dual<S> qd[N];
  for (int i = 0; i < N; ++i) qd[i] = Dual<S>(q[i], S(i == k ? 1 : 0));
  const SE3<Dual<S>> X = pose(qd);
  const SE3<S> X0 = valuePart(X), X1 = derivativePart(X);
  return {transposeTimes(X0.R, X1.p), vee(transpose(X0.R) * X1.R)};
}

/// Pose, S and dS/dq of a joint with one coordinate, all from one call of its pose map.
template <class S>
struct OneCoordinate {
  SE3<S> pose;
  Motion<S> subspace, rate;
};
template <class S, class Pose>
OneCoordinate<S> alongOneCoordinate(const Pose& pose, const S& q) {
  using D = Dual<S>;
  const Dual<D> along(D(q, S(1)), D(S(1), S(0)));
  const SE3<Dual<D>> X = pose(&along);
  const SE3<S> X0 = valuePart(valuePart(X)), X1 = derivativePart(valuePart(X)), X2 = derivativePart(derivativePart(X));
  const Mat3<S> Rt = transpose(X0.R);
  return {X0, {Rt * X1.p, vee(Rt * X1.R)}, {Rt * X2.p + transposeTimes(X1.R, X1.p), vee(Rt * X2.R)}};
}

/// (dS/dt) v along q(t) with dq/dt = v.
template <int N, class S, class Pose>
Motion<S> subspaceBias(const Pose& pose, const S* q, const S* v) {
  using D = Dual<S>;
  Dual<D> qd[N];
  for (int i = 0; i < N; ++i) qd[i] = Dual<D>(D(q[i], v[i]), D(v[i], S(0)));
  const SE3<Dual<D>> X = pose(qd);
  const SE3<S> X0 = valuePart(valuePart(X)), X1 = derivativePart(valuePart(X)), X2 = derivativePart(derivativePart(X));
  return {transposeTimes(X0.R, X2.p) + transposeTimes(X1.R, X1.p), vee(transpose(X0.R) * X2.R)};
}

}  // namespace dyn::sdk
