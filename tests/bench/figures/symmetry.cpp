// SPDX-License-Identifier: Apache-2.0
// Frames that are turned, flipped, brightened or made paler: the graph should be the same.
#include <functional>
#include <string>

#include <opencv2/imgproc.hpp>

#include "sketch/extract.hpp"
#include "tests/bench/figures/measures.hpp"

namespace emberfold::figures {

namespace {

constexpr double kWithin = 0.1;

struct Change {
  const char* name;
  std::function<cv::Mat(const cv::Mat&)> apply;
  std::function<Point(Point, cv::Size)> undo;  ///< of a place in the changed frame; size of the original
};

std::vector<Change> changes() {
  const auto flip = [](int code) {
    return [code](const cv::Mat& frame) {
      cv::Mat flipped;
      cv::flip(frame, flipped, code);
      return flipped;
    };
  };
  const auto turn = [](const cv::Mat& frame) {
    cv::Mat turned;
    cv::rotate(frame, turned, cv::ROTATE_90_CLOCKWISE);
    return turned;
  };
  const auto same = [](Point p, cv::Size) { return p; };
  return {{"flipped left-right", flip(1),
           [](Point p, cv::Size s) {
             return Point{s.width - 1 - p.x, p.y};
           }},
          {"flipped upside down", flip(0),
           [](Point p, cv::Size s) {
             return Point{p.x, s.height - 1 - p.y};
           }},
          {"turned by 90 degrees", turn,
           [](Point p, cv::Size s) {
             return Point{p.y, s.height - 1 - p.x};
           }},
          {"20 grey levels up", [](const cv::Mat& f) -> cv::Mat { return f + 20; }, same},
          {"contrast halved", [](const cv::Mat& f) -> cv::Mat { return f * 0.5; }, same}};
}

struct Named {
  bool real;
  cv::Mat1f levels;
};

}  // namespace

std::vector<Row> symmetry(const Inputs& inputs) {
  std::vector<Named> frames;
  for (const ClipFrame& frame : clip_frames(inputs.clips, {60}))
    frames.push_back({true, levels_of(grey_at(frame.pixels))});
  for (const Scene& scene : read_scenes(inputs.scenes, 50, 1, 1))
    frames.push_back({false, levels_of(scene.frames.front().pixels)});
  std::vector<Row> rows;
  for (const Change& change : changes())
    for (const bool real : {true, false}) {
      std::size_t hit = 0, all = 0;
      for (const Named& frame : frames) {
        if (frame.real != real) continue;
        const std::vector<Point> before = positions(sketch::extract(frame.levels, usual_options()));
        std::vector<Point> after = positions(sketch::extract(change.apply(frame.levels), usual_options()));
        for (Point& p : after) p = change.undo(p, frame.levels.size());
        hit += count_near(before, after, kWithin) + count_near(after, before, kWithin);
        all += before.size() + after.size();
      }
      rows.push_back({std::string("symmetry: ") + change.name + (real ? ", clips" : ", scenes"),
                      static_cast<double>(hit) / static_cast<double>(all), 3, "", at_least(0.98)});
    }
  return rows;
}

}  // namespace emberfold::figures
