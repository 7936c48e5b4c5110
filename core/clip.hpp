// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace emberfold::core {

/// Origin of a part of a clip. Added to positions and times of the part, it makes them relative to
/// `counted_from`.
struct ClipOrigin {
  double x = 0, y = 0;       ///< px of the clip's frames
  double seconds = 0;        ///< s, ≥ 0
  std::string counted_from;  ///< "source" or "part"; empty where the clip is no part of another
  bool operator==(const ClipOrigin&) const = default;
};

/// Format of a clip, known before its frames are read.
/// Frames are cv::Mat, height rows × width columns, of depth CV_8U, CV_16U or CV_32F, with 1 channel (grey)
/// or 3 (blue, green, red).
struct ClipInfo {
  int width = 0;       ///< px, ≥ 1
  int height = 0;      ///< px, ≥ 1
  int channels = 1;    ///< 1 or 3
  int depth = 0;       ///< CV_8U, CV_16U or CV_32F
  double fps = 25;     ///< frames a second, > 0
  double white = 255;  ///< value of white: 255, the true range of a 16-bit clip, or 1 for CV_32F
  std::optional<std::int64_t> frames = {};  ///< number of frames, if known without reading
  bool fps_is_known = true;                 ///< false: the rate is unknown, and `fps` is a guess
  std::optional<double> pixel_um = {};      ///< side of a pixel, µm, > 0, where known
  /// Time of each frame, s, ascending, from the source's first frame or the part's; empty where frames are
  /// evenly spaced, `fps` a second.
  std::vector<double> times = {};
  ClipOrigin origin = {};  ///< its seconds are already in `times`

  bool operator==(const ClipInfo&) const = default;
};

/// A clip in memory.
struct Clip {
  ClipInfo info;
  std::vector<cv::Mat> frames;
};

/// A clip that is read frame by frame, any number of times.
class FrameSource {
 public:
  virtual ~FrameSource() = default;
  [[nodiscard]] virtual const ClipInfo& info() const = 0;
  /// Returns the next frame, in memory of its own and in the format of info(); an empty one after the last.
  virtual cv::Mat next() = 0;
  /// Restarts from the first frame.
  virtual void rewind() = 0;
};

/// Reads a clip in memory, which must outlive it. Frames are deep copies.
class ClipSource final : public FrameSource {
 public:
  explicit ClipSource(const Clip& clip) : clip_(clip) {}
  [[nodiscard]] const ClipInfo& info() const override { return clip_.info; }
  cv::Mat next() override;
  void rewind() override { position_ = 0; }

 private:
  const Clip& clip_;
  std::size_t position_ = 0;
};

/// Reads all remaining frames of a source.
Clip read_all(FrameSource& source);

/// Converts a frame to levels: CV_32F, white = 255, channels kept.
cv::Mat to_levels(const cv::Mat& frame, const ClipInfo& info);

/// Computes the luma of a frame (ITU-R BT.601): CV_32F, one channel, white = 255.
cv::Mat luma(const cv::Mat& frame, const ClipInfo& info);
/// Computes the luma of levels (CV_32F, 1 or 3 channels); grey levels are returned without a copy.
cv::Mat luma(const cv::Mat& levels);

/// Converts levels (CV_32F, white = 255) to CV_8U, rounded and saturated.
cv::Mat to_bytes(const cv::Mat& levels);

}  // namespace emberfold::core
