// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <memory>

#include "core/context.hpp"

namespace emberfold::core {

/// Calls body(i) once for every i in [0, count), on as many threads as the process allows; the order is free.
/// Whoever needs random numbers in the body makes them from i. Checks `context` before each call: after a
/// cancel no further call begins and the result is Status::cancelled. The first exception of a body is
/// rethrown.
Status parallel_for(std::size_t count, const Context& context, const std::function<void(std::size_t)>& body);

/// Calls before(i), body(i) and after(i) for every i in [0, count): `before` and `after` in order, one call
/// of each at a time, `body` on as many threads as the process allows, all three side by side. At most
/// `at_once` ≥ 1 items are under way: before(i) comes after after(i − at_once) has returned, so that i %
/// at_once may name an item's place. After a cancel nothing more is begun, items under way go on to their
/// `after` as far as all those before them do, and the result is Status::cancelled. The first exception is
/// rethrown.
struct StreamSteps {
  std::function<void(std::size_t)> before, body, after;
};
Status parallel_stream(std::size_t count, std::size_t at_once, const Context& context,
                       const StreamSteps& steps);

/// Sum of term(i) over [0, count), the same bits at any thread count: blocks of `grain` terms are summed in
/// order, and the block sums are added along a fixed tree. `grain` is part of the result's definition.
double deterministic_sum(std::size_t count, std::size_t grain,
                         const std::function<double(std::size_t)>& term);

/// While one lives, the process uses at most this many threads (the library's and OpenCV's). For
/// applications: libraries never make one. 0 leaves the choice to the machine.
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
