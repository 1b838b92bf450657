// SPDX-License-Identifier: BSD-2-Clause
// The pointer to the implementation of objects that can be moved but not copied.
#pragma once

#include <dyn/export.hpp>

#include <memory>
#include <utility>

namespace dyn {

namespace detail {
/// Throws Error(argument).
[[noreturn]] DYN_API void refuseMovedFrom();
}  // namespace detail

/// Like std::unique_ptr, but access to an object that was moved from throws Error(argument). Such an object may still be destroyed and assigned to.
template <class T>
class Owned {
 public:
  /// Takes over the object.
  Owned(std::unique_ptr<T> object) : object_(std::move(object)) {}  // NOLINT: meant to convert
  /// Access the object. Throw Error(argument) if this pointer was moved from.
  /// @{
  T& operator*() const {
    if (object_ == nullptr) [[unlikely]]
      detail::refuseMovedFrom();
    return *object_;
  }
  T* operator->() const { return &**this; }
  /// @}

 private:
  std::unique_ptr<T> object_;
};

}  // namespace dyn
