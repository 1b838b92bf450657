// SPDX-License-Identifier: BSD-2-Clause
#include "data/room.hpp"

#include <dyn/error.hpp>

#include <unistd.h>

#include <cstdio>

namespace dyn {

void checkRoom(const std::string& what, double bytes) {
  static const double all = static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGE_SIZE));
  if (!(bytes > all)) return;
  char text[128];
  std::snprintf(text, sizeof text, " takes %.3g GB of memory, and this machine has %.3g GB; ask for less (see Need)", bytes / 1e9, all / 1e9);
  throw Error(ErrorCode::memory, what + text);
}

}  // namespace dyn
