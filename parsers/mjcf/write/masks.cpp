// SPDX-License-Identifier: BSD-2-Clause
#include "masks.hpp"

#include <algorithm>
#include <string>

namespace dyn::mjcf {

namespace {

constexpr std::size_t most_classes = 31, most_volumes = 500;
/// Whether two classes are checked against each other. Volumes of one body do not decide it, because they are never checked.
enum : char { undecided, yes, no };

}  // namespace

Masks::Masks(const Model& model) {
  std::unordered_map<std::string, std::size_t> bodies;
  std::unordered_map<std::string, std::vector<std::size_t>> named;
  std::vector<std::vector<std::size_t>> on(model.bodies.size());
  for (std::size_t i = 0; i < model.bodies.size(); ++i) bodies.emplace(model.bodies[i].name, i);
  for (std::size_t k = 0; k < model.geometries.size(); ++k) {
    const GeometryDescription& g = model.geometries[k];
    if (g.role != GeometryDescription::Role::collision) continue;
    named[g.name].push_back(k);
    on[static_cast<std::size_t>(g.body)].push_back(k);
  }
  // A name is that of a body, or else of a volume, as in compileGeometry().
  const auto meant = [&](const std::string& name) {
    const auto body = bodies.find(name);
    if (body != bodies.end()) return on[body->second];
    const auto volumes = named.find(name);
    return volumes == named.end() ? std::vector<std::size_t>{} : volumes->second;
  };
  std::vector<std::size_t> volumes, number(model.geometries.size());
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (const DisabledCollision& d : model.disabled_collisions) {
    if (bodies.count(d.body) && bodies.count(d.other)) continue;  // these are excluded as bodies
    for (const std::size_t a : meant(d.body))
      for (const std::size_t b : meant(d.other)) pairs.emplace_back(a, b);
  }
  for (const auto& [a, b] : pairs) volumes.insert(volumes.end(), {a, b});
  std::sort(volumes.begin(), volumes.end());
  volumes.erase(std::unique(volumes.begin(), volumes.end()), volumes.end());
  if (volumes.size() > most_volumes) {
    complete_ = false;
    return;
  }
  for (std::size_t k = 0; k < volumes.size(); ++k) number[volumes[k]] = k;
  std::vector<std::vector<bool>> apart(volumes.size(), std::vector<bool>(volumes.size()));
  for (const auto& [a, b] : pairs) apart[number[a]][number[b]] = apart[number[b]][number[a]] = true;
  complete_ = classify(model, volumes, apart);
  if (!complete_) class_.clear();
}

bool Masks::classify(const Model& model, const std::vector<std::size_t>& volumes, const std::vector<std::vector<bool>>& apart) {
  const auto body = [&](std::size_t x) { return model.geometries[volumes[x]].body; };
  /// Whether two volumes are checked against the same others.
  const auto alike = [&](std::size_t x, std::size_t y) {
    for (std::size_t z = 0; z < volumes.size(); ++z)
      if (body(z) != body(x) && body(z) != body(y) && apart[x][z] != apart[y][z]) return false;
    return true;
  };
  std::vector<std::vector<std::size_t>> members;  // of each class
  std::vector<std::size_t> chosen;                // the class of each volume
  for (std::size_t x = 0; x < volumes.size(); ++x) {
    std::size_t k = 0;
    while (k < members.size() && !std::all_of(members[k].begin(), members[k].end(), [&](std::size_t y) { return alike(x, y); })) ++k;
    if (k + 1 >= most_classes) return false;
    if (k == members.size()) members.emplace_back();
    members[k].push_back(x);
    chosen.push_back(k + 1);
    class_[&model.geometries[volumes[x]]] = k + 1;
  }
  // Class 0 are the volumes that are in no disabled pair.
  checked_.assign(members.size() + 1, std::vector<char>(members.size() + 1, undecided));
  for (std::size_t k = 0; k < checked_.size(); ++k) checked_[0][k] = checked_[k][0] = yes;
  for (std::size_t x = 0; x < volumes.size(); ++x)
    for (std::size_t y = 0; y < volumes.size(); ++y) {
      if (body(x) == body(y)) continue;
      char& known = checked_[chosen[x]][chosen[y]];
      const char is = apart[x][y] ? no : yes;
      if (known != undecided && known != is) return false;
      known = is;
    }
  return true;
}

std::pair<int, int> Masks::of(const GeometryDescription& g) const {
  const auto known = class_.find(&g);
  const std::size_t k = known == class_.end() ? 0 : known->second;
  int affinity = k == 0 ? 1 : 0;
  for (std::size_t c = 0; k > 0 && c <= k; ++c)
    if (checked_[k][c] != no) affinity |= 1 << c;
  return {1 << k, affinity};
}

}  // namespace dyn::mjcf
