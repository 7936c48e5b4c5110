// SPDX-License-Identifier: Apache-2.0
#include "dytex/quilting/quilt_map.hpp"

#include <string>

#include "core/error.hpp"
#include "dytex/quilting/render.hpp"
#include "tests/dytex/quilting/quilt_make.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/messages.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

const std::vector<cv::Size> kSizes{{8, 6}};

// Two pixels, of which the second changes twice in five frames.
dytex::QuiltMap small_map() {
  return {{2, 1}, {{0, 1, 2}, {0, 3, 4}}, {{2, {0, 5, 1}}, {4, {0, 3, 4}}}, {0, 2}, 5};
}

std::vector<std::int32_t> rows_of(const dytex::QuiltMap& map) {
  return std::get<std::vector<std::int32_t>>(dytex::to_array(map).data);
}

std::string refusal(std::vector<std::int32_t> rows) {
  const std::size_t count = rows.size() / 6;
  return test::message_of<core::InputError>([&] {
    (void)dytex::quilt_map({{count, 6}, false, std::move(rows)}, kSizes);
  });
}

}  // namespace

TEST_CASE("a map whose seams move is written in rows and read again") {
  const auto map = small_map();
  const auto array = dytex::to_array(map);
  CHECK(array.shape == std::vector<std::size_t>{5, 6});
  CHECK(rows_of(map) == std::vector<std::int32_t>{5, 1, 2, 2, 0, 0,  //
                                                  0, 0, 0, 0, 1, 2,  //
                                                  0, 0, 1, 0, 3, 4,  //
                                                  2, 0, 1, 0, 5, 1,  //
                                                  4, 0, 1, 0, 3, 4});
  CHECK(dytex::quilt_map(array, kSizes) == map);
  const std::vector<dytex::SourcePixel> expected{{0, 3, 4}, {0, 3, 4}, {0, 5, 1},
                                                 {0, 5, 1}, {0, 3, 4}, {0, 3, 4}};
  for (int t = 0; t < 6; ++t) {
    CHECK(map.at_frame(1, t) == expected[static_cast<std::size_t>(t)]);
    CHECK(dytex::still_at(map, t).pixels[1] == map.at_frame(1, t));
    CHECK(dytex::still_at(map, t).pixels[0] == dytex::SourcePixel{0, 1, 2});
  }
}

TEST_CASE("a map with wrong rows is refused in one line") {
  const auto changed = [](std::size_t at, std::int32_t value) {
    auto rows = rows_of(small_map());
    rows[at] = value;
    return refusal(rows);
  };
  for (const auto& [at, value] : {std::pair<std::size_t, int>(0, 0), {1, -1}, {2, 1 << 21}, {3, 1}, {4, 7}})
    CHECK(contains(changed(at, value), "first row"));
  CHECK(contains(changed(1, 3), "rows for 6 pixels"));
  CHECK(contains(changed(6, 1), "pixel 0,0 changes at frame 1"));
  CHECK(contains(changed(18, 0), "pixel 1,0 changes at frame 0"));
  CHECK(contains(changed(24, 2), "pixel 1,0 changes at frame 2"));
  CHECK(contains(changed(24, 5), "at most 4"));
  CHECK(contains(changed(8, 1), "pixel 0,0 is missing"));
  CHECK(contains(changed(26, 0), "behind its last pixel"));
  CHECK(contains(changed(21, 1), "names source 1"));
  CHECK(contains(changed(22, 8), "taken from 8,1"));
  CHECK(contains(changed(23, -1), "taken from 5,-1"));
  CHECK(contains(refusal({}), "int32 array"));
  CHECK(contains(refusal({5, 1, 2, 2, 0, 0}), "has 0 rows"));
}

TEST_CASE("pixels change what they copy with the time of the source that they show") {
  const auto clip = made_lapse({8, 6}, 5, CV_8UC1, 2, 0.2);
  const auto source = held(clip);
  const std::vector<const dytex::Trajectories*> sources{&source};
  const auto map = small_map();
  const auto value = [&](int t, int x, int y) {
    return static_cast<int>(clip.frames[static_cast<std::size_t>(t)].at<unsigned char>(y, x));
  };
  const auto frames = dytex::render_quilt(map, sources, {}, 0, 5);
  for (int t = 0; t < 5; ++t) {
    const auto& from = map.at_frame(1, t);
    CHECK(static_cast<int>(frames[static_cast<std::size_t>(t)].at<unsigned char>(0, 1)) ==
          value(t, from.x, from.y));
  }
  // Half way between frames 1 and 2, each as the quilt shows it.
  dytex::TimeControl control;
  control.offset = cv::Mat(1, 2, CV_32F, cv::Scalar(-1.5));
  const auto late = dytex::render_quilt(map, sources, control, 0, 1).front();
  CHECK(static_cast<int>(late.at<unsigned char>(0, 1)) == (value(1, 3, 4) + value(2, 5, 1) + 1) / 2);
  core::ClipSource streamed(clip);
  dytex::QuiltStream stream(map, {&streamed}, control);
  CHECK(static_cast<int>(stream.next().at<unsigned char>(0, 1)) ==
        static_cast<int>(late.at<unsigned char>(0, 1)));
}
