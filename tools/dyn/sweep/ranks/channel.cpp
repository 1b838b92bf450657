// SPDX-License-Identifier: BSD-2-Clause
#include "ranks/channel.hpp"

#include "messages.hpp"

#include <dyn/error.hpp>

#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>

#include <cerrno>
#include <cstdlib>
#include <sstream>

namespace dyn::tool::sweep {

namespace {

constexpr std::size_t longest_message = std::size_t{1} << 30;
constexpr std::size_t longest_head = 64;

/// Files of a sweep are written as a whole, so that the process may end at any time.
[[noreturn]] void leave(const char* why) {
  error(std::string("the program that carries the messages of the ranks ") + why);
  std::_Exit(1);
}

class Channel final : public Connection {
 public:
  explicit Channel(const ChannelPlace& place) : place_(place) {}

  // Each rank waits for rank 0's answer before it sends what comes next, so that no text of a later call arrives.
  std::vector<std::string> gather(const std::string& text) override {
    if (place_.rank != 0) {
      send(0, text);
      return {};
    }
    std::vector<std::string> out(static_cast<std::size_t>(place_.count));
    out[0] = text;
    for (int k = 1; k < place_.count; ++k) {
      Message message = next();
      out[static_cast<std::size_t>(message.from)] = std::move(message.text);
    }
    return out;
  }

  std::string broadcast(const std::string& text) override {
    if (place_.rank != 0) return wait();
    for (int k = 1; k < place_.count; ++k) send(k, text);
    return text;
  }

  void send(int to, const std::string& text) override {
    const std::string all = std::to_string(to) + " " + std::to_string(text.size()) + "\n" + text;
    for (std::size_t sent = 0; sent < all.size();) {
      const ssize_t n = ::send(place_.socket, all.data() + sent, all.size() - sent, MSG_NOSIGNAL);
      if (n < 0 && errno == EINTR) continue;
      if (n <= 0) leave("has ended");
      sent += static_cast<std::size_t>(n);
    }
  }

  std::optional<Message> poll() override {
    while (ready(0)) read();
    return taken();
  }

  std::string wait() override { return next().text; }

 private:
  bool ready(int milliseconds) const {
    pollfd wanted{place_.socket, POLLIN, 0};
    return ::poll(&wanted, 1, milliseconds) > 0;
  }

  void read() {
    char part[65536];
    const ssize_t n = recv(place_.socket, part, sizeof part, MSG_DONTWAIT);
    if (n < 0 && (errno == EINTR || errno == EAGAIN)) return;
    if (n <= 0) leave("has ended");
    buffer_.append(part, static_cast<std::size_t>(n));
  }

  Message next() {
    for (;;) {
      if (std::optional<Message> message = taken()) return *std::move(message);
      if (ready(-1)) read();
    }
  }

  /// The first message of the buffer, if all of it is there.
  std::optional<Message> taken() {
    const std::size_t line = buffer_.find('\n');
    if (line == std::string::npos && buffer_.size() < longest_head) return {};
    std::istringstream words(buffer_.substr(0, std::min(line, longest_head)));
    Message out;
    std::size_t size = 0;
    if (!(words >> out.from >> size) || out.from < 0 || out.from >= place_.count || size > longest_message) leave("sends no messages");
    if (buffer_.size() - line - 1 < size) return {};
    out.text = buffer_.substr(line + 1, size);
    buffer_.erase(0, line + 1 + size);
    return out;
  }

  ChannelPlace place_;
  std::string buffer_;
};

}  // namespace

std::optional<ChannelPlace> ChannelPlace::fromEnvironment() {
  const char* const value = std::getenv("DYN_SWEEP_CHANNEL");
  if (value == nullptr) return {};
  std::istringstream words(value);
  ChannelPlace out;
  if (!(words >> out.rank >> out.count >> out.socket) || out.rank < 0 || out.rank >= out.count || fcntl(out.socket, F_SETFD, FD_CLOEXEC) != 0)
    throw Error(ErrorCode::argument, std::string("DYN_SWEEP_CHANNEL is '") + value + "' and must be RANK COUNT FD, where FD is an open socket");
  return out;
}

std::unique_ptr<Connection> channelConnection(const ChannelPlace& place) { return std::make_unique<Channel>(place); }

}  // namespace dyn::tool::sweep
