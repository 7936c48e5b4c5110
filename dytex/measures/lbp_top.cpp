// SPDX-License-Identifier: Apache-2.0
#include "dytex/measures/lbp_top.hpp"

#include <cstdint>
#include <utility>

#include <opencv2/core.hpp>

#include "core/error.hpp"

namespace emberfold::dytex {

void BinaryPatterns::add(const cv::Mat& luma) {
  if (luma.empty() || luma.type() != CV_32FC1)
    throw core::InputError("binary patterns: a frame must be luma, one channel of 32-bit floats");
  if (!frames_[2].empty() && luma.size() != frames_[2].size())
    throw core::InputError("binary patterns: a frame is of another size than those before it");
  frames_[0] = std::move(frames_[1]);
  frames_[1] = std::move(frames_[2]);
  frames_[2] = cv::Mat();
  luma.convertTo(frames_[2], CV_8U);
  if (frames_[0].empty()) return;

  std::array<std::array<std::uint32_t, 256>, 3> seen{};
  const auto& [before, here, after] = frames_;
  for (int y = 1; y + 1 < here.rows; ++y) {
    const auto *above = here.ptr<std::uint8_t>(y - 1), *row = here.ptr<std::uint8_t>(y),
               *below = here.ptr<std::uint8_t>(y + 1);
    const auto *past = before.ptr<std::uint8_t>(y), *next = after.ptr<std::uint8_t>(y);
    const auto *past_above = before.ptr<std::uint8_t>(y - 1), *next_above = after.ptr<std::uint8_t>(y - 1),
               *past_below = before.ptr<std::uint8_t>(y + 1), *next_below = after.ptr<std::uint8_t>(y + 1);
    for (int x = 1; x + 1 < here.cols; ++x) {
      const auto level = row[x];
      const auto code = [level](auto... neighbours) {
        unsigned pattern = 0, bit = 0;
        ((pattern |= static_cast<unsigned>(neighbours >= level) << bit++), ...);
        return pattern;
      };
      ++seen[0][code(above[x - 1], above[x], above[x + 1], row[x + 1], below[x + 1], below[x], below[x - 1],
                     row[x - 1])];
      ++seen[1][code(past[x - 1], past[x], past[x + 1], row[x + 1], next[x + 1], next[x], next[x - 1],
                     row[x - 1])];
      ++seen[2][code(past_above[x], past[x], past_below[x], below[x], next_below[x], next[x], next_above[x],
                     above[x])];
    }
  }
  for (std::size_t plane = 0; plane < 3; ++plane)
    for (Eigen::Index i = 0; i < 256; ++i) counts_[plane](i) += seen[plane][static_cast<std::size_t>(i)];
}

Eigen::VectorXd BinaryPatterns::shares(Plane plane) const {
  const auto& counts = counts_[static_cast<std::size_t>(plane)];
  const double all = counts.sum();
  return all > 0 ? (counts / all).eval() : counts;
}

double chi_square_distance(const Eigen::Ref<const Eigen::VectorXd>& p,
                           const Eigen::Ref<const Eigen::VectorXd>& q) {
  if (p.size() != q.size())
    throw core::InputError("chi-square distance: the histograms are of different sizes");
  double sum = 0;
  for (Eigen::Index i = 0; i < p.size(); ++i) {
    if (!(p(i) >= 0) || !(q(i) >= 0))
      throw core::InputError("chi-square distance: a histogram has a value that is negative or no number");
    if (p(i) + q(i) > 0) sum += (p(i) - q(i)) * (p(i) - q(i)) / (p(i) + q(i));
  }
  return sum / 2;
}

double chi_square_distance(const BinaryPatterns& a, const BinaryPatterns& b) {
  double sum = 0;
  for (const auto plane : {Plane::xy, Plane::xt, Plane::yt})
    sum += chi_square_distance(a.shares(plane), b.shares(plane));
  return sum / 3;
}

}  // namespace emberfold::dytex
