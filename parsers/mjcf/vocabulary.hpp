// SPDX-License-Identifier: BSD-2-Clause
// The elements and attributes that the reader knows. Everything else becomes a note.
#pragma once

#include "source.hpp"
#include "xml/notes.hpp"

namespace dyn::mjcf {

/// Whether the reader reads this attribute of the element <kind>.
bool reads(const std::string& kind, const char* attribute);

/// Whether this is <tendon> or the name of an actuator's type, whose default values are kept as they are written.
bool isDevice(const std::string& kind);

/// Counts each kind of element and attribute that nothing reads. Those of the appearance (colours, textures, lights) and of MuJoCo's memory are not
/// counted. Elements that are not read are not entered.
void noteUnread(const Source& source, xml::Notes& notes);

}  // namespace dyn::mjcf
