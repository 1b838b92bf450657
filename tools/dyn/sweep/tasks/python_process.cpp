// SPDX-License-Identifier: BSD-2-Clause
#include "tasks/python_process.hpp"

#include "interrupt.hpp"
#include "python_model.hpp"
#include "tasks/python_server.hpp"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>

#include <cstdlib>
#include <cstring>
#include <utility>

extern char** environ;

namespace dyn::tool::sweep {

namespace {

constexpr int look_again = 100;                             ///< [ms] between looks at signals and at the process while nothing arrives
constexpr int last_second = 1000;                           ///< [ms] that a process has to end
constexpr std::size_t longest_line = std::size_t{1} << 24;  ///< of an answer

/// Starts python3 with a socket as its standard input.
pid_t spawn(const std::string& file, int socket) {
  std::vector<std::string> words{"python3", "-c", python_server, pythonModuleFolder()}, more;
  std::vector<char*> argv, env;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  // Sets and dictionaries of texts then have the same order in each process. Processes share the processors, so each has one thread.
  for (const auto& [name, value] : {std::pair("PYTHONHASHSEED", "0"), std::pair("OMP_NUM_THREADS", "1"), std::pair("OPENBLAS_NUM_THREADS", "1")})
    if (std::getenv(name) == nullptr) more.push_back(std::string(name) + "=" + value);
  for (char** variable = environ; *variable != nullptr; ++variable) env.push_back(*variable);
  for (std::string& variable : more) env.push_back(variable.data());
  env.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, socket, 0);
  pid_t child = -1;
  const int problem = posix_spawnp(&child, argv[0], &actions, nullptr, argv.data(), env.data());
  posix_spawn_file_actions_destroy(&actions);
  if (problem == ENOENT) throw pythonMissing(file);
  if (problem != 0) throw Error(ErrorCode::file, std::string("python3 cannot be started: ") + std::strerror(problem), {file, 0, ""});
  return child;
}

}  // namespace

PythonProcess::PythonProcess(const std::string& file, const std::string& setup) : file_(file) {
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
    throw Error(ErrorCode::file, std::string("there is no socket for python3: ") + std::strerror(errno), {file, 0, ""});
  socket_ = ends[0];
  try {
    child_ = spawn(file, ends[1]);
  } catch (...) {
    close(ends[0]);
    close(ends[1]);
    throw;
  }
  close(ends[1]);
  try {
    const std::string text = setup + "\n";
    send(text.data(), text.size());
    const nlohmann::json answer = line();
    if (answer.contains("missing")) throw pythonModuleMissing(file);
    if (answer.contains("error")) throw Error(ErrorCode::model, answer["error"], {file, 0, ""});
  } catch (...) {
    end(0);
    throw;
  }
}

PythonProcess::~PythonProcess() { end(usable_ ? last_second : 0); }

void PythonProcess::end(int milliseconds) {
  usable_ = false;
  if (socket_ >= 0) close(std::exchange(socket_, -1));  // which the process takes for the end of its work
  if (child_ < 0) return;
  pid_t over = waitpid(child_, &status_, WNOHANG);
  for (int waited = 0; over == 0 && waited < milliseconds; waited += 10) {
    poll(nullptr, 0, 10);
    over = waitpid(child_, &status_, WNOHANG);
  }
  if (over == 0) {
    kill(child_, SIGKILL);
    while (waitpid(child_, &status_, 0) < 0 && errno == EINTR) {
    }
  }
  child_ = -1;
}

void PythonProcess::ended() {
  end(last_second);
  std::string how = "ended with exit code " + std::to_string(WEXITSTATUS(status_));
  if (WIFSIGNALED(status_)) how = std::string("was ended by a signal: ") + strsignal(WTERMSIG(status_));
  throw Error(ErrorCode::model, "python3 " + how, {file_, 0, ""});
}

bool PythonProcess::ready(short events) {
  for (;;) {
    pollfd wanted{socket_, events, 0};
    const int count = poll(&wanted, 1, look_again);
    if (count > 0) return true;
    if (Interruption::pending()) {
      end(0);
      throw Error(ErrorCode::argument, "interrupted");
    }
    // A process that the function started may hold the other end, so that the socket does not tell.
    siginfo_t over{};
    if (count == 0 && waitid(P_PID, static_cast<id_t>(child_), &over, WEXITED | WNOHANG | WNOWAIT) == 0 && over.si_pid != 0)
      return poll(&wanted, 1, 0) > 0;
  }
}

void PythonProcess::send(const void* bytes, std::size_t size) {
  for (std::size_t sent = 0; sent < size;) {
    const ssize_t n = ready(POLLOUT) ? ::send(socket_, static_cast<const char*>(bytes) + sent, size - sent, MSG_NOSIGNAL | MSG_DONTWAIT) : 0;
    if (n < 0 && (errno == EINTR || errno == EAGAIN)) continue;
    if (n <= 0) ended();
    sent += static_cast<std::size_t>(n);
  }
}

void PythonProcess::receive(void* bytes, std::size_t size) {
  char* to = static_cast<char*>(bytes);
  const std::size_t kept = std::min(buffer_.size() - taken_, size);
  std::memcpy(to, buffer_.data() + taken_, kept);
  taken_ += kept;
  for (std::size_t got = kept; got < size;) {
    const ssize_t n = ready(POLLIN) ? recv(socket_, to + got, size - got, MSG_DONTWAIT) : 0;
    if (n < 0 && (errno == EINTR || errno == EAGAIN)) continue;
    if (n <= 0) ended();
    got += static_cast<std::size_t>(n);
  }
}

nlohmann::json PythonProcess::line() {
  buffer_.erase(0, std::exchange(taken_, 0));
  std::size_t end_of_line = 0;
  for (char part[65536]; (end_of_line = buffer_.find('\n')) == std::string::npos && buffer_.size() < longest_line;) {
    const ssize_t n = ready(POLLIN) ? recv(socket_, part, sizeof part, MSG_DONTWAIT) : 0;
    if (n < 0 && (errno == EINTR || errno == EAGAIN)) continue;
    if (n <= 0) ended();
    buffer_.append(part, static_cast<std::size_t>(n));
  }
  nlohmann::json answer = nlohmann::json::parse(buffer_.substr(0, end_of_line), nullptr, false);
  if (!answer.is_object()) {
    end(0);
    throw Error(ErrorCode::model, "python3 gave no answer; does the file write to the socket of `dyn`?", {file_, 0, ""});
  }
  taken_ = end_of_line + 1;
  return answer;
}

nlohmann::json PythonProcess::ask(const nlohmann::json& head, const std::vector<double>& numbers) {
  std::string text = head.dump() + "\n";
  text.append(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(double));
  send(text.data(), text.size());
  nlohmann::json answer = line();
  if (answer.contains("error")) throw Error(ErrorCode::model, answer["error"]);
  return answer;
}

void PythonProcess::read(double* numbers, std::size_t count) { receive(numbers, count * sizeof(double)); }

}  // namespace dyn::tool::sweep
