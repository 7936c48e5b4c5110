// SPDX-License-Identifier: Apache-2.0
#include "pipeline/steady_frames.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <opencv2/imgproc.hpp>

#include "pipeline/frame_motion.hpp"
#include "sketch/steadying/steady_sketch.hpp"

namespace emberfold::pipeline {

namespace {

// Composes two successive motions, of frames of this size, as vectors on one grid.
cv::Mat followed_by(const cv::Mat& motion, const cv::Mat& next, cv::Size frame) {
  const auto across = static_cast<float>(motion.cols) / static_cast<float>(frame.width),
             down = static_cast<float>(motion.rows) / static_cast<float>(frame.height);
  cv::Mat map(motion.size(), CV_32FC2), more;
  for (int y = 0; y < motion.rows; ++y) {
    const auto* from = motion.ptr<cv::Vec2f>(y);
    auto* to = map.ptr<cv::Vec2f>(y);
    for (int x = 0; x < motion.cols; ++x)
      to[x] = {static_cast<float>(x) + across * from[x][0], static_cast<float>(y) + down * from[x][1]};
  }
  cv::remap(next, more, map, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  return cv::Mat(motion + more);
}

}  // namespace

graph::AttributeGraph inside_mask(const graph::AttributeGraph& graph, const cv::Mat& mask) {
  if (mask.empty()) return graph;
  const auto inside = [&](std::size_t i) {
    const auto& at = graph.patch(i).position;
    const int x = std::clamp(static_cast<int>(std::lround(at.x)), 0, mask.cols - 1),
              y = std::clamp(static_cast<int>(std::lround(at.y)), 0, mask.rows - 1);
    return mask.at<std::uint8_t>(y, x) != 0;
  };
  // Drops a patch whose neighbours are all outside: it is no stroke of its own.
  const auto stays = [&](std::size_t i) {
    return inside(i) && (graph.degree(i) == 0 || std::ranges::any_of(graph.neighbours(i), inside));
  };
  std::vector<graph::Vertex> vertices;
  std::vector<graph::Edge> edges;
  for (std::size_t i = 0; i < graph.size(); ++i)
    if (stays(i)) vertices.push_back(graph.vertices()[i]);
  for (const graph::Edge& edge : graph.edges())
    if (stays(graph.index_of(edge.a)) && stays(graph.index_of(edge.b))) edges.push_back(edge);
  return {std::move(vertices), std::move(edges)};
}

cv::Mat packed_levels(const cv::Mat& levels) {
  cv::Mat bytes;
  levels.convertTo(bytes, CV_8U);
  cv::Mat changed;
  cv::compare(levels.reshape(1), unpacked_levels(bytes).reshape(1), changed, cv::CMP_NE);
  return cv::countNonZero(changed) == 0 ? bytes : levels;
}

cv::Mat unpacked_levels(const cv::Mat& packed) {
  if (packed.depth() == CV_32F) return packed;
  cv::Mat levels;
  packed.convertTo(levels, CV_32F);
  return levels;
}

void SteadyFrames::push(std::vector<FrameReading> readings, cv::Mat mask) {
  Entry entry{std::move(readings), std::move(mask), {}, {}, {}};
  if (is_on_) entry.luma = core::luma(unpacked_levels(entry.readings.front().levels));
  entries_.push_back(std::move(entry));
}

std::size_t SteadyFrames::prepare(bool last, const core::Context& context) {
  if (!is_on_) return waiting();
  compute_motion(entries_, context);
  return last ? waiting() : waiting() - std::min(waiting(), std::size_t{kNeighbours});
}

cv::Mat SteadyFrames::motion(std::size_t from, std::size_t to) const {
  const cv::Size frame = entries_[from].luma.size();
  cv::Mat result;
  while (from != to) {
    const cv::Mat& step = from < to ? entries_[from].on : entries_[from - 1].back;
    result = result.empty() ? step : followed_by(result, step, frame);
    from = from < to ? from + 1 : from - 1;
  }
  return result;
}

std::vector<FrameReading> SteadyFrames::steady(std::size_t i) const {
  const std::size_t at = first_ + i;
  const Entry& entry = entries_[at];
  std::vector<FrameReading> result = entry.readings;
  for (FrameReading& reading : result) reading.levels = unpacked_levels(reading.levels);
  const auto cut = [&] {
    for (FrameReading& reading : result) reading.graph = inside_mask(reading.graph, entry.mask);
  };
  if (!is_on_) {
    cut();
    return result;
  }
  struct Neighbour {
    std::size_t at;
    cv::Mat from;  // its motion to this frame
    cv::Mat1f difference;
  };
  std::vector<Neighbour> neighbours;
  const auto add = [&](std::size_t other) {
    neighbours.push_back({other, motion(other, at),
                          sketch::measure_difference(entry.luma, entries_[other].luma, motion(at, other))});
  };
  for (std::size_t away = 1; away <= kNeighbours; ++away) {
    if (at >= away) add(at - away);
    if (at + away < entries_.size()) add(at + away);
  }
  // The most similar come first, an order that reversing the clip does not change.
  std::ranges::stable_sort(neighbours, {}, [](const Neighbour& n) { return cv::mean(n.difference)[0]; });
  for (std::size_t reading = 0; reading < result.size(); ++reading) {
    std::vector<sketch::CarriedSketch> carried;
    for (const Neighbour& n : neighbours)
      carried.push_back(
          {sketch::carry_sketch(entries_[n.at].readings[reading].graph, n.from, entry.luma.size()),
           n.difference});
    FrameReading& own = result[reading];
    own.graph = sketch::steady_sketch(own.levels, own.graph, carried, options_);
  }
  cut();
  return result;
}

void SteadyFrames::drop(std::size_t count) {
  first_ += count;
  const std::size_t gone = first_ - std::min(first_, is_on_ ? std::size_t{kNeighbours} : 0);
  entries_.erase(entries_.begin(), entries_.begin() + static_cast<std::ptrdiff_t>(gone));
  first_ -= gone;
}

}  // namespace emberfold::pipeline
