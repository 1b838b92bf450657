// Threads that wait for work: started once, woken by each call, without locks or memory of their own in between. A child of fork() has none of its
// parent's threads: its first call starts its own.
#pragma once

#include <atomic>
#include <exception>
#include <thread>
#include <vector>

namespace dyn {

class Workers {
 public:
  /// With `count` = 1 there are no threads, and the caller does all the work. Throws Error(argument) if the system gives fewer.
  explicit Workers(int count);
  ~Workers();
  Workers(const Workers&) = delete;
  Workers& operator=(const Workers&) = delete;

  int count() const { return static_cast<int>(threads_.size()) + 1; }
  /// Calls work(i) for i in [0, count()) at once, i = 0 by the caller, and returns when all are done. The first of what they throw is thrown
  /// again.
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
  /// Made in a process of which this one is a child.
  bool inherited() const;

  std::vector<std::thread> threads_;
  std::atomic<unsigned> round_{0};
  std::atomic<int> busy_{0};
  bool stop_ = false;
  Call call_ = nullptr;
  const void* context_ = nullptr;
  std::atomic<bool> failed_{false};
  std::exception_ptr error_;  ///< of the first to fail
  unsigned forks_;            ///< how many there had been when the threads were started
};

}  // namespace dyn
