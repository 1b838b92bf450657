// A function that is chosen while the dynamic loader links it, without any constructor, ends the process.
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
