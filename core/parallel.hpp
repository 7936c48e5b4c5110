// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <memory>

#include "core/context.hpp"

namespace emberfold::core {

/// Calls body(i) once for every i in [0, count), in any order, on as many threads as the process allows.
/// Random numbers in the body are made from i. Checks `context` before each call: after a stop no call
/// begins, and Cancelled is thrown. The first exception of a body is rethrown.
void parallel_for(std::size_t count, const Context& context, const std::function<void(std::size_t)>& body);

/// The steps of parallel_stream, each called with an item's index.
struct StreamSteps {
  std::function<void(std::size_t)> before, body, after;
};
/// Runs a pipeline: before(i), body(i) and after(i) for every i in [0, count), concurrently.
/// `before` and `after` are called in order, one call at a time; `body` on as many threads as the process
/// allows. At most `at_once` ≥ 1 items are under way: before(i) follows after(i − at_once), so i % at_once
/// may be an item's slot. After a stop nothing is begun, items under way reach `after` unless an earlier one
/// does not, and Cancelled is thrown. The first exception is rethrown.
void parallel_stream(std::size_t count, std::size_t at_once, const Context& context,
                     const StreamSteps& steps);

/// Sums term(i) over [0, count) in parallel, with the same bits at any number of threads.
/// Blocks of `grain` terms are summed in order, and the block sums along a fixed tree; another `grain` may
/// change the bits.
double deterministic_sum(std::size_t count, std::size_t grain,
                         const std::function<double(std::size_t)>& term);

/// Limits the threads of the process, the library's and OpenCV's, during its lifetime.
/// For applications only. 0: no limit.
class ThreadLimit {
 public:
  explicit ThreadLimit(std::size_t threads);
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

 private:
  struct Control;
  std::unique_ptr<Control> control_;
};

}  // namespace emberfold::core
