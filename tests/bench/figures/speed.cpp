// SPDX-License-Identifier: Apache-2.0
// CPU time of the sketch and of the fill on one thread, the least of some repeats.
#include <cstddef>
#include <string>

#include <opencv2/imgproc.hpp>

#include "core/parallel.hpp"
#include "sketch/extract.hpp"
#include "sketch/inpainting/fill.hpp"
#include "sketch/rendering/render.hpp"
#include "tests/bench/figures/cpu_time.hpp"
#include "tests/bench/figures/measures.hpp"

namespace emberfold::figures {

namespace {

constexpr int kRepeats = 7;

struct Times {
  double sketch = 0, fill = 0;
};

/// Means over the frames.
Times measure(const std::vector<cv::Mat>& frames, cv::Size size) {
  Times times;
  for (const cv::Mat& pixels : frames) {
    cv::Mat scaled, levels;
    cv::resize(pixels, scaled, size, 0, 0, pixels.cols > size.width ? cv::INTER_AREA : cv::INTER_CUBIC);
    scaled.convertTo(levels, CV_32F);
    graph::AttributeGraph graph;
    times.sketch += least_time(kRepeats, [&] { graph = sketch::extract(levels, usual_options()); });
    const sketch::Sketchable held = sketch::draw_pixels(graph, levels);
    times.fill += least_time(kRepeats, [&] { sketch::fill(held.levels, held.mask); });
  }
  times.sketch /= static_cast<double>(frames.size());
  times.fill /= static_cast<double>(frames.size());
  return times;
}

void add_rows(std::vector<Row>& rows, const std::string& name, const std::vector<cv::Mat>& frames) {
  const Times small = measure(frames, {320, 240}), large = measure(frames, {1280, 720});
  const double more_pixels = 1280.0 * 720 / (320 * 240);
  rows.push_back({"speed: " + name + ", sketch, 320x240", small.sketch, 1, "ms", at_most(15)});
  rows.push_back({"speed: " + name + ", sketch, 1280x720", large.sketch, 1, "ms", at_most(200)});
  rows.push_back({"speed: " + name + ", sketch, time per pixel, large : small",
                  large.sketch / small.sketch / more_pixels,
                  2,
                  "",
                  {}});
  rows.push_back({"speed: " + name + ", fill, 320x240", small.fill, 1, "ms", at_most(8)});
  rows.push_back({"speed: " + name + ", fill, 1280x720", large.fill, 1, "ms", at_most(120)});
  rows.push_back({"speed: " + name + ", fill, time per pixel, large : small",
                  large.fill / small.fill / more_pixels,
                  2,
                  "",
                  {}});
}

}  // namespace

std::vector<Row> speed(const Inputs& inputs) {
  const core::ThreadLimit one(1);
  std::vector<cv::Mat> scenes, grey, colour;
  for (const Scene& scene : read_scenes(inputs.scenes, 50, 1, 1))
    scenes.push_back(scene.frames.front().pixels);
  for (const ClipFrame& frame : clip_frames(inputs.clips, {60})) {
    colour.push_back(frame.pixels);
    grey.emplace_back();
    cv::cvtColor(frame.pixels, grey.back(), cv::COLOR_BGR2GRAY);
  }
  std::vector<Row> rows;
  add_rows(rows, "scenes", scenes);
  add_rows(rows, "clips, grey", grey);
  add_rows(rows, "clips, colour", colour);
  return rows;
}

}  // namespace emberfold::figures
