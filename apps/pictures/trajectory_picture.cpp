// SPDX-License-Identifier: Apache-2.0
#include "apps/pictures/trajectory_picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "apps/pictures/draw.hpp"

namespace emberfold::apps {

namespace {

constexpr std::size_t kInSpace = 24, kInPlots = 100, kSlices = 40;
constexpr int kWidth = 1400, kHeight = 600;
const cv::Rect kSpaceTime(16, 40, 720, 540);
const std::array<cv::Rect, 2> kCourses{cv::Rect(800, 40, 580, 240), cv::Rect(800, 330, 580, 240)};
const cv::Scalar kFrameInk(206, 200, 196);

/// The centre of a stroke, by frame.
struct StrokeCourse {
  int first = 0;
  std::vector<graph::Point> middles;
};
using StrokeCourses = std::map<std::uint32_t, StrokeCourse>;

StrokeCourses stroke_courses(const graph::MotionGraph& motion) {
  StrokeCourses courses;
  for (std::size_t t = 0; t < motion.sketch.frames.size(); ++t) {
    std::map<std::uint32_t, std::pair<graph::Point, double>> here;
    for (const auto& vertex : motion.sketch.frames[t].vertices()) {
      auto& [sum, count] = here[vertex.subgraph.value];
      sum = sum + vertex.patch.position, ++count;
    }
    for (const auto& [id, middle] : here) {
      const auto [course, is_new] = courses.try_emplace(id);
      if (is_new) course->second.first = static_cast<int>(t);
      course->second.middles.push_back(middle.first * (1 / middle.second));
    }
  }
  return courses;
}

// Returns the spread of the centre about its mean, px.
double spread_of(const StrokeCourse& course) {
  graph::Point sum;
  double squares = 0;
  for (const auto p : course.middles) sum = sum + p, squares += graph::dot(p, p);
  const double share = 1 / static_cast<double>(course.middles.size());
  return std::sqrt(std::max(0.0, share * squares - share * share * graph::dot(sum, sum)));
}

// Returns the strokes that live longest; those that hardly move count less.
std::set<std::uint32_t> telling_strokes(const StrokeCourses& courses, std::size_t most) {
  constexpr double kMoves = 2;  // px
  std::vector<std::pair<double, std::uint32_t>> ranks;
  for (const auto& [id, course] : courses)
    if (course.middles.size() > 1)
      ranks.emplace_back(
          -static_cast<double>(course.middles.size()) * (0.05 + std::min(1.0, spread_of(course) / kMoves)),
          id);
  std::ranges::sort(ranks);
  std::set<std::uint32_t> chosen;
  for (const auto& [rank, id] : ranks)
    if (chosen.size() < most) chosen.insert(id);
  return chosen;
}

bool is_shown(const graph::Event& event, const std::set<std::uint32_t>& strokes) {
  const auto concerned = [&](graph::SubgraphId id) { return strokes.contains(id.value); };
  return event.probability >= 0.5 &&
         (std::ranges::any_of(event.before, concerned) || std::ranges::any_of(event.after, concerned));
}

cv::Scalar bgr_of(std::uint32_t stroke) {
  const Colour colour = stroke_colour(stroke);  // designed for dark frames: darkened on paper
  return {0.78 * colour.blue, 0.78 * colour.green, 0.78 * colour.red};
}

void draw_course(cv::Mat& picture, const std::vector<cv::Point2d>& points, const cv::Scalar& colour) {
  constexpr int kShift = 4;
  std::vector<cv::Point> at;
  for (const auto& p : points)
    at.emplace_back(static_cast<int>(std::lround(p.x * (1 << kShift))),
                    static_cast<int>(std::lround(p.y * (1 << kShift))));
  cv::polylines(picture, at, false, colour, 1, cv::LINE_AA, kShift);
}

/// Projects space and time from the side: x is depth, y down, time to the right.
class SpaceTimeView {
 public:
  SpaceTimeView(int width, int height, std::size_t frames) : width_(width), height_(height) {
    last_ = std::max(1.0, static_cast<double>(frames) - 1);
    constexpr double kDepthX = 0.42, kDepthY = 0.30;
    scale_ =
        std::min(kSpaceTime.height / (height + kDepthY * width), 0.5 * kSpaceTime.width / (kDepthX * width));
    into_ = {kDepthX * scale_, -kDepthY * scale_};
    origin_ = {double(kSpaceTime.x), kSpaceTime.y + kDepthY * scale_ * width};
    pace_ = (kSpaceTime.width - kDepthX * scale_ * width) / last_;
  }

  [[nodiscard]] cv::Point2d operator()(graph::Point p, double t) const {
    return {origin_.x + p.x * into_.x + t * pace_, origin_.y + p.x * into_.y + p.y * scale_};
  }
  [[nodiscard]] double last() const { return last_; }

  /// Draws the edges of the box that all frames fill: those in the back, or with `front` those in front.
  void draw_box(cv::Mat& picture, bool front) const {
    const double w = width_, h = height_;
    const auto edge = [&](graph::Point a, double s, graph::Point b, double t) {
      draw_course(picture, {(*this)(a, s), (*this)(b, t)}, kFrameInk);
    };
    for (const double t : {0.0, last_}) {
      if ((t > 0) != front) continue;
      edge({0, 0}, t, {w, 0}, t), edge({w, 0}, t, {w, h}, t);
      edge({w, h}, t, {0, h}, t), edge({0, h}, t, {0, 0}, t);
    }
    if (front)
      edge({0, 0}, 0, {0, 0}, last_), edge({0, h}, 0, {0, h}, last_), edge({w, 0}, 0, {w, 0}, last_);
    else
      edge({w, h}, 0, {w, h}, last_);
  }

 private:
  int width_, height_;
  double last_ = 1, scale_ = 1, pace_ = 1;
  cv::Point2d into_, origin_;
};

void draw_space_time(cv::Mat& picture, const graph::MotionGraph& motion, const StrokeCourses& courses,
                     std::span<const graph::Event> events) {
  const auto& sketch = motion.sketch;
  const SpaceTimeView view(sketch.width, sketch.height, sketch.frames.size());
  const auto chosen = telling_strokes(courses, kInSpace);
  view.draw_box(picture, false);
  const std::size_t step = std::max<std::size_t>(1, (sketch.frames.size() + kSlices - 1) / kSlices);
  for (std::size_t t = 0; t < sketch.frames.size(); t += step)
    for (const auto& curve : graph::curves(sketch.frames[t])) {
      const auto stroke = sketch.frames[t].vertices()[curve.front()].subgraph.value;
      if (!chosen.contains(stroke)) continue;
      std::vector<cv::Point2d> points;
      for (const auto v : curve) points.push_back(view(sketch.frames[t].patch(v).position, double(t)));
      draw_course(picture, points, bgr_of(stroke));
    }
  view.draw_box(picture, true);
  for (const auto& event : events)
    if (is_shown(event, chosen)) draw_mark(picture, view(event.position, event.frame), event.type, 6, 0.9);
  write_text(picture,
             std::to_string(chosen.size()) + " strokes that last and move, in x (depth), y and time (right)",
             {kSpaceTime.x, 24});
}

/// Plots values against time in a box.
struct CoursePlot {
  cv::Rect box;
  double frames = 1, size = 1;
  [[nodiscard]] cv::Point2d operator()(double t, double value) const {
    return {box.x + box.width * t / frames, box.y + box.height * value / size};
  }
};

void draw_courses(cv::Mat& picture, const CoursePlot& plot, const StrokeCourses& courses,
                  std::span<const graph::Event> events, double graph::Point::*coordinate,
                  const std::string& title) {
  cv::rectangle(picture, plot.box, kFrameInk);
  const auto chosen = telling_strokes(courses, kInPlots);
  for (const auto id : chosen) {
    const auto& course = courses.at(id);
    std::vector<cv::Point2d> points;
    for (std::size_t k = 0; k < course.middles.size(); ++k)
      points.push_back(plot(course.first + double(k), course.middles[k].*coordinate));
    draw_course(picture, points, bgr_of(id));
  }
  const auto marks =
      std::ranges::count_if(events, [&](const auto& event) { return is_shown(event, chosen); });
  const double radius = std::clamp(60 / std::sqrt(double(marks) + 1), 3.0, 6.0);
  for (const auto& event : events)
    if (is_shown(event, chosen))
      draw_mark(picture, plot(event.frame, event.position.*coordinate), event.type, radius, 0.9);
  write_text(picture, title, {plot.box.x, plot.box.y - 10});
  const int below = plot.box.y + plot.box.height + 18;
  const std::string last = std::to_string(static_cast<int>(plot.frames));
  write_text(picture, "0", {plot.box.x, below});
  write_text(picture, "frame", {plot.box.x + (plot.box.width - text_width("frame")) / 2, below});
  write_text(picture, last, {plot.box.x + plot.box.width - text_width(last), below});
  const std::string size = std::to_string(static_cast<int>(plot.size) + 1);
  write_text(picture, "0", {plot.box.x - 8 - text_width("0"), plot.box.y + 10});
  write_text(picture, size, {plot.box.x - 8 - text_width(size), plot.box.y + plot.box.height});
}

}  // namespace

cv::Mat draw_trajectories(const graph::MotionGraph& motion, std::span<const graph::Event> events) {
  cv::Mat picture(kHeight, kWidth, CV_8UC3, kPaper);
  const auto& sketch = motion.sketch;
  const auto courses = stroke_courses(motion);
  draw_space_time(picture, motion, courses, events);
  const double last = std::max(1.0, static_cast<double>(sketch.frames.size()) - 1);
  draw_courses(picture, {kCourses[0], last, std::max(1.0, sketch.width - 1.0)}, courses, events,
               &graph::Point::x, "x of the middle of the strokes, px");
  draw_courses(picture, {kCourses[1], last, std::max(1.0, sketch.height - 1.0)}, courses, events,
               &graph::Point::y, "y of the middle of the strokes, px");
  const cv::Mat legend = draw_legend(
      kWidth,
      std::to_string(courses.size()) + " strokes in " + std::to_string(sketch.frames.size()) + " frames",
      event_legend());
  cv::Mat whole;
  cv::vconcat(picture, legend, whole);
  return whole;
}

}  // namespace emberfold::apps
