// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "apps/clip_writer.hpp"

namespace emberfold::apps {

/// A video of clips beside each other, each under its label and at least 240 px high; larger ones keep their
/// size as long as all of them are at most 3840 px wide.
class SideBySide {
 public:
  /// `sizes`: of the clips' frames, one for each label.
  SideBySide(const std::filesystem::path& path, std::vector<std::string> labels,
             std::span<const cv::Size> sizes, double fps);
  /// A frame of each, CV_8UC1 or CV_8UC3.
  void write(std::span<const cv::Mat> frames);
  void finish() { writer_->finish(); }

 private:
  [[nodiscard]] cv::Rect place(std::size_t index) const;

  std::vector<std::string> labels_;
  std::vector<cv::Size> panels_;
  cv::Mat empty_;  // with the labels
  std::unique_ptr<ClipWriter> writer_;
};

}  // namespace emberfold::apps
