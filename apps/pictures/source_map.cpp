// SPDX-License-Identifier: Apache-2.0
#include "apps/pictures/source_map.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "apps/pictures/draw.hpp"
#include "apps/pictures/side_by_side.hpp"

namespace emberfold::apps {

namespace {

using pipeline::SourceKind;

constexpr int kMoments = 6, kMostTimes = 400;
constexpr int kTimesHeight = 300, kMapMargin = 60;
constexpr int kMapLine = 22;
constexpr double kOfMap = 0.6;  // opacity of the map over the frame
const cv::Scalar kCarried(40, 130, 255), kHiding(200, 60, 200), kTurning(255, 255, 255);

/// Returns the colour of a frame of the clip: from dark blue at its beginning to yellow at its end.
cv::Vec3b colour_of_time(double share) {
  static const cv::Mat colours = [] {
    cv::Mat1b levels(1, 256);
    std::iota(levels.begin(), levels.end(), std::uint8_t{0});
    cv::Mat map;
    cv::applyColorMap(levels, map, cv::COLORMAP_VIRIDIS);
    return map;
  }();
  return colours.at<cv::Vec3b>(0, cv::saturate_cast<std::uint8_t>(255 * share));
}

cv::Vec3b bytes(const cv::Scalar& colour) {
  return {cv::saturate_cast<std::uint8_t>(colour[0]), cv::saturate_cast<std::uint8_t>(colour[1]),
          cv::saturate_cast<std::uint8_t>(colour[2])};
}

std::string percent(double share) {
  return std::to_string(std::lround(100 * share)) + " %";
}

}  // namespace

std::string name(SourceKind kind) {
  using enum SourceKind;
  switch (kind) {
    case still:
      return "still";
    case played:
      return "played";
    case turning:
      return "turning";
    case carried:
      return "carried";
    case hiding:
      return "hiding";
  }
  return {};
}

SourceMap::SourceMap(int frames, int clip_frames)
    : frames_(frames), clip_frames_(clip_frames), step_((frames + kMostTimes - 1) / kMostTimes) {}

bool SourceMap::wants_next() const {
  return next_ % step_ == 0;
}

void SourceMap::add(const cv::Mat& frame, const pipeline::FrameSources& sources) {
  auto& shown = shown_.emplace_back(static_cast<std::size_t>(clip_frames_), 0);
  for (int y = 0; y < sources.kinds.rows; ++y)
    for (int x = 0; x < sources.kinds.cols; ++x) {
      const SourceKind kind = sources.kind(y, x);
      kinds_[static_cast<std::size_t>(kind)] += 1.0 / static_cast<double>(sources.kinds.total());
      if (kind != SourceKind::still) ++shown[static_cast<std::size_t>(sources.frames(y, x))];
    }
  const auto taken = static_cast<std::int64_t>(moments_.size());
  if (taken < kMoments && next_ >= taken * (frames_ - 1) / (kMoments - 1)) {
    cv::Mat colour = frame.clone();
    if (frame.channels() == 1) cv::cvtColor(frame, colour, cv::COLOR_GRAY2BGR);
    moments_.push_back({next_, std::move(colour), sources});
  }
  ++next_;
}

std::array<double, pipeline::kSourceKinds> SourceMap::shares() const {
  auto shares = kinds_;
  for (auto& share : shares) share /= std::max<double>(1, static_cast<double>(shown_.size()));
  return shares;
}

cv::Mat SourceMap::draw_map(const cv::Mat& frame, const pipeline::FrameSources& sources) const {
  cv::Mat3b map(sources.kinds.size());
  cv::Mat1f opacity(map.size(), static_cast<float>(kOfMap));
  for (int y = 0; y < map.rows; ++y)
    for (int x = 0; x < map.cols; ++x) {
      const double share = static_cast<double>(sources.frames(y, x)) / std::max(1, clip_frames_ - 1);
      switch (sources.kind(y, x)) {
        case SourceKind::still:
          opacity(y, x) = 0;
          break;
        case SourceKind::played:
          map(y, x) = colour_of_time(share);
          break;
        case SourceKind::turning:
          map(y, x) = (x + y) % 2 == 0 ? bytes(kTurning) : colour_of_time(share);
          break;
        case SourceKind::carried:
          map(y, x) = bytes(kCarried);
          break;
        case SourceKind::hiding:
          map(y, x) = bytes(kHiding);
          break;
      }
    }
  cv::Mat large, strength, luma;
  cv::Mat3b grey;
  cv::resize(map, large, frame.size(), 0, 0, cv::INTER_NEAREST);
  cv::resize(opacity, strength, frame.size(), 0, 0, cv::INTER_NEAREST);
  cv::cvtColor(frame, luma, cv::COLOR_BGR2GRAY);
  cv::cvtColor(luma, grey, cv::COLOR_GRAY2BGR);
  for (int y = 0; y < frame.rows; ++y)
    for (int x = 0; x < frame.cols; ++x)
      for (int c = 0; c < 3; ++c) {
        const double part = double{strength.at<float>(y, x)};
        grey(y, x)[c] =
            cv::saturate_cast<std::uint8_t>((1 - part) * grey(y, x)[c] + part * large.at<cv::Vec3b>(y, x)[c]);
      }
  return grey;
}

/// Returns the share of the moving area that each frame of the clip (upwards) fills in each new frame (to the
/// right).
cv::Mat1f SourceMap::shown_areas() const {
  const int columns = static_cast<int>(shown_.size());
  cv::Mat1f area(clip_frames_, columns, 0.F);
  for (int i = 0; i < columns; ++i) {
    const auto& shown = shown_[static_cast<std::size_t>(i)];
    const double all = std::max(1, std::accumulate(shown.begin(), shown.end(), 0));
    for (int f = 0; f < clip_frames_; ++f)
      area(clip_frames_ - 1 - f, i) = static_cast<float>(shown[static_cast<std::size_t>(f)] / all);
  }
  return area;
}

/// Draws shown_areas(), and the shares of all kinds of sources.
cv::Mat SourceMap::draw_times(int width) const {
  cv::Mat picture(kTimesHeight + 3 * kMapLine + 2 * kMapLine, width, CV_8UC3, kPaper);
  const int plot_width = width - 2 * kMapMargin;
  write_text(picture,
             "Which frame of the clip (upwards) is shown in which frame of the new one; darker: in more "
             "of what moves",
             {kMapMargin, kMapLine - 6});
  cv::Mat area = shown_areas();
  cv::Mat1f large;
  // Thin lines stay visible when many frames share a pixel.
  if (area.rows > kTimesHeight) cv::dilate(area, area, cv::Mat(area.rows / kTimesHeight + 1, 1, CV_8U, 1));
  cv::resize(area, large, {plot_width, kTimesHeight}, 0, 0, cv::INTER_NEAREST);
  for (int y = 0; y < large.rows; ++y)
    for (int x = 0; x < large.cols; ++x) {
      const double part = std::sqrt(std::clamp(double{large(y, x)}, 0.0, 1.0));
      const auto colour = colour_of_time(1 - (y + 0.5) / large.rows);
      auto& pixel = picture.at<cv::Vec3b>(y + kMapLine, x + kMapMargin);
      for (int c = 0; c < 3; ++c)
        pixel[c] = cv::saturate_cast<std::uint8_t>((1 - part) * pixel[c] + part * colour[c]);
    }
  cv::rectangle(picture, {kMapMargin - 1, kMapLine - 1, plot_width + 2, kTimesHeight + 2}, kInk);
  const int bottom = kMapLine + kTimesHeight;
  const auto number = [&](int value, cv::Point at) { write_text(picture, std::to_string(value), at); };
  number(clip_frames_ - 1, {kMapMargin - 8 - text_width(std::to_string(clip_frames_ - 1)), kMapLine + 10});
  number(0, {kMapMargin - 16, bottom});
  number(0, {kMapMargin, bottom + 16});
  const std::string last = std::to_string(frames_ - 1);
  write_text(picture, last, {kMapMargin + plot_width - text_width(last), bottom + 16});

  const auto share = shares();
  const std::array<std::pair<SourceKind, std::string>, pipeline::kSourceKinds> words = {{
      {SourceKind::still, "does not move (grey)"},
      {SourceKind::played, "played from the clip (by its time)"},
      {SourceKind::turning, "between two moments, about a jump (chequered)"},
      {SourceKind::carried, "strokes carried here (orange)"},
      {SourceKind::hiding, "strokes hidden here (purple)"},
  }};
  int x = kMapMargin, y = bottom + 2 * kMapLine;
  for (const auto& [kind, text] : words) {
    if (share[static_cast<std::size_t>(kind)] == 0) continue;
    const std::string label = percent(share[static_cast<std::size_t>(kind)]) + " " + text;
    if (x > kMapMargin && x + text_width(label) > width - kMapMargin) x = kMapMargin, y += kMapLine;
    write_text(picture, label, {x, y});
    x += text_width(label) + 28;
  }
  return picture;
}

cv::Mat SourceMap::draw() const {
  std::vector<cv::Mat> pictures;
  std::vector<std::string> labels;
  for (const bool map : {false, true})
    for (const auto& moment : moments_) {
      pictures.push_back(map ? draw_map(moment.frame, moment.sources) : moment.frame);
      labels.push_back(map ? "its sources" : "frame " + std::to_string(moment.number));
    }
  cv::Mat whole = compose_rows(pictures, labels, moments_.size());
  whole.push_back(draw_times(whole.cols));
  return whole;
}

}  // namespace emberfold::apps
