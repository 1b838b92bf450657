// What of a file the reader knows: names, attributes and how often an element may be there. All else is said.
#pragma once

#include "document.hpp"

namespace dyn::urdf {

/// A note for each kind of element and attribute that nothing reads, and of elements after the first where only that counts, with how often and the
/// first line. Not below <visual> and <libdyn>: pictures are nobody's business here, and parameters of joints are judged against their types.
void noteUnread(const Document& document);

}  // namespace dyn::urdf
