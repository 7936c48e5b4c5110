// SPDX-License-Identifier: Apache-2.0
#include "apps/benchmark/line_scene.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "apps/builtin/line_drawing.hpp"
#include "core/parallel.hpp"

namespace emberfold::apps {

namespace {

using std::numbers::pi;
constexpr std::uint32_t kNoiseStream = 101, kGroundStream = 102;
constexpr double kGround = 100, kWaves = 14;  // grey levels

}  // namespace

SceneFlow::SceneFlow(core::Rng& rng, double strength) {
  const double amplitude = strength * std::sqrt(4.0 / static_cast<double>(waves_.size()));
  for (Wave& wave : waves_) {
    const double heading = rng.uniform(0, 2 * pi), k = 2 * pi / rng.uniform(120, 320);
    wave.vector = k * cv::Point2d(std::cos(heading), std::sin(heading));
    const double way = rng.uniform(0, 2 * pi);
    wave.way = amplitude * cv::Point2d(std::cos(way), std::sin(way));
    wave.phase = rng.uniform(0, 2 * pi);
    wave.turn = 2 * pi / rng.uniform(25, 60);
  }
}

cv::Point2d SceneFlow::at(const cv::Point2d& rest, int frame) const {
  cv::Point2d sum(0, 0);
  for (const Wave& wave : waves_)
    sum += std::cos(wave.vector.dot(rest) + wave.turn * frame + wave.phase) * wave.way;
  return sum;
}

Line straight_line(const cv::Point2d& from, const cv::Point2d& to) {
  const int steps = std::max(1, static_cast<int>(std::lround(cv::norm(to - from) / 2)));
  Line line;
  for (int k = 0; k <= steps; ++k) line.push_back(from + (to - from) * (static_cast<double>(k) / steps));
  return line;
}

Line line_at(const LineScene& scene, const SceneLine& line, int frame) {
  Line points;
  const auto last = static_cast<double>(std::max<std::size_t>(2, line.rest.size()) - 1);
  for (std::size_t i = 0; i < line.rest.size(); ++i) {
    cv::Point2d p = line.rest[i] + scene.flow.at(line.rest[i], frame);
    if (line.move) p += line.move(static_cast<double>(i) / last, frame);
    points.push_back(p);
  }
  return points;
}

void tell(LineScene& scene, int frame, graph::EventType type, const SceneLine& line, double share) {
  const Line points = line_at(scene, line, frame);
  const cv::Point2d place =
      points[static_cast<std::size_t>(std::lround(share * static_cast<double>(points.size() - 1)))];
  scene.events.push_back({frame, type, {place.x, place.y}, 1, {}, {}});
}

std::vector<cv::Mat> draw_scene(const LineScene& scene, const core::Context& context) {
  core::Rng ground_rng(scene.seed, {kGroundStream});
  const SceneFlow ground(ground_rng, kWaves);
  std::vector<cv::Mat> frames(static_cast<std::size_t>(scene.frames));
  core::parallel_for(frames.size(), context, [&](std::size_t k) {
    const int t = static_cast<int>(k);
    std::array<cv::Mat, 2> fields;  // bright, dark
    for (cv::Mat& field : fields) field = cv::Mat::zeros(scene.height, scene.width, CV_32F);
    for (const SceneLine& line : scene.lines) {
      const double there = line.presence.contrast_at(t);
      if (there <= 0) continue;
      std::vector<Dab> dabs;
      for (const cv::Point2d& p : line_at(scene, line, t))
        dabs.push_back({p, there * std::abs(line.contrast), line.sigma});
      draw_line(fields[line.contrast > 0 ? 0 : 1], dabs);
    }
    core::Rng noise(scene.seed, {kNoiseStream, static_cast<std::uint32_t>(t)});
    cv::Mat frame(scene.height, scene.width, CV_8UC1);
    for (int y = 0; y < scene.height; ++y)
      for (int x = 0; x < scene.width; ++x)
        frame.at<std::uint8_t>(y, x) = cv::saturate_cast<std::uint8_t>(
            kGround + ground.at(cv::Point2d(x, y), 0).x + static_cast<double>(fields[0].at<float>(y, x)) -
            static_cast<double>(fields[1].at<float>(y, x)) + scene.noise * noise.normal());
    frames[k] = frame;
  });
  return frames;
}

}  // namespace emberfold::apps
