// SPDX-License-Identifier: Apache-2.0
#include "dytex/quilting/render.hpp"

#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <string>
#include <tuple>

#include <opencv2/imgproc.hpp>

#include "core/error.hpp"
#include "core/rng.hpp"
#include "dytex/quilting/flatten.hpp"
#include "dytex/quilting/quilt_measures.hpp"
#include "tests/dytex/quilting/quilt_make.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/messages.hpp"

using namespace emberfold;
using namespace emberfold::test;
using dytex::ClipEnds;

namespace {

// Every output pixel is another source pixel, all in disorder.
dytex::QuiltMap shuffled_map(cv::Size output, cv::Size source) {
  core::Rng rng(7);
  dytex::QuiltMap map{output, {}};
  for (int i = 0; i < output.area(); ++i)
    map.pixels.push_back({0, static_cast<int>(rng.below(static_cast<std::uint32_t>(source.width))),
                          static_cast<int>(rng.below(static_cast<std::uint32_t>(source.height)))});
  return map;
}

bool same(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0;
}

double shown(double time, int frames, ClipEnds ends) {
  const auto moment = dytex::frame_time(time, frames, ends);
  CHECK((moment.before >= 0 && moment.before < frames && moment.after >= 0 && moment.after < frames));
  CHECK((moment.weight >= 0 && moment.weight < 1));
  if (moment.weight == 0) CHECK(moment.before == moment.after);
  return (1 - moment.weight) * moment.before + moment.weight * moment.after;
}

}  // namespace

TEST_CASE("moments fall where the clip and its ends say") {
  CHECK(shown(3.25, 10, ClipEnds::clamp) == 3.25);
  CHECK(shown(-2, 10, ClipEnds::clamp) == 0);
  CHECK(shown(12.5, 10, ClipEnds::clamp) == 9);
  CHECK(shown(12.5, 10, ClipEnds::loop) == 2.5);
  CHECK(shown(-1, 10, ClipEnds::loop) == 9);
  CHECK_THAT(shown(9.75, 10, ClipEnds::loop), WithinAbs(0.25 * 9, 1e-12));  // from the last to the first
  CHECK(shown(10, 10, ClipEnds::ping_pong) == 8);
  CHECK(shown(-1.5, 10, ClipEnds::ping_pong) == 1.5);
  CHECK(shown(18, 10, ClipEnds::ping_pong) == 0);
  for (const auto ends : {ClipEnds::clamp, ClipEnds::loop, ClipEnds::ping_pong}) {
    CHECK(shown(123.4, 1, ends) == 0);
    for (int t = 0; t < 7; ++t) CHECK(shown(t, 7, ends) == t);
    for (double t = -40; t < 40; t += 0.37) CHECK(std::isfinite(shown(t, 5, ends)));
  }
}

TEST_CASE("a rate of 1 copies and a rate of 0 freezes") {
  const int type = GENERATE(CV_8UC1, CV_16UC3, CV_32FC3);
  const auto clip = made_lapse({20, 18}, 23, type, 3, 0.1);
  const auto source = held(clip);
  const auto map = shuffled_map({31, 25}, source.size());
  const std::vector<const dytex::Trajectories*> sources{&source};
  dytex::TimeControl control;
  const auto plain = dytex::render_quilt(map, sources, control, 0, 23);
  control.rate = cv::Mat::ones(map.size, CV_32F);
  control.offset = cv::Mat::zeros(map.size, CV_32F);
  const auto one = dytex::render_quilt(map, sources, control, 0, 23);
  control.rate.setTo(0);
  const auto frozen = dytex::render_quilt(map, sources, control, 0, 23);
  for (std::size_t t = 0; t < plain.size(); ++t) {
    CHECK(same(plain[t], one[t]));
    CHECK(same(frozen[t], plain[0]));
    int wrong = 0;
    for (int y = 0; y < map.size.height; ++y)
      for (int x = 0; x < map.size.width; ++x)
        wrong += std::memcmp(plain[t].ptr(y, x), clip.frames[t].ptr(map.at(x, y).y, map.at(x, y).x),
                             plain[t].elemSize()) == 0
                     ? 0
                     : 1;
    CHECK(wrong == 0);
  }
  // Frames that are drawn alone are the same.
  CHECK(same(dytex::render_quilt(map, sources, {}, 17, 1).front(), plain[17]));
}

TEST_CASE("a pixel shows the time that rate and offset tell") {
  const auto clip = made_lapse({12, 10}, 30, CV_32FC1, 3);
  const auto source = held(clip);
  const auto map = shuffled_map({12, 9}, source.size());
  dytex::TimeControl control;
  control.rate.create(map.size, CV_32F);
  control.offset.create(map.size, CV_32F);
  for (int i = 0; i < map.size.area(); ++i) {
    control.rate.ptr<float>()[i] = static_cast<float>(i) / 64;
    control.offset.ptr<float>()[i] = static_cast<float>(i % 7) - 2.5F;
  }
  const std::vector<const dytex::Trajectories*> sources{&source};
  const auto frame = dytex::render_quilt(map, sources, control, 11, 1).front();
  for (int y = 0; y < map.size.height; ++y)
    for (int x = 0; x < map.size.width; ++x) {
      const double time = std::clamp(11 * static_cast<double>(control.rate.at<float>(y, x)) -
                                         static_cast<double>(control.offset.at<float>(y, x)),
                                     0.0, 29.0);
      const auto before = static_cast<std::size_t>(time), after = std::min<std::size_t>(before + 1, 29);
      const cv::Point from(map.at(x, y).x, map.at(x, y).y);
      const double u = time - static_cast<double>(before);
      const double expected = (1 - u) * static_cast<double>(clip.frames[before].at<float>(from)) +
                              u * static_cast<double>(clip.frames[after].at<float>(from));
      CHECK_THAT(static_cast<double>(frame.at<float>(y, x)), WithinAbs(expected, 1e-6));
    }
}

TEST_CASE("a stream draws what whole trajectories draw") {
  const auto clip = made_lapse({20, 18}, 40, CV_8UC3, 3, 0.05);
  const auto source = held(clip);
  const auto map = shuffled_map({31, 25}, source.size());
  dytex::TimeControl control;
  SECTION("plain") {}
  SECTION("half as fast, and later to the right") {
    control.rate = cv::Mat(map.size, CV_32F, cv::Scalar(0.5));
    control.offset = cv::Mat(map.size, CV_32F);
    for (int x = 0; x < map.size.width; ++x) control.offset.col(x).setTo(0.3 * x);
  }
  SECTION("faster than the clip lasts") {
    control.rate = cv::Mat(map.size, CV_32F, cv::Scalar(2.75));
    control.rate.row(3).setTo(0.1);
  }
  SECTION("jitter") {
    control.offset = dytex::time_jitter(map.size, {8, 8}, 3, 1);
  }
  const std::vector<const dytex::Trajectories*> sources{&source};
  REQUIRE(dytex::streamable(control, 40));
  core::ClipSource frames(clip);
  dytex::QuiltStream stream(map, {&frames}, control);
  const auto whole = dytex::render_quilt(map, sources, control, 0, 40);
  for (const auto& frame : whole) {
    CHECK(same(stream.next(), frame));
    CHECK_FALSE((stream.ended() && control.plain()));
  }
}

TEST_CASE("what a stream cannot hold is known") {
  dytex::TimeControl control;
  CHECK(dytex::streamable(control, 1000) == 3);
  control.rate = cv::Mat::ones(4, 4, CV_32F);
  control.rate.at<float>(1, 1) = 0;
  CHECK(*dytex::streamable(control, 1000) > 900);
  control.rate.at<float>(1, 1) = -1;
  CHECK_FALSE(dytex::streamable(control, 1000));
  control.rate.at<float>(1, 1) = 1;
  control.ends = ClipEnds::loop;
  CHECK_FALSE(dytex::streamable(control, 1000));
}

TEST_CASE("control maps of another size or with NaN are refused") {
  dytex::TimeControl control;
  control.rate = cv::Mat::ones(4, 5, CV_32F);
  const auto refused = [&] { return test::message_of<core::InputError>([&] { control.validate({5, 4}); }); };
  CHECK(refused().empty());
  control.rate.at<float>(2, 3) = std::numeric_limits<float>::quiet_NaN();
  CHECK_THAT(refused(), Contains("rate") && Contains("not a number") && Contains("3,2"));
  control.rate = cv::Mat::ones(4, 6, CV_32F);
  CHECK_THAT(refused(), Contains("6x4") && Contains("5x4"));
  control.rate.release();
  control.offset = cv::Mat(4, 5, CV_32F, cv::Scalar(2e6));
  CHECK_THAT(refused(), Contains("offset") && Contains("1000000"));
}

TEST_CASE("jitter stays in its range and varies smoothly") {
  const cv::Mat field = dytex::time_jitter({90, 70}, {16, 12}, 5, 3);
  double least = 0, most = 0;
  cv::minMaxLoc(field, &least, &most);
  CHECK(least >= -5);
  CHECK(most <= 5);
  CHECK(most - least > 2);
  for (int y = 0; y < 70; ++y)
    for (int x = 1; x < 90; ++x)
      CHECK(std::abs(field.at<float>(y, x) - field.at<float>(y, x - 1)) < 10.0F / 16);
  CHECK(same(field, dytex::time_jitter({90, 70}, {16, 12}, 5, 3)));
  CHECK_FALSE(same(field, dytex::time_jitter({90, 70}, {16, 12}, 5, 4)));
}

TEST_CASE("flattening takes a gradient away and leaves detail and brightness") {
  for (const int depth : {CV_8U, CV_16U}) {
    const double white = depth == CV_8U ? 255 : 65535;
    cv::Mat frame(96, 128, CV_MAKETYPE(depth, 1)), detail(96, 128, CV_64F);
    for (int y = 0; y < 96; ++y)
      for (int x = 0; x < 128; ++x) {
        detail.at<double>(y, x) = 0.08 * white * std::sin(1.1 * x) * std::cos(0.9 * y);
        const double value = white * (0.3 + 0.4 * x / 127.0) + detail.at<double>(y, x);
        if (depth == CV_8U)
          frame.at<std::uint8_t>(y, x) = cv::saturate_cast<std::uint8_t>(value);
        else
          frame.at<std::uint16_t>(y, x) = cv::saturate_cast<std::uint16_t>(value);
      }
    const core::ClipInfo info{128, 96, 1, depth, 25, white, 1};
    const cv::Mat flat = dytex::flatten(frame, info, 12);
    CHECK(flat.type() == frame.type());
    CHECK_THAT(cv::mean(flat)[0], WithinAbs(cv::mean(frame)[0], 0.005 * white));
    cv::Mat left;
    flat.convertTo(left, CV_64F);
    left -= detail + cv::mean(flat)[0];
    CHECK(cv::norm(left(cv::Rect(20, 20, 88, 56)), cv::NORM_INF) < 0.02 * white);
  }
}

TEST_CASE("flattening leaves no halo around a large thing") {
  cv::Mat frame(256, 256, CV_32F);
  core::Rng rng(3);
  for (float& level : cv::Mat1f(frame)) level = static_cast<float>(40 * rng.normal());
  cv::GaussianBlur(frame, frame, {}, 1.5);
  const cv::Point middle(128, 128);
  const auto ring = [&](int from, int to) {
    cv::Mat mask = cv::Mat::zeros(frame.size(), CV_8U);
    cv::circle(mask, middle, to, 255, -1);
    cv::circle(mask, middle, from, 0, -1);
    return mask;
  };
  frame += 120;
  const cv::Mat texture = frame.clone();
  frame.setTo(60, ring(0, 50));
  const cv::Mat flat = dytex::flatten(frame, {256, 256, 1, CV_32F, 25, 255, 1}, 20);
  const double near = cv::mean(flat, ring(54, 64))[0], far = cv::mean(flat, ring(95, 120))[0];
  CHECK(std::abs(near - far) < 4);  // less a Gaussian mean it is 15
  cv::Scalar mean, before, after;
  cv::meanStdDev(texture, mean, before, ring(80, 120));
  cv::meanStdDev(flat, mean, after, ring(80, 120));
  CHECK(after[0] > 0.87 * before[0]);
  // and a frame without anything in it stays as it is
  const cv::Mat plain(40, 50, CV_8UC3, cv::Scalar(10, 90, 200));
  CHECK(same(dytex::flatten(plain, {50, 40, 3, CV_8U, 25, 255, 1}, 8), plain));
}

TEST_CASE("a map survives its array and other arrays are refused") {
  const auto map = shuffled_map({5, 4}, {20, 18});
  const std::vector<cv::Size> sizes{{20, 18}};
  CHECK(dytex::quilt_map(dytex::to_array(map), sizes) == map);
  const auto refused = [&](const core::NpyArray& array) {
    return test::message_of<core::InputError>([&] { dytex::quilt_map(array, sizes); });
  };
  auto array = dytex::to_array(map);
  std::get<std::vector<std::int32_t>>(array.data)[4] = 20;
  CHECK_THAT(refused(array), Contains("pixel 1,0") && Contains("20x18"));
  std::get<std::vector<std::int32_t>>(array.data)[3] = 1;
  CHECK_THAT(refused(array), Contains("source 1"));
  CHECK_THAT(refused({{4, 5}, false, std::vector<std::int32_t>(20)}), Contains("height x width x 3"));
  CHECK_THAT(refused({{2, 2, 3}, false, std::vector<float>(12)}), Contains("int32"));
}

TEST_CASE("measures of a quilt count every block but the first, and every pixel that shows at any time") {
  core::Clip clip{{8, 2, 1, CV_8U, 25, 255, 4}, {}};
  for (int t = 0; t < 4; ++t) clip.frames.push_back(cv::Mat(2, 8, CV_8UC1, cv::Scalar(10 * t)));
  const auto source = held(clip);
  const std::vector<const dytex::Trajectories*> sources{&source};
  // Four of sixteen pixels from the first frame on; from frame 2 on two of them are others.
  dytex::QuiltMap map{{4, 1}, {}};
  for (int x = 0; x < 4; ++x) map.pixels.push_back({0, x, 0});
  map.changes = {{2, {0, 6, 1}}, {2, {0, 7, 1}}};
  map.change_ends = {0, 0, 1, 2};
  map.frames = 4;
  std::vector<dytex::QuiltChoice> choices(4);
  choices[1].column = 1, choices[1].continues = true;
  choices[2].row = 1;
  choices[3].column = choices[3].row = 1, choices[3].continues = true;
  const auto measures = dytex::measure_quilt(map, choices, sources);
  CHECK_THAT(measures.verbatim_blocks, WithinAbs(2 / 3.0, 1e-12));
  CHECK_THAT(measures.source_share, WithinAbs(6 / 16.0, 1e-12));
  CHECK_THAT(measures.change_share, WithinAbs(2 / 12.0, 1e-12));  // of three steps in time
}

TEST_CASE("jitter goes both ways, by the seed") {
  const auto field = dytex::time_jitter({200, 150}, {8, 6}, 10, 3);
  double least = 0, most = 0;
  cv::minMaxLoc(field, &least, &most);
  CHECK(least < -3);
  CHECK(most > 3);
  CHECK(std::abs(cv::mean(field)[0]) < 1);
  CHECK(cv::norm(field, dytex::time_jitter({200, 150}, {8, 6}, 10, 4), cv::NORM_INF) > 1);
}

TEST_CASE("measures of a quilt tell copies from seams") {
  core::Clip clip{{40, 40, 1, CV_8U, 25, 255, 3}, {}};
  for (int t = 0; t < 3; ++t) {
    cv::Mat frame(40, 40, CV_8U);
    for (int x = 0; x < 40; ++x) frame.col(x).setTo(2 * x);
    clip.frames.push_back(frame);
  }
  const auto source = held(clip);
  const std::vector<const dytex::Trajectories*> sources{&source};
  dytex::QuiltMap map{{20, 10}, {}};
  for (int y = 0; y < 10; ++y)
    for (int x = 0; x < 20; ++x) map.pixels.push_back({0, x < 12 ? x : x + 8, y});
  const auto measures = dytex::measure_quilt(map, {}, sources);
  CHECK_THAT(measures.largest_piece, WithinAbs(0.6, 1e-12));
  CHECK_THAT(measures.source_share, WithinAbs(200.0 / 1600, 1e-12));
  CHECK_THAT(measures.seam_share, WithinAbs(10.0 / (19 * 10 + 20 * 9), 1e-12));
  CHECK_THAT(measures.seam_step, WithinAbs(18, 1e-4));
  CHECK_THAT(measures.other_step, WithinAbs(2.0 * 180 / 360, 1e-4));
  CHECK_THAT(measures.seam_ratio(), WithinAbs(18, 1e-3));
}
