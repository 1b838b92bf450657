// SPDX-License-Identifier: BSD-2-Clause
#include "ranks/ranks.hpp"

#include "ranks/channel.hpp"

#include <dyn/error.hpp>

#include <cstdlib>

#ifdef DYN_HAS_MPI
#include <mpi.h>

#include <algorithm>
#include <chrono>
#include <thread>
#endif

namespace dyn::tool::sweep {

namespace {

int fromEnvironment(std::initializer_list<const char*> names, int otherwise) {
  for (const char* name : names)
    if (const char* value = std::getenv(name)) return std::atoi(value);
  return otherwise;
}

#ifdef DYN_HAS_MPI

class MpiConnection final : public Connection {
 public:
  MpiConnection() {
    int provided = 0;
    MPI_Init_thread(nullptr, nullptr, MPI_THREAD_SERIALIZED, &provided);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    MPI_Comm_size(MPI_COMM_WORLD, &count);
    if (provided < MPI_THREAD_SERIALIZED) throw Error(ErrorCode::argument, "this MPI does not allow threads (MPI_THREAD_SERIALIZED)");
  }
  ~MpiConnection() override { MPI_Finalize(); }

  std::vector<std::string> gather(const std::string& text) override {
    const int length = static_cast<int>(text.size());
    std::vector<int> lengths(static_cast<std::size_t>(count)), begins(lengths.size());
    MPI_Gather(&length, 1, MPI_INT, lengths.data(), 1, MPI_INT, 0, MPI_COMM_WORLD);
    int sum = 0;
    for (std::size_t k = 0; k < lengths.size(); ++k) begins[k] = sum, sum += lengths[k];
    std::string all(static_cast<std::size_t>(sum), ' ');
    MPI_Gatherv(text.data(), length, MPI_CHAR, all.data(), lengths.data(), begins.data(), MPI_CHAR, 0, MPI_COMM_WORLD);
    std::vector<std::string> out;
    if (rank == 0)
      for (std::size_t k = 0; k < lengths.size(); ++k)
        out.push_back(all.substr(static_cast<std::size_t>(begins[k]), static_cast<std::size_t>(lengths[k])));
    return out;
  }

  std::string broadcast(const std::string& text) override {
    int length = static_cast<int>(text.size());
    MPI_Bcast(&length, 1, MPI_INT, 0, MPI_COMM_WORLD);
    std::string out = text;
    out.resize(static_cast<std::size_t>(length));
    MPI_Bcast(out.data(), length, MPI_CHAR, 0, MPI_COMM_WORLD);
    return out;
  }

  void send(int to, const std::string& text) override { MPI_Send(text.data(), static_cast<int>(text.size()), MPI_CHAR, to, 0, MPI_COMM_WORLD); }

  std::optional<Message> poll() override {
    int arrived = 0, length = 0;
    MPI_Status status;
    MPI_Iprobe(MPI_ANY_SOURCE, 0, MPI_COMM_WORLD, &arrived, &status);
    if (!arrived) return {};
    MPI_Get_count(&status, MPI_CHAR, &length);
    Message out{status.MPI_SOURCE, std::string(static_cast<std::size_t>(length), ' ')};
    MPI_Recv(out.text.data(), length, MPI_CHAR, out.from, 0, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    return out;
  }

  std::string wait() override {
    // MPI's own wait would keep a processor busy.
    for (std::chrono::microseconds pause(100);; pause = std::min(2 * pause, std::chrono::microseconds(1000))) {
      if (const std::optional<Message> message = poll()) return message->text;
      std::this_thread::sleep_for(pause);
    }
  }

  int rank = 0, count = 1;
};

#endif

}  // namespace

// A channel comes first; then the names that Open MPI, MPICH and Slurm give to the processes that they start.
int Ranks::numberFromEnvironment() {
  if (const std::optional<ChannelPlace> place = ChannelPlace::fromEnvironment()) return place->rank;
  return fromEnvironment({"OMPI_COMM_WORLD_RANK", "PMI_RANK", "PMIX_RANK"}, 0);
}
int Ranks::countFromEnvironment() {
  if (const std::optional<ChannelPlace> place = ChannelPlace::fromEnvironment()) return place->count;
  return fromEnvironment({"OMPI_COMM_WORLD_SIZE", "PMI_SIZE"}, std::getenv("PMIX_RANK") ? 2 : 1);
}
bool Ranks::haveOwnInput() { return ChannelPlace::fromEnvironment().has_value(); }

Ranks::Ranks() {
  if (countFromEnvironment() <= 1) return;
  if (const std::optional<ChannelPlace> place = ChannelPlace::fromEnvironment()) {
    rank_ = place->rank;
    count_ = place->count;
    connection_ = channelConnection(*place);
    return;
  }
#ifdef DYN_HAS_MPI
  auto mpi = std::make_unique<MpiConnection>();
  rank_ = mpi->rank;
  count_ = mpi->count;
  if (count_ > 1) connection_ = std::move(mpi);
#else
  throw Error(ErrorCode::argument, "this dyn was built without MPI; start it without mpirun, or install libopenmpi-dev and build again");
#endif
}

std::vector<std::string> Ranks::gather(const std::string& text) const {
  return connection_ ? connection_->gather(text) : std::vector<std::string>{text};
}
std::string Ranks::broadcast(const std::string& text) const { return connection_ ? connection_->broadcast(text) : text; }
void Ranks::send(int to, const std::string& text) const {
  if (connection_) connection_->send(to, text);
}
std::optional<Message> Ranks::poll() const { return connection_ ? connection_->poll() : std::nullopt; }
std::string Ranks::wait() const { return connection_ ? connection_->wait() : ""; }

}  // namespace dyn::tool::sweep
