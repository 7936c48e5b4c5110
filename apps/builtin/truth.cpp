// SPDX-License-Identifier: Apache-2.0
#include "apps/builtin/truth.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include <nlohmann/json.hpp>

#include "apps/builtin/render.hpp"
#include "apps/builtin/style.hpp"
#include "core/text/format_number.hpp"

namespace emberfold::apps {

namespace {

using Json = nlohmann::ordered_json;

Json point_json(const cv::Point2d& p) {
  return Json::array({core::round_to(p.x, 2), core::round_to(p.y, 2)});
}

cv::Point2d at_point(const Line& line, double index) {
  const auto i = std::min(static_cast<std::size_t>(index), line.size() - 2);
  return line[i] + (index - static_cast<double>(i)) * (line[i + 1] - line[i]);
}

// Returns the pieces of a body's first curve at half contrast or more, cut where it is exactly half.
std::vector<Line> visible_pieces(const Body& body, const Line& line, int frame) {
  constexpr int fine = 20;  // samples between two points
  std::vector<Line> found(1);
  bool shown = false;
  for (std::size_t i = 0; i + 1 <= line.size(); ++i)
    for (int k = 0; k < (i + 1 < line.size() ? fine : 1); ++k) {
      const double index = static_cast<double>(i) + static_cast<double>(k) / fine;
      const bool shows = gap_contrast(body, index, frame) >= 0.5;
      if (shows != shown && index > 0) {
        if (shows) found.emplace_back();
        found.back().push_back(at_point(line, index));
      }
      if (shows && k == 0 && (found.back().empty() || cv::norm(found.back().back() - line[i]) > 0))
        found.back().push_back(line[i]);
      shown = shows;
    }
  return found;
}

Json stroke_json(int id, const Body& body, double sigma, const Line& line) {
  Json points = Json::array();
  for (const auto& p : line) points.push_back(point_json(p));
  return {{"id", id},
          {"polarity", body.polarity},
          {"sigma", core::round_to(sigma, 3)},
          {"ar", {core::round_to(body.ar[0], 6), core::round_to(body.ar[1], 6)}},
          {"points", std::move(points)}};
}

struct Event {
  int frame;
  const char* type;
  cv::Point2d at;
};

// Returns the middle of a body: half way along its line, or where its lines cross.
cv::Point2d middle_of(const Scene& scene, const Body& body, int frame) {
  const Line line = line_at(scene.options, body, body.curves[0], frame);
  if (body.curves.size() == 1) return midpoint(line);
  return crossing_point(line, line_at(scene.options, body, body.curves[1], frame)).value_or(midpoint(line));
}

std::vector<Event> events_of(const Scene& scene) {
  std::vector<Event> events;
  for (const Body& body : scene.bodies) {
    if (body.life.begin) {
      const int t = body.life.begin->frame;
      events.push_back({t, "birth", middle_of(scene, body, t)});
    }
    if (body.life.end) {
      const int t = body.life.end->frame;
      events.push_back({t, "death", middle_of(scene, body, t - 1)});
    }
    for (const Gap& gap : body.gaps) {
      const auto place = [&](int t) {
        return at_point(line_at(scene.options, body, body.curves[0], t), gap.centre);
      };
      if (gap.open.begin) events.push_back({gap.open.begin->frame, "split", place(gap.open.begin->frame)});
      if (gap.open.end) events.push_back({gap.open.end->frame, "merge", place(gap.open.end->frame)});
    }
  }
  for (const Bridge& bridge : scene.bridges) {
    const auto place = [&](int t) { return midpoint(line_at(scene, bridge, t)); };
    if (bridge.presence.begin)
      events.push_back({bridge.presence.begin->frame, "connect", place(bridge.presence.begin->frame)});
    if (bridge.presence.end)
      events.push_back({bridge.presence.end->frame, "disconnect", place(bridge.presence.end->frame - 1)});
  }
  std::sort(events.begin(), events.end(), [](const Event& a, const Event& b) {
    return std::tuple(a.frame, std::string(a.type), a.at.x, a.at.y) <
           std::tuple(b.frame, std::string(b.type), b.at.x, b.at.y);
  });
  return events;
}

/// Adds a frame's strokes and junctions.
void add_frame(const Scene& scene, int frame, Json& all_strokes, Json& all_junctions) {
  Json strokes = Json::array(), junctions = Json::array();
  for (const Body& body : scene.bodies) {
    if (!body.life.shows(frame)) continue;
    std::vector<Line> lines;
    for (const RestCurve& curve : body.curves) lines.push_back(line_at(scene.options, body, curve, frame));
    for (std::size_t c = 0; c < lines.size(); ++c)
      for (const Line& piece : c == 0 ? visible_pieces(body, lines[c], frame) : std::vector<Line>{lines[c]})
        strokes.push_back(stroke_json(body.curves[c].id, body, body.sigma, piece));
    if (lines.size() > 1)
      if (const auto cross = crossing_point(lines[0], lines[1])) junctions.push_back(point_json(*cross));
  }
  for (const Bridge& bridge : scene.bridges) {
    if (!bridge.presence.shows(frame)) continue;
    const Line line = line_at(scene, bridge, frame);
    strokes.push_back(stroke_json(bridge.id, scene.bodies[bridge.from.body], bridge.sigma, line));
    junctions.push_back(point_json(line.front()));
    junctions.push_back(point_json(line.back()));
  }
  all_strokes.push_back(std::move(strokes));
  all_junctions.push_back(std::move(junctions));
}

const char* name_of(BuiltinScene scene) {
  return scene == BuiltinScene::fire ? "fire" : scene == BuiltinScene::cloth ? "cloth" : "river";
}

}  // namespace

std::string truth_of(const Scene& scene) {
  const BuiltinOptions& o = scene.options;
  Json truth{{"kind", name_of(o.scene)},
             {"width", o.width},
             {"height", o.height},
             {"frames", o.frames},
             {"fps", o.fps},
             {"noise", builtin_noise},
             {"ramp", 3},
             {"flicker", style_of(o.scene).flicker},
             {"seed", o.seed}};
  Json events = Json::array(), strokes = Json::array(), junctions = Json::array();
  for (const Event& event : events_of(scene))
    events.push_back({{"frame", event.frame},
                      {"type", event.type},
                      {"x", core::round_to(event.at.x, 2)},
                      {"y", core::round_to(event.at.y, 2)}});
  for (int t = 0; t < o.frames; ++t) add_frame(scene, t, strokes, junctions);
  truth["events"] = std::move(events);
  truth["strokes"] = std::move(strokes);
  truth["junctions"] = std::move(junctions);
  return truth.dump();
}

}  // namespace emberfold::apps
