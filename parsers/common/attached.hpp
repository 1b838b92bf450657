// SPDX-License-Identifier: BSD-2-Clause
// Lists of the volumes and frames that are fixed to each body, and of the bodies that it carries, for writers.
#pragma once

#include <dyn/model/model.hpp>

#include <vector>

namespace dyn::reader {

/// Lists of what each body has, by its index and in the model's order.
struct Attached {
  /// Throws Error(model) for a model without the world, and for indices out of range. O(n).
  explicit Attached(const Model& model);
  std::vector<std::vector<const GeometryDescription*>> volumes;
  std::vector<std::vector<const FrameDescription*>> frames;
  std::vector<std::vector<std::size_t>> children;  ///< indices of bodies
};

}  // namespace dyn::reader
