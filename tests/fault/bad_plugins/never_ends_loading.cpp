// Its static constructor waits for good.
#include <unistd.h>

namespace {
struct Waiter {
  Waiter() {
    while (true) pause();
  }
} const waiter;
}  // namespace
