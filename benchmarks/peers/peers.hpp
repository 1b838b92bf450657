// SPDX-License-Identifier: BSD-2-Clause
// The functions that make a Peer, one per source file. A file is not compiled if its library was not found.
#pragma once

#include "peers/peer.hpp"

#include <algorithm>

namespace dyn::benchmark::peers {

std::unique_ptr<Peer> makeLibdyn(const Robot& robot);
std::unique_ptr<Peer> makeMujoco(const Robot& robot);
std::unique_ptr<Peer> makeDart(const Robot& robot);
std::unique_ptr<Peer> makeKdl(const Robot& robot);
std::unique_ptr<Peer> makeBullet(const Robot& robot);
std::unique_ptr<Peer> makeSimbody(const Robot& robot);
std::unique_ptr<Peer> makePinocchio(const Robot& robot);
std::unique_ptr<Peer> makeRbdl(const Robot& robot);

}  // namespace dyn::benchmark::peers
