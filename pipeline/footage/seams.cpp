// SPDX-License-Identifier: Apache-2.0
#include "pipeline/footage/seams.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/math/robust.hpp"
#include "core/math/smooth_step.hpp"

namespace emberfold::pipeline {

namespace {

constexpr double kSlack = 0.14;      // share of what moves by which a seam may leave its place
constexpr double kSmoothSeam = 1.5;  // cells: SD of the smoothing of a seam, which follows whole cells
constexpr float kStay = 0.5F;        // cost of a pixel that changes sides, relative to one under the seam
constexpr double kShortWay = 0.02;   // share of the mean difference: cost of path length where all is alike
constexpr int kPairs = 64;           // pairs of frames that measure the usual visibility of seams
constexpr double kFeather = 0.03;    // share of the longer side: width over which plays are blended
constexpr int kCells = 80;           // on the longer side

cv::Size seam_cells(cv::Size frame) {
  const double cell = std::max(1.0, double(std::max(frame.width, frame.height)) / kCells);
  return {std::max(1, static_cast<int>(std::lround(frame.width / cell))),
          std::max(1, static_cast<int>(std::lround(frame.height / cell)))};
}

cv::Mat turn_over(const cv::Mat& picture, bool turned) {
  return turned ? cv::Mat(picture.t()) : picture;
}

}  // namespace

Seams::Seams(const std::vector<cv::Mat>& footage, const cv::Mat1b& moves, int plays)
    : turned_(footage.front().rows > footage.front().cols) {
  const cv::Size size = footage.front().size();
  const cv::Size cells = seam_cells(size);
  cell_ = double(std::max(size.width, size.height)) / std::max(cells.width, cells.height);
  for (const auto& frame : footage) {
    cv::Mat small, levels;
    cv::resize(frame, small, cells, 0, 0, cv::INTER_AREA);
    small.convertTo(levels, CV_32F);
    pictures_.push_back(turn_over(levels, turned_));
  }
  cv::Mat share, columns;
  cv::resize(moves, share, cells, 0, 0, cv::INTER_AREA);
  cv::reduce(turn_over(share, turned_), columns, 0, cv::REDUCE_SUM, CV_64F);
  std::vector<double> below(columns.begin<double>(), columns.end<double>());
  for (std::size_t i = 1; i < below.size(); ++i) below[i] += below[i - 1];
  const auto cell_of = [&](double part) {
    const auto at = std::ranges::lower_bound(below, part * below.back());
    return std::min(static_cast<int>(at - below.begin()), static_cast<int>(below.size()) - 1);
  };
  for (int i = 1; i < plays; ++i)
    bands_.push_back({cell_of(double(i) / plays - kSlack), cell_of(double(i) / plays + kSlack)});
  if (bands_.empty()) return;
  std::vector<double> sums;
  const auto frames = static_cast<int>(pictures_.size());
  for (int i = 0; i < kPairs; ++i)
    sums.push_back(visibility(0, i * frames / kPairs, (i * frames / kPairs + frames / 2) % frames));
  usual_ = std::max(1e-6, core::median(sums));
}

cv::Mat1f Seams::difference(int frame, int other) const {
  cv::Mat apart;
  cv::absdiff(pictures_[static_cast<std::size_t>(frame)], pictures_[static_cast<std::size_t>(other)], apart);
  if (apart.channels() == 3) cv::transform(apart, apart, cv::Matx13f(1, 1, 1) / 3.F);
  return apart;
}

double Seams::visibility(int seam, int frame, int other) const {
  return find_line(difference(frame, other), bands_[static_cast<std::size_t>(seam)], {}).sum / usual_;
}

/// Finds the path from row to row, at most one cell aside per step, with the least sum of differences under
/// it and cost of leaving its former place.
Seams::Line Seams::find_line(const cv::Mat1f& apart, const Band& band, const std::vector<float>& before) {
  const int width = band.last - band.first + 1, rows = apart.rows;
  cv::Mat1f least(rows, width);
  cv::Mat1i from(rows, width, 0);
  std::vector<float> passed(static_cast<std::size_t>(width) + 1);
  for (int y = 0; y < rows; ++y) {
    const float* const row = apart[y] + band.first;
    for (std::size_t i = 0; i + 1 < passed.size(); ++i) passed[i + 1] = passed[i] + row[i];
    const float was = before.empty() ? 0
                                     : passed[static_cast<std::size_t>(before[static_cast<std::size_t>(y)]) -
                                              static_cast<std::size_t>(band.first)];
    for (int i = 0; i < width; ++i) {
      least(y, i) = row[i];
      if (!before.empty()) least(y, i) += kStay * std::abs(passed[static_cast<std::size_t>(i)] - was);
      if (y == 0) continue;
      int best = i;
      for (const int j : {i - 1, i + 1})
        if (j >= 0 && j < width && least(y - 1, j) < least(y - 1, best)) best = j;
      least(y, i) += least(y - 1, best);
      from(y, i) = best;
    }
  }
  Line line{std::vector<float>(static_cast<std::size_t>(rows))};
  const cv::Mat1f last = least.row(rows - 1);
  int at = static_cast<int>(std::ranges::min_element(last) - last.begin());
  line.sum = double{last(0, at)};
  for (int y = rows - 1; y >= 0; --y) {
    line.cells[static_cast<std::size_t>(y)] = static_cast<float>(band.first + at);
    at = from(y, at);
  }
  return line;
}

SeamLines Seams::next(const std::vector<std::vector<int>>& shown, const SeamLines& before) const {
  SeamLines lines;
  for (std::size_t s = 0; s < bands_.size(); ++s) {
    cv::Mat1f apart(pictures_.front().size(), 0.F);
    for (const auto& plays : shown) apart += difference(plays[s], plays[s + 1]);
    apart += kShortWay * cv::mean(apart)[0];
    lines.push_back(find_line(apart, bands_[s], before.empty() ? std::vector<float>{} : before[s]).cells);
  }
  return lines;
}

cv::Mat1b Seams::plays_by_cell(const SeamLines& lines) const {
  cv::Mat1b plays(pictures_.front().size(), std::uint8_t{0});
  for (std::size_t s = 0; s < lines.size(); ++s)
    for (int y = 0; y < plays.rows; ++y)
      for (int x = 0; x < plays.cols; ++x)
        if (static_cast<float>(x) > lines[s][static_cast<std::size_t>(y)])
          plays(y, x) = static_cast<std::uint8_t>(s + 1);
  return turn_over(plays, turned_);
}

cv::Mat Seams::join(const std::vector<cv::Mat>& frames, const SeamLines& lines) const {
  cv::Mat out = frames.front().clone();
  const int channels = out.channels();
  const double feather = std::max(2.0, kFeather * std::max(out.cols, out.rows));
  for (std::size_t s = 0; s < lines.size(); ++s) {
    std::vector<float> line;
    cv::GaussianBlur(cv::Mat(lines[s], false).reshape(1, 1), line, {}, kSmoothSeam);
    const auto place = [&](int along) {
      const double at = std::clamp((along + 0.5) / cell_ - 0.5, 0.0, double(line.size() - 1));
      const auto i = std::min(static_cast<std::size_t>(at), line.size() - 1);
      const double part = at - static_cast<double>(i);
      return ((1 - part) * double{line[i]} + part * double{line[std::min(i + 1, line.size() - 1)]} + 0.5) *
             cell_;
    };
    std::vector<double> places;  // px
    for (int i = 0; i < (turned_ ? out.cols : out.rows); ++i) places.push_back(place(i));
    const auto& other = frames[s + 1];
    for (int y = 0; y < out.rows; ++y)
      for (int x = 0; x < out.cols; ++x) {
        const double distance =
            (turned_ ? y - places[static_cast<std::size_t>(x)] : x - places[static_cast<std::size_t>(y)]) +
            0.5;
        const double w = core::smooth_step(distance / feather + 0.5);
        if (w <= 0) continue;
        for (int c = 0; c < channels; ++c) {
          auto& level = out.ptr<std::uint8_t>(y)[x * channels + c];
          level = cv::saturate_cast<std::uint8_t>((1 - w) * level +
                                                  w * other.ptr<std::uint8_t>(y)[x * channels + c]);
        }
      }
  }
  return out;
}

}  // namespace emberfold::pipeline
