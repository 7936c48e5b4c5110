// SPDX-License-Identifier: Apache-2.0
#include "apps/pictures/rate_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "core/text/format_number.hpp"

namespace emberfold::apps {

namespace {

constexpr int kShorterSide = 480, kBorder = 10, kLine = 26, kFixedPoint = 4;
constexpr double kDot = 4, kLeastRatio = 1.5;

void draw_dot(cv::Mat& picture, cv::Point2d at) {
  const auto to_fixed_point = [](double v) { return static_cast<int>(std::lround(v * (1 << kFixedPoint))); };
  const cv::Point centre(to_fixed_point(at.x), to_fixed_point(at.y));
  cv::circle(picture, centre, to_fixed_point(kDot), {24, 20, 20}, cv::FILLED, cv::LINE_AA, kFixedPoint);
  cv::circle(picture, centre, to_fixed_point(kDot - 1), {255, 255, 255}, cv::FILLED, cv::LINE_AA,
             kFixedPoint);
}

// Returns the opacity of the colour for a share.
double opacity(double share) {
  return 0.85 * std::pow(std::min(std::abs(share), 1.0), 0.7);
}

/// The range of the colour scale.
struct Scale {
  bool relative = false;
  double top = 0;
  /// Maps a value to 0…1, a ratio to −1…1.
  [[nodiscard]] double share(double value) const {
    if (!relative) return top > 0 ? value / top : 0;
    return std::clamp(std::log(std::max(value, 1e-9)) / std::log(top), -1.0, 1.0);
  }
  /// Returns the value at a place 0…1 of the scale.
  [[nodiscard]] double value(double place) const {
    return relative ? std::pow(top, 2 * place - 1) : top * place;
  }
};

Scale scale_of(const RateMap& what) {
  Scale scale{what.relative, what.relative ? kLeastRatio : 0};
  for (const double v : what.map->values) {
    scale.top = std::max(scale.top, v);
    if (what.relative && v > 0) scale.top = std::max(scale.top, 1 / v);
  }
  return scale;
}

cv::Vec3b blend(Colour colour, double part, cv::Vec3b under) {
  const std::array<double, 3> own{double(colour.blue), double(colour.green), double(colour.red)};
  cv::Vec3b out;
  for (int c = 0; c < 3; ++c)
    out[c] =
        cv::saturate_cast<unsigned char>(part * own[static_cast<std::size_t>(c)] + (1 - part) * under[c]);
  return out;
}

// Draws the legend: unit, meaning of a dot, colour scale.
cv::Mat draw_scale(int width, const RateMap& what, const Scale& scale, std::size_t dots) {
  const std::string label =
      std::string(graph::name(what.type)) + (dots == 1 ? "" : "s") + " found: " + std::to_string(dots);
  const bool one_line = kBorder * 4 + text_width(what.unit) + text_width(label) + 20 <= width;
  const int bar_top = (one_line ? 1 : 2) * kLine + 4;
  cv::Mat picture(bar_top + 2 * kLine - 8, width, CV_8UC3, cv::Scalar(246, 248, 250));
  write_text(picture, what.unit, {kBorder, kLine / 2 + 6});
  const cv::Point place = one_line ? cv::Point(3 * kBorder + text_width(what.unit), kLine / 2 + 6)
                                   : cv::Point(kBorder, kLine + kLine / 2 + 6);
  draw_dot(picture, {place.x + 4.0, place.y - 4.0});
  write_text(picture, label, {place.x + 14, place.y});
  const int left = kBorder + 4, right = std::min(width - kBorder - 24, left + 420);
  const cv::Vec3b ground(60, 56, 54);
  for (int x = left; x < right; ++x) {
    const double share =
        scale.share(scale.value(static_cast<double>(x - left) / std::max(1, right - left - 1)));
    const cv::Scalar colour = blend(rate_colour(share), opacity(share), ground);
    cv::line(picture, {x, bar_top}, {x, bar_top + 11}, colour);
  }
  for (int k = 0; k <= 4; ++k) {
    const int x = left + (right - left - 1) * k / 4;
    const std::string number = core::significant_text(what.factor * scale.value(k / 4.0), 3);
    cv::line(picture, {x, bar_top + 12}, {x, bar_top + 16}, cv::Scalar(140, 132, 126));
    write_text(picture, number,
               {std::clamp(x - text_width(number) / 2, 2, width - text_width(number) - 2), bar_top + 30});
  }
  return picture;
}

}  // namespace

RateMap birth_map(const mcmc::MotionModel& model) {
  return {&model.rates.birth, 1e4, false, "births per frame and 100x100 px", graph::EventType::birth};
}

RateMap death_map(const mcmc::MotionModel& model) {
  return {&model.rates.death, 1, true, "deaths, times what is usual for a stroke's size",
          graph::EventType::death};
}

Colour rate_colour(double share) {
  using Stops = std::array<std::array<double, 3>, 3>;
  static constexpr Stops kWarm{{{150, 40, 20}, {235, 110, 30}, {255, 235, 140}}},
      kCold{{{20, 60, 150}, {40, 140, 225}, {190, 245, 255}}};
  const Stops& stops = share < 0 ? kCold : kWarm;
  const double at = std::min(std::abs(share), 1.0) * 2;
  const std::size_t k = at < 1 ? 0 : 1;
  const auto channel = [&](std::size_t c) {
    return static_cast<unsigned char>(
        std::lround(stops[k][c] + (at - static_cast<double>(k)) * (stops[k + 1][c] - stops[k][c])));
  };
  return {channel(0), channel(1), channel(2)};
}

cv::Mat1f smooth_map(const mcmc::CellMap& map, cv::Size frame, double scale) {
  const cv::Size size(cvRound(frame.width * scale), cvRound(frame.height * scale));
  if (map.values.empty()) return cv::Mat1f(size, 0.0F);
  cv::Mat1f grid(map.rows, map.columns), field;
  std::ranges::transform(map.values, grid.begin(), [](double v) { return static_cast<float>(v); });
  // a picture's pixel to the cells: the edges of frame, picture and first cell coincide
  const double step = 1 / (scale * map.cell), shift = 0.5 * step - 0.5;
  const cv::Matx23d to_cells(step, 0, shift, 0, step, shift);
  cv::warpAffine(grid, field, to_cells, size, cv::INTER_CUBIC | cv::WARP_INVERSE_MAP, cv::BORDER_REPLICATE);
  double low = 0, high = 0;
  cv::minMaxLoc(grid, &low, &high);
  cv::max(field, low, field);
  cv::min(field, high, field);
  return field;
}

cv::Mat draw_rate_map(const cv::Mat& under, const RateMap& what, std::span<const graph::Event> events) {
  const Placement place{enlargement(under.size(), kShorterSide), {}};
  cv::Mat grey, picture;
  cv::cvtColor(enlarge(under, place.scale), grey, cv::COLOR_BGR2GRAY);
  grey.convertTo(grey, -1, 0.55, 16);
  cv::cvtColor(grey, picture, cv::COLOR_GRAY2BGR);
  const Scale scale = scale_of(what);
  cv::Mat1f field = smooth_map(*what.map, under.size(), place.scale);
  cv::copyMakeBorder(field, field, 0, std::max(0, picture.rows - field.rows), 0,
                     std::max(0, picture.cols - field.cols), cv::BORDER_REPLICATE);
  for (int y = 0; y < picture.rows; ++y)
    for (int x = 0; x < picture.cols; ++x) {
      const double share = scale.share(double{field(y, x)});
      auto& pixel = picture.at<cv::Vec3b>(y, x);
      pixel = blend(rate_colour(share), opacity(share), pixel);
    }
  std::size_t dots = 0;
  for (const auto& event : events) {
    if (event.type != what.type || event.probability < 0.5) continue;
    draw_dot(picture, place(event.position));
    ++dots;
  }
  cv::Mat whole;
  cv::vconcat(picture, draw_scale(picture.cols, what, scale, dots), whole);
  return whole;
}

}  // namespace emberfold::apps
