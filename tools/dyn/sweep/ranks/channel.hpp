// SPDX-License-Identifier: BSD-2-Clause
// Ranks whose messages another program carries. The Python function sweep() does so by mpi4py, so that dyn itself needs no MPI.
#pragma once

#include "ranks/ranks.hpp"

namespace dyn::tool::sweep {

/// The variable DYN_SWEEP_CHANNEL, "RANK COUNT FD": the number of this process, how many there are, and a socket. A message is a line with the other
/// rank's number and the bytes of the text, then the text.
struct ChannelPlace {
  int rank = 0, count = 1, socket = -1;
  /// Returns nothing if the variable is not set. Throws Error(argument) if it is not understood. Other programs do not inherit the socket.
  static std::optional<ChannelPlace> fromEnvironment();
};

/// The process ends if the other program closes the socket, as it does under MPI if another rank dies.
std::unique_ptr<Connection> channelConnection(const ChannelPlace& place);

}  // namespace dyn::tool::sweep
