// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/clip.hpp"
#include "dytex/quilting/quilt_map.hpp"
#include "dytex/quilting/trajectories.hpp"

namespace emberfold::dytex {

/// The frames beyond the first and last: these repeated; the clip again; the clip to and fro.
enum class ClipEnds { clamp, loop, ping_pong };

/// The source time that an output pixel shows in frame t: f = t · rate(x, y) − offset(x, y), in frames
/// (Enrique et al. 2005, section 2, with the offsets of Gu et al. 2006).
struct TimeControl {
  cv::Mat rate;    ///< CV_32F of the output's size, or empty: 1 everywhere
  cv::Mat offset;  ///< CV_32F of the output's size, in frames, or empty: 0
  ClipEnds ends = ClipEnds::clamp;

  /// Throws InputError unless both have this size and type and are finite, sizes up to 10⁶.
  void validate(cv::Size size) const;
  [[nodiscard]] bool plain() const { return rate.empty() && offset.empty(); }
};

/// A time between two frames of a clip: (1 − weight) · before + weight · after.
struct FrameTime {
  int before = 0, after = 0;
  double weight = 0;  ///< [0, 1)
};
/// Locates `time` in a clip of `frames` ≥ 1.
FrameTime frame_time(double time, int frames, ClipEnds ends);

/// Draws time offsets that differ smoothly from place to place, so that copies of one source block do not all
/// change at once: independent and uniform in ±`frames` at the points of a grid `spacing` px apart, cubic in
/// between. CV_32F.
cv::Mat time_jitter(cv::Size size, cv::Size spacing, double frames, std::uint64_t seed);

/// Renders output frames `first` … `first` + `count` − 1, of the sources' depth and channels. A pixel whose
/// time is a frame of the source is copied bit by bit. Rendering the frames of a chunk together is cheapest.
/// The map's places have to be inside these sources, which agree in all but their size.
std::vector<cv::Mat> render_quilt(const QuiltMap& map, std::span<const Trajectories* const> sources,
                                  const TimeControl& control, std::int64_t first, int count);

/// Renders a quilt frame after frame from sources that are not in memory. It holds the frames between the
/// earliest and the latest time of an output frame.
class QuiltStream {
 public:
  /// All must outlive the stream. InputError where the sources differ in more than size, or streamable() is
  /// none.
  QuiltStream(const QuiltMap& map, std::vector<core::FrameSource*> sources, const TimeControl& control);
  /// Renders the next frame; after the end of the sources the last one again.
  cv::Mat next();
  /// Returns whether a source ended before the times of the last frame of next().
  [[nodiscard]] bool ended() const { return ended_; }

 private:
  struct Ring {
    std::deque<cv::Mat> frames;
    std::int64_t first = 0;  // number of frames.front()
    std::optional<std::int64_t> count;
  };
  void advance(Ring& ring, core::FrameSource& source, std::int64_t from, std::int64_t to);

  const QuiltMap& map_;
  std::vector<core::FrameSource*> sources_;
  const TimeControl& control_;
  std::vector<Ring> rings_;
  std::int64_t frame_ = 0;
  bool ended_ = false;
};

/// Returns the most frames that a QuiltStream of `frames` output frames holds. None where times run
/// backwards, or recur at the ends.
std::optional<std::int64_t> streamable(const TimeControl& control, std::int64_t frames);

}  // namespace emberfold::dytex
