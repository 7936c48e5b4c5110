// SPDX-License-Identifier: Apache-2.0
#include "pipeline/footage/copied_share.hpp"

#include <vector>

#include <opencv2/core.hpp>

#include "tests/support/catch.hpp"

using namespace emberfold;

TEST_CASE("copied share: a pixel is copied if all of its channels are, and of one frame") {
  const cv::Size size(20, 10);
  const std::vector<cv::Mat> footage{cv::Mat(size, CV_8UC3, cv::Scalar(50, 100, 150)),
                                     cv::Mat(size, CV_8UC3, cv::Scalar(90, 40, 150))};
  const cv::Mat1b moves(size, std::uint8_t{255});
  const auto share = [&](const cv::Mat& frame) {
    pipeline::CopiedShare copied(footage, moves);
    copied.add(frame);
    return copied.mean();
  };
  CHECK(share(footage[0]) == 1);
  CHECK(share(cv::Mat(size, CV_8UC3, cv::Scalar(52, 98, 150))) == 1);  // through a codec
  for (const auto& level : {cv::Scalar(60, 100, 150), cv::Scalar(50, 110, 150), cv::Scalar(50, 100, 140)})
    CHECK(share(cv::Mat(size, CV_8UC3, level)) == 0);
  cv::Mat both = footage[0].clone();
  footage[1].colRange(0, 5).copyTo(both.colRange(0, 5));
  CHECK(share(both) == 0.75);  // a quarter is of another frame
}
