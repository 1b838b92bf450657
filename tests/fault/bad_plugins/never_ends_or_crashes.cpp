// SPDX-License-Identifier: BSD-2-Clause
// The plugin has a type whose pose never returns, a type whose pose aborts the process, and a sound type.
#include <dyn_sdk/joint_plugin.hpp>

#include <cstdlib>

struct NeverEnds : dyn::sdk::Joint<NeverEnds, 1> {
  static constexpr const char* name = "never_ends";
  static constexpr const char* summary = "for tests";
  template <class S>
  static dyn::SE3<S> pose(const S* q, const dyn::sdk::Constants&) {
    for (volatile bool never = true; never;) {
    }
    return {dyn::Mat3<S>::identity(), {q[0], S(0), S(0)}};
  }
};

struct Crashes : dyn::sdk::Joint<Crashes, 1> {
  static constexpr const char* name = "crashes";
  static constexpr const char* summary = "for tests";
  template <class S>
  static dyn::SE3<S> pose(const S*, const dyn::sdk::Constants&) {
    std::abort();
  }
};

struct SoundAfterThem : dyn::sdk::Joint<SoundAfterThem, 1> {
  static constexpr const char* name = "sound_after_them";
  static constexpr const char* summary = "for tests";
  template <class S>
  static dyn::SE3<S> pose(const S* q, const dyn::sdk::Constants&) {
    return {dyn::Mat3<S>::identity(), {q[0], S(0), S(0)}};
  }
};

DYN_EXPORT_JOINTS(NeverEnds, Crashes, SoundAfterThem)
