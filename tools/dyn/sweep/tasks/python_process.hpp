// SPDX-License-Identifier: BSD-2-Clause
// A process of python3 that has loaded a function of a file and calls it for one sample after another.
#pragma once

#include <nlohmann/json.hpp>

#include <sys/types.h>

#include <string>
#include <vector>

namespace dyn::tool::sweep {

/// Requests and answers are a line of JSON, then numbers as the eight bytes of each, so that they arrive as they are.
class PythonProcess {
 public:
  /// Starts python3, loads the file and compiles the model. Returns once all that is done. Text that the file prints goes to standard error.
  /// Throws Error(file) if python3 or the module libdyn is missing, Error(model) if the file fails or does not have the function.
  PythonProcess(const std::string& file, const std::string& setup);
  /// The process gets a second to end; then it is killed.
  ~PythonProcess();
  PythonProcess(const PythonProcess&) = delete;
  PythonProcess& operator=(const PythonProcess&) = delete;

  /// Sends a request and returns the line of the answer. Throws Error if the process ends, if a signal interrupts this program, and if the function
  /// fails. Only in the last case the process can be asked again.
  nlohmann::json ask(const nlohmann::json& head, const std::vector<double>& numbers);
  /// Reads numbers that follow the line.
  void read(double* numbers, std::size_t count);
  bool usable() const { return usable_; }

 private:
  void send(const void* bytes, std::size_t size);
  void receive(void* bytes, std::size_t size);
  nlohmann::json line();
  /// Waits until the socket is ready for `events` of poll(). Returns false once the process has ended and nothing is left to read.
  bool ready(short events);
  void end(int milliseconds);
  /// Ends the process and throws an Error that says how it ended.
  [[noreturn]] void ended();

  std::string file_, buffer_;
  std::size_t taken_ = 0;  ///< bytes of the buffer
  pid_t child_ = -1;
  int socket_ = -1, status_ = 0;
  bool usable_ = true;
};

}  // namespace dyn::tool::sweep
