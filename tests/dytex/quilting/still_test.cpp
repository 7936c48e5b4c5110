// SPDX-License-Identifier: Apache-2.0
// Quilting of one frame against image quilting as Efros and Freeman (2001) describe it, written down here
// once more: blocks in raster order, every place of the source tried, sums of whole numbers.
#include <cstdlib>
#include <limits>

#include "tests/dytex/quilting/quilt_make.hpp"
#include "tests/support/catch.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

struct Plain {
  cv::Mat source;  // CV_8UC3
  int block = 0, overlap = 0;
  double tolerance = 0, floor = 0;
  std::uint64_t seed = 1;
  cv::Mat canvas;  // CV_8UC3
  cv::Mat places;  // CV_32SC2: the source pixel of each output pixel
};

long long difference(const cv::Vec3b& a, const cv::Vec3b& b) {
  long long sum = 0;
  for (int c = 0; c < 3; ++c) sum += (a[c] - b[c]) * (a[c] - b[c]);
  return sum;
}

// True if pixel (x, y) of a block in this column and row lies on earlier blocks.
bool overlaps(const Plain& p, int column, int row, int x, int y) {
  return (column > 0 && x < p.overlap) || (row > 0 && y < p.overlap);
}

cv::Point find_place(const Plain& p, int column, int row) {
  const int step = p.block - p.overlap;
  std::vector<std::pair<long long, cv::Point>> places;
  long long values = 0;
  for (int y = 0; y < p.block; ++y)
    for (int x = 0; x < p.block; ++x) values += overlaps(p, column, row, x, y) ? 3 : 0;
  for (int v = 0; v + p.block <= p.source.rows; ++v)
    for (int u = 0; u + p.block <= p.source.cols; ++u) {
      long long sum = 0;
      for (int y = 0; y < p.block; ++y)
        for (int x = 0; x < p.block; ++x)
          if (overlaps(p, column, row, x, y))
            sum += difference(p.source.at<cv::Vec3b>(v + y, u + x),
                              p.canvas.at<cv::Vec3b>(row * step + y, column * step + x));
      places.emplace_back(sum, cv::Point(u, v));
    }
  long long least = std::numeric_limits<long long>::max();
  for (const auto& place : places) least = std::min(least, place.first);
  const double limit = std::max((1 + p.tolerance) * static_cast<double>(least),
                                p.floor * p.floor * static_cast<double>(values));
  std::erase_if(places, [&](const auto& place) { return static_cast<double>(place.first) > limit; });
  core::Rng rng(p.seed, {0x626cu, static_cast<std::uint32_t>(column), static_cast<std::uint32_t>(row)});
  return places[rng.below(static_cast<std::uint32_t>(places.size()))].second;
}

// The first column of each row that is the block's: dynamic programming from the lowest row upwards.
std::vector<int> cut(const std::vector<std::vector<long long>>& cost) {
  const std::size_t rows = cost.size();
  const int columns = static_cast<int>(cost.front().size());
  auto sum = cost;
  const auto least_of = [&](std::size_t y, int x) {
    int best = std::max(0, x - 1);
    for (int c = best + 1; c <= std::min(columns - 1, x + 1); ++c)
      if (sum[y][static_cast<std::size_t>(c)] < sum[y][static_cast<std::size_t>(best)]) best = c;
    return best;
  };
  for (std::size_t y = 1; y < rows; ++y)
    for (int x = 0; x < columns; ++x)
      sum[y][static_cast<std::size_t>(x)] += sum[y - 1][static_cast<std::size_t>(least_of(y - 1, x))];
  std::vector<int> seam(rows);
  int at = 0;
  for (int x = 1; x < columns; ++x)
    if (sum.back()[static_cast<std::size_t>(x)] < sum.back()[static_cast<std::size_t>(at)]) at = x;
  seam[rows - 1] = at;
  for (std::size_t y = rows - 1; y > 0; --y) seam[y - 1] = at = least_of(y - 1, at);
  return seam;
}

void paste(Plain& p, int column, int row, cv::Point place) {
  const int step = p.block - p.overlap;
  const cv::Point corner(column * step, row * step);
  const auto error = [&](int x, int y) {
    return difference(p.source.at<cv::Vec3b>(place.y + y, place.x + x),
                      p.canvas.at<cv::Vec3b>(corner.y + y, corner.x + x));
  };
  const auto side = static_cast<std::size_t>(p.block), width = static_cast<std::size_t>(p.overlap);
  std::vector left(side, std::vector<long long>(width)), top = left;
  for (int i = 0; i < p.block; ++i)
    for (int j = 0; j < p.overlap; ++j) {
      left[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] = error(j, i);
      top[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] = error(i, j);
    }
  const auto from_left = column > 0 ? cut(left) : std::vector<int>(side, 0);
  const auto from_top = row > 0 ? cut(top) : std::vector<int>(side, 0);
  for (int y = 0; y < p.block; ++y)
    for (int x = 0; x < p.block; ++x)
      if (x >= from_left[static_cast<std::size_t>(y)] && y >= from_top[static_cast<std::size_t>(x)]) {
        p.canvas.at<cv::Vec3b>(corner.y + y, corner.x + x) = p.source.at<cv::Vec3b>(place.y + y, place.x + x);
        p.places.at<cv::Vec2i>(corner.y + y, corner.x + x) = {place.x + x, place.y + y};
      }
}

void run_plain(Plain& p, int columns, int rows) {
  const int step = p.block - p.overlap;
  p.canvas = cv::Mat::zeros(rows * step + p.overlap, columns * step + p.overlap, CV_8UC3);
  p.places = cv::Mat::zeros(p.canvas.size(), CV_32SC2);
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) paste(p, column, row, find_place(p, column, row));
}

}  // namespace

TEST_CASE("a still is quilted as Efros and Freeman quilt it") {
  const auto clip = made_lapse({61, 53}, 1, CV_8UC3, 5);
  const auto source = held(clip);
  for (const std::uint64_t seed : {1ULL, 2ULL, 3ULL}) {
    Plain plain{clip.frames.front(), 16, 5, 0.1, 2, seed, {}, {}};
    run_plain(plain, 8, 6);
    dytex::QuiltOptions options;
    options.size = {85, 70};  // neither is a whole number of blocks
    options.block = {16, 16};
    options.overlap = 5;
    options.floor = 2;
    options.seed = seed;
    for (const bool exact : {false, true}) {
      options.exact = exact;
      const auto result = quilted(source, options);
      CHECK(result.columns == 8);
      CHECK(result.rows == 6);
      int wrong = 0;
      for (int y = 0; y < options.size.height; ++y)
        for (int x = 0; x < options.size.width; ++x) {
          const auto& place = plain.places.at<cv::Vec2i>(y, x);
          wrong += result.map.at(x, y) == dytex::SourcePixel{0, place[0], place[1]} ? 0 : 1;
        }
      CHECK(wrong == 0);
    }
  }
}

TEST_CASE("quilting takes the only place that fits") {
  // A source that is nowhere like itself, and a block that ends where another place of it goes on.
  const auto clip = made_lapse({40, 40}, 1, CV_8UC3, 9);
  const auto source = held(clip);
  dytex::QuiltOptions options;
  options.size = {40, 16};
  options.block = {16, 16};
  options.overlap = 4;
  options.tolerance = 0, options.floor = 0;
  const auto result = quilted(source, options);
  for (const auto& choice : result.choices)
    if (choice.column > 0 && choice.error == 0) CHECK(choice.continues);
  CHECK(result.choices[1].equals == 1);
}
