// SPDX-License-Identifier: Apache-2.0
#include "apps/pictures/rate_map.hpp"

#include <opencv2/imgproc.hpp>

#include "tests/support/catch.hpp"
#include "tests/support/drawn_models.hpp"

using namespace emberfold;
using namespace emberfold::apps;
using namespace emberfold::test;

namespace {

graph::Event event(graph::EventType type, graph::Point place, double probability = 1) {
  graph::Event e;
  e.frame = 1, e.type = type, e.position = place, e.probability = probability;
  return e;
}

double difference(const cv::Mat& a, const cv::Mat& b) {
  return cv::norm(a, b, cv::NORM_L1);
}

}  // namespace

TEST_CASE("a smooth map goes through the cells' values and keeps between them") {
  const auto map = made_map(100, 70, 16, 1, 3);  // the last cells reach beyond the frame
  for (const double scale : {1.0, 3.0}) {
    const cv::Mat1f field = smooth_map(map, {100, 70}, scale);
    REQUIRE(field.size() == cv::Size(cvRound(100 * scale), cvRound(70 * scale)));
    for (int row = 0; row < map.rows - 1; ++row)
      for (int column = 0; column < map.columns - 1; ++column) {
        // the middle of a cell lies between picture pixels where their number is even
        const double x = (column + 0.5) * 16 * scale - 0.5, y = (row + 0.5) * 16 * scale - 0.5;
        double mean = 0;
        for (const double u : {std::floor(x), std::ceil(x)})
          for (const double v : {std::floor(y), std::ceil(y)})
            mean += double{field(static_cast<int>(v), static_cast<int>(u))} / 4;
        CHECK_THAT(mean, WithinAbs(map.values[static_cast<std::size_t>(row * map.columns + column)],
                                   scale > 1 ? 0.01 : 0.08));
      }
    double low = 0, high = 0;
    cv::minMaxLoc(field, &low, &high);
    CHECK(low >= *std::ranges::min_element(map.values) - 1e-6);
    CHECK(high <= *std::ranges::max_element(map.values) + 1e-6);
  }
}

TEST_CASE("a map is strong where its rate is high") {
  auto model = made_model(320, 240, 16);
  auto& values = model.rates.birth.values;
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = i % 20 < 10 ? 0 : 2e-5;
  const cv::Mat under(240, 320, CV_8UC3, cv::Scalar(90, 90, 90));
  const cv::Mat picture = draw_rate_map(under, birth_map(model), {});
  CHECK(picture.type() == CV_8UC3);
  CHECK(picture.cols == 640);
  CHECK(picture.rows > 480);
  CHECK(picture.rows % 2 == 0);
  const auto none = cv::mean(picture(cv::Rect(10, 10, 280, 460))),
             strong = cv::mean(picture(cv::Rect(350, 10, 280, 460)));
  CHECK_THAT(none[2], WithinAbs(0.55 * 90 + 16, 1.5));  // as it is, dimmed
  CHECK(strong[2] > none[2] + 100);
  // nothing to show: nothing but the frame, and no division by zero
  std::ranges::fill(values, 0.0);
  const auto empty = cv::mean(draw_rate_map(under, birth_map(model), {})(cv::Rect(0, 0, 640, 480)));
  CHECK_THAT(empty[0], WithinAbs(0.55 * 90 + 16, 1.5));
}

TEST_CASE("a map of ratios is clear at 1, warm above and cold below") {
  auto model = made_model(320, 240, 16);
  auto& values = model.rates.death.values;
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = i % 20 < 6 ? 0.5 : i % 20 < 14 ? 1 : 2;
  const cv::Mat picture =
      draw_rate_map(cv::Mat(240, 320, CV_8UC3, cv::Scalar(90, 90, 90)), death_map(model), {});
  const auto cold = cv::mean(picture(cv::Rect(10, 10, 140, 460))),
             clear = cv::mean(picture(cv::Rect(250, 10, 140, 460))),
             warm = cv::mean(picture(cv::Rect(490, 10, 140, 460)));
  for (int c = 0; c < 3; ++c) CHECK_THAT(clear[c], WithinAbs(0.55 * 90 + 16, 1.5));
  CHECK(cold[0] > cold[2] + 30);
  CHECK(warm[2] > warm[0] + 30);
  CHECK(rate_colour(0.3) != rate_colour(-0.3));
}

TEST_CASE("dots are the map's own events of probability a half or more, where they are") {
  const auto model = made_model(320, 240, 16);
  const cv::Mat under(240, 320, CV_8UC3, cv::Scalar(40, 60, 90));
  const cv::Mat plain = draw_rate_map(under, birth_map(model), {});
  const auto with = [&](const graph::Event& e) { return draw_rate_map(under, birth_map(model), {&e, 1}); };
  const cv::Mat one = with(event(graph::EventType::birth, {100, 50}));
  const Placement place{2, {}};
  const cv::Point at(cvRound(place({100, 50}).x), cvRound(place({100, 50}).y));
  CHECK(one.at<cv::Vec3b>(at) == cv::Vec3b(255, 255, 255));
  cv::Mat elsewhere = one.clone();
  plain(cv::Rect(at.x - 6, at.y - 6, 13, 13)).copyTo(elsewhere(cv::Rect(at.x - 6, at.y - 6, 13, 13)));
  CHECK(difference(elsewhere.rowRange(0, 480), plain.rowRange(0, 480)) == 0);
  CHECK(difference(one.rowRange(480, one.rows), plain.rowRange(480, plain.rows)) > 0);  // their number
  CHECK(difference(with(event(graph::EventType::death, {100, 50})), plain) == 0);
  CHECK(difference(with(event(graph::EventType::birth, {100, 50}, 0.49)), plain) == 0);
  CHECK(difference(with(event(graph::EventType::birth, {100, 50}, 0.5)), one) == 0);
}

TEST_CASE("maps of the smallest and of tall frames have a legend that fits") {
  for (const cv::Size size : {cv::Size(2, 2), {641, 481}, {60, 400}}) {
    const auto model = made_model(size.width, size.height, 16);
    const cv::Mat under(size, CV_8UC3, cv::Scalar::all(100));
    for (const auto& what : {birth_map(model), death_map(model)}) {
      const cv::Mat picture = draw_rate_map(under, what, {});
      CHECK(picture.cols >= 480);
      CHECK(picture.rows > picture.cols * size.height / size.width);
    }
  }
}
