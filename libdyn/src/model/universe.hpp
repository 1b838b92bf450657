// SPDX-License-Identifier: BSD-2-Clause
// Checks that a description has body 0, which the user's code can remove.
#pragma once

#include <dyn/error.hpp>
#include <dyn/model/model.hpp>

namespace dyn {

/// Throws Error(model) if the description has no body 0.
inline void requireUniverse(const Model& model) {
  if (model.bodies.empty())
    throw Error(ErrorCode::model, "the model '" + model.name + "' has no bodies; bodies[0] is the universe, which Model() makes: keep it");
}

}  // namespace dyn
