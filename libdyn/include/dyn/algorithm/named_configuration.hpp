// SPDX-License-Identifier: BSD-2-Clause
// Named states of a description as vectors of its compiled model.
#pragma once

#include <dyn/compile/compact_model.hpp>
#include <dyn/data/views.hpp>
#include <dyn/model/model.hpp>

#include <string>

namespace dyn {

namespace detail {
DYN_API void namedState(const CompactModel& model, const Model& description, const std::string& names, double* q, double* v);
}  // namespace detail

/// Return the configuration (nq) and the velocity (nv) of a named state of Model::configurations. The name is a state's own, "home", or follows its
/// group's, "arm/home". The name alone stands for the states of all groups that have one of that name. Several names are separated by commas; later
/// ones overwrite coordinates of earlier ones. Joints that no state sets are neutral and at rest. Coordinates of joints that the compiled model
/// holds, and of dependent joints, are not in q and are left out. Throw Error(argument) for a name that does not exist, with similar ones, and if
/// states of one name give a joint different coordinates; Error(model) for a joint that does not exist; Error(size) for a wrong number of
/// coordinates. O(n + joints of all states).
/// @{
inline Eigen::VectorXd namedConfiguration(const CompactModel& model, const Model& description, const std::string& name) {
  Eigen::VectorXd q(model.nq()), v(model.nv());
  detail::namedState(model, description, name, q.data(), v.data());
  return q;
}
inline Eigen::VectorXd namedVelocity(const CompactModel& model, const Model& description, const std::string& name) {
  Eigen::VectorXd q(model.nq()), v(model.nv());
  detail::namedState(model, description, name, q.data(), v.data());
  return v;
}
/// @}

}  // namespace dyn
