// SPDX-License-Identifier: BSD-2-Clause
// The elements and attributes that a reader knows, and how often an element may occur. Everything else becomes a note.
#pragma once

#include "document.hpp"

#include <map>
#include <string>
#include <vector>

namespace dyn::urdf {

using Names = std::vector<std::string>;

/// The attributes and children of one element that the reader knows.
struct ElementWords {
  Names attributes;
  Names once;  ///< children of which only the first counts
  Names any;   ///< children that may occur several times
};

/// Elements by name, or by "PARENT/NAME" where the parent matters.
using Vocabulary = std::map<std::string, ElementWords>;

/// The elements of URDF. <visual>, <collision_checking> and <libdyn> are not in it, so they are not looked into: materials do not matter here, and
/// joint parameters are checked against their types.
const Vocabulary& vocabulary();

/// Adds a note for each kind of element and attribute that is not in the vocabulary, and for elements after the first where only the first counts. A
/// note says how often they occur and in which line first.
void noteUnread(const Document& document, const Vocabulary& words = vocabulary());

}  // namespace dyn::urdf
