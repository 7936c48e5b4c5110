// SPDX-License-Identifier: Apache-2.0
// Ranks of a job as threads of one process, and a keeper in memory that they share.
#pragma once

#include <condition_variable>
#include <cstring>
#include <deque>
#include <exception>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "dytex/distributed/communicator.hpp"
#include "dytex/distributed/stripe_keeper.hpp"

namespace emberfold::test {

/// Letters on their way, by sender and receiver.
class Mailboxes {
 public:
  void put(int from, int to, std::span<const std::byte> bytes) {
    const std::scoped_lock lock(mutex_);
    boxes_[{from, to}].emplace_back(bytes.begin(), bytes.end());
    changed_.notify_all();
  }
  void take(int from, int to, std::span<std::byte> bytes) {
    std::unique_lock lock(mutex_);
    auto& box = boxes_[{from, to}];
    if (!changed_.wait_for(lock, std::chrono::seconds(60), [&] { return !box.empty(); }))
      throw std::logic_error("a rank waits for a letter that never comes");
    if (box.front().size() != bytes.size()) throw std::logic_error("a letter has another size");
    std::ranges::copy(box.front(), bytes.begin());
    box.pop_front();
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::map<std::pair<int, int>, std::deque<std::vector<std::byte>>> boxes_;
};

class ThreadRank final : public dytex::Communicator {
 public:
  ThreadRank(Mailboxes& boxes, int rank, int ranks) : boxes_(boxes), rank_(rank), ranks_(ranks) {}
  [[nodiscard]] int rank() const override { return rank_; }
  [[nodiscard]] int ranks() const override { return ranks_; }
  void send(int rank, std::span<const std::byte> bytes) override {
    count(bytes.size());
    boxes_.put(rank_, rank, bytes);
  }
  void receive(int rank, std::span<std::byte> bytes) override { boxes_.take(rank, rank_, bytes); }
  void exchange(const std::vector<std::span<const std::byte>>& to,
                const std::vector<std::span<std::byte>>& from) override {
    for (int r = 0; r < ranks_; ++r) {
      if (r != rank_) count(to[static_cast<std::size_t>(r)].size());
      boxes_.put(rank_, r, to[static_cast<std::size_t>(r)]);
    }
    for (int r = 0; r < ranks_; ++r) boxes_.take(r, rank_, from[static_cast<std::size_t>(r)]);
  }

 private:
  Mailboxes& boxes_;
  int rank_, ranks_;
};

/// Calls body on so many ranks at once; rethrows what the first of them threw.
inline void run_ranks(int ranks, const std::function<void(dytex::Communicator&)>& body) {
  Mailboxes boxes;
  std::vector<std::exception_ptr> failures(static_cast<std::size_t>(ranks));
  std::vector<std::thread> threads;
  for (int r = 0; r < ranks; ++r)
    threads.emplace_back([&, r] {
      ThreadRank rank(boxes, r, ranks);
      try {
        body(rank);
      } catch (...) {
        failures[static_cast<std::size_t>(r)] = std::current_exception();
      }
    });
  for (auto& thread : threads) thread.join();
  for (const auto& failure : failures)
    if (failure) std::rethrow_exception(failure);
}

/// What ranks of this process keep; lives on when they end.
struct SharedMemory {
  std::mutex mutex;
  std::map<std::size_t, std::vector<std::byte>> stripes;
  std::map<std::string, std::vector<std::byte>> named;
  int puts = 0;
};

class MemoryKeeper final : public dytex::StripeKeeper {
 public:
  explicit MemoryKeeper(SharedMemory& memory) : memory_(memory) {}
  void put(std::size_t stripe, std::size_t offset, std::span<const std::byte> values) override {
    const std::scoped_lock lock(memory_.mutex);
    auto& bytes = memory_.stripes[stripe];
    if (bytes.size() < offset + values.size()) bytes.resize(offset + values.size());
    std::ranges::copy(values, bytes.begin() + static_cast<std::ptrdiff_t>(offset));
    ++memory_.puts;
  }
  std::span<const std::byte> values(std::size_t stripe, std::size_t size) override {
    const std::scoped_lock lock(memory_.mutex);
    const auto& bytes = memory_.stripes.at(stripe);
    if (bytes.size() < size) throw std::logic_error("a stripe is too short");
    return {bytes.data(), size};
  }
  void flush() override {}
  void save(const std::string& name, std::span<const std::byte> bytes) override {
    const std::scoped_lock lock(memory_.mutex);
    memory_.named[name].assign(bytes.begin(), bytes.end());
  }
  std::optional<std::vector<std::byte>> load(const std::string& name) override {
    const std::scoped_lock lock(memory_.mutex);
    const auto found = memory_.named.find(name);
    if (found == memory_.named.end()) return std::nullopt;
    return found->second;
  }
  void remove(const std::string& name) override {
    const std::scoped_lock lock(memory_.mutex);
    memory_.named.erase(name);
  }

 private:
  SharedMemory& memory_;
};

}  // namespace emberfold::test
