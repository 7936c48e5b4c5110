// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace emberfold::core {

/// What is known of a clip before its frames are read. Frames are cv::Mat, height rows × width columns, of
/// depth CV_8U, CV_16U or CV_32F, with 1 (grey) or 3 channels (in OpenCV's order: blue, green, red).
struct ClipInfo {
  int width = 0;       ///< px, ≥ 1
  int height = 0;      ///< px, ≥ 1
  int channels = 1;    ///< 1 or 3
  int depth = 0;       ///< CV_8U, CV_16U or CV_32F
  double fps = 25;     ///< frames a second, > 0
  double white = 255;  ///< the value that shows as white: 255, a 16-bit clip's true range, or 1 for CV_32F
  std::optional<std::int64_t> frames;  ///< where the source knows it without reading

  bool operator==(const ClipInfo&) const = default;
};

/// A clip in memory.
struct Clip {
  ClipInfo info;
  std::vector<cv::Mat> frames;
};

/// A clip that is read frame by frame, as often as one likes.
class FrameSource {
 public:
  virtual ~FrameSource() = default;
  [[nodiscard]] virtual const ClipInfo& info() const = 0;
  /// The next frame, its own memory, of the size and type that info() tells; an empty one after the last.
  virtual cv::Mat next() = 0;
  /// Starts again from the first frame.
  virtual void rewind() = 0;
};

/// A source over a clip in memory; the clip must outlive it. Its frames are deep copies.
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

/// All frames of a source from where it stands.
Clip read_all(FrameSource& source);

/// The frame's values as CV_32F on the scale of 8-bit grey levels, white = 255; channels kept.
cv::Mat to_levels(const cv::Mat& frame, const ClipInfo& info);

/// Luma (Rec. 601) as CV_32F, one channel, white = 255; of a frame, or of levels (CV_32F, 1 or 3 channels),
/// whose own memory it is where they are grey.
cv::Mat luma(const cv::Mat& frame, const ClipInfo& info);
cv::Mat luma(const cv::Mat& levels);

/// Levels (CV_32F, white = 255) rounded and saturated to CV_8U.
cv::Mat to_bytes(const cv::Mat& levels);

}  // namespace emberfold::core
