// The makers, one a file; those whose library was not found are not compiled.
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
