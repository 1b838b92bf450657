// SPDX-License-Identifier: BSD-2-Clause
// The processes that compute one sweep together: those that mpirun or Slurm has started, or those of a program that carries their messages.
// Without them there is one rank, and MPI is not touched.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace dyn::tool::sweep {

/// A text from another rank.
struct Message {
  int from = 0;
  std::string text;
};

/// How texts pass between ranks. Texts from one rank to another keep their order.
class Connection {
 public:
  virtual ~Connection() = default;
  virtual std::vector<std::string> gather(const std::string& text) = 0;
  virtual std::string broadcast(const std::string& text) = 0;
  virtual void send(int to, const std::string& text) = 0;
  virtual std::optional<Message> poll() = 0;
  virtual std::string wait() = 0;
};

class Ranks {
 public:
  /// The number of this process, and how many there are. Both are known without MPI, from the environment.
  static int numberFromEnvironment();
  static int countFromEnvironment();
  /// Whether each rank has a standard input of its own, which is so for those of a channel.
  static bool haveOwnInput();

  /// Throws Error(argument) if several processes were started by MPI and this program was built without it.
  Ranks();

  int rank() const { return rank_; }
  int count() const { return count_; }

  /// Returns the texts of all ranks to rank 0, and an empty list to the others. All ranks call it.
  std::vector<std::string> gather(const std::string& text) const;
  /// Returns rank 0's text. All ranks call it.
  std::string broadcast(const std::string& text) const;

  void send(int to, const std::string& text) const;
  /// Returns a message that has arrived, if there is one.
  std::optional<Message> poll() const;
  /// Waits for a message. Other work on the processor goes on meanwhile.
  std::string wait() const;

 private:
  int rank_ = 0, count_ = 1;
  std::unique_ptr<Connection> connection_;  ///< empty for one rank
};

}  // namespace dyn::tool::sweep
