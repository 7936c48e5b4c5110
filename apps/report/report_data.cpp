// SPDX-License-Identifier: Apache-2.0
#include "apps/report/report_data.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>

#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "apps/pictures/draw.hpp"

namespace emberfold::apps {

namespace {

using Json = nlohmann::ordered_json;
constexpr std::size_t kEventBytes = 800'000, kCurveBytes = 550'000, kPathPoints = 20'000;

// Rounds to a tenth of a pixel, in clips wider than 600 px to whole ones: finer than a screen resolves.
Json coordinate_json(double value, int width) {
  if (width > 600) return static_cast<std::int64_t>(std::llround(value));
  return std::round(value * 10) / 10;
}

Json ids_json(const std::vector<graph::SubgraphId>& list) {
  constexpr std::size_t kMost = 8;
  Json out = Json::array();
  for (std::size_t i = 0; i < std::min(list.size(), kMost); ++i) out.push_back(list[i].value);
  return out;
}

struct Path {
  int first = 0;
  std::vector<graph::Point> points;
};

// Returns the diagonal of the path's bounding box, px.
double box_diagonal(const Path& path) {
  graph::Point low = path.points.front(), high = low;
  for (const auto& p : path.points) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y)};
  }
  return graph::distance(low, high);
}

// Orders paths alternately by extent and by duration, since the longest-lived may all stand still.
std::vector<std::size_t> order_by_interest(const std::vector<Path>& paths) {
  std::vector<std::size_t> by_life(paths.size());
  std::iota(by_life.begin(), by_life.end(), std::size_t{0});
  auto by_extent = by_life;
  std::vector<double> extents;
  for (const auto& path : paths) extents.push_back(box_diagonal(path));
  std::ranges::stable_sort(by_life, std::greater{}, [&](std::size_t i) { return paths[i].points.size(); });
  std::ranges::stable_sort(by_extent, std::greater{}, [&](std::size_t i) { return extents[i]; });
  std::vector<std::size_t> order;
  std::vector<bool> taken(paths.size());
  for (std::size_t i = 0; i < paths.size(); ++i)
    for (const std::size_t index : {by_extent[i], by_life[i]})
      if (!taken[index]) taken[index] = true, order.push_back(index);
  return order;
}

Json choose_paths(const std::vector<Path>& paths, int width, std::size_t least) {
  Json out = Json::array();
  std::size_t points = 0;
  for (const std::size_t index : order_by_interest(paths)) {
    const auto& path = paths[index];
    if (path.points.size() < least) continue;
    // a path that exceeds the remaining budget is truncated
    const std::size_t count = std::min(path.points.size(), kPathPoints - points);
    if (count < least) break;
    Json line = Json::array({path.first});
    for (std::size_t i = 0; i < count; ++i) {
      line.push_back(coordinate_json(path.points[i].x, width));
      line.push_back(coordinate_json(path.points[i].y, width));
    }
    out.push_back(std::move(line));
    points += count;
  }
  return out;
}

std::vector<cv::Point2f> simplify_curve(const graph::AttributeGraph& graph, const graph::Curve& curve,
                                        double tolerance) {
  std::vector<cv::Point2f> line, simple;
  for (const auto index : curve) {
    const auto at = graph.patch(index).position;
    line.emplace_back(static_cast<float>(at.x), static_cast<float>(at.y));
  }
  if (line.size() < 3) return line;
  cv::approxPolyDP(line, simple, tolerance, false);
  return simple;
}

Json frame_curves(const graph::AttributeGraph& graph, double tolerance, std::size_t most, int width) {
  auto list = graph::curves(graph);
  std::ranges::stable_sort(list, [](const auto& a, const auto& b) { return a.size() > b.size(); });
  if (list.size() > most) list.resize(most);
  Json out = Json::array();
  for (const auto& curve : list) {
    Json line = Json::array({hex(stroke_colour(graph.vertices()[curve.front()].subgraph.value))});
    for (const auto& p : simplify_curve(graph, curve, tolerance)) {
      line.push_back(coordinate_json(static_cast<double>(p.x), width));
      line.push_back(coordinate_json(static_cast<double>(p.y), width));
    }
    out.push_back(std::move(line));
  }
  return out;
}

template <class Value>
Json bin_means(const std::vector<Value>& values, std::size_t step) {
  Json out = Json::array();
  for (std::size_t i = 0; i < values.size(); i += step) {
    const std::size_t end = std::min(values.size(), i + step);
    double sum = 0;
    for (std::size_t k = i; k < end; ++k) sum += double(values[k]);
    out.push_back(std::round(sum / double(end - i) * 100) / 100);
  }
  return out;
}

}  // namespace

Json report_events(std::span<const graph::Event> events) {
  for (std::size_t every = 1;; ++every) {
    Json frame = Json::array(), type = frame, x = frame, y = frame, p = frame, before = frame, after = frame;
    for (std::size_t i = 0; i < events.size(); i += every) {
      const auto& e = events[i];
      frame.push_back(e.frame);
      type.push_back(std::ranges::find(graph::all_event_types(), e.type) - graph::all_event_types().begin());
      x.push_back(std::round(e.position.x * 10) / 10);
      y.push_back(std::round(e.position.y * 10) / 10);
      p.push_back(std::round(e.probability * 1000) / 1000);
      before.push_back(ids_json(e.before));
      after.push_back(ids_json(e.after));
    }
    Json columns = {{"total", events.size()},
                    {"every", every},
                    {"frame", frame},
                    {"type", type},
                    {"x", x},
                    {"y", y},
                    {"p", p},
                    {"before", before},
                    {"after", after}};
    const std::size_t size = columns.dump().size();
    if (size <= kEventBytes) return columns;
    every += size / kEventBytes - 1;
  }
}

Json report_series(const graph::MotionGraph& motion, std::span<const graph::Event> events) {
  const std::size_t frames = motion.sketch.frames.size(), step = frames / kSeries + 1;
  std::vector<std::size_t> patches(frames), strokes(frames);
  for (std::size_t t = 0; t < frames; ++t) {
    patches[t] = motion.sketch.frames[t].size();
    strokes[t] = graph::components(motion.sketch.frames[t]).count;
  }
  Json rates = Json::array();
  for (const auto type : graph::all_event_types()) {
    std::vector<std::size_t> count(frames);
    for (const auto& e : events)
      if (e.type == type && e.frame >= 0 && static_cast<std::size_t>(e.frame) < frames)
        ++count[static_cast<std::size_t>(e.frame)];
    rates.push_back(bin_means(count, step));
  }
  return {{"step", step},
          {"strokes", bin_means(strokes, step)},
          {"patches", bin_means(patches, step)},
          {"events", rates}};
}

Json report_stroke_paths(const graph::MotionGraph& motion) {
  struct Middle {
    graph::Point sum;
    double count = 0;
  };
  std::map<std::uint32_t, Path> paths;
  for (std::size_t t = 0; t < motion.sketch.frames.size(); ++t) {
    std::map<std::uint32_t, Middle> here;
    for (const auto& vertex : motion.sketch.frames[t].vertices()) {
      auto& middle = here[vertex.subgraph.value];
      middle.sum = middle.sum + vertex.patch.position;
      ++middle.count;
    }
    for (const auto& [id, middle] : here) {
      auto [path, is_new] = paths.try_emplace(id);
      if (is_new) path->second.first = static_cast<int>(t);
      path->second.points.push_back(middle.sum * (1 / middle.count));
    }
  }
  std::vector<Path> list;
  for (auto& [id, path] : paths) list.push_back(std::move(path));
  return choose_paths(list, motion.sketch.width, 3);
}

Json report_patch_paths(const graph::MotionGraph& motion) {
  std::vector<Path> list;
  for (const auto& course : graph::trajectories(motion)) {
    if (course.vertices.size() < 4) continue;
    Path path{course.first_frame, {}};
    for (std::size_t i = 0; i < course.vertices.size(); ++i) {
      const auto& graph = motion.sketch.frames[static_cast<std::size_t>(course.first_frame) + i];
      path.points.push_back(graph.patch(graph.index_of(course.vertices[i])).position);
    }
    list.push_back(std::move(path));
  }
  return choose_paths(list, motion.sketch.width, 4);
}

Json report_curves(const graph::MotionGraph& motion, std::span<const int> frames) {
  std::size_t most = 4000;
  double tolerance = 0.5;  // px
  for (;;) {
    Json out = Json::array();
    for (const int t : frames)
      out.push_back(frame_curves(motion.sketch.frames[static_cast<std::size_t>(t)], tolerance, most,
                                 motion.sketch.width));
    if (out.dump().size() <= kCurveBytes || most == 0) return out;
    if (tolerance > 2) most /= 2;
    tolerance *= 1.6;
  }
}

}  // namespace emberfold::apps
