// SPDX-License-Identifier: Apache-2.0
// The bounds that make the fast search exact: of the basis and of the Fourier transforms.
#include <algorithm>
#include <cmath>

#include "dytex/quilting/basis.hpp"
#include "dytex/quilting/correlation.hpp"
#include "dytex/quilting/overlap.hpp"
#include "tests/dytex/quilting/quilt_make.hpp"
#include "tests/support/catch.hpp"

using namespace emberfold;
using namespace emberfold::test;
using namespace emberfold::dytex::detail;

TEST_CASE("distances of trajectories lie between the bounds of the basis") {
  const int type = GENERATE(CV_8UC3, CV_16UC1, CV_32FC1);
  const double grain = GENERATE(0.0, 0.1);
  const auto clip = made_lapse({32, 24}, 40, type, 2, grain);
  const auto source = held(clip);
  const std::vector<const dytex::Trajectories*> sources{&source};
  const auto basis = fit_basis(sources, 4, 1);
  REQUIRE(basis.directions.cols() == 4);
  const Eigen::MatrixXf unit = basis.directions.transpose() * basis.directions;
  CHECK((unit - Eigen::MatrixXf::Identity(4, 4)).cwiseAbs().maxCoeff() < 1e-5F);
  const auto planes = project_trajectories(sources, basis, {}).front();
  REQUIRE(planes.size() == 5);
  core::Rng rng(1);
  double captured = 0, all = 0;
  for (int i = 0; i < 500; ++i) {
    const cv::Point a(static_cast<int>(rng.below(32)), static_cast<int>(rng.below(24)));
    const cv::Point b(static_cast<int>(rng.below(32)), static_cast<int>(rng.below(24)));
    double exact = 0, inside = 0;
    for (const auto& frame : clip.frames) {
      cv::Mat values;
      frame.convertTo(values, CV_64F);
      const auto channels = static_cast<std::size_t>(values.channels());
      for (std::size_t c = 0; c < channels; ++c) {
        const double d = values.ptr<double>(a.y)[static_cast<std::size_t>(a.x) * channels + c] -
                         values.ptr<double>(b.y)[static_cast<std::size_t>(b.x) * channels + c];
        exact += d * d;
      }
    }
    for (std::size_t p = 0; p < 4; ++p) {
      const double d =
          static_cast<double>(planes[p].at<float>(a)) - static_cast<double>(planes[p].at<float>(b));
      inside += d * d;
    }
    const double r =
        static_cast<double>(planes[4].at<float>(a)) - static_cast<double>(planes[4].at<float>(b));
    CHECK(inside + r * r <= exact * (1 + 1e-4) + 1e-6);
    captured += inside, all += exact;
  }
  if (grain == 0) CHECK(captured > 0.6 * all);
}

TEST_CASE("the transforms give every difference within their margin") {
  const cv::Size size(71, 58), block(16, 12);
  std::vector<cv::Mat> planes;
  core::Rng rng(4);
  for (int p = 0; p < 3; ++p) {
    cv::Mat plane(size, CV_32F);
    for (float& v : cv::Mat_<float>(plane)) v = static_cast<float>(100 * rng.normal());
    planes.push_back(plane);
  }
  const QuiltBlock place{1, 1, {0, 0, 16, 12}, 5, 4, 0, 0};
  const auto boxes = run_boxes(overlap_runs(place));
  std::vector<cv::Mat> query;
  for (const auto& plane : planes) {
    cv::Mat part = cv::Mat::zeros(block, CV_32F);
    for (const auto& box : boxes) plane(box + cv::Point(21, 30)).copyTo(part(box));
    query.push_back(part);
  }
  const Correlator correlator(planes, block, block);
  const cv::Mat errors = correlator.squared_differences(query, boxes);
  REQUIRE(errors.size() == cv::Size(56, 47));
  const double margin = correlator.margin(query);
  double worst = 0, largest = 0;
  for (int v = 0; v < errors.rows; ++v)
    for (int u = 0; u < errors.cols; ++u) {
      double exact = 0;
      for (std::size_t p = 0; p < planes.size(); ++p)
        for (const auto& box : boxes)
          exact += std::pow(cv::norm(planes[p](box + cv::Point(u, v)), query[p](box)), 2);
      worst = std::max(worst, std::abs(exact - static_cast<double>(errors.at<float>(v, u))));
      largest = std::max(largest, exact);
    }
  CHECK(worst < margin);
  CHECK(margin < 0.01 * largest);
  CHECK(std::abs(static_cast<double>(errors.at<float>(30, 21))) < margin);
}

TEST_CASE("differences of any depth and length are exact") {
  core::Rng rng(2);
  for (const std::size_t n : {1U, 7U, 64U, 16384U, 40000U}) {
    std::vector<std::uint8_t> a(n), b(n);
    std::vector<std::uint16_t> c(n), d(n);
    std::uint64_t bytes = 0, words = 0;
    for (std::size_t i = 0; i < n; ++i) {
      a[i] = static_cast<std::uint8_t>(rng.below(2) * 255), b[i] = static_cast<std::uint8_t>(rng.below(256));
      c[i] = static_cast<std::uint16_t>(rng.below(2) * 65535),
      d[i] = static_cast<std::uint16_t>(rng.below(65536));
      const std::int64_t e = a[i] - b[i], f = c[i] - d[i];
      bytes += static_cast<std::uint64_t>(e * e), words += static_cast<std::uint64_t>(f * f);
    }
    const auto as_bytes = [](const auto& v) { return reinterpret_cast<const std::byte*>(v.data()); };
    CHECK(squared_difference(as_bytes(a), as_bytes(b), n, CV_8U) == static_cast<double>(bytes));
    CHECK(squared_difference(as_bytes(c), as_bytes(d), n, CV_16U) == static_cast<double>(words));
  }
}
