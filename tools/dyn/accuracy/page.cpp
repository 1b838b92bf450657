// SPDX-License-Identifier: BSD-2-Clause
#include "page.hpp"

#include <dyn/file.hpp>

#include <ctime>
#include <fstream>
#include <sstream>

namespace dyn::tool {

namespace {

using benchmark::escaped;

constexpr const char* style = R"(
:root{color-scheme:light dark;--paper:#fff;--ink:#222;--faint:#666;--line:#ddd;--head:#f3f5f7}
@media (prefers-color-scheme:dark){:root{--paper:#16191d;--ink:#ddd;--faint:#99a;--line:#3a4048;--head:#22272e}}
*{box-sizing:border-box}
body{margin:0 auto;max-width:72rem;padding:1rem;background:var(--paper);color:var(--ink);font:16px/1.5 system-ui,sans-serif}
h1{font-size:1.6rem;line-height:1.2}h2{font-size:1.25rem;margin-top:2.5rem;border-top:1px solid var(--line);padding-top:1rem}
p{max-width:46rem}a{color:inherit}nav a{display:inline-block;margin-right:1rem}
.charts{display:grid;gap:1rem;grid-template-columns:repeat(auto-fill,minmax(min(100%,30rem),1fr))}
.charts svg{width:100%;height:auto;border:1px solid var(--line);border-radius:6px}
details{margin-top:1rem}summary{cursor:pointer;padding:.4rem 0}
.table{overflow-x:auto}table{border-collapse:collapse;font-size:.85rem;white-space:nowrap}
th,td{padding:.25rem .6rem;border-bottom:1px solid var(--line);text-align:left}th{background:var(--head);position:sticky;top:0}
td.number{text-align:right;font-variant-numeric:tabular-nums}.faint{color:var(--faint)}
)";

std::string cell(const Json& value) {
  if (value.is_null()) return "<td class=\"number faint\">–</td>";
  if (value.is_number()) return "<td class=\"number\">" + benchmark::shortNumber(value.get<double>()) + "</td>";
  return "<td>" + escaped(value.get<std::string>()) + "</td>";
}

std::string html(const Table& table) {
  std::ostringstream out;
  out << "<details><summary>The numbers (" << table.rows.size() << " rows)</summary><div class=\"table\"><table><tr>";
  for (const std::string& column : table.columns) out << "<th>" << escaped(column) << "</th>";
  out << "</tr>\n";
  for (const auto& row : table.rows) {
    out << "<tr>";
    for (const Json& value : row) out << cell(value);
    out << "</tr>\n";
  }
  out << "</table></div></details>\n";
  return out.str();
}

}  // namespace

std::string Page::html() const {
  std::ostringstream out;
  out << "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">"
      << "<title>" << escaped(title_) << "</title><style>" << style << "</style></head>\n<body><h1>" << escaped(title_)
      << "</h1>\n<p class=\"faint\">" << escaped(machineAndDay()) << "</p>\n<nav>";
  for (const Section& s : sections_) out << "<a href=\"#" << escaped(s.id) << "\">" << escaped(s.title) << "</a> ";
  out << "</nav>\n";
  for (const Section& s : sections_) {
    out << "<section id=\"" << escaped(s.id) << "\"><h2>" << escaped(s.title) << "</h2>\n";
    for (const std::string& paragraph : s.text) out << "<p>" << escaped(paragraph) << "</p>\n";
    out << "<div class=\"charts\">\n";
    for (const benchmark::LineChart& chart : s.charts) out << chart.svg();
    out << "</div>\n";
    if (!s.table.rows.empty()) out << tool::html(s.table);
    out << "</section>\n";
  }
  out << "</body></html>\n";
  return out.str();
}

Json Page::json() const {
  Json out;
  out["title"] = title_;
  out["machine"] = machineAndDay();
  out["sections"] = Json::array();
  for (const Section& s : sections_) {
    Json rows = Json::array();
    for (const auto& row : s.table.rows) {
      Json entry;
      for (std::size_t k = 0; k < s.table.columns.size(); ++k) entry[s.table.columns[k]] = row[k];
      rows.push_back(std::move(entry));
    }
    out["sections"].push_back({{"id", s.id}, {"title", s.title}, {"rows", std::move(rows)}});
  }
  return out;
}

void Page::write(const std::string& folder) const {
  replaceFile(folder + "/index.html", html());
  replaceFile(folder + "/report.json", json().dump(1) + '\n');
}

std::string machineAndDay() {
  std::string processor = "an unknown processor", line;
  std::ifstream info("/proc/cpuinfo");
  while (std::getline(info, line))
    if (line.rfind("model name", 0) == 0 && line.find(": ") != std::string::npos) {
      processor = line.substr(line.find(": ") + 2);
      break;
    }
  char day[16] = "";
  const std::time_t now = std::time(nullptr);
  std::strftime(day, sizeof day, "%Y-%m-%d", std::gmtime(&now));
  return processor + ", " + day;
}

}  // namespace dyn::tool
