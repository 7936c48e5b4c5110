// SPDX-License-Identifier: Apache-2.0
#include "dytex/measures/flow_histograms.hpp"

#include <algorithm>
#include <cmath>

#include <opencv2/core.hpp>

#include "core/error.hpp"

namespace emberfold::dytex {

void FlowHistograms::add(const cv::Mat& flow, int stride) {
  if (flow.empty() || flow.type() != CV_32FC2)
    throw core::InputError("flow: a field of motion has two channels of 32-bit floats");
  if (stride < 1) throw core::InputError("flow: the stride is at least 1");
  const auto bin = [](double value) {
    return static_cast<Eigen::Index>(
        std::lround(kBinsPerPixel * (kMostSpeed + std::clamp<double>(value, -kMostSpeed, kMostSpeed))));
  };
  for (int y = 0; y < flow.rows; y += stride)
    for (int x = 0; x < flow.cols; x += stride) {
      const auto& v = flow.at<cv::Vec2f>(y, x);
      if (!std::isfinite(v[0]) || !std::isfinite(v[1])) continue;
      counts_[0](bin(double{v[0]})) += 1;
      counts_[1](bin(double{v[1]})) += 1;
      counts_[2](bin(double{std::hypot(v[0], v[1])})) += 1;
    }
}

Eigen::VectorXd FlowHistograms::shares(FlowPart part) const {
  const auto& counts = counts_[static_cast<std::size_t>(part)];
  const double all = counts.sum();
  return all > 0 ? (counts / all).eval() : counts;
}

double flow_distance(const FlowHistograms& a, const FlowHistograms& b, FlowPart part) {
  const auto p = a.shares(part), q = b.shares(part);
  if (p.sum() <= 0 || q.sum() <= 0) throw core::InputError("flow distance: there is no motion to compare");
  double ahead = 0, sum = 0;
  for (Eigen::Index i = 0; i < p.size(); ++i) {
    ahead += p(i) - q(i);
    sum += std::abs(ahead);
  }
  return sum / FlowHistograms::kBinsPerPixel;
}

double flow_distance(const FlowHistograms& a, const FlowHistograms& b) {
  return std::max({flow_distance(a, b, FlowPart::x), flow_distance(a, b, FlowPart::y),
                   flow_distance(a, b, FlowPart::speed)});
}

}  // namespace emberfold::dytex
