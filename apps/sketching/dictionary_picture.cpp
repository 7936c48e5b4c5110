// SPDX-License-Identifier: Apache-2.0
#include "apps/sketching/dictionary_picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "apps/pictures/draw.hpp"
#include "core/text/format_number.hpp"

namespace emberfold::apps {

namespace {

constexpr int kMargin = 16, kHead = 56, kLabel = 150, kLeastColumns = 3;
constexpr int kPatch = 96, kPlot = 140, kSmall = 28, kCaption = 20, kGap = 6, kRowGap = 22;
constexpr int kCellWidth = kPatch + kGap + kPlot, kCellHeight = kCaption + kPatch + kGap + kSmall;
constexpr double kGrey = 46, kFull = 2.8;  // grey levels per unit; the end of the plot
const cv::Scalar kFaint(222, 218, 214), kSoft(130, 122, 116);
const std::array<cv::Scalar, sketch::kMostComponents> kColours = {
    cv::Scalar(190, 110, 30), cv::Scalar(50, 80, 205), cv::Scalar(80, 150, 50), cv::Scalar(170, 70, 150)};

// Draws the shape as a grey patch with its curve upwards.
cv::Mat patch_picture(const std::vector<float>& shape, bool window, int side) {
  const int rows = window ? static_cast<int>(sketch::kWindowSide) : 1;
  cv::Mat1f values(rows, static_cast<int>(shape.size()) / rows);
  std::copy(shape.begin(), shape.end(), values.begin());
  cv::Mat1f upright, large;
  cv::flip(values, upright, 0);
  cv::resize(upright, large, {side, side}, 0, 0, window ? cv::INTER_CUBIC : cv::INTER_LINEAR);
  cv::Mat grey, picture;
  large.convertTo(grey, CV_8U, kGrey, 128);
  cv::cvtColor(grey, picture, cv::COLOR_GRAY2BGR);
  return picture;
}

void paste(cv::Mat& picture, const cv::Mat& content, cv::Point corner) {
  content.copyTo(picture(cv::Rect(corner, content.size())));
  cv::rectangle(picture, cv::Rect(corner, content.size()), kFaint);
}

// Returns the profile across the curve; of a window, its middle row.
std::vector<float> cross_section(const std::vector<float>& shape, bool window) {
  if (!window) return shape;
  const auto row = shape.begin() + (sketch::kWindowSide / 2) * sketch::kWindowSide;
  return {row, row + sketch::kWindowSide};
}

void draw_curve(cv::Mat& picture, const cv::Rect& box, const std::vector<float>& values,
                const cv::Scalar& colour, int thickness) {
  constexpr int kShift = 4;
  std::vector<cv::Point> points;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double x = box.x + 3 + double(i) / double(values.size() - 1) * (box.width - 7);
    const double v = std::clamp(static_cast<double>(values[i]) / kFull, -1.0, 1.0);
    const double y = box.y + 0.5 * box.height - v * (0.5 * box.height - 3);
    points.emplace_back(cvRound(x * (1 << kShift)), cvRound(y * (1 << kShift)));
  }
  cv::polylines(picture, points, false, colour, thickness, cv::LINE_AA, kShift);
}

std::vector<float> shift_mean(const sketch::DictionaryEntry& entry, std::size_t k, double sd) {
  std::vector<float> coefficients(entry.components.size(), 0.0F);
  coefficients[k] = static_cast<float>(sd * entry.spread[k]);
  return sketch::compose_shape(entry, coefficients);
}

void draw_entry(cv::Mat& picture, const sketch::DictionaryEntry& entry, cv::Point corner) {
  const bool window = entry.window();
  write_text(picture, core::fixed_text(100 * entry.share, 1) + " %", corner + cv::Point(0, 13), 0.46);
  write_text(picture, "leaves " + core::fixed_text(entry.residual, 2),
             corner + cv::Point(kPatch + kGap + 2, 13), 0.38, kSoft);
  const cv::Point top = corner + cv::Point(0, kCaption);
  paste(picture, patch_picture(entry.mean, window, kPatch), top);
  const cv::Rect box(top.x + kPatch + kGap, top.y, kPlot, kPatch);
  cv::rectangle(picture, box, cv::Scalar(255, 255, 255), cv::FILLED);
  cv::rectangle(picture, box, kFaint);
  const int middle_y = box.y + box.height / 2, middle_x = box.x + box.width / 2;
  cv::line(picture, {box.x + 1, middle_y}, {box.x + box.width - 2, middle_y}, kFaint);
  cv::line(picture, {middle_x, box.y + 1}, {middle_x, box.y + box.height - 2}, kFaint);
  for (std::size_t k = 0; k < entry.components.size(); ++k) {
    const cv::Scalar& colour = kColours[k];
    for (const double sd : {-2.0, 2.0})
      draw_curve(picture, box, cross_section(shift_mean(entry, k, sd), window), colour, 1);
    const cv::Point at(top.x + static_cast<int>(k) * (2 * kSmall + kGap), top.y + kPatch + kGap);
    paste(picture, patch_picture(shift_mean(entry, k, -2), window, kSmall), at);
    paste(picture, patch_picture(shift_mean(entry, k, 2), window, kSmall), at + cv::Point(kSmall, 0));
    cv::rectangle(picture, cv::Rect(at, cv::Size(2 * kSmall, kSmall)), colour);
  }
  draw_curve(picture, box, cross_section(entry.mean, window), kInk, 2);
}

// Groups the entries by degree and type.
std::vector<std::span<const sketch::DictionaryEntry>> group_entries(const sketch::Dictionary& dictionary) {
  std::vector<std::span<const sketch::DictionaryEntry>> all;
  const std::span<const sketch::DictionaryEntry> entries(dictionary.entries);
  for (std::size_t first = 0, i = 1; i <= entries.size(); ++i)
    if (i == entries.size() || entries[i].degree != entries[first].degree ||
        entries[i].type != entries[first].type) {
      all.push_back(entries.subspan(first, i - first));
      first = i;
    }
  return all;
}

std::string readable_name(std::string_view type) {
  std::string name(type);
  std::ranges::replace(name, '_', ' ');
  return name;
}

}  // namespace

cv::Mat draw_dictionary(const sketch::Dictionary& dictionary) {
  const auto rows = group_entries(dictionary);
  int columns = kLeastColumns;
  std::uint64_t seen = 0;
  for (const auto& row : rows) {
    columns = std::max(columns, static_cast<int>(row.size()));
    for (const auto& entry : row) seen += entry.seen;
  }
  const int row_height = kCellHeight + kRowGap;
  const int width = 2 * kMargin + kLabel + columns * (kCellWidth + kMargin);
  const int height = kHead + static_cast<int>(std::max<std::size_t>(rows.size(), 1)) * row_height + kMargin;
  cv::Mat picture(height, width, CV_8UC3, kPaper);
  write_text(picture,
             "dictionary: " + std::to_string(dictionary.entries.size()) + " entries, learned from " +
                 std::to_string(seen) + " patches",
             {kMargin, 24}, 0.55);
  write_text(picture,
             "%: share of its row; black: mean across the curve; colours: components, -2 SD and +2 SD",
             {kMargin, 44}, 0.42, kSoft);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const int top = kHead + static_cast<int>(r) * row_height;
    cv::line(picture, {kMargin, top}, {width - kMargin, top}, kFaint);
    std::uint64_t count = 0;
    for (const auto& entry : rows[r]) count += entry.seen;
    write_text(picture, readable_name(graph::name(rows[r].front().type)), {kMargin, top + 50}, 0.55);
    const int degree = rows[r].front().degree;
    write_text(picture, "degree " + std::to_string(degree) + (degree == 4 ? " and more" : ""),
               {kMargin, top + 72}, 0.42, kSoft);
    write_text(picture, std::to_string(count) + (count == 1 ? " patch" : " patches"), {kMargin, top + 90},
               0.42, kSoft);
    for (std::size_t i = 0; i < rows[r].size(); ++i)
      draw_entry(picture, rows[r][i],
                 {kMargin + kLabel + static_cast<int>(i) * (kCellWidth + kMargin), top + kRowGap / 2});
  }
  return picture;
}

}  // namespace emberfold::apps
