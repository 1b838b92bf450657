// SPDX-License-Identifier: BSD-2-Clause
// Checks that a request for memory fits into this machine.
#pragma once

#include <cstddef>
#include <string>

namespace dyn {

/// Throws Error(memory) if `bytes` is more than the memory of this machine; the message says how much `what` takes. Without this check, the
/// allocation would succeed, and the system would end this process or another one when the memory is written.
void checkRoom(const std::string& what, double bytes);

}  // namespace dyn
