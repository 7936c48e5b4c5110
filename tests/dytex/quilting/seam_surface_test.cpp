// SPDX-License-Identifier: Apache-2.0
#include "dytex/quilting/seam_surface.hpp"

#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include <opencv2/core.hpp>

#include "core/parallel.hpp"
#include "dytex/quilting/quilt_measures.hpp"
#include "dytex/quilting/render.hpp"
#include "dytex/quilting/seam_expansion.hpp"
#include "tests/dytex/quilting/quilt_make.hpp"
#include "tests/support/catch.hpp"

using namespace emberfold;
using namespace emberfold::test;
using namespace emberfold::dytex::detail;

namespace {

// Values of the two places of a source that lie one above the other, `rows` apart.
int level(const core::Clip& clip, int t, int x, int y) {
  return clip.frames[static_cast<std::size_t>(t)].at<unsigned char>(y, x);
}

core::Clip random_clip(cv::Size size, int frames, std::uint64_t seed) {
  core::Clip clip{{size.width, size.height, 1, CV_8U, 25, 255, frames}, {}};
  core::Rng rng(seed);
  for (int t = 0; t < frames; ++t) {
    cv::Mat frame(size, CV_8U);
    for (auto& v : cv::Mat_<unsigned char>(frame)) v = static_cast<unsigned char>(rng.below(60));
    clip.frames.push_back(frame);
  }
  return clip;
}

// The cost of seams of a volume that shows the clip, or `shift` rows below where `taken` says so.
double seam_cost_of(const core::Clip& clip, cv::Size size, int shift, const std::vector<bool>& taken) {
  const int frames = static_cast<int>(clip.frames.size());
  const auto is_taken = [&](int t, int x, int y) -> bool {
    const int pixel = (t * size.height + y) * size.width + x;
    return taken[static_cast<std::size_t>(pixel)];
  };
  const auto shown = [&](int t, int x, int y) {
    return level(clip, t, x, y + (is_taken(t, x, y) ? shift : 0));
  };
  double sum = 0;
  for (int t = 0; t < frames; ++t)
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x)
        for (const auto& [dt, dx, dy] : {std::tuple(1, 0, 0), std::tuple(0, 1, 0), std::tuple(0, 0, 1)}) {
          if (t + dt >= frames || x + dx >= size.width || y + dy >= size.height) continue;
          if (is_taken(t, x, y) == is_taken(t + dt, x + dx, y + dy)) continue;
          const double step = shown(t, x, y) - shown(t + dt, x + dx, y + dy);
          sum += 2 * step * step + 1;
        }
  return sum;
}

double steps_at_seams(const dytex::QuiltMap& map, const dytex::Trajectories& source) {
  const std::vector<const dytex::Trajectories*> sources{&source};
  double sum = 0;
  cv::Mat last;
  for (int t = 0; t < source.frames(); ++t) {
    cv::Mat frame;
    dytex::render_quilt(map, sources, {}, t, 1).front().convertTo(frame, CV_64F);
    const auto square = [](double step) { return 2 * step * step + 1; };
    for (int y = 0; y < map.size.height; ++y)
      for (int x = 0; x < map.size.width; ++x) {
        const std::size_t i = map.index(x, y);
        const double own = frame.at<double>(y, x);
        if (x + 1 < map.size.width && !dytex::continues(map.at_frame(i, t), map.at_frame(i + 1, t), {1, 0}))
          sum += square(own - frame.at<double>(y, x + 1));
        if (y + 1 < map.size.height &&
            !dytex::continues(map.at_frame(i, t), map.at_frame(map.index(x, y + 1), t), {0, 1}))
          sum += square(own - frame.at<double>(y + 1, x));
        if (t > 0 && !(map.at_frame(i, t) == map.at_frame(i, t - 1)))
          sum += square(own - last.at<double>(y, x));
      }
    last = frame;
  }
  return sum;
}

dytex::QuiltOptions moving_options() {
  dytex::QuiltOptions options;
  options.size = {70, 60};
  options.block = {16, 16};
  options.overlap = 5;
  options.components = 3;
  options.apart = 8;
  options.seams = dytex::Seams::moving;
  return options;
}

}  // namespace

TEST_CASE("a move of a seam costs the least of all moves of small volumes") {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    // The middle of three columns is undecided; the left is the old block's, the right the new one's.
    const cv::Size size(4, 3);
    const int frames = 2, shift = 3;
    const auto clip = random_clip({4, 6}, frames, seed);
    const auto source = held(clip);
    const std::vector<dytex::QuiltSource> sources{{&source, {}, {}}};
    std::vector<std::int32_t> shown(12, 0);
    for (std::size_t y = 0; y < 3; ++y) shown[4 * y + 3] = 1;
    BlockCourses courses(size, false, {{{{}, size}, {0, 0, 0}}, {{{}, size}, {0, 0, shift}}}, shown);
    const CourseValues values(sources);
    const SpanBegins begins{0, 1};
    SeamExpansion move(courses, values, {{{}, size}, 2}, 1, begins);
    REQUIRE(move.is_needed());
    move.solve();
    move.write(courses);
    std::vector<bool> found;
    const auto map = courses.map(frames);
    for (int t = 0; t < frames; ++t)
      for (std::size_t i = 0; i < 12; ++i) found.push_back(map.at_frame(i, t).y >= shift);
    double least = std::numeric_limits<double>::max();
    for (unsigned sides = 0; sides < 1U << 12; ++sides) {
      std::vector<bool> taken;
      for (int t = 0; t < frames; ++t)
        for (int y = 0; y < 3; ++y)
          for (int x = 0; x < 4; ++x)
            taken.push_back(x == 3 || (x > 0 && (sides >> (6 * t + 2 * y + x - 1) & 1U) != 0));
      least = std::min(least, seam_cost_of(clip, size, shift, taken));
    }
    CHECK(seam_cost_of(clip, size, shift, found) == least);
  }
}

TEST_CASE("seams that move cost less than seams that stand still") {
  const auto source = held(made_lapse({44, 40}, 37, CV_8UC1, 3, 0.02));
  auto options = moving_options();
  options.tileable = GENERATE(false, true);
  const auto moving = quilted(source, options);
  options.seams = dytex::Seams::still;
  const auto still = quilted(source, options);
  CHECK(still.map.is_still());
  CHECK_FALSE(moving.map.is_still());
  CHECK(steps_at_seams(moving.map, source) < 0.8 * steps_at_seams(still.map, source));
  const std::vector<const dytex::Trajectories*> sources{&source};
  const auto before = dytex::measure_quilt(still.map, {}, sources),
             after = dytex::measure_quilt(moving.map, {}, sources);
  CHECK(after.seam_ratio() < before.seam_ratio());
  CHECK(before.change_share == 0);
  CHECK(after.change_share > 0);
}

TEST_CASE("seams of a source that stands still do not move") {
  auto clip = made_lapse({44, 40}, 1, CV_8UC1, 5, 0.05);
  clip.frames.assign(19, clip.frames.front());
  const auto source = held(clip);
  auto options = moving_options();
  const auto moving = quilted(source, options);
  options.seams = dytex::Seams::still;
  const auto still = quilted(source, options);
  CHECK(moving.map.is_still());
  CHECK(steps_at_seams(moving.map, source) < steps_at_seams(still.map, source));
}

TEST_CASE("seams move alike at any number of threads", "[heavy]") {
  const auto source = held(made_lapse({60, 50}, 20, CV_8UC3, 6, 0.05));
  auto options = moving_options();
  options.size = {150, 120};
  options.tileable = GENERATE(false, true);
  std::vector<dytex::QuiltMap> maps;
  for (const std::size_t threads : {1U, 2U, 7U}) {
    const core::ThreadLimit limit(threads);
    maps.push_back(quilted(source, options).map);
  }
  CHECK(maps[1] == maps[0]);
  CHECK(maps[2] == maps[0]);
}

TEST_CASE("seams that move show nothing that a mask forbids and nothing outside of the source") {
  const int type = GENERATE(CV_8UC1, CV_16UC1, CV_32FC1);
  const auto source = held(made_lapse({60, 50}, 16, type, 7, 0.05));
  cv::Mat forbidden = cv::Mat::zeros(50, 60, CV_8U);
  forbidden(cv::Rect(25, 20, 6, 6)) = 255;
  const std::vector<dytex::QuiltSource> sources{{&source, forbidden, {}}};
  const auto map = dytex::quilt(sources, moving_options()).map;
  int wrong = 0;
  for (int t = 0; t < 16; ++t)
    for (std::size_t i = 0; i < map.pixels.size(); ++i) {
      const auto& from = map.at_frame(i, t);
      const bool inside = from.source == 0 && cv::Rect(0, 0, 60, 50).contains({from.x, from.y});
      wrong += inside && forbidden.at<unsigned char>(from.y, from.x) == 0 ? 0 : 1;
    }
  CHECK(wrong == 0);
  CHECK_FALSE(map.is_still());
}
