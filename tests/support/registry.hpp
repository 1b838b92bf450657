// The registry that tests share: the standard plugin and, through DYN_PLUGIN_PATH, the examples.
#pragma once

#include <dyn/joint/registry.hpp>

namespace dyn::test {

inline const JointRegistry& registry() {
  static const JointRegistry r = JointRegistry::standard();
  return r;
}

/// Its joints but those whose configuration space is no group, which the variational integrator refuses; no couplings.
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
