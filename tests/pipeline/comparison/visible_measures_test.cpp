// SPDX-License-Identifier: Apache-2.0
#include "pipeline/comparison/visible_measures.hpp"

#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/parallel.hpp"
#include "core/rng.hpp"
#include "tests/support/catch.hpp"

using namespace emberfold;
using pipeline::VisibleMeasures;

namespace {

/// Blobs that drift to the right by `speed` px a frame and come in again on the left.
std::vector<cv::Mat> drifting_blobs(int frames, double speed, std::uint64_t seed, double contrast = 80) {
  const cv::Size size(80, 60);
  core::Rng rng(seed);
  std::vector<cv::Point2d> middles;
  for (int i = 0; i < 14; ++i) middles.emplace_back(rng.uniform(0, size.width), rng.uniform(0, size.height));
  std::vector<cv::Mat> clip;
  for (int t = 0; t < frames; ++t) {
    cv::Mat1b picture(size);
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x) {
        double level = 60;
        for (const auto& middle : middles) {
          const double dx = std::remainder(x - middle.x - speed * t, size.width), dy = y - middle.y;
          level += contrast * std::exp(-(dx * dx + dy * dy) / 40);
        }
        picture(y, x) = cv::saturate_cast<std::uint8_t>(level);
      }
    clip.push_back(picture);
  }
  return clip;
}

}  // namespace

TEST_CASE("visible measures: the source itself is complete, moves as itself, and is copied", "[heavy]") {
  const auto source = drifting_blobs(40, 1.5, 1);
  const auto own = VisibleMeasures(source, {}).measure(source, {});
  CHECK(own.complete < 1);
  CHECK(own.coherent < 1);
  CHECK(own.apart() < 0.01);
  CHECK(own.flow == Approx(1));
  CHECK(own.variance == Approx(1));
  CHECK(own.difference == Approx(1));
  CHECK(own.copied == Approx(1));
  CHECK(own.moves_alike());
}

TEST_CASE("visible measures: what is missing, too slow or too faint is told, each by its figure", "[heavy]") {
  const auto source = drifting_blobs(40, 1.5, 1);
  const VisibleMeasures measures(source, {});
  const auto slow = measures.measure(drifting_blobs(40, 0.5, 1), {});
  CHECK(slow.flow == Approx(1 / 3.0).margin(0.12));
  CHECK(slow.difference == Approx(1 / 3.0).margin(0.1));
  CHECK_FALSE(slow.moves_alike());
  // The same blobs at half the contrast have a quarter of the variance.
  const auto faint = measures.measure(drifting_blobs(40, 1.5, 1, 40), {});
  CHECK(faint.variance == Approx(0.25).margin(0.04));
  CHECK(faint.difference == Approx(0.5).margin(0.05));
  CHECK(faint.complete > 1.5);
  CHECK(faint.copied < 0.4);
  std::vector<cv::Mat> still(20, source.front());
  const auto frozen = measures.measure(still, {});
  CHECK(frozen.difference == 0);
  CHECK(frozen.variance == Approx(0).margin(1e-6));
  CHECK(frozen.complete > 1.5);
}

TEST_CASE("visible measures: what the source never shows is not coherent") {
  const auto source = drifting_blobs(40, 1.5, 1);
  const VisibleMeasures measures(source, {});
  std::vector<cv::Mat> noisy = source;  // and some noise behind it
  cv::RNG rng(5);
  for (int t = 0; t < 20; ++t) {
    noisy.push_back(source.front().clone());
    rng.fill(noisy.back(), cv::RNG::UNIFORM, 0, 255);
  }
  const auto found = measures.measure(noisy, {});
  CHECK(found.coherent > 3 * found.complete);
  CHECK(found.apart() > 1.5);
}

TEST_CASE("visible measures: how far apart a clip is grows with each figure") {
  pipeline::VisibleFigures same{0.9, 1, 1, 1, 1, 0.2};
  CHECK(same.apart() == 0);
  const auto with = [&](double pipeline::VisibleFigures::*figure, double value) {
    auto other = same;
    other.*figure = value;
    return other.apart();
  };
  CHECK(with(&pipeline::VisibleFigures::complete, std::exp(0.1)) == Approx(0.3));
  CHECK(with(&pipeline::VisibleFigures::coherent, std::exp(0.2)) == Approx(0.6));
  CHECK(with(&pipeline::VisibleFigures::flow, 0.5) == Approx(std::log(2)));
  CHECK(with(&pipeline::VisibleFigures::variance, 2) == Approx(std::log(2)));
  CHECK(with(&pipeline::VisibleFigures::difference, 0) == Approx(std::log(3)).epsilon(1e-4));
  CHECK(with(&pipeline::VisibleFigures::copied, 1) == 0);
}

TEST_CASE("visible measures: other sizes are reduced, and threads change nothing", "[heavy]") {
  const auto source = drifting_blobs(24, 1, 3), other = drifting_blobs(24, 1, 4);
  const VisibleMeasures measures(source, {});
  const auto all = measures.measure(other, {});
  {
    const core::ThreadLimit limit(1);
    CHECK(VisibleMeasures(source, {}).measure(other, {}) == all);
  }
  std::vector<cv::Mat> larger;
  for (const auto& picture : other) {
    cv::Mat twice;
    cv::resize(picture, twice, {}, 2, 2, cv::INTER_CUBIC);
    larger.push_back(twice);
  }
  const auto reduced = measures.measure(larger, {});
  CHECK(reduced.variance == Approx(all.variance).epsilon(0.05));
  CHECK(reduced.complete == Approx(all.complete).epsilon(0.1));
  CHECK(pipeline::visible_picture(cv::Mat1f(1080, 1920, 7.F)).total() <= (1 << 16) + 400);
  CHECK(pipeline::visible_picture(cv::Mat1f(100, 60, 7.F)).size() == cv::Size(30, 50));
}
