#include "sections.hpp"

#include <dyn/error.hpp>

#include <algorithm>
#include <fstream>

namespace dyn::tool {

Section peerSection(const std::string& file) {
  const Where where{file, 0, ""};
  const nlohmann::json rows = nlohmann::json::parse(std::ifstream(file), nullptr, false);
  if (rows.is_discarded() || !rows.is_array()) throw Error(ErrorCode::syntax, "is not what tools/bench-peers writes", where);
  Section out;
  out.id = "peers";
  out.title = "Other libraries, the same work";
  out.text = {
      "All libraries in one process, in turn, on the same robots: times of random states, errors at rest against the fifty-digit reference, relative "
      "to "
      "the largest entry. Those that are not installed are not here, and those that give something else for a robot are left out for it."};
  out.table.columns = {"robot", "task", "library", "version", "ns a call", "quartile 1", "quartile 3", "error relative [u]"};
  std::vector<std::string> robots;
  try {
    for (const auto& row : rows) {
      const std::string robot = row.at("robot");
      if (std::find(robots.begin(), robots.end(), robot) == robots.end()) robots.push_back(robot);
    }
    for (const std::string& robot : robots) {
      benchmark::LineChart chart(robot, {"relative error [u]", benchmark::Scale::logarithmic}, {"ns a call", benchmark::Scale::logarithmic});
      chart.joinPoints(false);
      for (const auto& row : rows) {
        if (row.at("robot") != robot) continue;
        const double error = row.at("error_u"), ns = row.at("ns");
        chart.add(row.at("library"), std::max(error, 0.01), ns, row.at("task"));
        out.table.rows.push_back(
            {row.at("robot"), row.at("task"), row.at("library"), row.at("version"), ns, row.at("ns_low"), row.at("ns_high"), error});
      }
      out.charts.push_back(std::move(chart));
    }
  } catch (const nlohmann::json::exception& e) {
    throw Error(ErrorCode::syntax, std::string("is not what tools/bench-peers writes: ") + e.what(), where);
  }
  return out;
}

}  // namespace dyn::tool
