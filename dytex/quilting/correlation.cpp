// SPDX-License-Identifier: Apache-2.0
#include "dytex/quilting/correlation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/math/simd_clones.hpp"
#include "core/parallel.hpp"

namespace emberfold::dytex::detail {

namespace {

// Relative forward error of three transforms of up to 2^28 values: 3 · 28 · 4 units of 2^-24.
constexpr double kTransformError = 2e-5;
constexpr double kSumError = 2e-7;  // relative, of the sums of squares in 32 bits

// acc += a · conj(b) for n complex numbers in two halves each.
EMBERFOLD_SIMD_CLONES
void add_products(const float* a, const float* b, float* acc, std::size_t n) {
  const float *a_im = a + n, *b_im = b + n;
  float* acc_im = acc + n;
  for (std::size_t i = 0; i < n; ++i) {
    acc[i] += a[i] * b[i] + a_im[i] * b_im[i];
    acc_im[i] += a_im[i] * b[i] - a[i] * b_im[i];
  }
}

// acc += a · conj(b) for a column as cv::dft packs it: the real first number, pairs, the real last one.
void add_packed_products(const float* a, const float* b, float* acc, std::size_t n) {
  acc[0] += a[0] * b[0];
  acc[n - 1] += a[n - 1] * b[n - 1];
  for (std::size_t i = 1; i + 1 < n - 1; i += 2) {
    acc[i] += a[i] * b[i] + a[i + 1] * b[i + 1];
    acc[i + 1] += a[i + 1] * b[i] - a[i] * b[i + 1];
  }
}

int tiles_along(int places, int step) {
  return (places + step - 1) / step;
}

double norm_of(const std::vector<cv::Mat>& planes, const cv::Rect& box) {
  double sum = 0;
  for (const cv::Mat& plane : planes) sum += cv::norm(plane(box), cv::NORM_L2SQR);
  return std::sqrt(sum);
}

}  // namespace

void Correlator::choose_tile(cv::Size most) {
  constexpr std::array kSides{16,  32,  64,   128,  192,  256,  320,  384,  512,
                              640, 768, 1024, 1536, 2048, 4096, 8192, 16384};
  double least = std::numeric_limits<double>::max();
  for (const int width : kSides)
    for (const int height : kSides) {
      if (width < most.width || height < most.height) continue;
      const double values = static_cast<double>(width) * height, transform = values * std::log2(values);
      const double tiles =
          static_cast<double>(tiles_along(size_.width - most.width + 1, width - most.width + 1)) *
          tiles_along(size_.height - most.height + 1, height - most.height + 1);
      // In units of one step of a transform of one value; a product costs about as much as three of them.
      const auto planes = static_cast<double>(planes_);
      const double cost = planes * transform + tiles * (transform + 3 * planes * values);
      if (cost >= least) continue;
      least = cost;
      tile_ = {width, height};
    }
}

Correlator::Correlator(const std::vector<cv::Mat>& planes, cv::Size least, cv::Size most)
    : planes_(planes.size()), size_(planes.front().size()) {
  choose_tile(most);
  step_ = {tile_.width - most.width + 1, tile_.height - most.height + 1};
  for (int y = 0; y + least.height <= size_.height; y += step_.height)
    for (int x = 0; x + least.width <= size_.width; x += step_.width) tiles_.push_back({{x, y}, {}, {}});
  const cv::Rect whole({}, size_);
  std::vector<double> norms(tiles_.size());
  core::parallel_for(tiles_.size(), {}, [&](std::size_t i) {
    Tile& tile = tiles_[i];
    const cv::Rect box = cv::Rect(tile.origin, tile_) & whole;
    for (std::size_t p = 0; p < planes_; ++p) {
      cv::Mat values = cv::Mat::zeros(tile_, CV_32F);
      planes[p](box).copyTo(values(cv::Rect({}, box.size())));
      cv::dft(values, values, 0, box.height);
      split(values, p, tile);
    }
    norms[i] = norm_of(planes, box);
  });
  norm_ = *std::max_element(norms.begin(), norms.end());
  cv::Mat squares = cv::Mat::zeros(size_, CV_32F);
  for (const cv::Mat& plane : planes) squares += plane.mul(plane);
  cv::integral(squares, energy_, CV_64F);
}

void Correlator::split(const cv::Mat& packed, std::size_t plane, Tile& tile) const {
  const auto width = static_cast<std::size_t>(tile_.width), height = static_cast<std::size_t>(tile_.height);
  tile.rows.resize(width * height * planes_);
  tile.edges.resize(2 * height * planes_);
  float* first = tile.edges.data() + 2 * height * plane;
  for (std::size_t y = 0; y < height; ++y) {
    const auto* in = packed.ptr<float>(static_cast<int>(y));
    float* re = tile.rows.data() + (y * planes_ + plane) * width;
    float* im = re + width / 2;
    re[0] = im[0] = 0;
    for (std::size_t i = 1; i < width / 2; ++i) re[i] = in[2 * i - 1], im[i] = in[2 * i];
    first[y] = in[0];
    first[height + y] = in[width - 1];
  }
}

cv::Mat Correlator::correlate(const Tile& tile, const Tile& query) const {
  const auto width = static_cast<std::size_t>(tile_.width), height = static_cast<std::size_t>(tile_.height);
  cv::Mat packed(tile_, CV_32F);
  std::vector<float> sum(width), edges(2 * height);
  for (std::size_t p = 0; p < planes_; ++p)
    for (std::size_t side = 0; side < 2; ++side) {
      const std::size_t at = (2 * p + side) * height;
      add_packed_products(tile.edges.data() + at, query.edges.data() + at, edges.data() + side * height,
                          height);
    }
  for (std::size_t y = 0; y < height; ++y) {
    std::fill(sum.begin(), sum.end(), 0.0F);
    for (std::size_t p = 0; p < planes_; ++p) {
      const std::size_t at = (y * planes_ + p) * width;
      add_products(tile.rows.data() + at, query.rows.data() + at, sum.data(), width / 2);
    }
    auto* out = packed.ptr<float>(static_cast<int>(y));
    for (std::size_t i = 1; i < width / 2; ++i) out[2 * i - 1] = sum[i], out[2 * i] = sum[width / 2 + i];
    out[0] = edges[y];
    out[width - 1] = edges[height + y];
  }
  cv::dft(packed, packed, cv::DFT_INVERSE | cv::DFT_SCALE | cv::DFT_REAL_OUTPUT);
  return packed;
}

cv::Mat Correlator::squared_differences(const std::vector<cv::Mat>& query,
                                        const std::vector<cv::Rect>& boxes) const {
  const cv::Size block = query.front().size();
  cv::Mat result = box_sums(energy_, boxes, block);
  double own = 0;
  Tile transformed;
  for (std::size_t p = 0; p < planes_; ++p) {
    own += cv::norm(query[p], cv::NORM_L2SQR);
    cv::Mat values = cv::Mat::zeros(tile_, CV_32F);
    query[p].copyTo(values(cv::Rect({}, block)));
    cv::dft(values, values, 0, block.height);
    split(values, p, transformed);
  }
  cv::Mat errors(result.size(), CV_32F);
  core::parallel_for(tiles_.size(), {}, [&](std::size_t i) {
    const Tile& tile = tiles_[i];
    const cv::Rect places = cv::Rect(tile.origin, step_) & cv::Rect({}, errors.size());
    if (places.empty()) return;
    const cv::Mat products = correlate(tile, transformed);
    for (int y = 0; y < places.height; ++y) {
      const auto* product = products.ptr<float>(y);
      const auto* energy = result.ptr<double>(places.y + y) + places.x;
      auto* error = errors.ptr<float>(places.y + y) + places.x;
      for (int x = 0; x < places.width; ++x)
        error[x] = static_cast<float>(energy[x] + own - 2.0 * static_cast<double>(product[x]));
    }
  });
  return errors;
}

double Correlator::margin(const std::vector<cv::Mat>& query) const {
  const double own = norm_of(query, cv::Rect({}, query.front().size()));
  return 2 * kTransformError * norm_ * own + kSumError * (norm_ * norm_ + own * own);
}

cv::Mat box_sums(const cv::Mat& integral, const std::vector<cv::Rect>& boxes, cv::Size block) {
  cv::Mat sums = cv::Mat::zeros(integral.rows - block.height, integral.cols - block.width, CV_64F);
  core::parallel_for(static_cast<std::size_t>(sums.rows), {}, [&](std::size_t row) {
    const auto y = static_cast<int>(row);
    auto* sum = sums.ptr<double>(y);
    for (const cv::Rect& box : boxes) {
      const auto* above = integral.ptr<double>(y + box.y) + box.x;
      const auto* below = integral.ptr<double>(y + box.y + box.height) + box.x;
      for (int x = 0; x < sums.cols; ++x)
        sum[x] += below[x + box.width] - below[x] - above[x + box.width] + above[x];
    }
  });
  return sums;
}

}  // namespace emberfold::dytex::detail
