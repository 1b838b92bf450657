// SPDX-License-Identifier: BSD-2-Clause
// Worker threads: errors when the system cannot create enough of them, and work that throws.
#include "data/workers.hpp"

#include "support/catch.hpp"
#include "support/skip.hpp"

#include <dyn/error.hpp>

#include <alloc_guard.hpp>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <fstream>
#include <stdexcept>

using namespace dyn;
using namespace dyn::test;

TEST_CASE("more threads than the system gives are an error that says how many there are", "[data][error]") {
  if (!tool::canCountAllocations()) DYN_SKIP("a sanitizer ends the process when memory does");
  rlimit before{};
  getrlimit(RLIMIT_AS, &before);
  long pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  // This limit leaves room for the stacks of only a few threads.
  const rlimit tight{static_cast<rlim_t>(pages) * static_cast<rlim_t>(sysconf(_SC_PAGESIZE)) + (rlim_t{100} << 20), before.rlim_max};
  std::string message;
  setrlimit(RLIMIT_AS, &tight);
  try {
    const Workers workers(2000);
  } catch (const Error& e) {
    message = e.what();
  }
  setrlimit(RLIMIT_AS, &before);
  CHECK_THAT(message, containing("2000 threads are asked for") && containing("ask for fewer"));
}

TEST_CASE("a child of fork() has threads of its own from its first call on, and ends without its parent's", "[data]") {
  Workers workers(3);
  const auto sum = [&] {
    std::array<int, 3> done{};
    workers.run([&](int i) { done[static_cast<std::size_t>(i)] = i + 1; });
    return done[0] + done[1] + done[2];
  };
  CHECK(sum() == 6);
  for (const bool calls : {true, false}) {
    const pid_t child = fork();
    if (child == 0) {
      alarm(20);
      bool right = true;
      for (int k = 0; calls && k < 50; ++k) right = right && sum() == 6;
      workers.~Workers();
      _exit(right ? 0 : 1);
    }
    int status = -1;
    REQUIRE(waitpid(child, &status, 0) == child);
    CHECK((WIFEXITED(status) && WEXITSTATUS(status) == 0));
    CHECK(sum() == 6);
  }
}

TEST_CASE("what work throws is thrown again when all are done, and the threads go on", "[data][error]") {
  for (const int count : {1, 4}) {
    Workers workers(count);
    for (int round = 0; round < 20; ++round) {
      for (int failing = 0; failing < count; ++failing) {
        std::array<int, 4> done{};
        const auto work = [&](int i) {
          if (i == failing) throw std::runtime_error("no memory");
          done[static_cast<std::size_t>(i)] = 1;
        };
        CHECK_THROWS_WITH(workers.run(work), containing("no memory"));
        for (int i = 0; i < count; ++i) CHECK(done[static_cast<std::size_t>(i)] == (i == failing ? 0 : 1));
      }
      std::array<int, 4> done{};
      workers.run([&](int i) { done[static_cast<std::size_t>(i)] = 1; });
      for (int i = 0; i < count; ++i) CHECK(done[static_cast<std::size_t>(i)] == 1);
    }
  }
}
