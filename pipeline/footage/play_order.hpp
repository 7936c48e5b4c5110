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

/// What a moment of a played footage shows: a frame, or about a jump the way from one frame to another.
struct PlayedMoment {
  int frame = 0;
  int other = 0;  ///< the frame that it turns into
  int half = 0;   ///< half of the moments of that way; 0: `frame` alone
  int place = 0;  ///< on that way, −half…half − 1

  bool operator==(const PlayedMoment&) const = default;
};

/// Returns the frame that a moment shows more of.
inline int shown_frame(const PlayedMoment& moment) {
  return moment.half > 0 && moment.place >= 0 ? moment.other : moment.frame;
}

/// Names a turn by the frames of both runs at its middle, and its half.
using Turn = std::tuple<int, int, int>;

/// Returns the turn that a moment is of, of those whose half is not 0.
inline Turn turn_of(const PlayedMoment& moment) {
  return {moment.frame - moment.place, moment.other - moment.place, moment.half};
}

/// Holds the settings of a PlayOrder.
struct PlayOrderOptions {
  std::uint64_t seed = 1;
  std::optional<int> loop = {};  ///< after so many frames, at least 2, the order begins anew
  int shift = 0;                 ///< of a loop: moments by which it is ahead of the order without shift
  /// Cost of showing a frame at a moment, beside other plays of the footage: 1 is usual, infinite what must
  /// not be. Empty: none. Called while the order is drawn, with ascending moments.
  std::function<double(std::int64_t moment, int frame)> beside = {};
};

/// Plays a footage without end: frame by frame, and now and then on from a moment like the one that is left.
/// A jump is drawn by its cost, how often the next frames were shown, and how long it can go on from there;
/// it takes the longer, the less alike the moments are. Where the footage has no like moments, as one that
/// drifts, it is played to its end and back. Equal options play equal orders.
class PlayOrder {
 public:
  explicit PlayOrder(LikeMoments moments, PlayOrderOptions options = {});

  /// Returns what moment n ≥ 0 shows. Moments may be asked for in any order.
  PlayedMoment at(std::int64_t n);
  /// Returns the mean cost of the jumps so far over the mean change between neighbouring frames; 0 without.
  [[nodiscard]] double relative_cost() const;
  /// Tells whether any frames so far were played backwards.
  [[nodiscard]] bool plays_back() const;

 private:
  struct Run {
    std::int64_t begin = 0;   // moment of its first frame
    int first = 0, last = 0;  // frames; last < first: backwards
    int half = 0;             // frames on each side of its end that turn into the next run's

    [[nodiscard]] int length() const { return std::abs(last - first) + 1; }
    [[nodiscard]] std::int64_t end() const { return begin + length(); }
  };
  struct Jump {
    int from = 0, to = 0;  // frames
    double cost = 0;       // squared, of the best jumps', with all that makes it better or worse
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
  std::vector<int> played_;  // how often each frame was
};

}  // namespace emberfold::pipeline
