// SPDX-License-Identifier: BSD-2-Clause
// The registry that tests share. It has the standard plugin and, through DYN_PLUGIN_PATH, the examples.
#pragma once

#include <dyn/joint/registry.hpp>

namespace dyn::test {

inline const JointRegistry& registry() {
  static const JointRegistry r = JointRegistry::standard();
  return r;
}

/// The registry without couplings and without joint types whose configuration space is not a group, which the variational integrator refuses.
inline const JointRegistry& groups() {
  static const JointRegistry r = [] {
    JointRegistry all;
    for (const JointType* type : registry().jointTypes())
      if (!(type->info().closed_forms & own_rates)) all.add(*type);
    return all;
  }();
  return r;
}

}  // namespace dyn::test
