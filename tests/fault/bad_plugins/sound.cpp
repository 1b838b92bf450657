// SPDX-License-Identifier: BSD-2-Clause
// A sound plugin, with a static constructor that does not throw.
#include <dyn_sdk/joint_plugin.hpp>

#include <string>

namespace {
const std::string text(64, 'x');
}

struct Sound : dyn::sdk::Joint<Sound, 1> {
  static constexpr const char* name = "sound_slider";
  static constexpr const char* summary = "for tests";
  template <class S>
  static dyn::SE3<S> pose(const S* q, const dyn::sdk::Constants&) {
    return {dyn::Mat3<S>::identity(), {q[0], S(0), S(0)}};
  }
};

DYN_EXPORT_JOINTS(Sound)
