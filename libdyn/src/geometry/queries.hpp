// SPDX-License-Identifier: BSD-2-Clause
// Shared by collision and distance: the two placed volumes of a pair, and checks of arguments.
#pragma once

#include "geometry/geometry_impl.hpp"
#include "geometry/narrow/fcl.hpp"
#include "number_text.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace dyn {

/// Throws Error(argument): FCL cannot answer for this pair.
[[noreturn]] inline void refuseByFcl(const GeometryImpl& m, int pair, const std::string& reason, const std::string& cure) {
  const auto [a, b] = m.pairs[static_cast<std::size_t>(pair)];
  throw Error(ErrorCode::argument, "FCL cannot compare '" + m.records[static_cast<std::size_t>(a)].name + "' with '" +
                                       m.records[static_cast<std::size_t>(b)].name + "': " + reason + "; " + cure +
                                       ", or take libdyn's own functions (--narrow own)");
}

/// The two placed volumes of a pair, compared by the functions that the geometry was compiled for. Where FCL fails, this throws Error(argument).
struct PlacedPair {
  const GeometryImpl& model;
  int pair;
  const Volume &a, &b;
  const SE3<double>&oMa, &oMb;
  SE3<double> aMb;

  bool collide() const {
    return orRefuse([&] { return dyn::collide(a, b, aMb, model.narrow); });
  }
  Separation nearest(double beyond) const {
    return orRefuse([&] { return dyn::nearest(a, b, aMb, model.narrow, beyond); });
  }
  template <class Found>
  void contacts(double within, const Found& found) const {
    orRefuse([&] { dyn::contacts(a, b, aMb, model.narrow, within, found); });
  }

 private:
  template <class Compare>
  auto orRefuse(const Compare& compare) const -> decltype(compare()) {
    try {
      return compare();
    } catch (const FclFailure& failure) {
      const bool finite = std::isfinite(norm(aMb.p)) && std::all_of(aMb.R.m, aMb.R.m + 9, [](double x) { return std::isfinite(x); });
      refuseByFcl(model, pair, failure.what(),
                  finite ? "raise GeometryOptions::fcl_tolerance from " + number(model.narrow.fcl_tolerance)
                         : std::string("their placements are not finite; check q for NaN and infinity"));
    }
  }
};

inline PlacedPair placed(const GeometryImpl& m, const GeometryDataImpl& d, int pair) {
  const auto [a, b] = m.pairs[static_cast<std::size_t>(pair)];
  const auto i = static_cast<std::size_t>(a), j = static_cast<std::size_t>(b);
  const SE3<double>&oMa = d.placement[i], &oMb = d.placement[j];
  return {m, pair, *m.volumes[i], *m.volumes[j], oMa, oMb, {transpose(oMa.R) * oMb.R, oMa.actInv(oMb.p)}};
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
