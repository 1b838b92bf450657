// SPDX-License-Identifier: BSD-2-Clause
#include "engine.hpp"

#include "interrupt.hpp"
#include "messages.hpp"
#include "progress.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <functional>
#include <mutex>
#include <sstream>
#include <thread>

namespace dyn::tool::sweep {

namespace {

using Clock = std::chrono::steady_clock;
constexpr std::int64_t nothing_left = -1;

double secondsSince(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// A chunk that a worker has written.
struct Done {
  std::int64_t number = 0;
  std::size_t failed = 0;
  std::string reason;  ///< of the first sample that failed
};

/// Computes chunks in several threads until there are no more. `next` is called with the chunk that is done, or nothing at first, and returns the
/// next one; `failed` takes the text of an error that ends the thread.
void computeInThreads(const Work& work, const std::function<std::int64_t(const Done*)>& next, const std::function<void(const std::string&)>& failed,
                      std::vector<std::thread>& threads) {
  for (int k = 0; k < work.threads; ++k)
    threads.emplace_back([&work, next, failed] {
      try {
        Worker worker(work.setting);
        std::int64_t number = next(nullptr);
        while (number != nothing_left && !Interruption::pending()) {
          const std::optional<Chunk> chunk = worker.chunk(work.manifest.first(number), work.manifest.count(number));
          if (!chunk) return;
          work.store.write(work.manifest, number, *chunk);
          Done done{number, chunk->failures.size(), ""};
          if (!chunk->failures.empty())
            done.reason = "sample " + std::to_string(chunk->failures.front().sample) + ": " + chunk->failures.front().reason;
          number = next(&done);
        }
      } catch (const std::exception& e) {
        failed(e.what());
      }
    });
}

/// The state of the sweep, as rank 0 knows it.
class Overseer {
 public:
  Overseer(const Work& work, const std::vector<std::int64_t>& missing)
      : work_(work), missing_(missing), progress_(static_cast<double>(work.manifest.samples), "samples"), start_(Clock::now()) {
    done_ = work.manifest.samples;
    for (const std::int64_t number : missing) done_ -= work.manifest.count(number);
    before_ = done_;
  }

  std::int64_t next(const Done* done) {
    const std::lock_guard guard(mutex_);
    if (done) note(*done);
    if (stopped_ || Interruption::pending() || handed_ == missing_.size()) return nothing_left;
    return missing_[handed_++];
  }
  void fail(const std::string& text) {
    const std::lock_guard guard(mutex_);
    if (error_.empty()) error_ = text;
    stopped_ = true;
  }
  /// Shows how far the sweep has come.
  void show(bool last = false) {
    const std::lock_guard guard(mutex_);
    progress_.at(static_cast<double>(done_));
    if (!work_.json_lines || !(last || secondsSince(shown_) > 1)) return;
    shown_ = Clock::now();
    const double rate = static_cast<double>(done_ - before_) / std::max(secondsSince(start_), 1e-9);
    Json line = {{"done", done_}, {"samples", work_.manifest.samples}, {"failed", failed_}, {"rate", rate}, {"seconds_left", nullptr}};
    if (rate > 0) line["seconds_left"] = static_cast<double>(work_.manifest.samples - done_) / rate;
    std::printf("%s\n", line.dump().c_str());
    std::fflush(stdout);
  }
  void finish() const {
    if (!error_.empty()) throw Error(ErrorCode::argument, error_ + " (the chunks that are finished are kept; --resume goes on)");
    if (!Interruption::pending() && done_ != work_.manifest.samples)
      throw Error(ErrorCode::argument, "some ranks ended before their work was done; --resume goes on");
  }

 private:
  void note(const Done& done) {
    constexpr int most_shown = 5;
    done_ += work_.manifest.count(done.number);
    failed_ += static_cast<std::int64_t>(done.failed);
    if (done.failed > 0 && shown_failures_++ < most_shown) warning(done.reason + (done.failed > 1 ? " (and others of its chunk)" : ""));
    if (done.failed > 0 && shown_failures_ == most_shown)
      tool::note("more samples that fail are not shown; failures.jsonl has all of them in the end");
  }

  const Work& work_;
  const std::vector<std::int64_t>& missing_;
  std::mutex mutex_;
  std::size_t handed_ = 0;
  std::int64_t done_ = 0, before_ = 0, failed_ = 0;
  int shown_failures_ = 0;
  bool stopped_ = false;
  std::string error_;
  Progress progress_;
  Clock::time_point start_, shown_ = start_;
};

}  // namespace

std::int64_t chooseChunk(const Setting& setting, int workers) {
  constexpr double wanted = 0.5, least = 0.1, trial = 0.05;  // [s]
  constexpr std::int64_t most_chunks = 1'000'000, most_bytes = 1 << 26;
  Worker worker(setting);
  const std::int64_t samples = setting.study.samples;
  const auto bytes = static_cast<std::int64_t>(numbersOf(worker.fields()) * sizeof(double));
  const std::int64_t largest = std::max<std::int64_t>(most_bytes / bytes, 1);
  std::int64_t chunk = setting.study.chunk;
  if (chunk == 0) {
    const std::int64_t together = std::min(worker.together(), samples);
    std::vector<double> rows(numbersOf(worker.fields()) * static_cast<std::size_t>(together));
    worker.prepare();
    const Clock::time_point start = Clock::now();
    std::int64_t tried = 0;
    for (; tried + together <= samples && secondsSince(start) < trial && !Interruption::pending(); tried += together)
      worker.samples(tried, together, rows.data());
    const double seconds = std::max(secondsSince(start), 1e-9) / static_cast<double>(std::max<std::int64_t>(tried, 1));
    // Workers get many chunks each, so that none waits long for the others at the end, but none so short that its file costs more than a percent.
    const auto take = [&](double time) { return static_cast<std::int64_t>(std::min(time / seconds, 1e9)); };
    const std::int64_t share = std::max(std::min(samples / (32 * workers), take(wanted)), take(least));
    chunk = std::max<std::int64_t>(std::min(share, samples / (8 * workers)), 1);
  }
  return std::min(std::max(chunk, (samples + most_chunks - 1) / most_chunks), largest);
}

void computeChunks(const Work& work, const std::vector<std::int64_t>& missing) {
  Overseer overseer(work, missing);
  std::vector<std::thread> threads;
  std::atomic<int> running{work.threads};
  // Each thread ends with one call that returns nothing, with an error, or at a signal.
  computeInThreads(
      work, [&](const Done* done) { return overseer.next(done); }, [&](const std::string& text) { overseer.fail(text); }, threads);
  std::thread joiner([&] {
    for (std::thread& thread : threads) thread.join();
    running = 0;
  });
  int others = work.ranks.count() - 1;
  // Each look takes a processor from the threads for a moment, so that they become rarer while nothing arrives.
  constexpr std::chrono::microseconds shortest(200), longest(2000), alone(5000);
  std::chrono::microseconds pause = shortest;
  std::size_t requests = 0;
  Clock::duration answering{};
  while (running > 0 || others > 0) {
    pause = others > 0 ? std::min(2 * pause, longest) : alone;
    while (const std::optional<Message> message = work.ranks.poll()) {
      const Clock::time_point arrived = Clock::now();
      std::istringstream words(message->text);
      std::string word;
      words >> word;
      if (word == "end") {
        --others;
      } else if (word == "error") {
        overseer.fail("rank " + std::to_string(message->from) + ": " + message->text.substr(6));
      } else {
        Done done;
        if (word == "done") {
          words >> done.number >> done.failed;
          std::getline(words.ignore(), done.reason);
        }
        work.ranks.send(message->from, std::to_string(overseer.next(word == "done" ? &done : nullptr)));
      }
      ++requests;
      pause = shortest;
      answering += Clock::now() - arrived;
    }
    overseer.show();
    std::this_thread::sleep_for(pause);
  }
  joiner.join();
  if (requests > 0) detail("answered " + std::to_string(requests) + " requests of other ranks", answering);
  overseer.show(true);
  overseer.finish();
}

void serveRank(const Work& work) {
  std::mutex one_at_a_time;  // MPI_THREAD_SERIALIZED
  const auto next = [&](const Done* done) -> std::int64_t {
    const std::lock_guard guard(one_at_a_time);
    std::string reason = done ? done->reason : "";
    std::replace(reason.begin(), reason.end(), '\n', ' ');
    work.ranks.send(0, done ? "done " + std::to_string(done->number) + " " + std::to_string(done->failed) + " " + reason : "next");
    return std::stoll(work.ranks.wait());
  };
  const auto failed = [&](const std::string& text) {
    const std::lock_guard guard(one_at_a_time);
    work.ranks.send(0, "error " + text);
  };
  std::vector<std::thread> threads;
  computeInThreads(work, next, failed, threads);
  for (std::thread& thread : threads) thread.join();
  work.ranks.send(0, "end");
  work.ranks.wait();  // until the sweep is over, so that rank 0 takes nothing that comes afterwards for a request
}

}  // namespace dyn::tool::sweep
