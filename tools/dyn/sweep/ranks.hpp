// SPDX-License-Identifier: BSD-2-Clause
// The processes that mpirun or Slurm has started together. Without them there is one rank, and MPI is not touched.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace dyn::tool::sweep {

class Ranks {
 public:
  /// The number of this process, and how many there are. Both are known without MPI, from the environment.
  static int numberFromEnvironment();
  static int countFromEnvironment();

  /// Throws Error(argument) if several processes were started and this program was built without MPI.
  Ranks();
  ~Ranks();
  Ranks(const Ranks&) = delete;
  Ranks& operator=(const Ranks&) = delete;

  int rank() const { return rank_; }
  int count() const { return count_; }

  /// Returns the texts of all ranks to rank 0, and an empty list to the others. All ranks call it.
  std::vector<std::string> gather(const std::string& text) const;
  /// Returns rank 0's text. All ranks call it.
  std::string broadcast(const std::string& text) const;

  void send(int to, const std::string& text) const;
  struct Message {
    int from;
    std::string text;
  };
  /// Returns a message that has arrived, if there is one.
  std::optional<Message> poll() const;
  /// Waits for a message. Other work on the processor goes on meanwhile.
  std::string wait() const;

 private:
  int rank_ = 0, count_ = 1;
};

}  // namespace dyn::tool::sweep
