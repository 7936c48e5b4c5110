// SPDX-License-Identifier: Apache-2.0
#include "apps/comparison/comparison_films.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include <opencv2/imgproc.hpp>

namespace emberfold::apps {

namespace {

constexpr int kMoments = 6;        // of the contact sheet, for each clip
constexpr int kSheetHeight = 240;  // px of its pictures

}  // namespace

std::string drawn_clip_file(const std::string& key) {
  static const std::map<std::string, std::string> files{
      {"motion_model", "synthesized_motion.avi"}, {"footage", "synthesized_footage.avi"},
      {"strokes", "synthesized_strokes.avi"},     {"linear_dynamic_texture", "synthesized_dytex.avi"},
      {"star", "synthesized_star.avi"},           {"video_loop", "video_loop.avi"}};
  const auto found = files.find(key);
  return found == files.end() ? "" : found->second;
}

pipeline::CompareObserver ComparisonFilms::observer() {
  return {[this](std::span<const pipeline::ObservedClip> clips) { begin(clips); },
          [this](int first, std::span<const std::vector<cv::Mat>> clips) { write(first, clips); }};
}

void ComparisonFilms::begin(std::span<const pipeline::ObservedClip> clips) {
  std::vector<cv::Size> sizes;
  std::vector<std::string> labels;
  shortest_ = std::numeric_limits<int>::max();
  for (const auto& clip : clips) {
    const auto& info = clip.info;
    sizes.emplace_back(info.width, info.height);
    labels.push_back(clip.label);
    shortest_ = std::min(shortest_, clip.frames);
    const auto file = drawn_clip_file(clip.key);
    writers_.push_back(
        file.empty() ? nullptr
                     : io::create_video(output_.staged(file), sizes.back(), info.fps, info.channels == 3));
  }
  if (labels_.empty()) labels_ = labels;
  beside_.emplace(output_.staged("side_by_side.mp4"), labels_, sizes, clips.front().info.fps);
}

void ComparisonFilms::write(int first, std::span<const std::vector<cv::Mat>> clips) {
  for (std::size_t k = 0; k < clips.size(); ++k)
    if (writers_[k])
      for (const auto& frame : clips[k]) writers_[k]->write(frame);
  const auto rows = std::ranges::min(clips, {}, [](const auto& clip) { return clip.size(); }).size();
  for (std::size_t i = 0; i < rows; ++i) {
    std::vector<cv::Mat> row;
    for (const auto& clip : clips) row.push_back(clip[i]);
    beside_->write(row);
    const int frame = first + static_cast<int>(i);
    add_to_sheet(frame, row);
    if (frame == shortest_ / 4 || frame == shortest_ * 3 / 4)
      pictures_.push_back({frame, compose_rows(row, labels_, in_row_)});
  }
}

/// Keeps small pictures of all clips at the frames of the sheet.
void ComparisonFilms::add_to_sheet(int frame, std::span<const cv::Mat> row) {
  const int moments = std::min(kMoments, shortest_), next = static_cast<int>(sheet_.size());
  if (next == moments || frame < (2 * next + 1) * shortest_ / (2 * moments)) return;
  auto& pictures = sheet_.emplace_back();
  for (const auto& picture : row) {
    cv::Mat small;
    const double factor = double(kSheetHeight) / picture.rows;
    cv::resize(picture, small,
               {std::max(1, static_cast<int>(std::lround(picture.cols * factor))), kSheetHeight}, 0, 0,
               factor < 1 ? cv::INTER_AREA : cv::INTER_CUBIC);
    pictures.push_back(small);
  }
  sheet_frames_.push_back(frame);
}

cv::Mat ComparisonFilms::contact_sheet() const {
  std::vector<cv::Mat> pictures;
  std::vector<std::string> labels;
  for (std::size_t clip = 0; clip < labels_.size(); ++clip)
    for (std::size_t moment = 0; moment < sheet_.size(); ++moment) {
      pictures.push_back(sheet_[moment][clip]);
      labels.push_back(moment == 0 ? labels_[clip] : "frame " + std::to_string(sheet_frames_[moment]));
    }
  return pictures.empty() ? cv::Mat() : compose_rows(pictures, labels, sheet_.size());
}

void ComparisonFilms::finish() {
  beside_->finish();
  for (const auto& writer : writers_)
    if (writer) writer->finish();
}

}  // namespace emberfold::apps
