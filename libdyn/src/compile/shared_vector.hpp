// SPDX-License-Identifier: BSD-2-Clause
// A vector whose copies share their memory, until one of them is changed. Models that differ in numbers only share their structure this way.
#pragma once

#include <atomic>
#include <cstddef>
#include <iterator>
#include <memory>
#include <utility>
#include <vector>

namespace dyn {

/// Reads like a std::vector, and as fast. Access to a vector that is not const first makes a copy of its own if the memory is shared.
template <class T>
class SharedVector {
 public:
  SharedVector() = default;
  explicit SharedVector(std::vector<T> values) : owner_(std::make_shared<std::vector<T>>(std::move(values))) { look(); }

  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  const T* data() const { return data_; }
  const T* begin() const { return data_; }
  const T* end() const { return data_ + size_; }
  auto rbegin() const { return std::make_reverse_iterator(end()); }
  auto rend() const { return std::make_reverse_iterator(begin()); }
  const T& operator[](std::size_t i) const { return data_[i]; }
  const T& back() const { return data_[size_ - 1]; }
  const std::vector<T>& vector() const {
    static const std::vector<T> none;
    return owner_ ? *owner_ : none;
  }
  std::size_t bytes() const { return owner_ ? sizeof(T) * owner_->capacity() : 0; }

  T* data() { return own().data(); }
  T* begin() { return own().data(); }
  T* end() { return own().data() + size_; }
  T& operator[](std::size_t i) { return own()[i]; }
  T& back() { return own().back(); }
  void resize(std::size_t size) {
    change([&](std::vector<T>& x) { x.resize(size); });
  }
  void assign(std::size_t size, const T& value) {
    change([&](std::vector<T>& x) { x.assign(size, value); });
  }
  void push_back(T value) {
    change([&](std::vector<T>& x) { x.push_back(std::move(value)); });
  }
  template <class... Arguments>
  void emplace_back(Arguments&&... arguments) {
    change([&](std::vector<T>& x) { x.emplace_back(std::forward<Arguments>(arguments)...); });
  }

 private:
  std::vector<T>& own() {
    if (!owner_) {
      owner_ = std::make_shared<std::vector<T>>();
    } else if (owner_.use_count() > 1) {
      owner_ = std::make_shared<std::vector<T>>(*owner_);
    } else {
      std::atomic_thread_fence(std::memory_order_acquire);  // others that shared the memory have read it before
    }
    data_ = owner_->data();
    return *owner_;
  }
  template <class Change>
  void change(Change&& apply) {
    apply(own());
    look();
  }
  void look() {
    data_ = owner_->data();
    size_ = owner_->size();
  }

  std::shared_ptr<std::vector<T>> owner_;
  const T* data_ = nullptr;
  std::size_t size_ = 0;
};

}  // namespace dyn
