// SPDX-License-Identifier: BSD-2-Clause
// Coupling types: y = f(x). The author writes f as a template over the scalar, and forward-mode differentiation gives its derivatives; or the author
// writes f and its derivatives in closed form.
#pragma once

#include <dyn_sdk/implementation.hpp>

namespace dyn::sdk {

/// The author wrote f and its derivatives in closed form.
template <class A>
concept HasDerivatives = requires(double x, const Constants& c, double* f) { A::derivatives(x, c, f); };

/// Implements CouplingType by an author's class.
///
/// Author has name, summary, parameters, and `template <class S> static S value(const S& x, const Constants& c)`; or in place of value
/// `static void derivatives(double x, const Constants& c, double* f)`, which writes f and its first three derivatives in closed form.
template <class Author>
class CouplingTypeOf final : public CouplingType {
 public:
  /// Implements CouplingType.
  /// @{
  const JointTypeInfo& info() const noexcept override {
    static constexpr JointTypeInfo description{Author::name,         Author::summary,           Structure::joint,
                                               closed_configuration, Author::parameters.data(), static_cast<int>(Author::parameters.size())};
    return description;
  }
  bool prepare(const ParameterArgument* args, int& count, char* message, int size) const noexcept override {
    const Refusal refuse{message, size};
    return guarded(refuse, [&] {
      count = placeNumbers(Author::parameters, args, nullptr);
      return Author::check(args, refuse);
    });
  }
  void constants(const ParameterArgument* args, double* out) const noexcept override {
    static_assert(hasPlaces(Author::parameters), "a list of numbers before other numbers moves them: make it the last parameter that has numbers");
    placeNumbers(Author::parameters, args, out);
  }
  void evaluate(const double* constants, int count, double x, double* f) const noexcept override {
    const Constants c(constants, 1, count);
    if constexpr (HasDerivatives<Author>) {
      Author::derivatives(x, c, f);
    } else {
      using D = Dual<double>;
      using DD = Dual<D>;
      const DD along(D(x, 1.0), D(1.0, 0.0));
      const Dual<DD> y = Author::value(Dual<DD>(along, DD(D(1.0, 0.0), D(0.0, 0.0))), c);
      f[0] = y.v.v.v;
      f[1] = y.v.v.d;
      f[2] = y.v.d.d;
      f[3] = y.d.d.d;
    }
  }
  /// @}
};

/// Returns the only instance of a coupling type in this plugin, as a CouplingType.
template <class Author>
const void* couplingInstance() {
  static constexpr CouplingTypeOf<Author> type;
  return static_cast<const CouplingType*>(&type);
}

/// A list of authors' classes.
template <class... T>
struct TypeList {};

/// Returns the plugin's descriptor, with its joint types J and its coupling types C.
template <class... J, class... C>
const dyn_plugin_descriptor* describe(TypeList<J...>, TypeList<C...>) {
  static const void* const joints[] = {instance<J>()..., nullptr};
  static const void* const couplings[] = {couplingInstance<C>()..., nullptr};
  static const dyn_plugin_descriptor descriptor{stamp(), sizeof...(J), sizeof...(C), joints, couplings};
  return &descriptor;
}

}  // namespace dyn::sdk
