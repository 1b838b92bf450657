// SPDX-License-Identifier: BSD-2-Clause
// A URDF file as XML.
#pragma once

#include "xml/document.hpp"

namespace dyn::urdf {

using xml::largest_file;
using xml::onlyNumbers;

/// A document whose first element is <robot>.
struct Document : xml::Document {
  Document(const std::string& text, std::string file) : xml::Document(text, std::move(file), "robot") {}
};

}  // namespace dyn::urdf
