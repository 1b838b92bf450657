// SPDX-License-Identifier: BSD-2-Clause
#include "trajectory.hpp"

#include <dyn/error.hpp>
#include <dyn/file.hpp>

#include <report/line_chart.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>

namespace dyn::tool {

namespace {

/// Appends x with the fewest digits that read back to the same number, independent of the locale.
void append(std::string& out, double x) {
  char text[32];
  out.append(text, std::to_chars(text, text + sizeof text, x).ptr);
}

/// Each name is the joint's, with the entry's number if the joint has several.
std::vector<std::string> columnNames(const CompactModel& model, bool configuration) {
  std::vector<std::string> names(static_cast<std::size_t>(configuration ? model.nq() : model.nv()));
  for (const JointRecord& joint : model.joints()) {
    const int first = configuration ? joint.idx_q : joint.idx_v, count = configuration ? joint.nq : joint.nv;
    for (int k = 0; k < count; ++k) names[static_cast<std::size_t>(first + k)] = count == 1 ? joint.name : joint.name + "[" + std::to_string(k) + "]";
  }
  return names;
}

/// The text as a CSV field, quoted if necessary.
std::string field(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + '"';
}

}  // namespace

void Trajectory::add(double t, const Eigen::VectorXd& q, const Eigen::VectorXd& v, double energy) {
  times_.push_back(t);
  q_.push_back(q);
  v_.push_back(v);
  energies_.push_back(energy);
}

double Trajectory::energyDrift() const {
  double most = 0;
  for (const double e : energies_) most = std::max(most, std::abs(e - energies_.front()));
  return most;
}

std::string Trajectory::csv() const {
  std::string out = "t";
  for (const std::string& name : columnNames(model_, true)) out += ',' + field("q:" + name);
  for (const std::string& name : columnNames(model_, false)) out += ',' + field("v:" + name);
  out += ",energy\n";
  for (std::size_t k = 0; k < times_.size(); ++k) {
    append(out, times_[k]);
    const auto numbers = [&](const Eigen::VectorXd& values) {
      for (const double x : values) {
        out += ',';
        append(out, x);
      }
    };
    numbers(q_[k]);
    numbers(v_[k]);
    out += ',';
    append(out, energies_[k]);
    out += '\n';
  }
  return out;
}

Json Trajectory::json() const {
  Json out;
  out["model"] = model_.name();
  out["q_names"] = columnNames(model_, true);
  out["v_names"] = columnNames(model_, false);
  out["states"] = Json::array();
  for (std::size_t k = 0; k < times_.size(); ++k)
    out["states"].push_back(
        {{"t", times_[k]}, {"q", flat(q_[k].data(), q_[k].size())}, {"v", flat(v_[k].data(), v_[k].size())}, {"energy", energies_[k]}});
  return out;
}

void Trajectory::write(const std::string& path) const { replaceFile(path, path.ends_with(".csv") ? csv() : json().dump(1) + '\n'); }

namespace {

/// Units of the coordinates of a joint type that comes with libdyn; empty for other types.
std::vector<std::string> unitsOf(const std::string& type) {
  const std::string angle = "rad", length = "m", turn = "cos, sin", quaternion = "quaternion";
  static const std::map<std::string, std::vector<std::string>> known = {
      {"revolute", {angle}},
      {"helical", {angle}},
      {"prismatic", {length}},
      {"continuous", {turn, turn}},
      {"cylindrical", {angle, length}},
      {"universal", {angle, angle}},
      {"spherical_zyx", {angle, angle, angle}},
      {"ellipsoid", {angle, angle, angle}},
      {"translation", {length, length, length}},
      {"planar", {length, length, turn, turn}},
      {"spherical", {quaternion, quaternion, quaternion, quaternion}},
      {"free_flyer", {length, length, length, quaternion, quaternion, quaternion, quaternion}}};
  const auto found = known.find(type);
  return found == known.end() ? std::vector<std::string>() : found->second;
}

/// Coordinates that are drawn together: they have the same unit, and their joints form a chain without branches.
struct Panel {
  std::string first, last, unit;
  std::vector<int> coordinates;
};

std::vector<Panel> panelsOf(const CompactModel& model) {
  constexpr std::size_t most = 8;  // curves that colours and names can distinguish
  const std::vector<JointRecord>& joints = model.joints();
  std::vector<int> children(joints.size());
  for (std::size_t j = 1; j < joints.size(); ++j) ++children[static_cast<std::size_t>(joints[j].parent)];
  std::vector<Panel> out;
  std::size_t begin = 0;  // first panel of the present limb
  for (std::size_t j = 1; j < joints.size(); ++j) {
    const JointRecord& joint = joints[j];
    const bool goes_on = static_cast<std::size_t>(joint.parent) + 1 == j && joint.parent != 0 && children[j - 1] == 1;
    if (!goes_on) begin = out.size();
    const std::vector<std::string> units = unitsOf(joint.type);
    for (int k = 0; k < joint.nq; ++k) {
      const std::string unit = static_cast<std::size_t>(k) < units.size() ? units[static_cast<std::size_t>(k)] : "";
      auto panel = std::find_if(out.begin() + static_cast<std::ptrdiff_t>(begin), out.end(),
                                [&](const Panel& p) { return p.unit == unit && p.coordinates.size() < most; });
      if (panel == out.end()) panel = out.insert(out.end(), {joint.name, "", unit, {}});
      panel->last = joint.name;
      panel->coordinates.push_back(joint.idx_q + k);
    }
  }
  return out;
}

}  // namespace

void Trajectory::plot(const std::string& path) const {
  const std::vector<std::string> names = columnNames(model_, true);
  std::vector<benchmark::LineChart> charts;
  std::string still;
  int stand = 0;
  for (const Panel& panel : panelsOf(model_)) {
    const std::string limb = panel.first == panel.last ? panel.first : panel.first + " to " + panel.last;
    benchmark::LineChart chart(model_.name() + ": " + limb, {"t [s]"}, {panel.unit.empty() ? "q" : "q [" + panel.unit + "]"});
    chart.markPoints(false);
    chart.nameAtEnds(true);
    chart.setHeight(180);
    bool moves = false;
    for (const int c : panel.coordinates) {
      const std::string& name = names[static_cast<std::size_t>(c)];
      double least = q_.empty() ? 0 : q_[0][c], most = least;
      for (const Eigen::VectorXd& q : q_) {
        least = std::min(least, q[c]);
        most = std::max(most, q[c]);
      }
      // A constant coordinate would only widen the axis of the moving ones.
      if (most - least <= 1e-9 * std::max(std::abs(least), std::abs(most))) {
        if (++stand <= 8) still += (stand == 1 ? "constant: " : ", ") + name + " = " + benchmark::shortNumber(least);
        continue;
      }
      moves = true;
      for (std::size_t k = 0; k < times_.size(); ++k) chart.add(name, times_[k], q_[k][c]);
    }
    if (moves) charts.push_back(std::move(chart));
  }
  if (charts.empty()) charts.emplace_back(model_.name() + ": nothing moves", benchmark::LineChart::Label{"t [s]"}, benchmark::LineChart::Label{"q"});
  if (stand > 8) still += " and " + std::to_string(stand - 8) + " more";
  charts.front().note(still);
  replaceFile(path, benchmark::stacked(charts));
}

}  // namespace dyn::tool
