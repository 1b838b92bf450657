// SPDX-License-Identifier: BSD-2-Clause
// Transforms external forces from the user's joint frames to the bodies' core frames.
#pragma once

#include "data/data_impl.hpp"

#include <dyn/error.hpp>

#include <string>

namespace dyn {

/// Returns null if there are none, else d.fext with an entry per body. Throws Error(size | argument).
inline const Force<double>* readExternalForces(const char* algorithm, const CompactImpl& m, DataImpl& d, const Force<double>* fext,
                                               std::size_t count) {
  if (count == 0) return nullptr;
  if (count != m.joints.size())
    throw Error(ErrorCode::size, std::string(algorithm) + ": fext has " + std::to_string(count) + " entries, the model wants " +
                                     std::to_string(m.joints.size()) + " (one a joint, the universe included)");
  if (fext == nullptr) throw Error(ErrorCode::argument, std::string(algorithm) + ": fext is a null pointer");
  for (int i = 0; i < m.bodies(); ++i) d.fext[i] = {};
  for (std::size_t j = 1; j < count; ++j) d.fext[m.body_of_joint[j]] = m.user_frame[j].act(fext[j]);
  return d.fext;
}

}  // namespace dyn
