// SPDX-License-Identifier: BSD-2-Clause
// The elements of SDF that this library reads, and how many numbers each has. libsdformat takes "0,5" for 0 and does not say what it leaves out.
#pragma once

#include "common/reader.hpp"
#include "xml/document.hpp"

#include <string>

namespace dyn::sdf {

class Vocabulary {
 public:
  /// `where` is added to notes.
  Vocabulary(const xml::Document& document, reader::Notes& notes, std::string where) : d_(document), notes_(notes), where_(std::move(where)) {}

  /// Checks the numbers of an element whose parent is known; throws Error(syntax). Notes the element if nobody reads it.
  void check(const tinyxml2::XMLElement& e);

 private:
  const xml::Document& d_;
  reader::Notes& notes_;
  std::string where_;
};

}  // namespace dyn::sdf
