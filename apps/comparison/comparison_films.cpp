// SPDX-License-Identifier: Apache-2.0
#include "apps/comparison/comparison_films.hpp"

#include <algorithm>
#include <limits>
#include <map>

namespace emberfold::apps {

std::string drawn_clip_file(const std::string& key) {
  static const std::map<std::string, std::string> files{{"motion_model", "synthesized_motion.avi"},
                                                        {"hybrid", "synthesized_hybrid.avi"},
                                                        {"footage", "synthesized_footage.avi"},
                                                        {"linear_dynamic_texture", "synthesized_dytex.avi"},
                                                        {"star", "synthesized_star.avi"}};
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
    if (frame == shortest_ / 4 || frame == shortest_ * 3 / 4)
      pictures_.push_back({frame, compose_rows(row, labels_, in_row_)});
  }
}

void ComparisonFilms::finish() {
  beside_->finish();
  for (const auto& writer : writers_)
    if (writer) writer->finish();
}

}  // namespace emberfold::apps
