// SPDX-License-Identifier: Apache-2.0
#include "sketch/inpainting/fill.hpp"

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/SparseCholesky>
#include <opencv2/core.hpp>

#include "core/error.hpp"
#include "core/rng.hpp"
#include "tests/support/catch.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

constexpr double kPromise = 0.25;  // grey levels, everywhere

/// Solves the equations as they are defined, by factorisation; `sink` draws to 0.
cv::Mat direct_fill(const cv::Mat& levels, const cv::Mat& mask, double sink = 0) {
  const int width = levels.cols, height = levels.rows;
  cv::Mat number(mask.size(), CV_32S, cv::Scalar(-1));
  int unknowns = 0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      if (mask.at<uchar>(y, x) == 0) number.at<int>(y, x) = unknowns++;
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::VectorXd right = Eigen::VectorXd::Zero(unknowns);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const int i = number.at<int>(y, x);
      if (i < 0) continue;
      entries.emplace_back(i, i, sink);
      for (const auto& [dx, dy] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
        const int nx = x + dx, ny = y + dy;
        if (nx < 0 || ny < 0 || nx >= width || ny >= height) continue;
        entries.emplace_back(i, i, 1.0);
        if (number.at<int>(ny, nx) >= 0)
          entries.emplace_back(i, number.at<int>(ny, nx), -1.0);
        else
          right[i] += static_cast<double>(levels.at<float>(ny, nx));
      }
    }
  Eigen::SparseMatrix<double> matrix(unknowns, unknowns);
  matrix.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(matrix);
  const Eigen::VectorXd solution = solver.solve(right);
  cv::Mat result = levels.clone();
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      if (number.at<int>(y, x) >= 0)
        result.at<float>(y, x) = static_cast<float>(solution[number.at<int>(y, x)]);
  return result;
}

double largest_difference(const cv::Mat& a, const cv::Mat& b) {
  return cv::norm(a, b, cv::NORM_INF);
}

cv::Mat random_levels(cv::Size size, core::Rng& rng) {
  cv::Mat levels(size, CV_32F);
  for (float& value : cv::Mat_<float>(levels)) value = static_cast<float>(rng.uniform(0, 255));
  return levels;
}

cv::Mat black_or_white(cv::Size size, core::Rng& rng) {
  cv::Mat levels(size, CV_32F);
  for (float& value : cv::Mat_<float>(levels)) value = rng.below(2) == 0 ? 0.0F : 255.0F;
  return levels;
}

cv::Mat mask_of(cv::Size size, const std::function<bool(int, int)>& held) {
  cv::Mat mask(size, CV_8U);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) mask.at<uchar>(y, x) = held(x, y) ? 255 : 0;
  return mask;
}

cv::Mat curves(cv::Size size, int count, core::Rng& rng) {
  cv::Mat mask(size, CV_8U, cv::Scalar(0));
  for (int i = 0; i < count; ++i) {
    double x = rng.uniform(0, size.width), y = rng.uniform(0, size.height), a = rng.uniform(0, 6.28);
    const double bend = rng.uniform(-0.05, 0.05);
    for (int step = 0; step < 150; ++step, x += std::cos(a), y += std::sin(a), a += bend)
      for (int j = -1; j <= 1; ++j) {
        const int px = static_cast<int>(std::lround(x)) + j, py = static_cast<int>(std::lround(y));
        if (px >= 0 && py >= 0 && px < size.width && py < size.height) mask.at<uchar>(py, px) = 1;
      }
  }
  return mask;
}

cv::Mat scattered(cv::Size size, double share, core::Rng& rng) {
  cv::Mat mask = mask_of(size, [&](int, int) { return rng.uniform() < share; });
  mask.at<uchar>(size.height / 3, size.width / 3) = 255;
  return mask;
}

struct Case {
  std::string name;
  cv::Mat mask;
};

std::vector<Case> cases(cv::Size size, core::Rng& rng) {
  const int w = size.width, h = size.height;
  std::vector<Case> all;
  all.push_back({"curves", curves(size, w * h / 2500 + 1, rng)});
  for (const double share : {0.5, 0.05, 0.002})
    all.push_back({"points " + std::to_string(share), scattered(size, share, rng)});
  const auto add = [&](const char* name, const std::function<bool(int, int)>& held) {
    all.push_back({name, mask_of(size, held)});
  };
  add("one pixel", [&](int x, int y) { return x == w / 4 && y == h / 2; });
  add("half plane", [&](int x, int) { return x <= w / 2; });
  add("two pixels of a corner", [](int x, int y) { return y == 0 && x <= 1; });
  add("block in a corner", [](int x, int y) { return x < 5 && y < 5; });
  add("opposite corners", [&](int x, int y) { return (x == 0 && y == 0) || (x == w - 1 && y == h - 1); });
  add("border", [&](int x, int y) { return x == 0 || y == 0 || x == w - 1 || y == h - 1; });
  add("islands", [](int x, int y) { return x % 7 == 3 || y % 5 == 2; });
  add("chequers", [](int x, int y) { return (x + y) % 2 == 1; });
  add("slabs with doors", [&](int x, int y) { return y % 6 == 5 && x != (y / 6 % 2 == 0 ? 0 : w - 1); });
  add("a wall with a hole", [&](int x, int y) { return y == h / 2 && x != w / 2; });
  return all;
}

}  // namespace

TEST_CASE("The filled frame is the direct solution, everywhere", "[sketch][fill]") {
  core::Rng rng(1);
  for (const cv::Size size : {cv::Size(160, 120), {97, 61}, {33, 128}, {64, 64}, {7, 5}})
    for (const auto& [name, mask] : cases(size, rng)) {
      if (cv::countNonZero(mask) == 0) continue;
      for (const cv::Mat& levels : {random_levels(size, rng), black_or_white(size, rng)}) {
        INFO(name << ", " << size.width << " × " << size.height);
        const auto result = sketch::fill(levels, mask);
        CHECK(result.converged);
        CHECK(largest_difference(result.levels, direct_fill(levels, mask)) < kPromise);
      }
    }
}

TEST_CASE("A step of full contrast between distant held pixels is filled exactly", "[sketch][fill]") {
  const cv::Size size(320, 240);
  const cv::Mat mask =
      mask_of(size, [](int x, int y) { return (x == 0 && y == 0) || (x == 319 && y == 239); });
  cv::Mat levels(size, CV_32F, cv::Scalar(0));
  levels.at<float>(0, 0) = 255;
  CHECK(largest_difference(sketch::fill(levels, mask).levels, direct_fill(levels, mask)) < kPromise);
}

TEST_CASE("Strips of a few pixels' width are filled as well as frames", "[sketch][fill]") {
  core::Rng rng(2);
  for (const int length : {1, 2, 3, 17, 500, 4000})
    for (const int width : {1, 2, 3})
      for (const bool upright : {false, true}) {
        const cv::Size size = upright ? cv::Size(width, length) : cv::Size(length, width);
        cv::Mat mask(size, CV_8U, cv::Scalar(0));
        mask.at<uchar>(0, 0) = 1;
        mask.at<uchar>(size.height - 1, size.width - 1) = 1;
        cv::Mat levels = random_levels(size, rng);
        levels.at<float>(0, 0) = 0;
        levels.at<float>(size.height - 1, size.width - 1) = 255;
        INFO(size.width << " × " << size.height);
        CHECK(largest_difference(sketch::fill(levels, mask).levels, direct_fill(levels, mask)) < kPromise);
      }
}

TEST_CASE("A large frame is the direct solution too", "[sketch][fill]") {
  core::Rng rng(3);
  const cv::Size size(1280, 720);
  const cv::Mat mask = curves(size, 500, rng), levels = random_levels(size, rng);
  CHECK(largest_difference(sketch::fill(levels, mask).levels, direct_fill(levels, mask)) < kPromise);
}

TEST_CASE("The reported error is of the size of the true one", "[sketch][fill]") {
  core::Rng rng(4);
  const cv::Size size(160, 120);
  for (const auto& [name, mask] : cases(size, rng))
    for (const double tolerance : {5.0, 0.5, 0.05}) {
      const cv::Mat levels = random_levels(size, rng);
      const auto result = sketch::fill(levels, mask, {.tolerance = tolerance});
      INFO(name << ", tolerance " << tolerance);
      CHECK(result.error <= tolerance);
      CHECK(largest_difference(result.levels, direct_fill(levels, mask)) <= 4 * tolerance);
    }
}

TEST_CASE("Too few iterations are reported", "[sketch][fill]") {
  core::Rng rng(5);
  const cv::Size size(160, 120);
  const auto result = sketch::fill(random_levels(size, rng), scattered(size, 0.01, rng),
                                   {.tolerance = 1e-3, .max_iterations = 2});
  CHECK(result.iterations == 2);
  CHECK_FALSE(result.converged);
  CHECK(result.error > 1e-3);
}

TEST_CASE("No filled pixel leaves the range of the held ones", "[sketch][fill]") {
  core::Rng rng(6);
  const cv::Size size(101, 75);
  for (const auto& [name, mask] : cases(size, rng)) {
    const cv::Mat levels = random_levels(size, rng);
    double low = 0, high = 0, filled_low = 0, filled_high = 0;
    cv::minMaxLoc(levels, &low, &high, nullptr, nullptr, mask);
    cv::minMaxLoc(sketch::fill(levels, mask).levels, &filled_low, &filled_high);
    INFO(name);
    CHECK(filled_low >= low);
    CHECK(filled_high <= high);
  }
}

TEST_CASE("A constant comes back as it is, a plane between held borders too", "[sketch][fill]") {
  core::Rng rng(7);
  const cv::Size size(83, 59);
  const cv::Mat constant(size, CV_32F, cv::Scalar(77.7F));
  for (const auto& [name, mask] : cases(size, rng)) {
    INFO(name);
    CHECK(largest_difference(sketch::fill(constant, mask).levels, constant) == 0);
  }
  cv::Mat plane(size, CV_32F);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      plane.at<float>(y, x) = 20 + 1.5F * static_cast<float>(x) + 0.75F * static_cast<float>(y);
  const cv::Mat border = mask_of(
      size, [&](int x, int y) { return x == 0 || y == 0 || x == size.width - 1 || y == size.height - 1; });
  CHECK(largest_difference(sketch::fill(plane, border).levels, plane) < 0.1);
}

TEST_CASE("Filling is linear in what is held", "[sketch][fill]") {
  core::Rng rng(8);
  const cv::Size size(120, 91);
  const cv::Mat mask = curves(size, 6, rng);
  const cv::Mat a = random_levels(size, rng), b = random_levels(size, rng);
  const cv::Mat mixed = 0.25 * a + 0.75 * b + 10;
  const cv::Mat expected = 0.25 * sketch::fill(a, mask).levels + 0.75 * sketch::fill(b, mask).levels + 10;
  CHECK(largest_difference(sketch::fill(mixed, mask).levels, expected) < 0.1);
  CHECK(largest_difference(sketch::fill(a * 1e4, mask, {.tolerance = 300}).levels / 1e4,
                           sketch::fill(a, mask).levels) < 0.1);
}

TEST_CASE("A turned frame is filled as the upright one", "[sketch][fill]") {
  core::Rng rng(9);
  const cv::Size size(121, 90);
  const cv::Mat mask = curves(size, 6, rng), levels = random_levels(size, rng);
  const cv::Mat upright = sketch::fill(levels, mask).levels;
  for (const int axis : {-1, 0, 1}) {
    cv::Mat flipped_mask, flipped, expected;
    cv::flip(mask, flipped_mask, axis);
    cv::flip(levels, flipped, axis);
    cv::flip(upright, expected, axis);
    CHECK(largest_difference(sketch::fill(flipped, flipped_mask).levels, expected) < 0.1);
  }
  CHECK(largest_difference(sketch::fill(levels.t(), mask.t()).levels, upright.t()) < 0.1);
}

TEST_CASE("Channels do not touch each other", "[sketch][fill]") {
  core::Rng rng(10);
  const cv::Size size(64, 48);
  const cv::Mat mask = curves(size, 3, rng);
  const std::vector<cv::Mat> channels = {random_levels(size, rng), cv::Mat(size, CV_32F, cv::Scalar(9)),
                                         black_or_white(size, rng)};
  cv::Mat colour;
  cv::merge(channels, colour);
  std::vector<cv::Mat> filled;
  cv::split(sketch::fill(colour, mask).levels, filled);
  for (std::size_t c = 0; c < 3; ++c)
    CHECK(largest_difference(filled[c], sketch::fill(channels[c], mask).levels) == 0);
}

TEST_CASE("All held: untouched. Nothing held: zero", "[sketch][fill]") {
  core::Rng rng(11);
  for (const cv::Size size : {cv::Size(1, 1), {1, 9}, {31, 20}}) {
    const cv::Mat levels = random_levels(size, rng);
    const auto full = sketch::fill(levels, cv::Mat(size, CV_8U, cv::Scalar(1)));
    CHECK(largest_difference(full.levels, levels) == 0);
    CHECK(full.levels.data != levels.data);
    const auto empty = sketch::fill(levels, cv::Mat(size, CV_8U, cv::Scalar(0)));
    CHECK(cv::countNonZero(empty.levels) == 0);
    CHECK(empty.converged);
  }
}

TEST_CASE("Held pixels come back bit by bit, and what lies under the rest does not matter",
          "[sketch][fill]") {
  core::Rng rng(12);
  const cv::Size size(90, 70);
  const cv::Mat mask = curves(size, 5, rng), levels = random_levels(size, rng);
  cv::Mat littered = levels.clone();
  const float litter[] = {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                          -std::numeric_limits<float>::infinity(), 3e38F};
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      if (mask.at<uchar>(y, x) == 0) littered.at<float>(y, x) = litter[rng.below(4)];
  const cv::Mat clean = sketch::fill(levels, mask).levels, other = sketch::fill(littered, mask).levels;
  CHECK(largest_difference(clean, other) == 0);
  cv::Mat held_before, held_after;
  levels.copyTo(held_before, mask);
  clean.copyTo(held_after, mask);
  CHECK(largest_difference(held_before, held_after) == 0);
}

TEST_CASE("Part of a larger picture is filled as a copy of it", "[sketch][fill]") {
  core::Rng rng(13);
  const cv::Mat levels = random_levels({80, 60}, rng), mask = curves({80, 60}, 5, rng);
  const cv::Rect part(11, 7, 45, 38);
  CHECK(largest_difference(sketch::fill(levels(part), mask(part)).levels,
                           sketch::fill(levels(part).clone(), mask(part).clone()).levels) == 0);
}

TEST_CASE("Numbers of any size are filled", "[sketch][fill]") {
  core::Rng rng(14);
  const cv::Size size(40, 30);
  const cv::Mat mask = curves(size, 3, rng), levels = random_levels(size, rng);
  const cv::Mat expected = direct_fill(levels, mask);
  for (const double scale : {1e-35, 1e-6, 1e6, 1e35}) {
    const cv::Mat scaled = levels * scale;
    const auto result = sketch::fill(scaled, mask, {.tolerance = 0.03 * scale});
    INFO("scale " << scale);
    CHECK(result.converged);
    CHECK(largest_difference(result.levels / scale, expected) < kPromise);
  }
}

TEST_CASE("What cannot be filled is refused by name", "[sketch][fill]") {
  const cv::Mat levels(6, 8, CV_32F, cv::Scalar(1)), mask(6, 8, CV_8U, cv::Scalar(1));
  const auto refused = [](const cv::Mat& l, const cv::Mat& m, const std::string& word,
                          const sketch::FillOptions& options = {}) {
    try {
      (void)sketch::fill(l, m, options);
    } catch (const core::InputError& error) {
      return std::string(error.what()).find(word) != std::string::npos;
    }
    return false;
  };
  CHECK(refused(cv::Mat(6, 8, CV_8U, cv::Scalar(1)), mask, "CV_8UC1"));
  CHECK(refused(cv::Mat(6, 8, CV_32FC2, cv::Scalar(1)), mask, "CV_32FC2"));
  CHECK(refused(cv::Mat(), cv::Mat(), "at least 1 × 1"));
  CHECK(refused(levels, cv::Mat(6, 7, CV_8U, cv::Scalar(1)), "7 × 6"));
  CHECK(refused(levels, cv::Mat(6, 8, CV_8UC3, cv::Scalar(1)), "CV_8UC3"));
  CHECK(refused(levels, cv::Mat(6, 8, CV_32F, cv::Scalar(1)), "CV_32FC1"));
  CHECK(refused(levels, mask, "tolerance", {.tolerance = 0}));
  CHECK(refused(levels, mask, "tolerance", {.tolerance = std::numeric_limits<double>::quiet_NaN()}));
  CHECK(refused(levels, mask, "max_iterations", {.max_iterations = 0}));
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    cv::Mat broken = levels.clone();
    broken.at<float>(4, 5) = bad;
    CHECK(refused(broken, mask, "row 4"));
  }
}

TEST_CASE("Put onto a ground, the difference is that of a direct solution with a sink", "[sketch][fill]") {
  core::Rng rng(21);
  for (const cv::Size size : {cv::Size(63, 41), cv::Size(16, 80), cv::Size(1, 30), cv::Size(300, 4)}) {
    const cv::Mat levels = random_levels(size, rng), background = random_levels(size, rng);
    cv::Mat mask(size, CV_8U, cv::Scalar(0));
    for (int i = 0; i < 6; ++i)
      mask.at<uchar>(static_cast<int>(rng.below(static_cast<std::uint32_t>(size.height))),
                     static_cast<int>(rng.below(static_cast<std::uint32_t>(size.width)))) = 255;
    for (const double reach : {1.0, 3.0, 12.0, 500.0}) {
      cv::Mat held(size, CV_32F, cv::Scalar(0));
      cv::Mat(levels - background).copyTo(held, mask);
      const cv::Mat expected = background + direct_fill(held, mask, 1 / (reach * reach));
      const auto result = sketch::fill_onto(levels, mask, background, reach);
      INFO(size << ", reach " << reach);
      CHECK(result.converged);
      CHECK(result.iterations < 40);
      CHECK(largest_difference(result.levels, expected) < kPromise);
      CHECK(cv::countNonZero((result.levels != levels) & mask) == 0);
    }
  }
}

TEST_CASE("A ground stays itself away from what is put onto it, in every channel", "[sketch][fill]") {
  core::Rng rng(22);
  cv::Mat background(60, 90, CV_32FC3), mask(60, 90, CV_8U, cv::Scalar(0));
  for (auto& pixel : cv::Mat_<cv::Vec3f>(background))
    for (int c = 0; c < 3; ++c) pixel[c] = static_cast<float>(rng.uniform(0, 255));
  const cv::Mat levels(60, 90, CV_32FC3, cv::Scalar(200, 100, 0));
  CHECK(largest_difference(sketch::fill_onto(levels, mask, background, 4).levels, background) == 0);
  mask.colRange(0, 6).setTo(255);
  const cv::Mat drawn = sketch::fill_onto(levels, mask, background, 4).levels;
  CHECK(largest_difference(drawn.colRange(0, 6), levels.colRange(0, 6)) == 0);
  // e^(−40/4) of at most 255 levels is left 40 px away.
  CHECK(largest_difference(drawn.colRange(46, 90), background.colRange(46, 90)) < 0.1);
  mask.setTo(255);
  CHECK(largest_difference(sketch::fill_onto(levels, mask, background, 4).levels, levels) == 0);
  mask.colRange(50, 90).setTo(0);
  CHECK(largest_difference(sketch::fill_onto(background, mask, background, 4).levels, background) == 0);
}

TEST_CASE("A ground that cannot be taken is refused by name", "[sketch][fill]") {
  const cv::Mat levels(6, 8, CV_32F, cv::Scalar(1)), mask(6, 8, CV_8U, cv::Scalar(0));
  const auto refused = [&](const cv::Mat& background, double reach, const std::string& word) {
    try {
      (void)sketch::fill_onto(levels, mask, background, reach);
    } catch (const core::InputError& error) {
      return std::string(error.what()).find(word) != std::string::npos;
    }
    return false;
  };
  CHECK(refused(cv::Mat(6, 7, CV_32F, cv::Scalar(1)), 5, "7 × 6"));
  CHECK(refused(cv::Mat(6, 8, CV_32FC3, cv::Scalar(1)), 5, "CV_32FC3"));
  CHECK(refused(levels, 0, "reach is 0"));
  CHECK(refused(levels, std::numeric_limits<double>::quiet_NaN(), "reach"));
  cv::Mat broken = levels.clone();
  broken.at<float>(2, 2) = std::numeric_limits<float>::infinity();
  CHECK(refused(broken, 5, "not finite"));
}
