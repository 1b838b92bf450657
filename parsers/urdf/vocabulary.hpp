// SPDX-License-Identifier: BSD-2-Clause
// The elements and attributes that the reader knows, and how often an element may occur. Everything else becomes a note.
#pragma once

#include "document.hpp"

namespace dyn::urdf {

/// Adds a note for each kind of element and attribute that nothing reads, and for elements after the first where only the first counts. A note says
/// how often they occur and in which line first. <visual>, <collision_checking> and <libdyn> are not looked into: materials do not matter here, and
/// joint parameters are checked against their types.
void noteUnread(const Document& document);

}  // namespace dyn::urdf
