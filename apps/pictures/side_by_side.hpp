// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/io/clip_writer.hpp"

namespace emberfold::apps {

/// Lays out pictures side by side under labels, each at least 240 px high. Larger ones keep their size while
/// the row is at most 3840 px wide.
class PanelRow {
 public:
  /// Computes the layout for pictures of these sizes.
  explicit PanelRow(std::span<const cv::Size> sizes);
  /// Composes pictures (CV_8UC1 or CV_8UC3) and a label for each into CV_8UC3; long labels are truncated.
  [[nodiscard]] cv::Mat compose(std::span<const cv::Mat> pictures, std::span<const std::string> labels) const;
  [[nodiscard]] cv::Size size() const { return size_; }

 private:
  [[nodiscard]] cv::Rect place(std::size_t index) const;

  std::vector<cv::Size> panels_;
  cv::Size size_;
};

/// Composes pictures of one size in rows of at most `most` and of nearly equal length, each under its label.
cv::Mat compose_rows(std::span<const cv::Mat> pictures, std::span<const std::string> labels,
                     std::size_t most);

/// Writes a video of clips side by side.
class SideBySide {
 public:
  /// Opens the video. `sizes`: frame sizes, one for each label.
  SideBySide(const std::filesystem::path& path, std::vector<std::string> labels,
             std::span<const cv::Size> sizes, double fps);
  /// Writes a frame of each clip, CV_8UC1 or CV_8UC3.
  void write(std::span<const cv::Mat> frames) { writer_->write(row_.compose(frames, labels_)); }
  void finish() { writer_->finish(); }

 private:
  PanelRow row_;
  std::vector<std::string> labels_;
  std::unique_ptr<io::VideoWriter> writer_;
};

}  // namespace emberfold::apps
