// SPDX-License-Identifier: BSD-2-Clause
// Threads that wait for work. They are started once and woken by each call, which takes no lock and allocates no memory. A child of fork() has none
// of its parent's threads, so its first call starts new ones.
#pragma once

#include <atomic>
#include <exception>
#include <thread>
#include <vector>

namespace dyn {

class Workers {
 public:
  /// Starts count - 1 threads; the caller of run() does the rest of the work. Throws Error(argument) if the system gives fewer.
  explicit Workers(int count);
  ~Workers();
  Workers(const Workers&) = delete;
  Workers& operator=(const Workers&) = delete;

  int count() const { return static_cast<int>(threads_.size()) + 1; }
  /// Calls work(i) for each i in [0, count()) in parallel, i = 0 in the calling thread, and returns when all are done. If calls throw, the first
  /// exception is thrown again.
  template <class Work>
  void run(const Work& work) {
    start([](const void* context, int i) { (*static_cast<const Work*>(context))(i); }, &work);
  }

 private:
  using Call = void (*)(const void* context, int i);
  void start(Call call, const void* context);
  void serve(int i);
  void work(int i) noexcept;
  void launch(int count);
  void end();
  /// Whether the threads were started in a parent of this process.
  bool inherited() const;

  std::vector<std::thread> threads_;
  std::atomic<unsigned> round_{0};
  std::atomic<int> busy_{0};
  bool stop_ = false;
  Call call_ = nullptr;
  const void* context_ = nullptr;
  std::atomic<bool> failed_{false};
  std::exception_ptr error_;  ///< the first exception of a round
  unsigned forks_;            ///< the number of forks when the threads were started
};

}  // namespace dyn
