#include "trajectory.hpp"

#include <dyn/error.hpp>
#include <dyn/file.hpp>

#include <report/line_chart.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace dyn::tool {

namespace {

/// In the fewest digits that read back to the same number, whatever the locale.
void append(std::string& out, double x) {
  char text[32];
  out.append(text, std::to_chars(text, text + sizeof text, x).ptr);
}

/// A joint's name, with the entry's number where it has several.
std::vector<std::string> columnNames(const CompactModel& model, bool configuration) {
  std::vector<std::string> names(static_cast<std::size_t>(configuration ? model.nq() : model.nv()));
  for (const JointRecord& joint : model.joints()) {
    const int first = configuration ? joint.idx_q : joint.idx_v, count = configuration ? joint.nq : joint.nv;
    for (int k = 0; k < count; ++k) names[static_cast<std::size_t>(first + k)] = count == 1 ? joint.name : joint.name + "[" + std::to_string(k) + "]";
  }
  return names;
}

/// As a field of a table: quoted where it must be.
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

void Trajectory::plot(const std::string& path) const {
  benchmark::LineChart chart(model_.name() + ": configuration over time", {"t [s]"}, {"q [rad, m]"});
  chart.markPoints(false);
  const std::vector<std::string> names = columnNames(model_, true);
  for (std::size_t c = 0; c < names.size(); ++c)
    for (std::size_t k = 0; k < times_.size(); ++k) chart.add(names[c], times_[k], q_[k][static_cast<Eigen::Index>(c)]);
  chart.write(path);
}

}  // namespace dyn::tool
