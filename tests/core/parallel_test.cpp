// SPDX-License-Identifier: Apache-2.0
#include "core/parallel.hpp"

#include <algorithm>
#include <atomic>
#include <bit>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <limits>
#include <mutex>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <opencv2/core/utility.hpp>
#include <tbb/task_arena.h>

#include "core/rng.hpp"
#include "tests/support/catch.hpp"

using namespace emberfold;

namespace {

/// Calls `body` where so many threads work, also on a machine with fewer cores.
template <typename Body>
auto with_threads(int threads, Body body) {
  const core::ThreadLimit limit(static_cast<std::size_t>(threads));
  tbb::task_arena arena(threads);
  return arena.execute(body);
}

/// Number of threads that meet inside parallel_for. Each waits until `awaited` have come or the time is over.
std::size_t threads_that_meet(std::size_t awaited, std::chrono::milliseconds patience) {
  std::mutex mutex;
  std::condition_variable arrived;
  std::set<std::thread::id> met;
  const auto end = std::chrono::steady_clock::now() + patience;
  core::parallel_for(64, {}, [&](std::size_t) {
    std::unique_lock lock(mutex);
    met.insert(std::this_thread::get_id());
    arrived.notify_all();
    arrived.wait_until(lock, end, [&] { return met.size() >= awaited; });
  });
  return met.size();
}

/// The sum as the header defines it: halves down to blocks of `grain` terms, added pairwise.
template <typename Term>
double tree_sum(std::size_t begin, std::size_t end, std::size_t grain, Term term) {
  if (end - begin > grain) {
    const std::size_t middle = begin + (end - begin) / 2;
    const double left = tree_sum(begin, middle, grain, term);
    return left + tree_sum(middle, end, grain, term);
  }
  double sum = 0;
  for (std::size_t i = begin; i < end; ++i) sum += term(i);
  return sum;
}

}  // namespace

TEST_CASE("A thread limit bounds the threads, and ends with itself", "[core][parallel]") {
  using namespace std::chrono_literals;
  const int opencv_threads = cv::getNumThreads();
  CHECK(with_threads(1, [] { return threads_that_meet(2, 100ms); }) == 1);
  CHECK(with_threads(4, [] { return threads_that_meet(4, 30s); }) == 4);
  {
    const core::ThreadLimit outer(3);
    CHECK(cv::getNumThreads() == 3);
    {
      const core::ThreadLimit inner(1);
      CHECK(cv::getNumThreads() == 1);
      tbb::task_arena arena(8);
      CHECK(arena.execute([] { return threads_that_meet(2, 100ms); }) == 1);
    }
    CHECK(cv::getNumThreads() == 3);
    const core::ThreadLimit none(0);
    CHECK(cv::getNumThreads() == 3);
  }
  CHECK(cv::getNumThreads() == opencv_threads);
}

TEST_CASE("parallel_for calls every index once", "[core][parallel]") {
  for (const int threads : {1, 2, 8})
    for (const std::size_t count : {std::size_t{0}, std::size_t{1}, std::size_t{7}, std::size_t{10000}}) {
      std::vector<std::atomic<int>> calls(count);
      with_threads(threads, [&] {
        core::parallel_for(count, {}, [&](std::size_t i) { ++calls.at(i); });
        return true;
      });
      CAPTURE(threads, count);
      CHECK(std::all_of(calls.begin(), calls.end(), [](const auto& n) { return n == 1; }));
    }
}

TEST_CASE("parallel_for can be called inside itself", "[core][parallel]") {
  std::vector<std::atomic<int>> calls(40 * 30);
  core::parallel_for(40, {}, [&](std::size_t i) {
    core::parallel_for(30, {}, [&](std::size_t j) { ++calls[30 * i + j]; });
  });
  CHECK(std::all_of(calls.begin(), calls.end(), [](const auto& n) { return n == 1; }));
}

TEST_CASE("After a cancel parallel_for begins nothing more", "[core][parallel]") {
  for (const int threads : {1, 2, 8}) {
    std::stop_source stop;
    std::atomic<std::size_t> calls{0};
    const auto run = [&] {
      core::parallel_for(100000, core::Context(stop.get_token()), [&](std::size_t) {
        if (++calls == 50) stop.request_stop();
      });
      return true;
    };
    CAPTURE(threads);
    CHECK_THROWS_AS(with_threads(threads, run), core::Cancelled);
    CHECK(calls >= 50);
    CHECK(calls <= 50 + static_cast<std::size_t>(threads));  // those under way
    calls = 1000;
    CHECK_THROWS_AS(run(), core::Cancelled);
    CHECK(calls == 1000);
  }
}

TEST_CASE("An exception of a body comes out as it was thrown", "[core][parallel]") {
  struct Trouble : std::runtime_error {
    using std::runtime_error::runtime_error;
  };
  for (const int threads : {1, 2, 8}) {
    CAPTURE(threads);
    try {
      with_threads(threads, [] {
        core::parallel_for(1000, {}, [](std::size_t i) {
          if (i == 333) throw Trouble("at 333");
        });
        return true;
      });
      FAIL("the exception was lost");
    } catch (const Trouble& error) {
      CHECK(std::string(error.what()) == "at 333");
    }
  }
}

TEST_CASE("deterministic_sum has the same bits at any thread count", "[core][parallel]") {
  std::vector<double> terms;
  core::Rng rng(11);
  for (int i = 0; i < 100003; ++i) terms.push_back(rng.normal() * std::pow(10, rng.uniform(-8, 8)));
  const auto term = [&](std::size_t i) { return terms[i]; };
  long double exact = 0;
  double magnitude = 0;
  for (const double value : terms) {
    exact += static_cast<long double>(value);
    magnitude += std::abs(value);
  }
  std::set<std::uint64_t> over_grains;
  for (const std::size_t grain : {1U, 16U, 1000U, 200000U}) {
    const auto bits = std::bit_cast<std::uint64_t>(tree_sum(0, terms.size(), grain, term));
    over_grains.insert(bits);
    for (const int threads : {1, 2, 8})
      for (int repeat = 0; repeat < 3; ++repeat) {
        const double sum =
            with_threads(threads, [&] { return core::deterministic_sum(terms.size(), grain, term); });
        CAPTURE(grain, threads, repeat);
        CHECK(std::bit_cast<std::uint64_t>(sum) == bits);
        // A block's additions in order and the tree's above it.
        const double depth = static_cast<double>(std::min(grain, terms.size())) + 18;
        CHECK(std::abs(static_cast<double>(static_cast<long double>(sum) - exact)) <=
              depth * std::numeric_limits<double>::epsilon() * magnitude);
      }
  }
  CHECK(over_grains.size() > 1);  // the terms are such that another order gives other bits
}

TEST_CASE("deterministic_sum of few terms", "[core][parallel]") {
  const auto one = [](std::size_t) { return 1.0; };
  CHECK(core::deterministic_sum(0, 16, one) == 0);
  CHECK(core::deterministic_sum(1, 16, one) == 1);
  CHECK(core::deterministic_sum(17, 16, one) == 17);
  CHECK(core::deterministic_sum(17, 0, one) == 17);
}
