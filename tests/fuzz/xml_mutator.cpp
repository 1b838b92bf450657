// SPDX-License-Identifier: BSD-2-Clause
// Mutates the tree of an XML document. libFuzzer's own mutations change bytes, and only one result in a hundred is still XML.
#include <tinyxml2.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <random>
#include <string>
#include <vector>

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

namespace {

using Random = std::minstd_rand;
using tinyxml2::XMLAttribute;
using tinyxml2::XMLElement;

constexpr const char* values[] = {"",
                                  "0",
                                  "-1",
                                  "1",
                                  "0.5",
                                  "1e308",
                                  "-1e308",
                                  "1e-320",
                                  "nan",
                                  "inf",
                                  "1 0 0",
                                  "0 0 1",
                                  "0 0",
                                  "1 2 3 4",
                                  "0 0 0 1",
                                  "1e3",
                                  "3.14159265",
                                  "fixed",
                                  "floating",
                                  "planar",
                                  "revolute",
                                  "continuous",
                                  "prismatic",
                                  "a",
                                  "b",
                                  "base_link",
                                  "world",
                                  "universe",
                                  "true",
                                  "false",
                                  "package://a/b.stl",
                                  "cam_follower",
                                  "composite",
                                  "hinge",
                                  "slide",
                                  "ball",
                                  "free",
                                  "mesh",
                                  "screw",
                                  "universal",
                                  "__model__"};

std::vector<XMLElement*> elementsOf(tinyxml2::XMLDocument& document) {
  std::vector<XMLElement*> all;
  for (XMLElement* e = document.FirstChildElement(); e; e = e->NextSiblingElement()) all.push_back(e);
  for (std::size_t k = 0; k < all.size() && all.size() < 1000; ++k)
    for (XMLElement* e = all[k]->FirstChildElement(); e; e = e->NextSiblingElement()) all.push_back(e);
  return all;
}

template <class T>
T& any(std::vector<T>& items, Random& random) {
  return items[random() % items.size()];
}

std::vector<const XMLAttribute*> attributesOf(const XMLElement& e) {
  std::vector<const XMLAttribute*> all;
  for (const XMLAttribute* a = e.FirstAttribute(); a; a = a->Next()) all.push_back(a);
  return all;
}

bool isAbove(const tinyxml2::XMLNode* above, const tinyxml2::XMLNode* node) {
  for (; node; node = node->Parent())
    if (node == above) return true;
  return false;
}

void change(tinyxml2::XMLDocument& document, Random& random) {
  std::vector<XMLElement*> elements = elementsOf(document);
  if (elements.empty()) return;
  XMLElement* e = any(elements, random);
  XMLElement* other = any(elements, random);
  std::vector<const XMLAttribute*> attributes = attributesOf(*e), others = attributesOf(*other);
  switch (random() % 7) {
    case 0:
      if (e->Parent() && e != document.RootElement()) e->Parent()->DeleteChild(e);
      break;
    case 1:  // puts a copy of the element elsewhere
      if (!isAbove(e, other)) other->InsertEndChild(e->DeepClone(&document));
      break;
    case 2:
      if (!attributes.empty()) e->SetAttribute(std::string(any(attributes, random)->Name()).c_str(), values[random() % std::size(values)]);
      break;
    case 3:
      if (!attributes.empty()) e->DeleteAttribute(std::string(any(attributes, random)->Name()).c_str());
      break;
    case 4:  // copies an attribute of another element
      if (!others.empty()) {
        const XMLAttribute* a = any(others, random);
        e->SetAttribute(std::string(a->Name()).c_str(), std::string(a->Value()).c_str());
      }
      break;
    case 5:
      e->SetName(std::string(other->Name()).c_str());
      break;
    default:  // moves the element
      if (e != document.RootElement() && !isAbove(e, other)) other->InsertEndChild(e);
  }
}

}  // namespace

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size, unsigned seed) {
  Random random(seed);
  tinyxml2::XMLDocument document;
  if (random() % 4 == 0 || document.Parse(reinterpret_cast<const char*>(data), size) != tinyxml2::XML_SUCCESS)
    return LLVMFuzzerMutate(data, size, max_size);
  for (unsigned k = 0; k <= random() % 3; ++k) change(document, random);
  tinyxml2::XMLPrinter printer(nullptr, true);
  document.Print(&printer);
  const std::size_t length = static_cast<std::size_t>(printer.CStrSize()) - 1;
  if (length > max_size) return LLVMFuzzerMutate(data, size, max_size);
  std::memcpy(data, printer.CStr(), length);
  return length;
}
