#include "data/workers.hpp"

namespace dyn {

Workers::Workers(int count) {
  threads_.reserve(static_cast<std::size_t>(count) - 1);
  for (int i = 1; i < count; ++i) threads_.emplace_back([this, i] { serve(i); });
}

Workers::~Workers() {
  stop_ = true;
  round_.fetch_add(1, std::memory_order_release);
  round_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void Workers::start(Call call, const void* context) {
  if (!threads_.empty()) {
    call_ = call;
    context_ = context;
    busy_.store(static_cast<int>(threads_.size()), std::memory_order_relaxed);
    round_.fetch_add(1, std::memory_order_release);
    round_.notify_all();
  }
  call(context, 0);
  for (int busy = busy_.load(std::memory_order_acquire); busy != 0; busy = busy_.load(std::memory_order_acquire)) busy_.wait(busy);
}

void Workers::serve(int i) {
  for (unsigned seen = 0;;) {
    round_.wait(seen, std::memory_order_acquire);
    const unsigned now = round_.load(std::memory_order_acquire);
    if (now == seen) continue;
    seen = now;
    if (stop_) return;
    call_(context_, i);
    if (busy_.fetch_sub(1, std::memory_order_acq_rel) == 1) busy_.notify_one();
  }
}

}  // namespace dyn
