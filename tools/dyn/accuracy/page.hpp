// SPDX-License-Identifier: BSD-2-Clause
// The report of `dyn accuracy`: sections of text, pictures and tables, as one self-contained page and as JSON.
#pragma once

#include "states.hpp"

#include <report/line_chart.hpp>

#include <string>
#include <vector>

namespace dyn::tool {

/// Rows of numbers and words. The page and the JSON file have the same rows.
struct Table {
  std::vector<std::string> columns;
  std::vector<std::vector<Json>> rows;
};

struct Section {
  std::string id, title;
  std::vector<std::string> text;  ///< paragraphs
  std::vector<benchmark::LineChart> charts;
  Table table;
};

class Page {
 public:
  explicit Page(std::string title) : title_(std::move(title)) {}
  void add(Section section) { sections_.push_back(std::move(section)); }
  /// Writes index.html and report.json to a folder, which must exist. Throws Error(file) if they cannot be written.
  void write(const std::string& folder) const;

 private:
  std::string html() const;
  Json json() const;

  std::string title_;
  std::vector<Section> sections_;
};

/// The processor and date of the measurements, such as "AMD EPYC ..., 2026-11-21".
std::string machineAndDay();

}  // namespace dyn::tool
