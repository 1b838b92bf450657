// SPDX-License-Identifier: BSD-2-Clause
// Shared by collision and distance: the two placed volumes of a pair, and checks of arguments.
#pragma once

#include "geometry/geometry_impl.hpp"
#include "geometry/narrow/narrow.hpp"

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

/// Returns the signed distance between the bounding spheres of a pair; -infinity if one geometry is a half-space.
inline double sphereBound(const GeometryImpl& m, const GeometryDataImpl& d, int pair) {
  const auto [a, b] = m.pairs[static_cast<std::size_t>(pair)];
  const auto i = static_cast<std::size_t>(a), j = static_cast<std::size_t>(b);
  return norm(d.center[i] - d.center[j]) - m.volumes[i]->radius() - m.volumes[j]->radius();
}

/// Throws Error(argument) unless the geometry was compiled for this model or a copy of it.
inline void checkModel(const char* function, const CompactModel& model, const GeometryModel& geometry) {
  if (&geometry.impl().model->impl() != &model.impl())
    throw Error(ErrorCode::argument, std::string(function) + ": the geometry was compiled for another model; compile one for this");
}

/// Throws Error(argument) unless the data was made for this geometry or a copy of it.
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
