// SPDX-License-Identifier: BSD-2-Clause
// While it is loaded, the plugin makes the processor flush subnormal numbers to zero, as libraries linked with -ffast-math do.
#include <dyn_sdk/joint_plugin.hpp>

#include <cfenv>
#include <string>

namespace {
const std::string text(64, 'x');
}

struct Sound : dyn::sdk::Joint<Sound, 1> {
  static constexpr const char* name = "flushing_slider";
  static constexpr const char* summary = "for tests";
  template <class S>
  static dyn::SE3<S> pose(const S* q, const dyn::sdk::Constants&) {
    return {dyn::Mat3<S>::identity(), {q[0], S(0), S(0)}};
  }
};

namespace {
struct Flusher {
  Flusher() {
#if defined(__x86_64__)
    fenv_t all;
    std::fegetenv(&all);
    all.__mxcsr |= 0x8040;  // flushes results and operands
    std::fesetenv(&all);
#endif
  }
} const flusher;
}  // namespace

DYN_EXPORT_JOINTS(Sound)
