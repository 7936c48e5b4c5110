// SPDX-License-Identifier: Apache-2.0
#include "core/parallel.hpp"

#include <algorithm>
#include <atomic>
#include <limits>
#include <vector>

#include <opencv2/core/utility.hpp>
#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/parallel_reduce.h>

#ifdef __SANITIZE_THREAD__
#include <sanitizer/tsan_interface.h>
#endif

namespace emberfold::core {

namespace {

/// Tells ThreadSanitizer that what was written before hand_over is seen after take_over: threads meet inside
/// TBB, whose library is not compiled with it (preset tsan).
class Meeting {
 public:
#ifdef __SANITIZE_THREAD__
  void hand_over() {
    __tsan_release(this);
  }
  void take_over() {
    __tsan_acquire(this);
  }
#else
  void hand_over() {}
  void take_over() {}
#endif
};

/// Calls it at the end of a scope, however it ends.
struct HandOver {
  Meeting& meeting;
  ~HandOver() { meeting.hand_over(); }
};
struct TakeOver {
  Meeting& meeting;
  ~TakeOver() { meeting.take_over(); }
};

}  // namespace

void parallel_for(std::size_t count, const Context& context, const std::function<void(std::size_t)>& body) {
  std::atomic<bool> cancelled{false};
  Meeting begin, end;
  begin.hand_over();
  const TakeOver after{end};
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, count, 1),
      [&](const tbb::blocked_range<std::size_t>& range) {
        begin.take_over();
        const HandOver after_body{end};
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
  /// Meetings of the item in a slot: from one step to the next, and from an item to the next one in the slot.
  struct Slot {
    Meeting begun, made, ended;
  };
  std::vector<Slot> slots(std::max<std::size_t>(at_once, 1));
  const auto slot = [&](std::size_t index) -> Slot& { return slots[index % slots.size()]; };
  Meeting begins, ends;  // of serial steps
  const auto stops = [&] { return cancelled = cancelled || context.cancelled(); };
  const auto begin = [&](tbb::flow_control& flow) -> Item {
    begins.take_over();
    if (next == count || stops()) {
      flow.stop();
      return {};
    }
    slot(next).ended.take_over();
    steps.before(next);
    slot(next).begun.hand_over();
    const Item item{next++, false};
    begins.hand_over();
    return item;
  };
  const auto make = [&](Item item) -> Item {
    if (stops()) return item;
    slot(item.index).begun.take_over();
    steps.body(item.index);
    slot(item.index).made.hand_over();
    return {item.index, true};
  };
  const auto end = [&](Item item) {
    ends.take_over();
    slot(item.index).made.take_over();
    broken = broken || !item.made;
    if (!broken) steps.after(item.index);
    slot(item.index).ended.hand_over();
    ends.hand_over();
  };
  using enum tbb::filter_mode;
  tbb::parallel_pipeline(std::max<std::size_t>(at_once, 1),
                         tbb::make_filter<void, Item>(serial_in_order, begin) &
                             tbb::make_filter<Item, Item>(parallel, make) &
                             tbb::make_filter<Item, void>(serial_in_order, end));
  ends.take_over();
  if (cancelled) throw Cancelled{};
}

double deterministic_sum(std::size_t count, std::size_t grain,
                         const std::function<double(std::size_t)>& term) {
  Meeting begin, end;
  begin.hand_over();
  const double total = tbb::parallel_deterministic_reduce(
      tbb::blocked_range<std::size_t>(0, count, std::max<std::size_t>(grain, 1)), 0.0,
      [&](const tbb::blocked_range<std::size_t>& range, double sum) {
        begin.take_over();
        for (std::size_t i = range.begin(); i != range.end(); ++i) sum += term(i);
        end.hand_over();
        return sum;
      },
      [](double a, double b) { return a + b; }, tbb::simple_partitioner());
  end.take_over();
  return total;
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
