// SPDX-License-Identifier: BSD-2-Clause
// The sections of the report of `dyn accuracy`.
#pragma once

#include "model_options.hpp"
#include "page.hpp"

#include <string>
#include <vector>

namespace dyn::tool {

/// A model with its description, which the fifty-digit reference reads. `path` and `root` are empty for built-in models.
struct Specimen {
  std::string path, root;
  Model description;
  CompactModel model;
};

/// Compiles without damping, friction and armature, which the reference does not model.
Specimen specimenOf(const Model& description, const JointRegistry& registry, bool lane_groups = true);

struct AccuracyOptions {
  std::vector<std::string> models, instruction_sets;
  std::string out = "accuracy", peers;
  bool quick = false, codegen = false;
};

/// Time against error of each algorithm in each mode, against the reference.
Section algorithmSection(const std::vector<Specimen>& specimens, const AccuracyOptions& options);
/// Time against error of the final state and against energy drift, for each integrator over its steps or tolerances.
Section motionSection(const std::vector<Specimen>& specimens, const AccuracyOptions& options);
/// Change of energy over a long time.
Section driftSection(const AccuracyOptions& options);
/// Errors and times against the length of a chain.
Section lengthSection(const AccuracyOptions& options);
/// Errors against the distance of the base.
Section distanceSection(const AccuracyOptions& options);
/// Errors of the functions of rotations and rigid motions against the angle.
Section lieSection(const AccuracyOptions& options);
/// Times and errors of other libraries' algorithms and motions, from the file that tools/bench-peers writes.
std::vector<Section> peerSections(const std::string& file);

}  // namespace dyn::tool
