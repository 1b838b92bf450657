// SPDX-License-Identifier: BSD-2-Clause
// A test installs this file beside sound.so as its build for one processor. It has the same type with an older description.
#include <dyn_sdk/joint_plugin.hpp>

struct SoundBefore : dyn::sdk::Joint<SoundBefore, 1> {
  static constexpr const char* name = "sound_slider";
  static constexpr const char* summary = "for earlier tests";
  template <class S>
  static dyn::SE3<S> pose(const S* q, const dyn::sdk::Constants&) {
    return {dyn::Mat3<S>::identity(), {S(0), q[0], S(0)}};
  }
};

DYN_EXPORT_JOINTS(SoundBefore)
