// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "pipeline/footage/like_moments.hpp"

namespace emberfold::pipeline {

/// What a moment of a played footage shows: a frame, or about a jump the way from one frame to another.
struct PlayedMoment {
  int frame = 0;
  int other = 0;  ///< the frame that it turns into
  int half = 0;   ///< half of the moments of that way; 0: `frame` alone
  int place = 0;  ///< on that way, −half…half − 1

  bool operator==(const PlayedMoment&) const = default;
};

/// Plays a footage without end: frame by frame, and now and then on from a moment like the one that is left.
/// A jump is drawn by its cost among those of the next frames; it takes the longer, the less alike the
/// moments are. Equal seeds play equal orders.
class PlayOrder {
 public:
  /// `loop`: after so many frames, at least 2, the order begins anew, by a jump like the others.
  PlayOrder(LikeMoments moments, std::uint64_t seed, std::optional<int> loop = {});

  /// Returns what moment n ≥ 0 shows. Moments may be asked for in any order.
  PlayedMoment at(std::int64_t n);
  /// Returns the mean cost of the jumps so far over the mean change between neighbouring frames; 0 without.
  [[nodiscard]] double relative_cost() const;

 private:
  struct Run {
    std::int64_t begin = 0;   // moment of its first frame
    int first = 0, last = 0;  // frames
    int half = 0;             // frames on each side of its end that turn into the next run's
  };
  void add_run(int first, int last);
  void set_half(std::size_t run, int next, int room);
  void draw_run();
  void close_loop(int frames);
  [[nodiscard]] std::int64_t end(const Run& run) const { return run.begin + run.last - run.first + 1; }

  LikeMoments moments_;
  std::uint64_t seed_;
  std::optional<int> loop_;
  std::vector<Run> runs_;
  std::vector<int> played_;  // how often each frame was
};

}  // namespace emberfold::pipeline
