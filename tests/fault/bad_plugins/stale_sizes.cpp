// SPDX-License-Identifier: BSD-2-Clause
// A test installs this file beside sound.so as its build for one processor. It has the same type and description, but two degrees of freedom.
#include <dyn_sdk/joint_plugin.hpp>

struct SoundOfTwo : dyn::sdk::Joint<SoundOfTwo, 2> {
  static constexpr const char* name = "sound_slider";
  static constexpr const char* summary = "for tests";
  template <class S>
  static dyn::SE3<S> pose(const S* q, const dyn::sdk::Constants&) {
    return {dyn::Mat3<S>::identity(), {q[0], q[1], S(0)}};
  }
};

DYN_EXPORT_JOINTS(SoundOfTwo)
