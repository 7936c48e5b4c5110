// SPDX-License-Identifier: Apache-2.0
#include "core/parallel.hpp"

#include <algorithm>
#include <atomic>
#include <limits>

#include <opencv2/core/utility.hpp>
#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/parallel_reduce.h>

namespace emberfold::core {

void parallel_for(std::size_t count, const Context& context, const std::function<void(std::size_t)>& body) {
  std::atomic<bool> cancelled{false};
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, count, 1),
      [&](const tbb::blocked_range<std::size_t>& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
          if (context.cancelled()) {
            cancelled = true;
            return;
          }
          body(i);
        }
      },
      tbb::simple_partitioner());
  if (cancelled) throw Cancelled{};
}

void parallel_stream(std::size_t count, std::size_t at_once, const Context& context,
                     const StreamSteps& steps) {
  std::size_t next = 0;
  std::atomic<bool> cancelled{false};
  bool broken = false;  // an item was skipped: later ones skip `after`
  struct Item {
    std::size_t index;
    bool made;
  };
  const auto stops = [&] { return cancelled = cancelled || context.cancelled(); };
  const auto begin = [&](tbb::flow_control& flow) -> Item {
    if (next == count || stops()) {
      flow.stop();
      return {};
    }
    steps.before(next);
    return {next++, false};
  };
  const auto make = [&](Item item) -> Item {
    if (stops()) return item;
    steps.body(item.index);
    return {item.index, true};
  };
  const auto end = [&](Item item) {
    broken = broken || !item.made;
    if (!broken) steps.after(item.index);
  };
  using enum tbb::filter_mode;
  tbb::parallel_pipeline(std::max<std::size_t>(at_once, 1),
                         tbb::make_filter<void, Item>(serial_in_order, begin) &
                             tbb::make_filter<Item, Item>(parallel, make) &
                             tbb::make_filter<Item, void>(serial_in_order, end));
  if (cancelled) throw Cancelled{};
}

double deterministic_sum(std::size_t count, std::size_t grain,
                         const std::function<double(std::size_t)>& term) {
  return tbb::parallel_deterministic_reduce(
      tbb::blocked_range<std::size_t>(0, count, std::max<std::size_t>(grain, 1)), 0.0,
      [&](const tbb::blocked_range<std::size_t>& range, double sum) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) sum += term(i);
        return sum;
      },
      [](double a, double b) { return a + b; }, tbb::simple_partitioner());
}

struct ThreadLimit::Control {
  explicit Control(std::size_t threads)
      : control(tbb::global_control::max_allowed_parallelism, threads), opencv_before(cv::getNumThreads()) {
    constexpr auto kMost = static_cast<std::size_t>(std::numeric_limits<int>::max());
    cv::setNumThreads(static_cast<int>(std::min(threads, kMost)));
  }
  ~Control() { cv::setNumThreads(opencv_before); }
  Control(const Control&) = delete;
  Control& operator=(const Control&) = delete;

  tbb::global_control control;
  int opencv_before;
};

ThreadLimit::ThreadLimit(std::size_t threads) {
  if (threads > 0) control_ = std::make_unique<Control>(threads);
}

ThreadLimit::~ThreadLimit() = default;

}  // namespace emberfold::core
