// SPDX-License-Identifier: BSD-2-Clause
// The plugin has a new type and a type with a name of the standard plugin.
#include <dyn_sdk/joint_plugin.hpp>

struct Original : dyn::sdk::Joint<Original, 1> {
  static constexpr const char* name = "an_original";
  static constexpr const char* summary = "for tests";
  template <class S>
  static dyn::SE3<S> pose(const S* q, const dyn::sdk::Constants&) {
    return {dyn::Mat3<S>::identity(), {q[0], S(0), S(0)}};
  }
};

struct Copy : Original {
  static constexpr const char* name = "revolute";
};

DYN_EXPORT_JOINTS(Original, Copy)
