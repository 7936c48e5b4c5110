// SPDX-License-Identifier: Apache-2.0
#include "apps/pictures/match_picture.hpp"

#include <algorithm>
#include <map>
#include <numeric>
#include <string>

#include <opencv2/imgproc.hpp>

#include "apps/pictures/draw.hpp"
#include "apps/pictures/overlay.hpp"

namespace emberfold::apps {

namespace {

constexpr int kSide = 480, kGutter = 12, kTitle = 30;

std::uint32_t find_root(std::vector<std::uint32_t>& parent, std::uint32_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

cv::Mat draw_half(const cv::Mat& frame, const graph::AttributeGraph& graph,
                  const std::vector<std::uint32_t>& cluster, std::span<const graph::Event> events,
                  const std::string& title, bool is_before) {
  const Placement place{enlargement(frame.size(), kSide), {}};
  cv::Mat picture = enlarge(frame, place.scale);
  picture.convertTo(picture, -1, 0.72);
  draw_graph(picture, graph, place, [&](std::size_t i) {
    return cluster[i] == 0 ? Colour{255, 255, 255} : stroke_colour(cluster[i]);
  });
  const double radius = mark_radius(events.size());
  for (const auto& event : events) {
    using enum graph::EventType;
    if (event.type == (is_before ? birth : death)) continue;  // the stroke is absent in this frame
    draw_mark(picture, place(event.position), event.type, radius);
  }
  cv::Mat head(kTitle, picture.cols, CV_8UC3, cv::Scalar(246, 248, 250)), whole;
  write_text(head, title, {2, 20}, 0.5);
  cv::vconcat(head, picture, whole);
  return whole;
}

}  // namespace

std::vector<int> eventful_gaps(std::span<const graph::Event> events, std::size_t count) {
  std::map<int, int> tally;
  for (const auto& event : events) ++tally[event.frame];
  std::vector<std::pair<int, int>> ranked(tally.begin(), tally.end());
  std::ranges::stable_sort(ranked, [](const auto& a, const auto& b) { return a.second > b.second; });
  std::vector<int> chosen;
  for (const auto& [frame, number] : ranked) {
    if (chosen.size() == count) break;
    const bool near =
        std::ranges::any_of(chosen, [f = frame](int other) { return std::abs(other - f) <= 1; });
    if (!near) chosen.push_back(frame);
  }
  std::ranges::sort(chosen);
  return chosen;
}

GapClusters gap_clusters(const graph::MotionGraph& motion, int t) {
  const auto index = static_cast<std::size_t>(t);
  const auto& before = motion.sketch.frames[index - 1];
  const auto& after = motion.sketch.frames[index];
  const auto parts_before = graph::components(before), parts_after = graph::components(after);
  std::vector<std::uint32_t> parent(parts_before.count + parts_after.count);
  std::iota(parent.begin(), parent.end(), 0U);
  std::vector<bool> linked(parent.size());
  for (const auto& link : motion.links[index]) {
    const auto a = parts_before.of_vertex[before.index_of(link.before)];
    const auto b =
        static_cast<std::uint32_t>(parts_before.count) + parts_after.of_vertex[after.index_of(link.after)];
    linked[a] = linked[b] = true;
    const auto ra = find_root(parent, a), rb = find_root(parent, b);
    parent[std::max(ra, rb)] = std::min(ra, rb);
  }
  std::vector<std::uint32_t> number(parent.size());
  std::uint32_t last = 0;
  const auto of_part = [&](std::uint32_t part) -> std::uint32_t {
    if (!linked[part]) return 0;
    auto& own = number[find_root(parent, part)];
    if (own == 0) own = ++last;
    return own;
  };
  GapClusters result;
  for (const auto part : parts_before.of_vertex) result.before.push_back(of_part(part));
  for (const auto part : parts_after.of_vertex)
    result.after.push_back(of_part(static_cast<std::uint32_t>(parts_before.count) + part));
  return result;
}

cv::Mat draw_match(const cv::Mat& before, const cv::Mat& after, const graph::MotionGraph& motion, int t,
                   std::span<const graph::Event> events) {
  const auto clusters = gap_clusters(motion, t);
  const auto here = events_between(events, t, t);
  const auto index = static_cast<std::size_t>(t);
  const cv::Mat left = draw_half(before, motion.sketch.frames[index - 1], clusters.before, here,
                                 "frame " + std::to_string(t - 1), true);
  const cv::Mat right = draw_half(after, motion.sketch.frames[index], clusters.after, here,
                                  "frame " + std::to_string(t), false);
  const cv::Mat gutter(left.rows, kGutter, CV_8UC3, cv::Scalar(246, 248, 250));
  const std::vector<cv::Mat> row{left, gutter, right};
  cv::Mat pair, whole;
  cv::hconcat(row, pair);
  cv::vconcat(pair, draw_legend(pair.cols, "one colour: matched   white: unmatched", event_legend()), whole);
  return whole;
}

}  // namespace emberfold::apps
