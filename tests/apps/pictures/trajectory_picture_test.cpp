// SPDX-License-Identifier: Apache-2.0
#include "apps/pictures/trajectory_picture.hpp"

#include <opencv2/core.hpp>

#include "apps/pictures/draw.hpp"
#include "graph/events/events.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/drawn_motion.hpp"

using namespace emberfold;
using namespace emberfold::apps;
using namespace emberfold::test;

namespace {

/// Number of pixels, above the legend, that have nearly the colour of an event's marks.
int marked(const cv::Mat& picture, graph::EventType type) {
  const Colour c = event_colour(type);
  const cv::Scalar bgr(c.blue, c.green, c.red);
  cv::Mat mask;
  cv::inRange(picture.rowRange(0, 590), bgr - cv::Scalar::all(28), bgr + cv::Scalar::all(28), mask);
  return cv::countNonZero(mask);
}

}  // namespace

TEST_CASE("trajectories show strokes, and marks of the events that are likely") {
  const auto motion = made_motion(made_strokes(9, 160, 120, 30), 160, 120, 30);
  auto events = graph::stroke_events(motion);
  REQUIRE(events.size() > 5);
  const cv::Mat plain = draw_trajectories(motion, {}), with_marks = draw_trajectories(motion, events);
  CHECK(plain.type() == CV_8UC3);
  CHECK((plain.cols == 1400 && plain.size() == with_marks.size()));
  const auto type = events[0].type;
  CHECK(marked(with_marks, type) > marked(plain, type) + 50);
  for (auto& event : events) event.probability = 0.4;
  CHECK(cv::norm(draw_trajectories(motion, events), plain, cv::NORM_INF) == 0);
}

TEST_CASE("trajectories of clips without strokes, or of one frame, are drawn too") {
  graph::MotionGraph motion;
  motion.sketch.width = motion.sketch.height = 2;
  motion.sketch.frames.resize(1);
  motion.links.resize(1);
  const cv::Mat none = draw_trajectories(motion, {});
  CHECK(none.cols == 1400);
  const auto strokes = made_motion(made_strokes(9, 160, 120, 30), 160, 120, 30);
  CHECK(cv::norm(none, draw_trajectories(strokes, {}), cv::NORM_L1) > 0);
}
