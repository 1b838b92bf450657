// SPDX-License-Identifier: BSD-2-Clause
#include "sections.hpp"

#include <dyn/error.hpp>

#include <algorithm>
#include <fstream>

namespace dyn::tool {

namespace {

std::vector<std::string> robotsOf(const nlohmann::json& rows) {
  std::vector<std::string> robots;
  for (const auto& row : rows) {
    const std::string robot = row.at("robot");
    if (std::find(robots.begin(), robots.end(), robot) == robots.end()) robots.push_back(robot);
  }
  return robots;
}

Section algorithms(const nlohmann::json& rows) {
  Section out;
  out.id = "peers";
  out.title = "Other libraries, the same work";
  out.text = {
      "All libraries in one process, in turn, on the same robots: times of random states, errors at rest against the fifty-digit reference, relative "
      "to "
      "the largest entry. Those that are not installed are not here, and those that give something else for a robot are left out for it."};
  out.table.columns = {"robot", "task", "library", "version", "ns a call", "quartile 1", "quartile 3", "error relative [u]"};
  for (const std::string& robot : robotsOf(rows)) {
    benchmark::LineChart chart(robot, {"relative error [u]", benchmark::Scale::logarithmic}, {"ns a call", benchmark::Scale::logarithmic});
    chart.joinPoints(false);
    for (const auto& row : rows) {
      if (row.at("robot") != robot) continue;
      const double error = row.at("error_u"), ns = row.at("ns");
      chart.add(row.at("library"), std::max(error, 0.01), ns, row.at("task"));
      out.table.rows.push_back({robot, row.at("task"), row.at("library"), row.at("version"), ns, row.at("ns_low"), row.at("ns_high"), error});
    }
    out.charts.push_back(std::move(chart));
  }
  return out;
}

Section motions(const nlohmann::json& rows) {
  Section out;
  out.id = "peer-motions";
  out.title = "Other libraries, the same motion";
  out.text = {
      "Robots fall from a bent posture, at rest and without torques, for half a second by each library's own integrators, in equal steps; down and "
      "to "
      "the left is better. Errors are against the fifty-digit reference, so that no library is judged by its own small steps.",
      "What limits each curve: the order of its method. With a method of first order a tenth of the error takes ten times the time."};
  out.table.columns = {"robot", "library", "version", "integrator", "steps", "seconds", "error [rad, m]"};
  for (const std::string& robot : robotsOf(rows)) {
    benchmark::LineChart chart(robot + " falling", {"error of the final configuration [rad, m]", benchmark::Scale::logarithmic},
                               {"seconds", benchmark::Scale::logarithmic});
    for (const auto& row : rows) {
      if (row.at("robot") != robot) continue;
      const double error = row.at("error"), seconds = row.at("seconds");
      const std::string library = row.at("library"), integrator = row.at("integrator");
      chart.add(library + ' ' + integrator, std::max(error, 1e-17), seconds);
      out.table.rows.push_back({robot, library, row.at("version"), integrator, row.at("steps"), seconds, error});
    }
    out.charts.push_back(std::move(chart));
  }
  return out;
}

}  // namespace

std::vector<Section> peerSections(const std::string& file) {
  const Where where{file, 0, ""};
  const nlohmann::json all = nlohmann::json::parse(std::ifstream(file), nullptr, false);
  if (all.is_discarded()) throw Error(ErrorCode::syntax, "is not what tools/bench-peers writes", where);
  try {
    return {algorithms(all.at("algorithms")), motions(all.at("motions"))};
  } catch (const nlohmann::json::exception& e) {
    throw Error(ErrorCode::syntax, std::string("is not what tools/bench-peers writes: ") + e.what(), where);
  }
}

}  // namespace dyn::tool
