// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace emberfold::dytex {

/// Sends bytes between the ranks of a job, which all run the same program on parts of the same work. Bytes
/// that a rank exchanges with itself do not count as sent.
class Communicator {
 public:
  Communicator() = default;
  virtual ~Communicator() = default;
  Communicator(const Communicator&) = delete;
  Communicator& operator=(const Communicator&) = delete;

  [[nodiscard]] virtual int rank() const = 0;   ///< 0 … ranks − 1
  [[nodiscard]] virtual int ranks() const = 0;  ///< ≥ 1

  /// Sends to another rank, which receives the same number of bytes.
  virtual void send(int rank, std::span<const std::byte> bytes) = 0;
  virtual void receive(int rank, std::span<std::byte> bytes) = 0;
  /// Sends `to[r]` to every rank r while it receives `from[r]` from it; all ranks call it, and sizes agree at
  /// both ends.
  virtual void exchange(const std::vector<std::span<const std::byte>>& to,
                        const std::vector<std::span<std::byte>>& from) = 0;

  [[nodiscard]] std::uint64_t bytes_sent() const { return sent_; }  ///< by this rank to others

 protected:
  void count(std::size_t bytes) { sent_ += bytes; }

 private:
  std::uint64_t sent_ = 0;
};

/// The only rank of a job.
class SingleRank final : public Communicator {
 public:
  [[nodiscard]] int rank() const override { return 0; }
  [[nodiscard]] int ranks() const override { return 1; }
  void send(int rank, std::span<const std::byte> bytes) override;
  void receive(int rank, std::span<std::byte> bytes) override;
  void exchange(const std::vector<std::span<const std::byte>>& to,
                const std::vector<std::span<std::byte>>& from) override;
};

}  // namespace emberfold::dytex
