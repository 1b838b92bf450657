// SPDX-License-Identifier: BSD-2-Clause
#include "data/workers.hpp"

#include <dyn/error.hpp>

#include <pthread.h>

#include <string>
#include <utility>

namespace dyn {

namespace {

std::atomic<unsigned> forks{0};

/// Returns the number of forks between the first call and this process.
unsigned forksSoFar() {
  static const int watched = pthread_atfork(nullptr, nullptr, [] { forks.fetch_add(1, std::memory_order_relaxed); });
  static_cast<void>(watched);
  return forks.load(std::memory_order_relaxed);
}

}  // namespace

Workers::Workers(int count) : forks_(forksSoFar()) { launch(count); }

Workers::~Workers() { end(); }

void Workers::launch(int count) {
  try {
    threads_.reserve(static_cast<std::size_t>(count) - 1);
    for (int i = 1; i < count; ++i) threads_.emplace_back([this, i] { serve(i); });
  } catch (const std::exception& e) {
    const int there_are = this->count();
    end();
    threads_.clear();
    throw Error(ErrorCode::argument, std::to_string(count) + " threads are asked for, and the system gives " + std::to_string(there_are) +
                                         " of them; ask for fewer (" + e.what() + ")");
  }
}

bool Workers::inherited() const { return !threads_.empty() && forks.load(std::memory_order_relaxed) != forks_; }

void Workers::end() {
  if (inherited()) {
    // The threads do not exist in this process and cannot be joined. Destroying unjoined std::threads would end the process, so they are leaked.
    new std::vector<std::thread>(std::move(threads_));
    threads_.clear();
    return;
  }
  stop_ = true;
  round_.fetch_add(1, std::memory_order_release);
  round_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void Workers::start(Call call, const void* context) {
  if (inherited()) {
    const int before = count();
    end();
    round_ = 0;
    busy_ = 0;
    failed_ = false;
    forks_ = forksSoFar();
    launch(before);
  }
  call_ = call;
  context_ = context;
  if (!threads_.empty()) {
    busy_.store(static_cast<int>(threads_.size()), std::memory_order_relaxed);
    round_.fetch_add(1, std::memory_order_release);
    round_.notify_all();
  }
  work(0);
  for (int busy = busy_.load(std::memory_order_acquire); busy != 0; busy = busy_.load(std::memory_order_acquire)) busy_.wait(busy);
  if (failed_.exchange(false)) std::rethrow_exception(std::exchange(error_, nullptr));
}

void Workers::work(int i) noexcept {
  try {
    call_(context_, i);
  } catch (...) {
    if (!failed_.exchange(true)) error_ = std::current_exception();
  }
}

void Workers::serve(int i) {
  for (unsigned seen = 0;;) {
    round_.wait(seen, std::memory_order_acquire);
    const unsigned now = round_.load(std::memory_order_acquire);
    if (now == seen) continue;
    seen = now;
    if (stop_) return;
    work(i);
    if (busy_.fetch_sub(1, std::memory_order_acq_rel) == 1) busy_.notify_one();
  }
}

}  // namespace dyn
