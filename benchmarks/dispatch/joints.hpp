// SPDX-License-Identifier: BSD-2-Clause
// The standard joint types as members of a closed set. They use the plugin's formulas and compute one joint at a time.
#pragma once

#include "kernels/order/sweep.hpp"

#include <standard/groups.hpp>
#include <standard/varying.hpp>

#include <string>
#include <variant>

namespace dyn::benchmark {

/// Where the constants, coordinates and results of a joint are in memory.
struct Place {
  const double* constants;
  std::ptrdiff_t constants_stride;
  int constant_count;
  int idx_q, idx_v;
  double *pose, *subspace, *bias;
  std::ptrdiff_t stride;
};

template <class Author>
struct Member {
  static constexpr int nv = Author::nv;
  static constexpr Shape shape = Author::shape;

  /// The joint class of the recursions for this shape.
  static auto kernelType() {
    if constexpr (shape == Shape::revolute) {
      return std::type_identity<kernels::Revolute<double>>();
    } else if constexpr (shape == Shape::prismatic) {
      return std::type_identity<kernels::Prismatic<double>>();
    } else if constexpr (shape == Shape::spherical) {
      return std::type_identity<kernels::Spherical<double>>();
    } else if constexpr (shape == Shape::translation) {
      return std::type_identity<kernels::Translation<double>>();
    } else if constexpr (shape == Shape::planar) {
      return std::type_identity<kernels::Planar<double>>();
    } else if constexpr (shape == Shape::free) {
      return std::type_identity<kernels::Free<double>>();
    } else {
      return std::type_identity<kernels::Dense<double, nv, shape == Shape::dense>>();
    }
  }
  using Kernel = typename decltype(kernelType())::type;

  static void evaluate(const Place& at, const double* q, const double* v) {
    const sdk::Constants c(at.constants, at.constants_stride, at.constant_count);
    const double* x = q + at.idx_q;
    double pose[12];
    if constexpr (sdk::HasPose<Author>) {
      const SE3<double> X = Author::pose(x, c);
      for (int k = 0; k < 9; ++k) pose[k] = X.R.m[k];
      for (int k = 0; k < 3; ++k) pose[9 + k] = X.p[k];
    } else {
      Author::coordinates(x, c, pose);
    }
    for (int k = 0; k < poseSize(shape); ++k) at.pose[k * at.stride] = pose[k];
    if constexpr (shape == Shape::dense) {
      Motion<double> S[Author::nv];
      if constexpr (sdk::HasSubspace<Author>) {
        Author::subspace(x, c, S);
      } else {
        for (int k = 0; k < Author::nv; ++k) S[k] = sdk::derivedColumn<Author>(x, c, k);
      }
      for (int k = 0; k < Author::nv; ++k) write(S[k], at.subspace + 6 * k * at.stride, at.stride);
      if (v == nullptr) return;
      if constexpr (sdk::HasBias<Author>) {
        write(Author::bias(x, v + at.idx_v, c), at.bias, at.stride);
      } else {
        write(sdk::derivedRates<Author>(x, v + at.idx_v, c).bias, at.bias, at.stride);
      }
    }
  }

 private:
  static void write(const Motion<double>& m, double* to, std::ptrdiff_t stride) {
    for (int k = 0; k < 3; ++k) {
      to[k * stride] = m.linear[k];
      to[(3 + k) * stride] = m.angular[k];
    }
  }
};

using AnyJoint = std::variant<Member<standard::Revolute>, Member<standard::Continuous>, Member<standard::Prismatic>, Member<standard::Helical>,
                              Member<standard::Cylindrical>, Member<standard::Universal>, Member<standard::Spherical>, Member<standard::SphericalZYX>,
                              Member<standard::Translation>, Member<standard::Planar>, Member<standard::FreeFlyer>, Member<standard::Ellipsoid>>;

/// The same type behind the plugin interface, but computed one joint at a time instead of in packs.
template <class Author>
struct OneByOne : Author {
  static constexpr bool branch_free = false;
};

/// Finds the member and the batched type of a name. Returns false for types that the closed set lacks, such as those that other plugins add.
inline bool findMember(const std::string& name, AnyJoint& member, const JointType*& batched) {
  const auto try_one = [&]<class Author>() {
    if (name != Author::name) return false;
    member = Member<Author>();
    batched = static_cast<const JointType*>(sdk::instance<OneByOne<Author>>());
    return true;
  };
  return try_one.operator()<standard::Revolute>() || try_one.operator()<standard::Continuous>() || try_one.operator()<standard::Prismatic>() ||
         try_one.operator()<standard::Helical>() || try_one.operator()<standard::Cylindrical>() || try_one.operator()<standard::Universal>() ||
         try_one.operator()<standard::Spherical>() || try_one.operator()<standard::SphericalZYX>() || try_one.operator()<standard::Translation>() ||
         try_one.operator()<standard::Planar>() || try_one.operator()<standard::FreeFlyer>() || try_one.operator()<standard::Ellipsoid>();
}

}  // namespace dyn::benchmark
