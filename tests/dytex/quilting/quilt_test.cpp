// SPDX-License-Identifier: Apache-2.0
#include "dytex/quilting/quilt.hpp"

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <set>
#include <stop_token>
#include <string>
#include <tuple>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "dytex/quilting/quilt_measures.hpp"
#include "dytex/quilting/render.hpp"
#include "tests/dytex/quilting/quilt_make.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/messages.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

dytex::QuiltOptions small_options() {
  dytex::QuiltOptions options;
  options.size = {70, 60};
  options.block = {16, 16};
  options.overlap = 5;
  options.components = 3;
  return options;
}

std::vector<std::tuple<int, int, int, int, int>> places(const dytex::QuiltResult& result) {
  std::vector<std::tuple<int, int, int, int, int>> all;
  for (const auto& c : result.choices) all.emplace_back(c.column, c.row, c.at.source, c.at.x, c.at.y);
  return all;
}

}  // namespace

TEST_CASE("the search in the basis and the exhaustive one choose alike", "[heavy]") {
  // With much grain most of what a trajectory holds is outside of the basis.
  const auto [type, grain] =
      GENERATE(std::tuple(CV_8UC1, 0.0), std::tuple(CV_8UC3, 0.1), std::tuple(CV_16UC1, 0.03),
               std::tuple(CV_16UC3, 0.3), std::tuple(CV_32FC1, 0.02));
  const auto source = held(made_lapse({44, 40}, 37, type, 3, grain));
  auto options = small_options();
  options.overlap = GENERATE(1, 5, 8);
  options.tileable = GENERATE(false, true);
  const auto fast = quilted(source, options);
  CHECK(fast.components == 3);
  options.exact = true;
  const auto slow = quilted(source, options);
  CHECK(places(fast) == places(slow));
  CHECK(fast.map == slow.map);
  std::int64_t compared = 0, all = 0;
  for (std::size_t i = 0; i < fast.choices.size(); ++i) {
    CHECK(fast.choices[i].error == slow.choices[i].error);
    CHECK(fast.choices[i].equals == slow.choices[i].equals);
    compared += fast.choices[i].compared, all += slow.choices[i].compared;
  }
  CHECK(compared <= all);
  if (grain == 0) CHECK(compared < all / 4);
}

TEST_CASE("every pixel of a quilt is a source pixel at all times bit by bit") {
  const int type = GENERATE(CV_8UC3, CV_16UC1, CV_32FC3);
  const auto clip = made_lapse({44, 40}, 37, type, 4, 0.05);
  const auto source = held(clip);
  const auto result = quilted(source, small_options());
  const std::vector<const dytex::Trajectories*> sources{&source};
  const auto frames = dytex::render_quilt(result.map, sources, {}, 0, 37);
  for (std::size_t t = 0; t < frames.size(); ++t) {
    int wrong = 0;
    for (int y = 0; y < result.map.size.height; ++y)
      for (int x = 0; x < result.map.size.width; ++x) {
        const auto& from = result.map.at(x, y);
        const std::size_t bytes = frames[t].elemSize();
        wrong += std::memcmp(frames[t].ptr(y, x), clip.frames[t].ptr(from.y, from.x), bytes) == 0 ? 0 : 1;
      }
    CHECK(wrong == 0);
  }
}

TEST_CASE("a quilt has the same bytes at any number of threads", "[heavy]") {
  const auto source = held(made_lapse({60, 50}, 20, CV_8UC3, 6, 0.05));
  auto options = small_options();
  options.size = {150, 120};
  options.tileable = GENERATE(false, true);
  std::vector<dytex::QuiltResult> results;
  for (const std::size_t threads : {1, 2, 7}) {
    const core::ThreadLimit limit(threads);
    results.push_back(quilted(source, options));
  }
  for (std::size_t i = 1; i < results.size(); ++i) {
    CHECK(results[i].map == results[0].map);
    CHECK(places(results[i]) == places(results[0]));
  }
}

TEST_CASE("a tileable quilt has no worse step at its border than inside") {
  const auto clip = made_lapse({64, 64}, 12, CV_8UC1, 8);
  const auto source = held(clip);
  auto options = small_options();
  options.size = {83, 71};
  const auto border_step = [&](bool tileable) {
    options.tileable = tileable;
    const auto map = quilted(source, options).map;
    CHECK(map.size == options.size);
    const auto at = [&](int x, int y, std::size_t t) {
      const auto& from = map.at(x, y);
      return static_cast<double>(clip.frames[t].at<unsigned char>(from.y, from.x));
    };
    double border = 0, inside = 0;
    for (std::size_t t = 0; t < clip.frames.size(); ++t)
      for (int y = 0; y < map.size.height; ++y) {
        border += std::abs(at(0, y, t) - at(map.size.width - 1, y, t));
        inside += std::abs(at(40, y, t) - at(41, y, t));
      }
    return border / inside;
  };
  CHECK(border_step(true) < 1.5);
  CHECK(border_step(false) > 2.5);
}

TEST_CASE("blocks come from all sources and never from what is forbidden") {
  const auto first = made_lapse({40, 36}, 10, CV_8UC1, 1), second = made_lapse({30, 50}, 10, CV_8UC1, 2);
  const auto one = held(first), two = held(second);
  cv::Mat forbidden = cv::Mat::zeros(two.size(), CV_8U);
  forbidden.rowRange(20, 30).setTo(1);
  const std::vector<dytex::QuiltSource> sources{{&one, {}, {}}, {&two, forbidden, {}}};
  auto options = small_options();
  options.size = {150, 150};
  options.floor = 40;
  const auto result = dytex::quilt(sources, options);
  std::set<int> seen;
  bool above = false, below = false;
  for (const auto& p : result.map.pixels) {
    seen.insert(p.source);
    if (p.source != 1) continue;
    CHECK_FALSE((p.y >= 20 && p.y < 30));
    above = above || p.y < 20, below = below || p.y >= 30;
  }
  CHECK(seen == std::set<int>{0, 1});
  CHECK(above);
  CHECK(below);
}

TEST_CASE("a guide leads blocks to where the source is like it") {
  // The left half of the source is dark, the right half bright; so is the guide, the other way round.
  core::Clip clip{{64, 40, 1, CV_8U, 25, 255, 8}, {}};
  for (int t = 0; t < 8; ++t) {
    cv::Mat frame = made_lapse({64, 40}, 1, CV_8UC1, 3).frames.front() / 8;
    frame.colRange(32, 64) += 150;
    clip.frames.push_back(frame);
  }
  const auto source = held(clip);
  cv::Mat own, guide(60, 70, CV_32F, cv::Scalar(200));
  clip.frames.front().convertTo(own, CV_32F);
  guide.colRange(35, 70).setTo(20);
  const std::vector<dytex::QuiltSource> sources{{&source, {}, own}};
  auto options = small_options();
  options.guide_weight = 0.9;
  const auto fast = dytex::quilt(sources, options, {}, guide);
  int right = 0;
  for (int y = 0; y < 60; ++y)
    for (int x = 0; x < 70; ++x) right += (x < 35) == (fast.map.at(x, y).x >= 32) ? 1 : 0;
  CHECK(right > 0.9 * 60 * 70);
  options.exact = true;
  CHECK(places(dytex::quilt(sources, options, {}, guide)) == places(fast));
}

TEST_CASE("what blocks nearby show is not shown again") {
  const auto source = held(made_lapse({90, 80}, 12, CV_8UC1, 6));
  auto options = small_options();
  options.apart = GENERATE(0, 9);
  const auto result = quilted(source, options);
  int again = 0;
  for (const auto& a : result.choices)
    for (const auto& b : result.choices) {
      const bool near = (a.row == b.row && b.column < a.column && b.column >= a.column - 2) ||
                        (b.row == a.row - 1 && std::abs(b.column - a.column) <= 1);
      if (near && std::abs(a.at.x - b.at.x) < 9 && std::abs(a.at.y - b.at.y) < 9) ++again;
    }
  CHECK((again == 0) == (options.apart == 9));
  options.exact = true;
  CHECK(places(quilted(source, options)) == places(result));
}

TEST_CASE("a source too small to stay apart is quilted all the same") {
  const auto source = held(made_lapse({20, 18}, 3));
  auto options = small_options();
  options.apart = 4096;
  CHECK(quilted(source, options).choices.size() == 30);
}

TEST_CASE("odd input to quilting is defined") {
  auto options = small_options();
  SECTION("a constant source") {
    core::Clip clip{{30, 30, 3, CV_8U, 25, 255, 20}, {}};
    for (int t = 0; t < 20; ++t) clip.frames.emplace_back(30, 30, CV_8UC3, cv::Scalar(9, 90, 200));
    const auto source = held(clip);
    const auto result = quilted(source, options);
    CHECK(result.components == 0);
    for (const auto& choice : result.choices) {
      CHECK(choice.error == 0);
      CHECK(choice.equals == 15 * 15);  // all places
    }
  }
  SECTION("more components than the trajectories have") {
    options.components = 200;
    const auto source = held(made_lapse({30, 30}, 7, CV_8UC3));
    const auto result = quilted(source, options);
    CHECK(result.components == 0);  // compared whole
    options.exact = true;
    CHECK(places(quilted(source, options)) == places(result));
  }
  SECTION("a block as large as the source") {
    options.block = {30, 28};
    const auto source = held(made_lapse({30, 28}, 3));
    for (const auto& choice : quilted(source, options).choices)
      CHECK(choice.at == dytex::SourcePixel{0, 0, 0});
  }
  SECTION("an output smaller than a block") {
    options.size = {3, 1};
    const auto result = quilted(held(made_lapse({30, 28}, 3)), options);
    CHECK(result.choices.size() == 1);
    CHECK(result.map.pixels.size() == 3);
  }
}

TEST_CASE("quilting refuses what cannot be in one line") {
  const auto source = held(made_lapse({30, 28}, 3));
  auto options = small_options();
  const auto refused = [&] { return test::message_of<core::InputError>([&] { quilted(source, options); }); };
  SECTION("block") {
    options.block = {32, 16};
    CHECK_THAT(refused(), Contains("block is 32x16") && Contains("30x28"));
  }
  SECTION("overlap") {
    options.overlap = 9;
    CHECK_THAT(refused(), Contains("overlap is 9") && Contains("1 to 8"));
  }
  SECTION("no overlap") {
    options.overlap = 0;
    CHECK_THAT(refused(), Contains("overlap is 0"));
  }
  SECTION("size") {
    options.size = {0, 5};
    CHECK_THAT(refused(), Contains("size is 0x5"));
  }
  SECTION("components") {
    options.components = 0;
    CHECK_THAT(refused(), Contains("components is 0") && Contains("1 to 256"));
  }
  SECTION("tolerance") {
    options.tolerance = std::nan("");
    CHECK_THAT(refused(), Contains("tolerance is not finite"));
  }
  SECTION("a torus too small") {
    options.tileable = true;
    options.size = {9, 40};
    CHECK_THAT(refused(), Contains("9x40") && Contains("at least 10"));
  }
  SECTION("a mask that forbids everything") {
    cv::Mat all(28, 30, CV_8U, cv::Scalar(0));
    all.at<unsigned char>(14, 15) = 1;  // in every block
    const std::vector<dytex::QuiltSource> sources{{&source, all, {}}};
    CHECK_THAT(test::message_of<core::InputError>([&] { dytex::quilt(sources, options); }),
               Contains("leaves no place"));
  }
  SECTION("a mask of another size") {
    const std::vector<dytex::QuiltSource> sources{{&source, cv::Mat::zeros(4, 5, CV_8U), {}}};
    CHECK_THAT(test::message_of<core::InputError>([&] { dytex::quilt(sources, options); }),
               Contains("mask 5x4"));
  }
  SECTION("sources that differ") {
    const auto longer = held(made_lapse({30, 28}, 4));
    const std::vector<dytex::QuiltSource> sources{{&source, {}, {}}, {&longer, {}, {}}};
    CHECK_THAT(test::message_of<core::InputError>([&] { dytex::quilt(sources, options); }),
               Contains("4 frames"));
  }
}
