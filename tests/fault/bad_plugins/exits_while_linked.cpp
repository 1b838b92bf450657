// SPDX-License-Identifier: BSD-2-Clause
// The resolver of an ifunc ends the process while the dynamic loader links the file, without any constructor.
#include <cstdlib>

namespace {
void nothing() {}
}  // namespace

extern "C" {
void (*chooseOne())() {
  _Exit(0);
  return nothing;
}
__attribute__((visibility("default"))) void chosen() __attribute__((ifunc("chooseOne")));
__attribute__((visibility("default"))) void (*choice)() = chosen;
}
