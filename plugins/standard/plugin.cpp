// SPDX-License-Identifier: BSD-2-Clause
// The standard joint types, in one shared object.
#include "composite.hpp"
#include "groups.hpp"
#include "varying.hpp"

namespace dyn::standard {
using Joints = sdk::TypeList<Fixed, Revolute, Continuous, Prismatic, Helical, Cylindrical, Universal, Spherical, SphericalZYX, Translation, Planar,
                             FreeFlyer, Ellipsoid, Composite>;
using Couplings = sdk::TypeList<Mimic>;
}  // namespace dyn::standard

DYN_EXPORT_PLUGIN(dyn::standard::Joints, dyn::standard::Couplings)
