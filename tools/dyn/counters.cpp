// SPDX-License-Identifier: BSD-2-Clause
#include "counters.hpp"

#include <linux/perf_event.h>
#include <sys/ioctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstring>

namespace dyn::tool {

namespace {

int open(std::uint64_t event) {
  perf_event_attr attributes{};
  attributes.size = sizeof attributes;
  attributes.type = PERF_TYPE_HARDWARE;
  attributes.config = event;
  attributes.disabled = 1;
  attributes.exclude_kernel = 1;
  attributes.exclude_hv = 1;
  return static_cast<int>(syscall(SYS_perf_event_open, &attributes, 0, -1, -1, 0));
}

double read(int file) {
  std::uint64_t count = 0;
  return ::read(file, &count, sizeof count) == static_cast<ssize_t>(sizeof count) ? static_cast<double>(count) : 0;
}

}  // namespace

Counters::Counters() : instructions_(open(PERF_COUNT_HW_INSTRUCTIONS)) {
  if (instructions_ >= 0) branch_misses_ = open(PERF_COUNT_HW_BRANCH_MISSES);
  if (branch_misses_ < 0) problem_ = std::string("the system does not let this program count instructions: ") + std::strerror(errno);
}

Counters::~Counters() {
  for (const int file : {instructions_, branch_misses_})
    if (file >= 0) close(file);
}

void Counters::start() {
  if (!problem_.empty()) return;
  for (const int file : {instructions_, branch_misses_}) {
    ioctl(file, PERF_EVENT_IOC_RESET, 0);
    ioctl(file, PERF_EVENT_IOC_ENABLE, 0);
  }
}

Counters::Reading Counters::stop() {
  if (!problem_.empty()) return {};
  for (const int file : {instructions_, branch_misses_}) ioctl(file, PERF_EVENT_IOC_DISABLE, 0);
  return {read(instructions_), read(branch_misses_)};
}

}  // namespace dyn::tool
