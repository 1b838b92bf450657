// What collision and distance share: a pair's two volumes where they are.
#pragma once

#include "geometry/geometry_impl.hpp"
#include "geometry/narrow.hpp"

#include <string>

namespace dyn {

struct PlacedPair {
  const Volume &a, &b;
  const SE3<double>&oMa, &oMb;
  SE3<double> aMb;
};

inline PlacedPair placed(const GeometryImpl& m, const GeometryDataImpl& d, int pair) {
  const auto [a, b] = m.pairs[static_cast<std::size_t>(pair)];
  const auto i = static_cast<std::size_t>(a), j = static_cast<std::size_t>(b);
  const SE3<double>&oMa = d.placement[i], &oMb = d.placement[j];
  return {*m.volumes[i], *m.volumes[j], oMa, oMb, {transpose(oMa.R) * oMb.R, oMa.actInv(oMb.p)}};
}

/// How far the bounding spheres of a pair are apart; -infinity where one is a half-space.
inline double sphereBound(const GeometryImpl& m, const GeometryDataImpl& d, int pair) {
  const auto [a, b] = m.pairs[static_cast<std::size_t>(pair)];
  const auto i = static_cast<std::size_t>(a), j = static_cast<std::size_t>(b);
  return norm(d.center[i] - d.center[j]) - m.volumes[i]->radius() - m.volumes[j]->radius();
}

/// Joints are those of the model that the geometry was compiled for, and of its copies.
inline void checkModel(const char* function, const CompactModel& model, const GeometryModel& geometry) {
  if (&geometry.impl().model->impl() != &model.impl())
    throw Error(ErrorCode::argument, std::string(function) + ": the geometry was compiled for another model; compile one for this");
}

/// Data is of the geometry that it was made for, and of its copies.
template <class AnyGeometryData>
auto& dataOf(const char* function, const GeometryModel& geometry, AnyGeometryData& data) {
  auto& d = data.impl();
  if (&d.model.impl() != &geometry.impl())
    throw Error(ErrorCode::argument, std::string(function) + ": this GeometryData was made for another GeometryModel");
  return d;
}

inline void checkPair(const GeometryImpl& m, int pair) {
  if (pair < 0 || static_cast<std::size_t>(pair) >= m.pairs.size())
    throw Error(ErrorCode::argument, "pair " + std::to_string(pair) + " does not exist; there are " + std::to_string(m.pairs.size()));
}

}  // namespace dyn
