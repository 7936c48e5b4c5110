// SPDX-License-Identifier: Apache-2.0
#include "apps/pictures/still.hpp"

#include <opencv2/imgcodecs.hpp>

#include "tests/support/catch.hpp"
#include "tests/support/clip_fixture.hpp"

using namespace emberfold;
using namespace emberfold::apps;
using namespace emberfold::test;

TEST_CASE("base64 of RFC 4648's own examples") {
  const auto of = [](const std::string& text) {
    return base64({reinterpret_cast<const unsigned char*>(text.data()), text.size()});
  };
  CHECK(of("").empty());
  CHECK(of("f") == "Zg==");
  CHECK(of("fo") == "Zm8=");
  CHECK(of("foo") == "Zm9v");
  CHECK(of("foob") == "Zm9vYg==");
  CHECK(of("fooba") == "Zm9vYmE=");
  CHECK(of("foobar") == "Zm9vYmFy");
  CHECK(of(std::string("\xff\xfe\xfd\x00", 4)) == "//79AA==");
}

TEST_CASE("a still keeps to its bytes, even of noise, and to its longest side") {
  const cv::Mat noise = noise_frame({1280, 720}, CV_8UC3, 1);
  for (const std::size_t most : {4096U, 20'000U, 300'000U}) {
    const Still still = make_still(noise, 640, most);
    CHECK(still.jpeg.size() <= most);
    const cv::Mat back = cv::imdecode(still.jpeg, cv::IMREAD_COLOR);
    CHECK(back.cols == still.width);
    CHECK(back.rows == still.height);
    CHECK(still.width <= 640);
    CHECK(std::abs(double(still.width) / still.height - 16.0 / 9) < 0.1);
  }
  const Still small = make_still(noise_frame({2, 2}, CV_8UC3, 1), 640, 4096);
  CHECK(small.width == 2);  // never enlarged
}

TEST_CASE("numbers are spread evenly, with both ends") {
  std::vector<int> numbers;
  for (int i = 0; i < 1000; ++i) numbers.push_back(3 * i);
  const auto some = spread_evenly(numbers, 7);
  REQUIRE(some.size() == 7);
  CHECK(some.front() == 0);
  CHECK(some.back() == 2997);
  for (std::size_t i = 1; i < some.size(); ++i) CHECK(std::abs(some[i] - some[i - 1] - 2997 / 6) <= 3);
  CHECK(spread_evenly(numbers, 5000) == numbers);
  CHECK(spread_evenly(numbers, 0).empty());
  CHECK(spread_evenly(numbers, 1).size() == 1);
  CHECK(spread_evenly({}, 3).empty());
}
