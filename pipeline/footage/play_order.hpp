// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <optional>
#include <tuple>
#include <vector>

#include "pipeline/footage/like_moments.hpp"

namespace emberfold::pipeline {

/// Content of a moment of a played footage: a frame, or around a jump a transition between two frames.
struct PlayedMoment {
  int frame = 0;
  int other = 0;  ///< the frame at the end of the transition
  int half = 0;   ///< half of the moments of the transition; 0: `frame` alone
  int place = 0;  ///< moment of the transition, −half…half − 1

  bool operator==(const PlayedMoment&) const = default;
};

/// Returns the frame with the larger share of a moment.
inline int shown_frame(const PlayedMoment& moment) {
  return moment.half > 0 && moment.place >= 0 ? moment.other : moment.frame;
}

/// Identifies a transition: the frames of both runs at its middle, and its half.
using Turn = std::tuple<int, int, int>;

/// Returns the transition of a moment whose half is not 0.
inline Turn turn_of(const PlayedMoment& moment) {
  return {moment.frame - moment.place, moment.other - moment.place, moment.half};
}

/// Holds the settings of a PlayOrder.
struct PlayOrderOptions {
  std::uint64_t seed = 1;
  std::optional<int> loop = {};  ///< frames, ≥ 2, after which the order repeats
  int shift = 0;                 ///< of a loop: moments by which it is ahead of the order without shift
  /// Returns the cost of showing a frame at a moment next to other plays of the footage: 1 is usual, infinite
  /// is forbidden. Empty: no cost. Called while the order is drawn, with ascending moments.
  std::function<double(std::int64_t moment, int frame)> beside = {};
};

/// Plays a footage endlessly: frame by frame, with occasional jumps to similar frames.
/// Jumps are drawn by their cost, by how often the frames that follow were shown, and by how many frames
/// remain there; the less similar the frames, the longer the transition. Without similar frames, as in a clip
/// that drifts, the footage is played to its end and back. Equal options give equal orders.
class PlayOrder {
 public:
  explicit PlayOrder(LikeMoments moments, PlayOrderOptions options = {});

  /// Returns the content of moment n ≥ 0. Moments may be requested in any order.
  PlayedMoment at(std::int64_t n);
  /// Returns the mean cost of the jumps so far over the mean change between neighbouring frames; 0 without
  /// jumps.
  [[nodiscard]] double relative_cost() const;
  /// Returns whether any frames so far were played backwards.
  [[nodiscard]] bool plays_back() const;

 private:
  struct Run {
    std::int64_t begin = 0;   // moment of its first frame
    int first = 0, last = 0;  // frames; last < first: backwards
    int half = 0;             // frames on each side of its end in the transition to the next run

    [[nodiscard]] int length() const { return std::abs(last - first) + 1; }
    [[nodiscard]] std::int64_t end() const { return begin + length(); }
  };
  struct Jump {
    int from = 0, to = 0;  // frames
    double cost = 0;       // squared, relative to the best jumps, with all penalties and preferences
  };
  void add_run(int first, int last);
  void set_half(std::size_t run, int next, int room);
  void begin_first_run();
  void draw_run();
  [[nodiscard]] std::vector<Jump> find_jumps(const Run& run) const;
  void add_neighbours_cost(const Run& run, std::vector<Jump>& jumps) const;
  void turn_back();
  void close_loop(int frames);
  bool close_loop_backwards(int frames);

  LikeMoments moments_;
  PlayOrderOptions options_;
  std::vector<Run> runs_;
  std::vector<int> played_;  // number of times that each frame was played
};

}  // namespace emberfold::pipeline
