// SPDX-License-Identifier: Apache-2.0
#include "core/io/reading/mask_clip.hpp"

#include <string>
#include <vector>

#include <opencv2/imgcodecs.hpp>

#include "core/io/mask_file.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/clip_fixture.hpp"
#include "tests/support/messages.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

/// Writes masks m0, m1, … of 4 x 3 px whose columns have these values.
void write_masks(const fs::path& folder, const std::string& extension,
                 const std::vector<std::vector<int>>& values) {
  fs::create_directories(folder);
  for (std::size_t t = 0; t < values.size(); ++t) {
    cv::Mat1b frame(24, 32);
    for (int x = 0; x < 4; ++x)
      frame.colRange(8 * x, 8 * x + 8).setTo(values[t][static_cast<std::size_t>(x)]);
    cv::imwrite((folder / ("m" + std::to_string(t) + extension)).string(), frame);
  }
}

void check_columns(const cv::Mat& found, const std::vector<bool>& expected) {
  for (int x = 0; x < 4; ++x)
    CHECK(found.at<std::uint8_t>(12, 8 * x + 4) == (expected[static_cast<std::size_t>(x)] ? 255 : 0));
}

}  // namespace

TEST_CASE("a pixel of a mask counts where it is not 0, whatever the largest value") {
  const TempFolder temp;
  write_masks(temp / "masks", ".png", {{0, 0, 0, 0}, {0, 1, 2, 100}, {100, 1, 0, 60}, {0, 52, 255, 127}});
  io::ReadOptions options;
  options.mask = (temp / "masks").string();
  std::vector<std::string> told;
  io::MaskClip mask(options, {32, 24}, [&](const std::string& line) { told.push_back(line); });
  CHECK(told.empty());  // of the first frame alone
  for (int pass = 0; pass < 2; ++pass) {
    check_columns(mask.next(), {false, false, false, false});
    check_columns(mask.next(), {false, true, true, true});
    check_columns(mask.next(), {true, true, false, true});
    check_columns(mask.next(), {false, true, true, true});
    mask.rewind();
  }
}

TEST_CASE("many values in a mask give a warning, and JPEG's small ones are no part of it") {
  const TempFolder temp;
  write_masks(temp / "labels", ".png", {{0, 1, 2, 3}});
  io::ReadOptions options;
  options.mask = (temp / "labels/m0.png").string();
  std::vector<std::string> told;
  io::MaskClip labels(options, {32, 24}, [&](const std::string& line) { told.push_back(line); });
  check_columns(labels.next(), {false, true, true, true});
  REQUIRE(told.size() == 1);
  CHECK(contains(told[0], "m0.png has 3 different values"));
  write_masks(temp / "lossy", ".jpg", {{0, 3, 255, 200}});
  options.mask = (temp / "lossy/m0.jpg").string();
  io::MaskClip lossy(options, {32, 24});
  check_columns(lossy.next(), {false, false, true, true});
}

TEST_CASE("masks of labels count inside wherever a mask is read from an image") {
  const TempFolder temp;
  write_masks(temp / "masks", ".png", {{0, 1, 2, 3}, {0, 1, 128, 255}});
  const auto inside = [&](const char* name) { return io::read_inside((temp / "masks" / name).string()); };
  const auto soft = [&](const char* name) { return io::read_mask((temp / "masks" / name).string()); };
  check_columns(inside("m0.png"), {false, true, true, true});
  check_columns(inside("m1.png"), {false, true, true, true});
  check_columns(soft("m0.png"), {false, true, true, true});
  CHECK(soft("m1.png").at<std::uint8_t>(12, 20) == 128);  // half transparent
}

TEST_CASE("a pixel of a mask counts above half of the brightest value so far, anew in every pass") {
  const TempFolder temp;
  write_masks(temp / "lossy", ".jpg", {{0, 30, 80, 100}, {0, 80, 200, 255}});
  io::ReadOptions options;
  options.mask = (temp / "lossy").string();
  io::MaskClip mask(options, {32, 24});
  for (int pass = 0; pass < 2; ++pass) {
    check_columns(mask.next(), {false, false, true, true});
    check_columns(mask.next(), {false, false, true, true});
    mask.rewind();
  }
}
