// SPDX-License-Identifier: Apache-2.0
// Strokes (connected parts of the graph) found where there is nothing but noise.
#include <cmath>
#include <cstdint>
#include <string>

#include <opencv2/imgproc.hpp>

#include "graph/attribute_graph.hpp"
#include "sketch/extract.hpp"
#include "tests/bench/figures/measures.hpp"
#include "tests/support/sketch_scene.hpp"

namespace emberfold::figures {

namespace {

constexpr int kImages = 20;
const cv::Size kSize{512, 512};

/// In all images; `smoothing`: px, of the noise, whose SD stays `level`.
std::size_t count_strokes(double level, double smoothing) {
  std::size_t strokes = 0;
  for (std::uint64_t seed = 1; seed <= kImages; ++seed) {
    cv::Mat1f frame = test::with_noise(cv::Mat1f(kSize, 0.0F), level, seed);
    if (smoothing > 0) {
      cv::GaussianBlur(frame, frame, {}, smoothing);
      cv::Scalar mean, sd;
      cv::meanStdDev(frame, mean, sd);
      frame *= level / sd[0];
    }
    frame += 128;
    strokes += graph::components(sketch::extract(frame, usual_options())).count;
  }
  return strokes;
}

}  // namespace

std::vector<Row> noise(const Inputs& /*inputs*/) {
  std::vector<Row> rows;
  for (const double smoothing : {0.0, 0.8})
    for (const double level : {2.0, 5.0, 10.0, 20.0, 40.0}) {
      const bool white = smoothing == 0;
      rows.push_back({std::string("noise: ") + (white ? "white" : "smoothed by 0.8 px") + ", SD " +
                          std::to_string(static_cast<int>(level)) + ": strokes in 20 images",
                      static_cast<double>(count_strokes(level, smoothing)), 0, "",
                      white ? std::optional(at_most(1)) : std::nullopt});
    }
  return rows;
}

}  // namespace emberfold::figures
