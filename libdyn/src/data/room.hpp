// Memory that there is not.
#pragma once

#include <cstddef>
#include <string>

namespace dyn {

/// Throws Error(memory) saying how much `what` takes, if that is more than this machine has: asking for it would succeed, and writing to it end the
/// process, or another one.
void checkRoom(const std::string& what, double bytes);

}  // namespace dyn
