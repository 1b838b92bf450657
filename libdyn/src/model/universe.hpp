// Body 0 of a description, which users' code can take away.
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
