// SPDX-License-Identifier: Apache-2.0
#include "core/io/reading/mask_clip.hpp"

#include <string>
#include <vector>

#include <opencv2/imgcodecs.hpp>

#include "tests/support/catch.hpp"
#include "tests/support/clip_fixture.hpp"

using namespace emberfold;
using namespace emberfold::test;

TEST_CASE("a pixel of a mask counts above half of the brightest value so far, anew in every pass") {
  const TempFolder temp;
  fs::create_directory(temp / "masks");
  const std::vector<std::vector<int>> levels{
      {0, 0, 0, 0}, {0, 40, 50, 51}, {100, 102, 40, 60}, {0, 52, 255, 127}};
  for (std::size_t t = 0; t < levels.size(); ++t) {
    cv::Mat1b frame(3, 4);
    for (int x = 0; x < 4; ++x) frame.col(x).setTo(levels[t][static_cast<std::size_t>(x)]);
    cv::imwrite((temp / "masks").string() + "/m" + std::to_string(t) + ".png", frame);
  }
  io::ReadOptions options;
  options.mask = (temp / "masks").string();
  io::MaskClip mask(options, {4, 3});
  const std::vector<std::vector<bool>> counts{{false, false, false, false},
                                              {false, true, true, true},
                                              {true, true, false, true},
                                              {false, false, true, false}};
  for (int pass = 0; pass < 2; ++pass) {
    for (const auto& expected : counts) {
      const cv::Mat found = mask.next();
      for (int x = 0; x < 4; ++x)
        for (int y = 0; y < 3; ++y)
          CHECK(found.at<std::uint8_t>(y, x) == (expected[static_cast<std::size_t>(x)] ? 255 : 0));
    }
    mask.rewind();
  }
}
