// SPDX-License-Identifier: Apache-2.0
#include "sketch/texture/texture_regions.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>

#include "core/clip.hpp"
#include "core/error.hpp"
#include "core/parallel.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/still_textures.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

constexpr int kSide = 80;

/// One texture beside the other.
cv::Mat beside(const std::vector<int>& kinds, double mean) {
  cv::Mat frame(kSide, kSide * static_cast<int>(kinds.size()), CV_32F);
  for (std::size_t i = 0; i < kinds.size(); ++i)
    test::texture({kSide, kSide}, kinds[i], mean, 7 + i)
        .copyTo(frame(cv::Rect(static_cast<int>(i) * kSide, 0, kSide, kSide)));
  return frame;
}

/// The share of the free pixels that have the right one of two or three labels, the labels taken in the order
/// that fits best.
double share_right(const cv::Mat& label, int count) {
  std::vector<std::vector<double>> seen(16, std::vector<double>(16, 0.0));
  double all = 0;
  for (int y = 0; y < label.rows; ++y)
    for (int x = 0; x < label.cols; ++x)
      if (const int own = label.at<uchar>(y, x); own > 0) {
        ++seen[static_cast<std::size_t>(x / kSide)][static_cast<std::size_t>(own - 1)];
        ++all;
      }
  std::vector<std::size_t> order;
  for (int i = 0; i < count; ++i) order.push_back(static_cast<std::size_t>(i));
  double best = 0;
  do {
    double right = 0;
    for (std::size_t i = 0; i < order.size(); ++i) right += seen[i][order[i]];
    best = std::max(best, right / all);
  } while (std::ranges::next_permutation(order).found);
  return best;
}

}  // namespace

TEST_CASE("Texture filters answer to what they are for and to nothing else", "[sketch][texture]") {
  const auto filters = sketch::make_texture_filters();
  cv::Mat plane(20, 20, CV_8U), flat(20, 20, CV_8U, cv::Scalar(91)), dot = flat.clone();
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 20; ++x) plane.at<uchar>(y, x) = static_cast<uchar>(10 + 5 * x + 2 * y);
  dot.at<uchar>(9, 11) = 92;
  for (std::size_t f = 0; f < filters.size(); ++f) {
    INFO(std::string(filters[f].name));
    const cv::Mat on_flat = sketch::filter_responses(flat, filters[f]),
                  on_plane = sketch::filter_responses(plane, filters[f]),
                  on_dot = sketch::filter_responses(dot, filters[f]);
    int weights = 0;
    for (const auto& tap : filters[f].taps) {
      CHECK(std::max(std::abs(tap.dx), std::abs(tap.dy)) <= filters[f].radius);
      CHECK(on_dot.at<int>(9 - tap.dy, 11 - tap.dx) - on_flat.at<int>(0, 0) == tap.weight);
      weights += std::abs(tap.weight);
    }
    CHECK(std::abs(weights - 128) <= 16);
    CHECK(on_flat.at<int>(7, 0) == (f == 0 ? 128 * 91 : 0));
    // On a plane: slopes read it, what bends is 0.
    const int middle = on_plane.at<int>(10, 10);
    if (filters[f].name == "slope along x") CHECK(middle > 0);
    if (filters[f].name == "slope along y") CHECK(middle > 0);
    if (f == 1 || (f > 3 && f < 9)) CHECK(middle == 0);
    if (f >= 9) CHECK(middle == (f == 9 ? 64 * 5 : 64 * 2));
  }
}

TEST_CASE("Bins hold the shares they are made for", "[sketch][texture]") {
  std::vector<int> responses;
  for (int i = 0; i < 10000; ++i) responses.push_back((i * 7919) % 10007);
  const auto edges = sketch::make_bin_edges(responses);
  CHECK(std::ranges::is_sorted(edges));
  std::array<int, sketch::kTextureBins> counts{};
  for (const int response : responses) ++counts[static_cast<std::size_t>(sketch::find_bin(edges, response))];
  const std::array<double, sketch::kTextureBins> shares{0,   .005, .025, .09,  .16,  .15, .14,
                                                        .15, .16,  .09,  .025, .005, 0};
  for (std::size_t b = 0; b < shares.size(); ++b)
    CHECK_THAT(counts[b] / 10000.0, WithinAbs(shares[b], 0.001));
  CHECK(sketch::find_bin(edges, edges[3]) == 4);
  CHECK(sketch::find_bin(edges, edges[3] - 1) == 3);
  const auto alike = sketch::make_bin_edges(std::vector<int>(50, 7));
  CHECK(sketch::find_bin(alike, 7) == 6);
  for (std::size_t i = 1; i < alike.size(); ++i) CHECK(alike[i] - alike[i - 1] == 32);
}

TEST_CASE("Textures side by side are told apart", "[sketch][texture][heavy]") {
  const auto parts = std::vector<std::vector<int>>{{0, 1}, {1, 2}, {2, 3}, {0, 3}, {0, 1, 2}, {1, 2, 3}};
  for (const auto& kinds : parts)
    for (const bool held : {false, true}) {
      const cv::Mat frame = beside(kinds, 120);
      const cv::Mat mask = held ? test::bands(frame.size()) : test::nothing(frame.size());
      const auto count = static_cast<int>(kinds.size());
      INFO(kinds[0] << " and " << kinds[1] << ", of " << kinds.size() << (held ? ", bands held" : ""));
      const auto given = sketch::segment_texture(frame, mask, {.regions = count});
      CHECK(given.count == count);
      CHECK(share_right(given.label, count) > 0.9);
      CHECK(cv::norm(given.label == 0, mask != 0, cv::NORM_INF) == 0);
      // And how many there are is found too, where no texture is as wide as the window.
      if (kinds.front() == 0 && kinds.back() == 3) continue;
      const auto found = sketch::segment_texture(frame, mask, {.fewest = 2});
      CHECK(found.count == count);
    }
}

TEST_CASE("Histograms of regions are counts of their own pixels", "[sketch][texture]") {
  const cv::Mat frame = beside({0, 2}, 100), mask = test::bands(frame.size());
  const auto regions = sketch::segment_texture(frame, mask);
  REQUIRE(regions.count >= 3);
  const int parts = 2 * regions.count;
  REQUIRE(regions.histograms.size() == static_cast<std::size_t>(parts));
  const auto filters = sketch::make_texture_filters();
  const cv::Mat bytes = core::to_bytes(frame);
  double before = 0;
  for (int k = 1; k <= parts; ++k) {
    const auto& histograms = regions.histograms[static_cast<std::size_t>(k - 1)];
    for (std::size_t f = 0; f < filters.size(); ++f) {
      double sum = 0, below = 0, count = 0;
      for (const double share : histograms[f]) sum += share;
      CHECK_THAT(sum, WithinAbs(1, 1e-9));
      for (int y = 0; y < frame.rows; ++y)
        for (int x = 0; x < frame.cols; ++x) {
          if (regions.part.at<uchar>(y, x) != k) continue;
          int response = 0;
          for (const auto& tap : filters[f].taps)
            response += tap.weight * bytes.at<uchar>(std::clamp(y + tap.dy, 0, frame.rows - 1),
                                                     std::clamp(x + tap.dx, 0, frame.cols - 1));
          below += response < regions.edges[static_cast<std::size_t>(k - 1)][f][5] ? 1 : 0;
          ++count;
        }
      double share = 0;
      for (std::size_t b = 0; b <= 5; ++b) share += histograms[f][b];
      CHECK_THAT(below / count, WithinAbs(share, 1e-9));
    }
  }
  for (int k = 1; k <= regions.count; ++k) {
    const double mean = cv::mean(bytes, regions.label == k)[0];
    CHECK(mean >= before);
    before = mean;
  }
  // Parts: within the filters' reach of a held pixel, or not.
  for (int y = 0; y < frame.rows; ++y)
    for (int x = 0; x < frame.cols; ++x) {
      bool beside = false;
      for (int v = std::max(0, y - 3); v <= std::min(frame.rows - 1, y + 3); ++v)
        for (int u = std::max(0, x - 3); u <= std::min(frame.cols - 1, x + 3); ++u)
          beside |= mask.at<uchar>(v, u) != 0;
      const int label = regions.label.at<uchar>(y, x);
      CHECK(int(regions.part.at<uchar>(y, x)) == (label == 0 || !beside ? label : label + regions.count));
    }
}

TEST_CASE("Texture regions are the same at any thread count and seed by seed", "[sketch][texture]") {
  const cv::Mat frame = beside({0, 3}, 110), mask = test::bands(frame.size());
  const auto with = [&](std::size_t threads) {
    const core::ThreadLimit limit(threads);
    return sketch::segment_texture(frame, mask, {.seed = 5});
  };
  const auto one = with(1), four = with(4);
  CHECK(cv::norm(one.label, four.label, cv::NORM_INF) == 0);
  CHECK(one.histograms == four.histograms);
  CHECK(one.edges == four.edges);
}

TEST_CASE("Texture regions of odd frames", "[sketch][texture]") {
  for (const cv::Size size : {cv::Size(1, 1), {3, 1}, {3, 40}, {40, 3}, {6, 6}}) {
    const auto regions = sketch::segment_texture(test::texture(size, 3, 100, 3), test::nothing(size));
    CHECK(regions.label.size() == size);
    CHECK(regions.count >= 1);
    CHECK(cv::countNonZero(regions.label) == size.area());
  }
  const cv::Size size(40, 30);
  const cv::Mat constant(size, CV_32F, cv::Scalar(80));
  CHECK(sketch::segment_texture(constant, test::nothing(size)).count == 1);
  const auto none = sketch::segment_texture(constant, cv::Mat(size, CV_8U, cv::Scalar(1)));
  CHECK(none.count == 0);
  CHECK(none.histograms.empty());
  CHECK(cv::countNonZero(none.label) == 0);
  cv::Mat one_free(size, CV_8U, cv::Scalar(255));
  one_free.at<uchar>(0, 0) = 0;
  CHECK(sketch::segment_texture(constant, one_free).count == 1);
}

TEST_CASE("Texture regions reject what is none", "[sketch][texture]") {
  const cv::Size size(20, 20);
  cv::Mat frame = test::texture(size, 3, 100, 3);
  const cv::Mat mask = test::nothing(size);
  CHECK_THROWS_AS(sketch::segment_texture(cv::Mat(), mask), core::InputError);
  CHECK_THROWS_AS(sketch::segment_texture(frame, test::nothing({3, 3})), core::InputError);
  for (const sketch::TextureOptions& options : std::vector<sketch::TextureOptions>{{.regions = 17},
                                                                                   {.regions = -1},
                                                                                   {.fewest = 0},
                                                                                   {.fewest = 8},
                                                                                   {.most = 17},
                                                                                   {.window = 4},
                                                                                   {.window = 1}})
    CHECK_THROWS_AS(sketch::segment_texture(frame, mask, options), core::InputError);
  frame.at<float>(1, 1) = std::numeric_limits<float>::quiet_NaN();
  CHECK_THROWS_AS(sketch::segment_texture(frame, mask), core::InputError);
}
