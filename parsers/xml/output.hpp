// SPDX-License-Identifier: BSD-2-Clause
// XML text: elements with attributes whose numbers read back to the same bits, and a list of what the format cannot say.
#pragma once

#include <dyn/error.hpp>
#include <dyn/model/model.hpp>
#include <dyn/spatial/vector3.hpp>

#include <tinyxml2.h>

#include <map>
#include <string>
#include <vector>

namespace dyn::xml {

class Output {
 public:
  /// `format` is the format's name in messages.
  explicit Output(const char* format) : format_(format) {}

  void open(const char* element) { printer_.OpenElement(element); }
  void close() { printer_.CloseElement(); }
  void put(const char* attribute, const std::string& value) { printer_.PushAttribute(attribute, value.c_str()); }
  void put(const char* attribute, double value) { put(attribute, std::vector<double>{value}); }
  /// Throws Error(model) for a number that is not finite, which no XML format of models has.
  void put(const char* attribute, const std::vector<double>& values);
  void put(const char* attribute, const Vec3<double>& x) { put(attribute, std::vector<double>{x.x, x.y, x.z}); }
  /// Writes an element of another document, with all that is in it.
  void copy(const tinyxml2::XMLElement& element) { element.Accept(&printer_); }
  /// Writes an element that has one attribute.
  template <class Value>
  void element(const char* name, const char* attribute, const Value& value) {
    open(name);
    put(attribute, value);
    close();
  }

  /// Counts something that the format cannot say, with its first owner.
  void lose(const std::string& what, const std::string& owner = {});
  /// Counts a relative path, which began in the folder of `file`. That may be another folder than the one of the file to write.
  void loseFolder(const std::string& path, const std::string& file);
  /// Counts the model's groups, end effectors, virtual and passive joints, which no format but SRDF says.
  void loseGroups(const Model& model);
  /// Returns a line for each kind of what was lost.
  std::vector<std::string> lost() const;
  /// Returns the text, with the XML declaration.
  std::string text() const;

 private:
  struct Loss {
    int count = 0;
    std::string first;
  };
  const char* format_;
  tinyxml2::XMLPrinter printer_;
  std::map<std::string, Loss> lost_;
};

}  // namespace dyn::xml
