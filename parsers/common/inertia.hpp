// SPDX-License-Identifier: BSD-2-Clause
// Whether any body can have an inertia, for all readers and writers.
#pragma once

#include <dyn/spatial/inertia.hpp>

namespace dyn::reader {

/// The faults of an inertia.
struct InertiaFaults {
  bool massless = false;    ///< it has a rotational inertia but no mass
  bool point = false;       ///< it has a mass but no rotational inertia, as a point has
  bool indefinite = false;  ///< it is not positive semi-definite; no body has it
  bool unreal = false;      ///< it violates the triangle inequality; no real body has it
};

/// Judges the mass and the inertia about the centre of mass. Numbers that were written with six digits pass, and so does the rounding relative to
/// the inertia about the body's origin: principal moments may be negative by 1e-6 of the largest entry and 1e-15 m |com|^2.
InertiaFaults faultsOf(const Inertia<double>& Y);

/// The faults in words, for messages.
/// @{
constexpr const char* massless_words = "it has an inertia but no mass";
constexpr const char* point_words = "it has a mass but no inertia, as a point has";
constexpr const char* indefinite_words = "its inertia is not positive semi-definite; no body has it";
constexpr const char* unreal_words = "its inertia violates the triangle inequality; no real body has it";
constexpr const char* anyway_words = " (Inertias::any, --inertia any, loads it all the same)";
/// @}

}  // namespace dyn::reader
