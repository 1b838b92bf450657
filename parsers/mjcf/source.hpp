// SPDX-License-Identifier: BSD-2-Clause
// An MJCF file with all files that it includes, as one tree of elements.
#pragma once

#include "xml/document.hpp"

#include <dyn/parsers/options.hpp>

#include <memory>
#include <string>
#include <unordered_map>
#include <vector>

namespace dyn::mjcf {

using tinyxml2::XMLElement;

/// The deepest nesting of bodies, frames and default classes, and of includes.
constexpr int deepest = 500;

class Source {
 public:
  /// Parses a text that messages call `file`, and reads the files that it includes; their names begin in the folder of the including file or of
  /// `file`. Throws Error(file | syntax) for broken files, for a file that is included twice, for one outside the folder of `file` unless the options
  /// allow it, and for more than 64 MB altogether.
  Source(const std::string& text, const std::string& file, Files files);

  const XMLElement& root() const { return documents_.front()->robot(); }
  /// The document that an element belongs to, which reads the element's attributes.
  const xml::Document& of(const XMLElement& e) const { return *document_.at(e.GetDocument()); }
  Where where(const XMLElement& e, const std::string& joint = {}) const { return of(e).where(e, joint); }
  [[noreturn]] void fail(const XMLElement& e, const std::string& why, ErrorCode code = ErrorCode::model) const { of(e).fail(e, why, code); }

  /// Calls f for each element below e, in order. The elements of an included file take the place of <include>.
  template <class F>
  void forEach(const XMLElement& e, const F& f) const {
    for (const XMLElement* child = e.FirstChildElement(); child; child = child->NextSiblingElement()) {
      const auto included = included_.find(child);
      if (included == included_.end()) {
        f(*child);
      } else {
        forEach(included->second->robot(), f);
      }
    }
  }

  /// Throws Error(file) if a file that an element names does not exist, or if it lies outside the folder of the main file and the options do not
  /// allow that.
  void checkAllowed(const XMLElement& e, const std::string& path) const;
  /// The folder of the main file; empty for the working directory.
  const std::string& folder() const { return folder_; }

  /// Remarks of all documents about numbers.
  std::vector<std::string> notes() const;

 private:
  void add(std::unique_ptr<xml::Document> document);
  void include(const XMLElement& e, int depth);
  void findIncludes(const xml::Document& document, int depth);

  std::string folder_;
  Files files_;
  std::uintmax_t bytes_ = 0;
  std::vector<std::unique_ptr<xml::Document>> documents_;
  std::unordered_map<const tinyxml2::XMLDocument*, const xml::Document*> document_;
  std::unordered_map<const XMLElement*, const xml::Document*> included_;  ///< <include> -> the file
  std::unordered_map<std::string, Where> seen_;                           ///< canonical path -> the <include> that named it
};

}  // namespace dyn::mjcf
