// SPDX-License-Identifier: Apache-2.0
#include "apps/pictures/heat_matrix.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iomanip>
#include <limits>
#include <sstream>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "apps/pictures/draw.hpp"

namespace emberfold::apps {

namespace {

constexpr int kMargin = 16, kHead = 40, kLongestName = 24;
const cv::Scalar kGrid(215, 212, 208);

// Replaces characters that the font, which has ASCII only, lacks.
std::string ascii_text(const std::string& name) {
  std::string text;
  for (const char c : name)
    if ((static_cast<unsigned char>(c) & 0xc0) != 0x80) text += c >= ' ' && c <= '~' ? c : '?';
  return text.size() > kLongestName ? text.substr(0, kLongestName - 2) + ".." : text;
}

// Returns the colour of a share 0…1, from paper over green to deep blue; lightness decreases monotonically.
cv::Vec3b cell_colour(double share) {
  static const std::array<cv::Vec3d, 5> kStops = {cv::Vec3d(246, 249, 247), cv::Vec3d(196, 219, 161),
                                                  cv::Vec3d(183, 168, 67), cv::Vec3d(158, 102, 34),
                                                  cv::Vec3d(84, 29, 12)};
  const double at = std::clamp(share, 0.0, 1.0) * (kStops.size() - 1);
  const auto below = std::min(static_cast<std::size_t>(at), kStops.size() - 2);
  return kStops[below] + (kStops[below + 1] - kStops[below]) * (at - static_cast<double>(below));
}

// Writes the number with the digits that fit; empty where none fit.
std::string cell_text(double value, bool whole, int room) {
  for (int shorter = 0; shorter < 3; ++shorter) {
    std::ostringstream text;
    if (shorter > 0)
      text << std::scientific << std::setprecision(2 - shorter);
    else if (whole || std::abs(value) >= 1000)
      text << std::fixed << std::setprecision(0);
    else
      text << std::setprecision(3);
    text << value;
    if (text_width(text.str(), 0.38) + 4 <= room) return text.str();
  }
  return {};
}

struct Colours {
  double low = 0, high = 1;
  bool log = false;

  explicit Colours(const HeatMatrix& matrix) : log(matrix.log_colours) {
    double least = std::numeric_limits<double>::infinity(), most = 0;
    for (auto v = matrix.values.begin<double>(); v != matrix.values.end<double>(); ++v)
      if (std::isfinite(*v) && *v > 0) least = std::min(least, *v), most = std::max(most, *v);
    if (most <= 0) return;
    low = log ? std::log(least) - 0.25 * std::log(most / least) - 0.1 : 0;
    high = log ? std::log(most) : most;
  }
  [[nodiscard]] double share(double value) const {
    if (!(value > 0)) return 0;
    return ((log ? std::log(value) : value) - low) / (high - low);
  }
};

void draw_cell(cv::Mat& picture, const cv::Rect& box, double value, const Colours& colours, bool whole) {
  if (!std::isfinite(value)) {
    cv::line(picture, box.tl(), box.br(), kGrid, 1, cv::LINE_AA);
    return;
  }
  const double share = colours.share(value);
  const cv::Vec3b fill = cell_colour(share);
  cv::rectangle(picture, box, cv::Scalar(fill), cv::FILLED);
  if (box.height < 16) return;
  const std::string text = cell_text(value, whole, box.width);
  const int width = text_width(text, 0.38);
  write_text(picture, text, {box.x + (box.width - width) / 2, box.y + box.height / 2 + 4}, 0.38,
             share > 0.5 ? kPaper : kInk);
}

}  // namespace

cv::Mat draw_heat_matrix(const HeatMatrix& matrix) {
  const int count = std::max(1, matrix.values.rows);
  const int cell = std::clamp(matrix.widest / count, 4, 56);
  const bool named = cell >= 12;
  std::vector<std::string> names;
  int longest = 0;
  for (const auto& name : matrix.names) {
    names.push_back(ascii_text(name));
    longest = std::max(longest, text_width(names.back(), 0.4));
  }
  const int label = named ? longest + 12 : 0, side = cell * count;
  const int width = std::max(2 * kMargin + label + side, 2 * kMargin + text_width(matrix.title, 0.5));
  cv::Mat picture(kHead + label + side + kMargin, width, CV_8UC3, kPaper);
  write_text(picture, matrix.title, {kMargin, 26}, 0.5);
  const cv::Point corner(kMargin + label, kHead + label);
  const Colours colours(matrix);
  for (int i = 0; i < matrix.values.rows; ++i)
    for (int j = 0; j < matrix.values.cols; ++j)
      draw_cell(picture, {corner.x + j * cell, corner.y + i * cell, cell, cell},
                matrix.values.at<double>(i, j), colours, matrix.whole);
  cv::rectangle(picture, cv::Rect(corner, cv::Size(side, side)), kGrid);
  if (!named) return picture;
  for (int i = 0; i < std::min(count, static_cast<int>(names.size())); ++i) {
    const std::string& name = names[static_cast<std::size_t>(i)];
    const int middle = i * cell + cell / 2;
    write_text(picture, name, {corner.x - 8 - text_width(name, 0.4), corner.y + middle + 4}, 0.4);
    cv::Mat flat(16, std::max(1, text_width(name, 0.4) + 2), CV_8UC3, kPaper), upright;
    write_text(flat, name, {0, 12}, 0.4);
    cv::rotate(flat, upright, cv::ROTATE_90_COUNTERCLOCKWISE);
    const cv::Rect there(corner.x + middle - 8, corner.y - 6 - upright.rows, 16, upright.rows);
    const cv::Rect inside = there & cv::Rect({0, 0}, picture.size());
    upright(cv::Rect(inside.tl() - there.tl(), inside.size())).copyTo(picture(inside));
  }
  return picture;
}

}  // namespace emberfold::apps
