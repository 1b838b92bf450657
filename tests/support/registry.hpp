// The registry that tests share: the standard plugin and, through DYN_PLUGIN_PATH, the examples.
#pragma once

#include <dyn/joint/registry.hpp>

namespace dyn::test {

inline const JointRegistry& registry() {
  static const JointRegistry r = JointRegistry::standard();
  return r;
}

}  // namespace dyn::test
