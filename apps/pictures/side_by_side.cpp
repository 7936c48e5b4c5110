// SPDX-License-Identifier: Apache-2.0
#include "apps/pictures/side_by_side.hpp"

#include <algorithm>
#include <cmath>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "apps/pictures/draw.hpp"

namespace emberfold::apps {

namespace {

constexpr int kLabel = 28, kGap = 6, kLeastHeight = 240, kMostWidth = 3840, kCodecWidth = 16384;

int panel_height(std::span<const cv::Size> sizes) {
  int tallest = 1;
  double shape = 0;  // of the row, width over height
  for (const auto& size : sizes) {
    tallest = std::max(tallest, size.height);
    shape += static_cast<double>(size.width) / size.height;
  }
  const double room = kMostWidth / shape,
               hard = (kCodecWidth - kGap * static_cast<double>(sizes.size())) / shape;
  return static_cast<int>(
      std::max(1.0, std::min(hard, std::max<double>(kLeastHeight, std::min<double>(tallest, room)))));
}

// Truncates a label with dots to the width.
std::string fit_label(const std::string& label, int width) {
  const auto fits = [&](const std::string& text) { return text_width(text, 0.5) + 8 <= width; };
  if (fits(label)) return label;
  for (std::size_t length = label.size(); length-- > 1;)
    if (fits(label.substr(0, length) + "...")) return label.substr(0, length) + "...";
  return {};
}

}  // namespace

PanelRow::PanelRow(std::span<const cv::Size> sizes) {
  const int height = panel_height(sizes);
  int width = -kGap;
  for (const auto& size : sizes) {
    const double scaled = static_cast<double>(size.width) * height / size.height;
    panels_.emplace_back(std::max(1, static_cast<int>(std::round(scaled))), height);
    width += panels_.back().width + kGap;
  }
  size_ = {width, height + kLabel};
}

cv::Rect PanelRow::place(std::size_t index) const {
  int left = 0;
  for (std::size_t i = 0; i < index; ++i) left += panels_[i].width + kGap;
  return {{left, kLabel}, panels_[index]};
}

cv::Mat PanelRow::compose(std::span<const cv::Mat> pictures, std::span<const std::string> labels) const {
  cv::Mat whole(size_, CV_8UC3, kPaper);
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const cv::Rect panel = place(i);
    write_text(whole, fit_label(labels[i], panel.width), {panel.x + 4, kLabel - 9}, 0.5);
    cv::Mat colour = pictures[i], scaled;
    if (colour.channels() == 1) cv::cvtColor(pictures[i], colour, cv::COLOR_GRAY2BGR);
    const bool shrinks = panel.height < colour.rows;
    cv::resize(colour, scaled, panel.size(), 0, 0, shrinks ? cv::INTER_AREA : cv::INTER_CUBIC);
    scaled.copyTo(whole(panel));
  }
  return whole;
}

cv::Mat compose_rows(std::span<const cv::Mat> pictures, std::span<const std::string> labels,
                     std::size_t most) {
  const std::size_t rows = (pictures.size() + most - 1) / most, in_row = (pictures.size() + rows - 1) / rows;
  const std::vector<cv::Size> sizes(in_row, pictures.front().size());
  const PanelRow panels(sizes);
  cv::Mat whole;
  for (std::size_t first = 0; first < pictures.size(); first += in_row) {
    const auto count = std::min(in_row, pictures.size() - first);
    whole.push_back(panels.compose(pictures.subspan(first, count), labels.subspan(first, count)));
  }
  return whole;
}

SideBySide::SideBySide(const std::filesystem::path& path, std::vector<std::string> labels,
                       std::span<const cv::Size> sizes, double fps)
    : row_(sizes), labels_(std::move(labels)), writer_(io::create_video(path, row_.size(), fps, true)) {}

}  // namespace emberfold::apps
