// SPDX-License-Identifier: Apache-2.0
#include "dytex/model/layers.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/error.hpp"
#include "core/text/check_range.hpp"
#include "core/text/size_text.hpp"

namespace emberfold::dytex {

namespace {

constexpr double kWhite8 = 255, kWhite16 = 65535;  // a mask's largest values
constexpr double kMostFeather = 1e4;               // px; beyond every frame's side

/// 255 inside, 0 outside.
cv::Mat inside_of(const cv::Mat& mask, const core::ClipInfo& info) {
  check_mask(mask, info);
  return mask != 0;
}

double white_of(const cv::Mat& mask) {
  if (mask.type() == CV_8UC1) return kWhite8;
  if (mask.type() == CV_16UC1) return kWhite16;
  if (mask.type() == CV_32FC1) return 1;
  throw core::InputError("mask is of OpenCV's type " + std::to_string(mask.type()) +
                         ", must have one channel of 8 or 16 bits, or floats");
}

}  // namespace

void check_mask(const cv::Mat& mask, const core::ClipInfo& info) {
  if (mask.channels() != 1)
    throw core::InputError("mask has " + std::to_string(mask.channels()) + " channels, must have 1");
  if (mask.cols != info.width || mask.rows != info.height)
    throw core::InputError("mask is " + core::size_text(mask.size()) + ", must be as the frames are, " +
                           core::size_text(info.width, info.height));
  if (cv::countNonZero(mask) == 0) throw core::InputError("mask is 0 everywhere, must hold some pixels");
}

cv::Mat layer_opacity(const cv::Mat& mask, double feather) {
  const double white = white_of(mask);
  core::check_range("feather", feather, 0, kMostFeather);
  cv::Mat opacity;
  mask.convertTo(opacity, CV_32F, 1 / white);
  if (!cv::checkRange(opacity, true, nullptr, 0, std::nextafter(1.0F, 2.0F)))
    throw core::InputError("mask has a value outside 0 to 1");
  if (feather == 0) return opacity;
  const cv::Mat inside = mask != 0;
  if (cv::countNonZero(inside) == static_cast<int>(inside.total())) return opacity;
  cv::Mat distance;  // to the nearest pixel outside, at least 1 inside
  cv::distanceTransform(inside, distance, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  for (int y = 0; y < opacity.rows; ++y) {
    auto* to = opacity.ptr<float>(y);
    const auto* from = distance.ptr<float>(y);
    for (int x = 0; x < opacity.cols; ++x) {
      const double s = std::min(double{from[x]} / (feather + 1), 1.0);
      to[x] *= static_cast<float>(s * s * (3 - 2 * s));
    }
  }
  return opacity;
}

RegionSource::RegionSource(core::FrameSource& source, const cv::Mat& mask) : source_(source) {
  outside_ = ~inside_of(mask, source.info());
  source_.rewind();
  first_ = source_.next();
  source_.rewind();
}

cv::Mat RegionSource::next() {
  cv::Mat frame = source_.next();
  if (!frame.empty()) first_.copyTo(frame, outside_);
  return frame;
}

void confine(LinearDynamicTexture& texture, const cv::Mat& mask) {
  const cv::Mat inside = inside_of(mask, texture.info);
  const Eigen::Index channels = texture.info.channels;
  const double share = double(cv::countNonZero(inside)) / static_cast<double>(inside.total());
  if (texture.noise.size() == 0)
    texture.noise = Eigen::VectorXf::Constant(texture.pixels(), static_cast<float>(texture.r / share));
  Eigen::Index value = 0;
  for (int y = 0; y < inside.rows; ++y)
    for (int x = 0; x < inside.cols; ++x, value += channels)
      if (inside.at<std::uint8_t>(y, x) == 0) {
        texture.C.middleRows(value, channels).setZero();
        texture.noise.segment(value, channels).setZero();
      }
}

cv::Mat moving_region(const LinearDynamicTexture& texture) {
  const Eigen::Index channels = texture.info.channels;
  cv::Mat region = cv::Mat::zeros(texture.info.height, texture.info.width, CV_8U);
  for (Eigen::Index k = 0; k < texture.components(); ++k)
    for (Eigen::Index i = 0; i < texture.pixels(); ++i)
      if (texture.C(i, k) != 0) region.data[i / channels] = 255;
  return region;
}

void put_layer(cv::Mat& frame, const cv::Mat& layer, const cv::Mat& opacity) {
  if (frame.depth() != CV_8U || frame.type() != layer.type() || frame.size() != layer.size())
    throw core::InputError("layer is " + core::size_text(layer.size()) + " of OpenCV's type " +
                           std::to_string(layer.type()) + ", the frame " + core::size_text(frame.size()) +
                           " of type " + std::to_string(frame.type()) +
                           "; both must have 8 bits and be alike");
  if (opacity.type() != CV_32FC1 || opacity.size() != frame.size())
    throw core::InputError("opacity is " + core::size_text(opacity.size()) + " of OpenCV's type " +
                           std::to_string(opacity.type()) + ", must be " + core::size_text(frame.size()) +
                           " of type " + std::to_string(CV_32FC1));
  const int channels = frame.channels();
  for (int y = 0; y < frame.rows; ++y) {
    auto* to = frame.ptr<std::uint8_t>(y);
    const auto* from = layer.ptr<std::uint8_t>(y);
    const auto* share = opacity.ptr<float>(y);
    for (int x = 0; x < frame.cols; ++x)
      for (int c = 0; c < channels; ++c, ++to, ++from)
        *to = cv::saturate_cast<std::uint8_t>(static_cast<float>(*to) +
                                              share[x] * static_cast<float>(*from - *to));
  }
}

}  // namespace emberfold::dytex
