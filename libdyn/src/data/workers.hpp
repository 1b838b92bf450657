// Threads that wait for work: started once, woken by each call, without locks or memory of their own in between.
#pragma once

#include <atomic>
#include <thread>
#include <vector>

namespace dyn {

class Workers {
 public:
  /// With `count` = 1 there are no threads, and the caller does all the work.
  explicit Workers(int count);
  ~Workers();
  Workers(const Workers&) = delete;
  Workers& operator=(const Workers&) = delete;

  int count() const { return static_cast<int>(threads_.size()) + 1; }
  /// Calls work(i) for i in [0, count()) at once, i = 0 by the caller, and returns when all are done. `work` must not throw.
  template <class Work>
  void run(const Work& work) {
    start([](const void* context, int i) { (*static_cast<const Work*>(context))(i); }, &work);
  }

 private:
  using Call = void (*)(const void* context, int i);
  void start(Call call, const void* context);
  void serve(int i);

  std::vector<std::thread> threads_;
  std::atomic<unsigned> round_{0};
  std::atomic<int> busy_{0};
  bool stop_ = false;
  Call call_ = nullptr;
  const void* context_ = nullptr;
};

}  // namespace dyn
