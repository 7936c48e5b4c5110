// SPDX-License-Identifier: Apache-2.0
// The only file that knows MPI.
#include "apps/distributed/mpi_job.hpp"

#include <algorithm>
#include <cstdlib>
#include <vector>

#include <mpi.h>

namespace emberfold::apps {

namespace {

constexpr std::size_t kMostBytes = std::size_t{1} << 28;  // of one message: MPI counts have 31 bits
constexpr int kTag = 0;

/// Calls body(part) for parts of the bytes that fit in one message.
template <class Bytes, class Body>
void in_messages(Bytes bytes, const Body& body) {
  for (std::size_t at = 0; at < bytes.size(); at += kMostBytes)
    body(bytes.subspan(at, std::min(kMostBytes, bytes.size() - at)));
}

int length(std::size_t bytes) {
  return static_cast<int>(bytes);
}

class MpiRanks final : public dytex::Communicator {
 public:
  MpiRanks() {
    MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
    MPI_Comm_size(MPI_COMM_WORLD, &ranks_);
  }
  [[nodiscard]] int rank() const override { return rank_; }
  [[nodiscard]] int ranks() const override { return ranks_; }

  void send(int rank, std::span<const std::byte> bytes) override {
    count(bytes.size());
    in_messages(bytes, [&](std::span<const std::byte> part) {
      MPI_Send(part.data(), length(part.size()), MPI_BYTE, rank, kTag, MPI_COMM_WORLD);
    });
  }
  void receive(int rank, std::span<std::byte> bytes) override {
    in_messages(bytes, [&](std::span<std::byte> part) {
      MPI_Recv(part.data(), length(part.size()), MPI_BYTE, rank, kTag, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    });
  }
  void exchange(const std::vector<std::span<const std::byte>>& to,
                const std::vector<std::span<std::byte>>& from) override {
    std::vector<MPI_Request> requests;
    const auto me = static_cast<std::size_t>(rank_);
    const auto begin = [&](const auto& call) {
      requests.emplace_back();
      call(&requests.back());
    };
    for (int r = 0; r < ranks_; ++r) {
      if (r == rank_) continue;
      in_messages(from[static_cast<std::size_t>(r)], [&](std::span<std::byte> part) {
        begin([&](MPI_Request* request) {
          MPI_Irecv(part.data(), length(part.size()), MPI_BYTE, r, kTag, MPI_COMM_WORLD, request);
        });
      });
    }
    for (int r = 0; r < ranks_; ++r) {
      if (r == rank_) continue;
      count(to[static_cast<std::size_t>(r)].size());
      in_messages(to[static_cast<std::size_t>(r)], [&](std::span<const std::byte> part) {
        begin([&](MPI_Request* request) {
          MPI_Isend(part.data(), length(part.size()), MPI_BYTE, r, kTag, MPI_COMM_WORLD, request);
        });
      });
    }
    std::ranges::copy(to[me], from[me].begin());
    MPI_Waitall(length(requests.size()), requests.data(), MPI_STATUSES_IGNORE);
  }

 private:
  int rank_ = 0, ranks_ = 1;
};

class Mpi {
 public:
  Mpi() {
    int granted = 0;
    MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &granted);
  }
  ~Mpi() { MPI_Finalize(); }
  Mpi(const Mpi&) = delete;
  Mpi& operator=(const Mpi&) = delete;
};

class StartedJob final : public MpiJob {
 public:
  [[nodiscard]] dytex::Communicator& ranks() override { return ranks_; }
  [[noreturn]] void abort(int status) override {
    MPI_Abort(MPI_COMM_WORLD, status);
    std::abort();  // MPI_Abort does not return
  }

 private:
  Mpi mpi_;
  MpiRanks ranks_;
};

}  // namespace

std::unique_ptr<MpiJob> join_mpi_job() {
  if (launched_ranks() == 0) return nullptr;
  return std::make_unique<StartedJob>();
}

bool is_left_out() {
  return false;
}

}  // namespace emberfold::apps
