// SPDX-License-Identifier: BSD-2-Clause
// Momentum about the centre of mass, its map, its rate, and their derivatives.
#pragma once

#include <dyn/catalogue/algorithm.hpp>
#include <dyn/data/data.hpp>
#include <dyn/spatial/vector3.hpp>

namespace dyn {

/// Momentum in world axes about the (moving) centre of mass, linear part first, and its map Ag, 6 x nv. The accuracy does not depend on where the
/// base stands.
struct CentroidalMomentum {
  VectorResult hg;              ///< momentum [kg m/s, kg m^2/s]
  MatrixResult Ag;              ///< hg = Ag v
  const Mat3<double>& inertia;  ///< rotational inertia of the whole model, taken as one rigid body, about the centre of mass [kg m^2]
};
/// Momentum as in CentroidalMomentum, and its rate. The matrices are 6 x nv.
struct CentroidalRate {
  VectorResult hg,  ///< momentum [kg m/s, kg m^2/s]
      dhg;          ///< d hg / dt [N, N m]: the total force of gravity, contacts and other bodies
  MatrixResult Ag,  ///< hg = Ag v
      dAg;          ///< dhg = Ag a + dAg v
};
/// Derivatives of hg and dhg, 6 x nv each; those by q are in its tangent space.
struct CentroidalDerivatives {
  MatrixResult dhg_dq;     ///< derivative of the momentum; dhg/dv is Ag
  MatrixResult dhgdot_dq,  ///< of its rate by q
      dhgdot_dv,           ///< of its rate by v
      dhgdot_da;           ///< of its rate by a: Ag
};
/// Derivatives of the centre of mass' motion, in world axes, 3 x nv each. jacobianCenterOfMass is the derivative of the position by q, of the
/// velocity by v and of the acceleration by a.
struct CenterOfMassDerivatives {
  MatrixResult vcom_dq,  ///< of the velocity by q
      acom_dq,           ///< of the acceleration by q
      acom_dv;           ///< of the acceleration by v
};

namespace detail {
struct CentroidalViews {
  const double *hg, *dhg, *Ag, *dAg, *dh_dq, *dhdot_dq, *dhdot_dv;
  const Mat3<double>* inertia;
};
struct CenterOfMassViews {
  const double *vcom_dq, *acom_dq, *acom_dv;
};
DYN_API CenterOfMassViews centerOfMassDerivatives(const CompactModel&, Data&, VectorView q, VectorView v, VectorView a);
DYN_API CentroidalViews centroidal(const CompactModel&, Data&, Algorithm, VectorView q, VectorView v, const VectorView* a);
}  // namespace detail

/// Computes the momentum and its map with the centroidal composite-rigid-body algorithm (Orin, Goswami and Lee 2013). This and the functions below
/// are O(n), need Need::derivatives and throw Error(size | argument), and Error(singular) for a model without mass.
inline CentroidalMomentum ccrba(const CompactModel& model, Data& data, const VectorArg& q, const VectorArg& v) {
  const detail::CentroidalViews x = detail::centroidal(model, data, Algorithm::centroidal_map, q, v, nullptr);
  return {{x.hg, 6}, {x.Ag, 6, model.nv()}, *x.inertia};
}
/// Computes the momentum, its map, its rate for accelerations a, and the time derivative of the map.
inline CentroidalRate computeCentroidalMomentumTimeVariation(const CompactModel& model, Data& data, const VectorArg& q, const VectorArg& v,
                                                             const VectorArg& a) {
  const VectorView acceleration = a;
  const detail::CentroidalViews x = detail::centroidal(model, data, Algorithm::centroidal_rate, q, v, &acceleration);
  return {{x.hg, 6}, {x.dhg, 6}, {x.Ag, 6, model.nv()}, {x.dAg, 6, model.nv()}};
}
/// Computes the derivatives of hg(q, v) and dhg(q, v, a), in the tangent space of q, with the formulas of computeRNEADerivatives, summed at the
/// centre of mass.
inline CentroidalDerivatives computeCentroidalDynamicsDerivatives(const CompactModel& model, Data& data, const VectorArg& q, const VectorArg& v,
                                                                  const VectorArg& a) {
  const VectorView acceleration = a;
  const detail::CentroidalViews x = detail::centroidal(model, data, Algorithm::centroidal_derivatives, q, v, &acceleration);
  const int n = model.nv();
  return {{x.dh_dq, 6, n}, {x.dhdot_dq, 6, n}, {x.dhdot_dv, 6, n}, {x.Ag, 6, n}};
}

/// Computes the derivatives of the velocity and acceleration (gravity not included) of the centre of mass, in the tangent space of q. They are
/// the derivatives of the linear momentum and its rate, divided by the mass.
inline CenterOfMassDerivatives computeCenterOfMassDerivatives(const CompactModel& model, Data& data, const VectorArg& q, const VectorArg& v,
                                                              const VectorArg& a) {
  const detail::CenterOfMassViews x = detail::centerOfMassDerivatives(model, data, q, v, a);
  const int n = model.nv();
  return {{x.vcom_dq, 3, n}, {x.acom_dq, 3, n}, {x.acom_dv, 3, n}};
}

}  // namespace dyn
