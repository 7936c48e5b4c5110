// SPDX-License-Identifier: Apache-2.0
#include "dytex/measures/psnr.hpp"

#include <algorithm>
#include <cmath>

#include <opencv2/core.hpp>

#include "core/error.hpp"
#include "dytex/measures/check_frames.hpp"

namespace emberfold::dytex {

double mean_square_error(const cv::Mat& a, const cv::Mat& b) {
  detail::check_alike(a, b, "mean square error");
  if (a.empty() || a.type() != b.type() || a.depth() != CV_32F)
    throw core::InputError("mean square error: frames must have as many channels of 32-bit floats each");
  const double distance = cv::norm(a, b, cv::NORM_L2);
  return distance * distance / static_cast<double>(a.total() * static_cast<std::size_t>(a.channels()));
}

double psnr(double mean_square_error) {
  return mean_square_error > 0 ? std::min(kMostPsnr, 10 * std::log10(255.0 * 255.0 / mean_square_error))
                               : kMostPsnr;
}

}  // namespace emberfold::dytex
