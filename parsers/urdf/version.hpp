// SPDX-License-Identifier: BSD-2-Clause
// The version of the format that a file declares: <robot version="1.2">.
#pragma once

#include "document.hpp"

#include <dyn/parsers/options.hpp>

namespace dyn::urdf {

/// Throws Error(model) if the file is of a version after 1.2, the newest that this reader knows; with Versions::any it adds a note instead. Adds a
/// note if the attribute is no version. Elements of versions 1.1 (quat_xyzw) and 1.2 (capsules, limits of acceleration and jerk) are read in files of
/// all versions.
void checkVersion(const Document& document, Versions versions);

}  // namespace dyn::urdf
