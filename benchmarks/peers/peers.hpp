// SPDX-License-Identifier: BSD-2-Clause
// The functions that make a Peer. libdyn's is part of the program. Each other library is behind a module of its own: modules may be compiled for
// other processors than the program, and then Eigen's inline functions differ, so that they must not be shared.
#pragma once

#include "peers/peer.hpp"

#include <algorithm>

namespace dyn::benchmark::peers {

std::unique_ptr<Peer> makeLibdyn(const Robot& robot);

}  // namespace dyn::benchmark::peers

/// The source of each module defines this function. The caller owns the result, which is null if the library cannot represent the robot. May throw
/// std::exception.
extern "C" __attribute__((visibility("default"))) dyn::benchmark::peers::Peer* makePeer(const dyn::benchmark::peers::Robot& robot);
