// SPDX-License-Identifier: Apache-2.0
// Lays out a scene: strokes are proposed one by one and kept where they have room for all their life; gaps
// and bridges are then proposed on them in the same way.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "apps/builtin/scene.hpp"
#include "apps/builtin/style.hpp"
#include "apps/builtin/wind.hpp"

namespace emberfold::apps {

namespace {

constexpr double margin = 7;     // px to the edge of the picture
constexpr double apart = 10;     // px between lines that do not touch
constexpr int pause = 6;         // frames between one body's end and another's beginning in its place
constexpr int events_apart = 5;  // frames between the events of one body

/// The frames first…last.
struct Window {
  int first, last;
};

Window window_of(const Presence& presence, int frames) {
  return {presence.begin ? std::max(0, presence.begin->frame - presence.begin->fade) : 0,
          presence.end ? std::min(frames - 1, presence.end->frame + presence.end->fade) : frames - 1};
}

bool overlap(const Window& a, const Window& b, int pad) {
  return a.first - pad <= b.last && b.first - pad <= a.last;
}

bool too_near(const Line& a, const Line& b, double least) {
  for (const auto& p : a)
    for (const auto& q : b) {
      const cv::Point2d gap = p - q;
      if (gap.dot(gap) < least * least) return true;
    }
  return false;
}

cv::Point2d nearest_in(const cv::Rect2d& box, const cv::Point2d& p) {
  return {std::clamp(p.x, box.x, box.x + box.width), std::clamp(p.y, box.y, box.y + box.height)};
}

class Planner {
 public:
  explicit Planner(const BuiltinOptions& options) : style_(style_of(options.scene)), wind_(options) {
    scene_.options = options;
    core::Rng rng(options.seed, {static_cast<std::uint32_t>(Purpose::body), 0, 0});
    for (double& phase : flow_) phase = rng.uniform(0, 2 * std::numbers::pi);
    showing_ = std::max(1.0, options.width * static_cast<double>(options.height) / style_.area_per_body);
  }

  Scene plan() {
    place_bodies();
    const double hundreds = scene_.options.frames / 100.0;
    attempt(Purpose::gap, 0, style_.gaps * showing_ * hundreds, 30,
            [&](core::Rng& rng) { return add_gap(rng); });
    attempt(Purpose::bridge, 0, style_.bridges * showing_ * hundreds, 400,
            [&](core::Rng& rng) { return add_bridge(rng); });
    return std::move(scene_);
  }

 private:
  struct Info {
    Window window;
    cv::Rect2d box;           ///< of all its frames
    std::vector<int> events;  ///< frames
  };

  /// Repeats until `wanted` attempts have succeeded, at most `patience` · `wanted` times. Attempt i is stream
  /// i.
  template <class Try>
  void attempt(Purpose purpose, std::uint32_t round, double wanted, int patience, const Try& attempt_once) {
    const int target = static_cast<int>(std::round(wanted));
    int found = 0;
    for (int i = 1; i <= target * patience && found < target; ++i) {
      core::Rng rng(scene_.options.seed,
                    {static_cast<std::uint32_t>(purpose), static_cast<std::uint32_t>(i), round});
      found += attempt_once(rng) ? 1 : 0;
    }
  }

  static Change change(int frame, core::Rng& rng) { return {frame, 1 + static_cast<int>(rng.below(3))}; }

  void place_bodies() {
    const int frames = scene_.options.frames;
    attempt(Purpose::body, 0, showing_, 20, [&](core::Rng& rng) {
      Presence life;
      const int end = static_cast<int>(rng.uniform(10, 2 * style_.life));
      if (end < frames - 3) life.end = change(end, rng);
      return add_body(life, rng);
    });
    const int initial = static_cast<int>(scene_.bodies.size());
    if (frames < 12) return;
    // Long lives first, then shorter ones in the remaining room.
    for (const std::uint32_t round : {1U, 2U, 3U})
      attempt(Purpose::body, round, style_.births * initial * frames / 300.0, 150, [&](core::Rng& rng) {
        Presence life;
        life.begin = change(3 + static_cast<int>(rng.below(static_cast<std::uint32_t>(frames - 8))), rng);
        const int end = life.begin->frame + static_cast<int>(rng.uniform(18, 2 * style_.life / round));
        if (end < frames - 3) life.end = change(end, rng);
        return add_body(life, rng);
      });
  }

  bool add_body(const Presence& life, core::Rng& rng) {
    std::optional<cv::Point2d> beside;
    if (const auto count = static_cast<std::uint32_t>(scene_.bodies.size());
        count > 0 && rng.uniform() < 0.6) {
      const auto& points = scene_.bodies[rng.below(count)].curves[0].points;
      beside = points[rng.below(static_cast<std::uint32_t>(points.size()))];
    }
    Body body = draw_body(scene_.options, flow_, beside, rng);
    if (body.curves.empty()) return false;
    body.life = life;
    Info info{window_of(life, scene_.options.frames), {}, {}};
    // Checking the rest shape first avoids simulating most bodies without room.
    body.first = info.window.first;
    body.modes.assign(1, {});
    if (!has_room(body, {body.first, body.first}, info)) return false;
    body.modes = wind_.sway(body, info.window.first, info.window.last, style_.sway, rng);
    if (!has_room(body, info.window, info)) return false;
    if (life.begin) info.events.push_back(life.begin->frame);
    if (life.end) info.events.push_back(life.end->frame);
    for (auto& curve : body.curves) curve.id = next_id_++;
    scene_.bodies.push_back(std::move(body));
    infos_.push_back(std::move(info));
    return true;
  }

  /// Returns whether a body stays inside the picture and apart from all bodies present at the same time; sets
  /// its box.
  bool has_room(const Body& body, const Window& frames, Info& info) const {
    const cv::Rect2d inside(margin, margin, scene_.options.width - 2 * margin,
                            scene_.options.height - 2 * margin);
    const double inf = std::numeric_limits<double>::infinity();
    cv::Point2d low(inf, inf), high(-inf, -inf);
    std::vector<Line> lines;
    for (int t = frames.first; t <= frames.last; ++t)
      for (const auto& curve : body.curves) {
        lines.push_back(line_at(scene_.options, body, curve, t));
        for (const auto& p : lines.back()) {
          if (!inside.contains(p)) return false;
          low = {std::min(low.x, p.x), std::min(low.y, p.y)};
          high = {std::max(high.x, p.x), std::max(high.y, p.y)};
        }
      }
    info.box = cv::Rect2d(low, high);
    const cv::Rect2d wide(low - cv::Point2d(24, 24), high + cv::Point2d(24, 24));
    for (std::size_t i = 0; i < scene_.bodies.size(); ++i) {
      if (!overlap(info.window, infos_[i].window, pause) || (wide & infos_[i].box).empty()) continue;
      const Body& other = scene_.bodies[i];
      const double least = std::max(apart, 2.4 * (body.sigma + other.sigma)) + 1;  // 1: points, not segments
      for (int t = frames.first; t <= frames.last; ++t) {
        const int there =
            std::clamp(t, infos_[i].window.first, infos_[i].window.last);  // within the pause: its last place
        for (const auto& curve : other.curves) {
          const Line line = line_at(scene_.options, other, curve, there);
          for (std::size_t c = 0; c < body.curves.size(); ++c)
            if (too_near(lines[static_cast<std::size_t>(t - frames.first) * body.curves.size() + c], line,
                         least))
              return false;
        }
      }
    }
    return true;
  }

  [[nodiscard]] bool is_free(std::size_t body, int frame) const {
    const auto& events = infos_[body].events;
    return std::all_of(events.begin(), events.end(),
                       [&](int e) { return std::abs(e - frame) >= events_apart; });
  }

  /// Returns the frames in which gaps and bridges of a body may begin and end.
  [[nodiscard]] Window usable(std::size_t body) const {
    const Presence& life = scene_.bodies[body].life;
    return {life.begin ? life.begin->frame + events_apart + 2 : 0,
            life.end ? life.end->frame - events_apart - 2 : scene_.options.frames - 1};
  }

  /// Draws a presence within a window; at the clip's first or last frame it may lack a begin or an end.
  std::optional<Presence> choose_time(const Window& window, core::Rng& rng) const {
    const int last = scene_.options.frames - 1;
    const int begin = window.first + static_cast<int>(rng.uniform() * (window.last - window.first)) - 2;
    const int end = begin + 9 + static_cast<int>(rng.uniform(0, 30));
    Presence time;
    if (begin >= 3) time.begin = change(begin, rng);
    if (end <= last - 3) time.end = change(end, rng);
    const bool fits = (begin >= std::max(3, window.first) || (begin < 3 && window.first == 0)) &&
                      (end <= std::min(last - 3, window.last) || (end > last - 3 && window.last == last));
    return fits && (time.begin || time.end) ? std::optional(time) : std::nullopt;
  }

  bool take_events(const Presence& time, std::initializer_list<std::size_t> bodies) {
    for (const std::size_t body : bodies)
      if ((time.begin && !is_free(body, time.begin->frame)) || (time.end && !is_free(body, time.end->frame)))
        return false;
    for (const std::size_t body : bodies) {
      if (time.begin) infos_[body].events.push_back(time.begin->frame);
      if (time.end) infos_[body].events.push_back(time.end->frame);
    }
    return true;
  }

  bool add_gap(core::Rng& rng) {
    const std::size_t index =
        rng.below(static_cast<std::uint32_t>(std::max<std::size_t>(1, scene_.bodies.size())));
    if (scene_.bodies.empty()) return false;
    Body& body = scene_.bodies[index];
    const auto points = static_cast<double>(body.curves[0].points.size());
    if (body.curves.size() > 1 || points < 24) return false;
    const auto time = choose_time(usable(index), rng);
    if (!time) return false;
    const Window window = window_of(*time, scene_.options.frames);
    for (const Gap& gap : body.gaps)
      if (overlap(window, window_of(gap.open, scene_.options.frames), pause)) return false;
    Gap gap{points * rng.uniform(0.4, 0.6), rng.uniform(2.9, 3.6) + 0.45 * body.sigma, *time};
    if (std::min(gap.centre, points - 1 - gap.centre) < gap.half_width + 5 || !take_events(*time, {index}))
      return false;
    body.gaps.push_back(gap);
    return true;
  }

  bool add_bridge(core::Rng& rng) {
    const auto count = static_cast<std::uint32_t>(scene_.bodies.size());
    if (count < 2) return false;
    Bridge bridge;
    bridge.from.body = rng.below(count);
    const Body& a = scene_.bodies[bridge.from.body];
    bridge.from.curve = rng.below(static_cast<std::uint32_t>(a.curves.size()));
    const auto& points = a.curves[bridge.from.curve].points;
    bridge.from.point =
        static_cast<std::size_t>(rng.uniform(0.15, 0.85) * static_cast<double>(points.size()));
    const std::vector<Anchor> ends = reachable(bridge.from);
    if (ends.empty()) return false;
    bridge.to = ends[rng.below(static_cast<std::uint32_t>(ends.size()))];
    const Body& b = scene_.bodies[bridge.to.body];
    const Window wa = usable(bridge.from.body), wb = usable(bridge.to.body);
    const auto time = choose_time({std::max(wa.first, wb.first), std::min(wa.last, wb.last)}, rng);
    if (!time) return false;
    bridge.presence = *time;
    bridge.bow = rng.uniform(-0.14, 0.14);
    bridge.sigma = 0.9 * std::min(a.sigma, b.sigma);
    bridge.contrast = 0.8 * std::min(a.contrast, b.contrast);
    if (!bridge_has_room(bridge) || makes_circle(bridge) ||
        !take_events(*time, {bridge.from.body, bridge.to.body}))
      return false;
    bridge.id = next_id_++;
    scene_.bridges.push_back(bridge);
    return true;
  }

  /// Returns the points of other bodies of the same polarity that a bridge from `from` can reach.
  [[nodiscard]] std::vector<Anchor> reachable(const Anchor& from) const {
    const Body& body = scene_.bodies[from.body];
    const cv::Point2d at = body.curves[from.curve].points[from.point];
    std::vector<Anchor> found;
    for (std::size_t i = 0; i < scene_.bodies.size(); ++i) {
      const Body& other = scene_.bodies[i];
      const Window wa = usable(from.body), wb = usable(i);
      if (i == from.body || other.polarity != body.polarity ||
          cv::norm(nearest_in(infos_[i].box, at) - at) > 36 ||
          std::min(wa.last, wb.last) - std::max(wa.first, wb.first) < 12)
        continue;
      for (std::size_t c = 0; c < other.curves.size(); ++c)
        for (std::size_t p = 4; p + 5 < other.curves[c].points.size(); ++p) {
          const cv::Point2d chord = other.curves[c].points[p] - at;
          const Anchor to{i, c, p};
          if (chord.dot(chord) > 14 * 14 && chord.dot(chord) < 34 * 34 && branches(from, chord) &&
              branches(to, chord))
            found.push_back(to);
        }
    }
    return found;
  }

  /// Returns whether a bridge would close a cycle of bodies with others present at the same time.
  [[nodiscard]] bool makes_circle(const Bridge& bridge) const {
    const Window window = window_of(bridge.presence, scene_.options.frames);
    std::vector<std::size_t> root(scene_.bodies.size());
    std::iota(root.begin(), root.end(), std::size_t{0});
    for (const Bridge& other : scene_.bridges) {
      if (!overlap(window, window_of(other.presence, scene_.options.frames), 1)) continue;
      const std::size_t from = root[other.from.body], to = root[other.to.body];
      std::replace(root.begin(), root.end(), from, to);
    }
    return root[bridge.from.body] == root[bridge.to.body];
  }

  [[nodiscard]] bool bridge_has_room(const Bridge& bridge) const {
    const Window window = window_of(bridge.presence, scene_.options.frames);
    for (const std::size_t body : {bridge.from.body, bridge.to.body})
      for (const Gap& gap : scene_.bodies[body].gaps)
        if (overlap(window, window_of(gap.open, scene_.options.frames), pause)) return false;
    for (int t = window.first; t <= window.last; ++t) {
      const Line line = line_at(scene_, bridge, t);
      if (line_length(line) < 13 || line_length(line) > 38) return false;
      if (!stands_off(bridge.from, line[1] - line[0], t) ||
          !stands_off(bridge.to, line[line.size() - 2] - line.back(), t))
        return false;
      for (std::size_t i = 0; i < scene_.bodies.size(); ++i)
        if (overlap(window, infos_[i].window, pause) && touches_body(bridge, line, i, t)) return false;
      for (const Bridge& other : scene_.bridges) {
        const Window there = window_of(other.presence, scene_.options.frames);
        if (overlap(window, there, pause) &&
            too_near(line, line_at(scene_, other, std::clamp(t, there.first, there.last)), apart + 3))
          return false;
      }
    }
    return true;
  }

  /// Returns whether a direction makes 40° or more with the line.
  static bool leaves(const Line& line, std::size_t point, const cv::Point2d& out) {
    if (point < 4 || point + 5 > line.size()) return false;
    const cv::Point2d along = line[point + 2] - line[point - 2];
    return std::abs(along.cross(out)) >
           std::sin(40 * std::numbers::pi / 180) * cv::norm(along) * cv::norm(out);
  }

  [[nodiscard]] bool stands_off(const Anchor& anchor, const cv::Point2d& out, int frame) const {
    const Body& body = scene_.bodies[anchor.body];
    return leaves(line_at(scene_.options, body, body.curves[anchor.curve], frame), anchor.point, out);
  }

  /// Returns whether a bridge branches off at 40° to 68° at rest, as flames and waves do.
  [[nodiscard]] bool branches(const Anchor& anchor, const cv::Point2d& out) const {
    const Line& line = scene_.bodies[anchor.body].curves[anchor.curve].points;
    if (!leaves(line, anchor.point, out)) return false;
    const cv::Point2d along = line[anchor.point + 2] - line[anchor.point - 2];
    return std::abs(along.cross(out)) <
           std::sin(68 * std::numbers::pi / 180) * cv::norm(along) * cv::norm(out);
  }

  [[nodiscard]] bool touches_body(const Bridge& bridge, const Line& line, std::size_t index,
                                  int frame) const {
    const Body& body = scene_.bodies[index];
    const int there = std::clamp(frame, infos_[index].window.first, infos_[index].window.last);
    for (std::size_t c = 0; c < body.curves.size(); ++c) {
      const Line curve = line_at(scene_.options, body, body.curves[c], there);
      const bool own = (index == bridge.from.body && c == bridge.from.curve) ||
                       (index == bridge.to.body && c == bridge.to.curve);
      if (!own && too_near(line, curve, apart + 1)) return true;
      // It may touch its own bodies only at its ends.
      if (own && too_near(Line(line.begin() + static_cast<std::ptrdiff_t>(line.size() / 2),
                               line.begin() + static_cast<std::ptrdiff_t>(line.size() / 2 + 1)),
                          curve, 4.5))
        return true;
    }
    return false;
  }

  const Style& style_;
  Wind wind_;
  Scene scene_;
  std::vector<Info> infos_;
  std::array<double, 4> flow_{};
  double showing_ = 1;
  int next_id_ = 0;
};

}  // namespace

Scene plan_scene(const BuiltinOptions& options) {
  return Planner(options).plan();
}

}  // namespace emberfold::apps
