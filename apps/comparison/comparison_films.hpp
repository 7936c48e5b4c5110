// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "apps/pictures/side_by_side.hpp"
#include "core/io/clip_writer.hpp"
#include "core/io/staged_output.hpp"
#include "pipeline/compare.hpp"

namespace emberfold::apps {

/// Holds one frame of all clips side by side, CV_8UC3.
struct ComparedFrame {
  int frame = 0;
  cv::Mat picture;
};

/// Returns the file of a model's new clip, by the model's key.
std::string drawn_clip_file(const std::string& key);

/// Writes side_by_side.mp4 and the clip of each model during the comparison, and keeps two frames for the
/// report, at a quarter and three quarters of the shortest clip.
class ComparisonFilms {
 public:
  /// `labels`: replace those of the comparison; `in_row`: pictures per row of a kept frame.
  ComparisonFilms(const io::OutputFolder& output, std::vector<std::string> labels, std::size_t in_row)
      : output_(output), labels_(std::move(labels)), in_row_(in_row) {}

  /// Returns an observer that writes the frames as they arrive; refers to this object.
  pipeline::CompareObserver observer();
  /// Completes all files.
  void finish();
  std::vector<ComparedFrame> take_pictures() { return std::move(pictures_); }
  /// Returns a picture with a row for each clip: its frames at six moments, CV_8UC3.
  [[nodiscard]] cv::Mat contact_sheet() const;

 private:
  void begin(std::span<const pipeline::ObservedClip> clips);
  void write(int first, std::span<const std::vector<cv::Mat>> clips);
  void add_to_sheet(int frame, std::span<const cv::Mat> row);

  const io::OutputFolder& output_;
  std::vector<std::string> labels_;
  std::size_t in_row_;
  int shortest_ = 0;
  std::optional<SideBySide> beside_;
  std::vector<std::unique_ptr<io::VideoWriter>> writers_;  ///< by clip; null without a file
  std::vector<ComparedFrame> pictures_;
  std::vector<std::vector<cv::Mat>> sheet_;  ///< by moment and clip
  std::vector<int> sheet_frames_;            ///< by moment
};

}  // namespace emberfold::apps
