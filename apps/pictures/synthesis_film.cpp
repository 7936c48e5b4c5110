// SPDX-License-Identifier: Apache-2.0
#include "apps/pictures/synthesis_film.hpp"

#include <algorithm>
#include <cstdint>
#include <ostream>
#include <utility>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "apps/pictures/draw.hpp"
#include "apps/pictures/overlay.hpp"
#include "apps/pictures/png.hpp"
#include "core/error.hpp"
#include "core/io/files.hpp"

namespace emberfold::apps {

namespace {

constexpr int kFilmMoments = 6;
const cv::Scalar kSketchGround(34, 30, 28);

cv::Mat sketch_alone(const graph::AttributeGraph& graph, cv::Size size) {
  return draw_sketch(cv::Mat(size, CV_8UC3, kSketchGround), graph, {.shorter_side = 240, .brightness = 1});
}

}  // namespace

bool is_film_picture(const std::filesystem::path& path) {
  return path.extension() == ".png";
}

SynthesisFilm::SynthesisFilm(std::filesystem::path path, pipeline::Footage clip, const core::ClipInfo& info,
                             int frames)
    : path_(std::move(path)), clip_(std::move(clip)), info_(info), frames_(frames) {
  const cv::Size size(info.width, info.height), sketch = sketch_alone({}, size).size();
  std::vector<cv::Size> sizes;
  const auto add_panel = [&](const char* label, cv::Size panel) {
    labels_.emplace_back(label);
    sizes.push_back(panel);
  };
  if (!clip_.empty()) add_panel("the clip", size);
  add_panel("drawn sketch", sketch);
  add_panel("drawn frame", size);
  if (!is_film_picture(path_)) video_.emplace(path_, labels_, sizes, info.fps);
}

void SynthesisFilm::add(const cv::Mat& frame, const graph::AttributeGraph& graph) {
  const int moments = std::min(kFilmMoments, frames_), taken = static_cast<int>(moments_.size());
  const bool shown =
      video_ ||
      (taken < moments && next_ >= (2 * taken + 1) * static_cast<std::int64_t>(frames_) / (2 * moments));
  if (shown) {
    std::vector<cv::Mat> panels;
    if (!clip_.empty()) {
      const auto at = static_cast<std::size_t>(next_) % clip_.frames.size();
      panels.push_back(pipeline::decode({clip_.size, clip_.channels, {clip_.frames[at]}}).front());
    }
    panels.push_back(sketch_alone(graph, {info_.width, info_.height}));
    panels.push_back(frame.clone());
    if (video_)
      video_->write(panels);
    else
      moments_.push_back(std::move(panels)), numbers_.push_back(next_);
  }
  ++next_;
}

void SynthesisFilm::finish() {
  if (video_) {
    video_->finish();
    return;
  }
  const cv::Size size = sketch_alone({}, {info_.width, info_.height}).size();
  std::vector<cv::Mat> pictures;
  std::vector<std::string> labels;
  for (std::size_t row = 0; row < labels_.size(); ++row)
    for (std::size_t k = 0; k < moments_.size(); ++k) {
      cv::Mat picture = moments_[k][row];
      if (picture.channels() == 1) cv::cvtColor(picture, picture, cv::COLOR_GRAY2BGR);
      if (picture.size() != size) picture = enlarge(picture, enlargement(picture.size(), 240));
      pictures.push_back(picture);
      labels.push_back((k == 0 ? labels_[row] + ", frame " : "frame ") + std::to_string(numbers_[k]));
    }
  io::StagedFile file(path_);
  write_png(file, compose_rows(pictures, labels, moments_.size()));
}

}  // namespace emberfold::apps
