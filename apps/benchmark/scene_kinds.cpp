// SPDX-License-Identifier: Apache-2.0
#include "apps/benchmark/scene_kinds.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <sstream>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "apps/builtin/builtin_clip.hpp"
#include "apps/builtin/rust.hpp"
#include "core/error.hpp"
#include "core/parallel.hpp"
#include "core/text/check_range.hpp"
#include "graph/io/motion_io.hpp"

namespace emberfold::apps {

namespace {

using graph::EventType;
using std::numbers::pi;

constexpr double kSway = 2.2, kStill = 0.8;  // px, SD of the flow
constexpr std::uint32_t kPlanStream = 100;
constexpr int kQuiet = 4;  // frames without events at both ends of a clip

/// Returns a change at a frame over one to three frames.
Change change_at(int frame, core::Rng& rng) {
  return {frame, 1 + static_cast<int>(rng.below(3))};
}
Presence from(const Change& change) {
  return {change, {}};
}
Presence until(const Change& change) {
  return {{}, change};
}
/// Returns a frame at a share of the clip, plus or minus up to `spread` frames.
int time_at(const LineScene& scene, double share, int spread, core::Rng& rng) {
  const int about = static_cast<int>(std::lround(share * scene.frames));
  const int moved = about - spread + static_cast<int>(rng.below(static_cast<std::uint32_t>(2 * spread + 1)));
  return std::clamp(moved, kQuiet, scene.frames - kQuiet - 1);
}

/// Returns a part of a line that moves like the whole.
SceneLine part_of(const SceneLine& whole, double first, double last) {
  SceneLine part = whole;
  const auto n = static_cast<double>(whole.rest.size() - 1);
  const auto a = static_cast<std::ptrdiff_t>(std::lround(first * n)),
             b = static_cast<std::ptrdiff_t>(std::lround(last * n));
  part.rest.assign(whole.rest.begin() + a, whole.rest.begin() + b + 1);
  if (whole.move) {
    const double begin = static_cast<double>(a) / n, length = static_cast<double>(b - a) / n;
    part.move = [move = whole.move, begin, length](double share, int t) {
      return move(begin + share * length, t);
    };
  }
  return part;
}

/// Adds a line with a gap of `half` px on each side of a place, from one frame to another.
void add_line_with_gap(LineScene& scene, const SceneLine& line, double share, double half,
                       const Change& opens, const Change& closes) {
  const double reach = half / (2 * static_cast<double>(line.rest.size() - 1));
  SceneLine early = part_of(line, share - reach, share + reach), late = early;
  early.presence.end = opens;
  late.presence.begin = closes;
  if (line.presence.end) late.presence.end = line.presence.end;
  for (const SceneLine& one : {part_of(line, 0, share - reach), part_of(line, share + reach, 1), early, late})
    scene.lines.push_back(one);
  tell(scene, opens.frame, EventType::split, line, share);
  tell(scene, closes.frame, EventType::merge, line, share);
}

/// Adds tongues of flame: each loses its tip, which rises and dies; an arm is born next to it, joins it,
/// separates and dies.
void add_flames(LineScene& scene, core::Rng& rng) {
  constexpr int kTongues = 5;
  constexpr double kSpacing = 58, kRise = 1.3, kArm = 30, kFoot = 16;
  for (int k = 0; k < kTongues; ++k) {
    const double x = 44 + kSpacing * k + rng.uniform(-4, 4), height = rng.uniform(120, 165);
    const double lean = rng.uniform(-8, 8), phase = rng.uniform(0, 2 * pi),
                 turn = 2 * pi / rng.uniform(18, 34);
    SceneLine tongue{{}, rng.uniform(55, 85), rng.uniform(1.6, 2.2), {}, {}};
    for (double s = 0; s <= 1; s += 2 / height)
      tongue.rest.emplace_back(x + lean * s + 4 * std::sin(4 * s + phase), 226 - height * s);
    tongue.move = [phase, turn](double s, int t) {
      return cv::Point2d(3.5 * std::pow(s, 1.5) * std::sin(turn * t + phase), 0);
    };
    const double cut = rng.uniform(0.62, 0.74);
    const Change breaks = change_at(time_at(scene, 0.22, 14, rng), rng);
    const Change dies = change_at(
        std::min(scene.frames - kQuiet - 1, breaks.frame + 14 + static_cast<int>(rng.below(6))), rng);
    const double half = 5 / height;
    scene.lines.push_back(part_of(tongue, 0, cut - half));
    SceneLine bridge = part_of(tongue, cut - half, cut + half), tip = part_of(tongue, cut + half, 1);
    bridge.presence = until(breaks);
    tip.presence = until(dies);
    tip.move = [move = tip.move, begins = breaks.frame](double s, int t) {
      return move(s, t) - cv::Point2d(0, kRise * std::max(0, t - begins));
    };
    tell(scene, breaks.frame, EventType::split, bridge, 0.5);
    tell(scene, dies.frame, EventType::death, tip, 0.5);
    scene.lines.push_back(bridge), scene.lines.push_back(tip);
    // The arm leaves the tongue at a third of its height; its foot appears and disappears.
    const double share = rng.uniform(0.25, 0.38);
    const auto root = static_cast<std::size_t>(share * static_cast<double>(tongue.rest.size() - 1));
    const cv::Point2d out = cv::Point2d(0.68, -0.73);
    SceneLine arm = tongue;
    arm.rest = straight_line(tongue.rest[root], tongue.rest[root] + (kFoot + kArm) * out);
    arm.move = [move = tongue.move, share](double, int t) { return move(share, t); };
    const double joint = kFoot / (kFoot + kArm);
    SceneLine foot = part_of(arm, 0, joint), limb = part_of(arm, joint, 1);
    const Change born = change_at(time_at(scene, 0.3, 10, rng), rng),
                 joins = change_at(time_at(scene, 0.5, 5, rng), rng);
    const Change leaves = change_at(time_at(scene, 0.68, 5, rng), rng),
                 gone = change_at(time_at(scene, 0.85, 6, rng), rng);
    limb.presence = {born, gone}, foot.presence = {joins, leaves};
    tell(scene, born.frame, EventType::birth, limb, 0.5);
    tell(scene, joins.frame, EventType::connect, foot, 0.5);
    tell(scene, leaves.frame, EventType::disconnect, foot, 0.5);
    tell(scene, gone.frame, EventType::death, limb, 0.5);
    scene.lines.push_back(limb), scene.lines.push_back(foot);
  }
}

/// Adds parallel folds, alternately bright and dark.
void add_folds(LineScene& scene, core::Rng& rng) {
  const double bend = rng.uniform(4, 9), phase = rng.uniform(0, 2 * pi);
  int k = 0;
  for (double x = 26; x < scene.width - 26; x += rng.uniform(12, 16), ++k) {
    SceneLine fold{{}, (k % 2 == 0 ? 1 : -1) * rng.uniform(40, 60), rng.uniform(1.6, 2.1), {}, {}};
    for (double y = 24; y <= scene.height - 24; y += 2)
      fold.rest.emplace_back(x + bend * std::sin(y / 60 + phase), y);
    const std::uint32_t what = rng.below(4);
    if (what == 0) {
      scene.lines.push_back(fold);
    } else if (what == 1) {
      const Change born = change_at(time_at(scene, 0.3, 15, rng), rng),
                   gone = change_at(time_at(scene, 0.75, 12, rng), rng);
      fold.presence = {born, gone};
      tell(scene, born.frame, EventType::birth, fold, 0.5);
      tell(scene, gone.frame, EventType::death, fold, 0.5);
      scene.lines.push_back(fold);
    } else {
      const Change opens = change_at(time_at(scene, 0.3, 18, rng), rng),
                   closes = change_at(time_at(scene, 0.72, 15, rng), rng);
      add_line_with_gap(scene, fold, rng.uniform(0.25, 0.75), 7, opens, closes);
    }
  }
}

/// Adds pairs of rings: born, growing until they touch, shrinking apart, and dying.
void add_ripples(LineScene& scene, core::Rng& rng) {
  constexpr double kLeast = 11, kMost = 27, kSigma = 1.8;
  for (int k = 0; k < 4; ++k) {
    const int column = k % 2, row = k / 2;
    const cv::Point2d middle(84 + 152 * column + rng.uniform(-6, 6), 64 + 112 * row + rng.uniform(-6, 6));
    const double angle = rng.uniform(-0.6, 0.6);
    const cv::Point2d half = kMost * cv::Point2d(std::cos(angle), std::sin(angle));
    const int born = time_at(scene, 0.1, 6, rng), touches = born + 22 + static_cast<int>(rng.below(10));
    const int parts = std::min(touches + 14 + static_cast<int>(rng.below(10)), scene.frames - 26);
    const int gone = std::min(parts + 18 + static_cast<int>(rng.below(6)), scene.frames - kQuiet - 1);
    const auto radius = [=](int t) {
      const double in = std::clamp(static_cast<double>(t - born) / (touches - born), 0.0, 1.0);
      const double out = std::clamp(static_cast<double>(t - parts + 1) / (gone - parts + 1), 0.0, 1.0);
      return kLeast + (kMost - kLeast) * (in - out);
    };
    for (const double side : {-1.0, 1.0}) {
      SceneLine ring{{}, rng.uniform(50, 75), kSigma, {}, {}};
      const cv::Point2d centre = middle + side * half;
      constexpr int kPoints = 48;
      for (int i = 0; i <= kPoints; ++i) ring.rest.push_back(centre);
      ring.move = [radius](double s, int t) {
        return radius(t) * cv::Point2d(std::cos(2 * pi * s), std::sin(2 * pi * s));
      };
      const int later = side > 0 ? static_cast<int>(rng.below(8)) : 0;
      const Change comes = change_at(born + later, rng), goes = change_at(gone - later, rng);
      ring.presence = {comes, goes};
      scene.lines.push_back(ring);
      SceneLine centre_line = ring;
      centre_line.move = {};
      tell(scene, comes.frame, EventType::birth, centre_line, 0);
      tell(scene, goes.frame, EventType::death, centre_line, 0);
    }
    // Two profiles merge where the level between them is at least half of theirs.
    SceneLine touch{straight_line(middle, middle), 1, 1, {}, {}};
    const auto is_one = [&](int t) { return 2 * (kMost - radius(t)) <= 2.35 * kSigma; };
    for (int t = born + 1; t < gone; ++t)
      if (is_one(t) != is_one(t - 1))
        tell(scene, t, is_one(t) ? EventType::connect : EventType::disconnect, touch, 0);
  }
}

/// Adds trees of four nodes on a grid; edges between neighbouring trees appear and disappear, and never close
/// a ring.
void add_networks(LineScene& scene, core::Rng& rng) {
  constexpr int kColumns = 6, kRows = 4;
  std::array<std::array<cv::Point2d, kColumns>, kRows> nodes;
  for (int r = 0; r < kRows; ++r)
    for (int c = 0; c < kColumns; ++c)
      nodes.at(static_cast<std::size_t>(r)).at(static_cast<std::size_t>(c)) =
          cv::Point2d(34 + 50.4 * c + rng.uniform(-7, 7), 34 + 57 * r + rng.uniform(-7, 7));
  const auto node = [&](int r, int c) {
    return nodes.at(static_cast<std::size_t>(r)).at(static_cast<std::size_t>(c));
  };
  const auto edge = [&](const cv::Point2d& a, const cv::Point2d& b, const Presence& presence) {
    SceneLine line{straight_line(a, b), rng.uniform(50, 75), 1.8, presence, {}};
    scene.lines.push_back(line);
    return line;
  };
  for (int r = 0; r < kRows; r += 2)
    for (int c = 0; c < kColumns; c += 2) {
      edge(node(r, c), node(r, c + 1), {});
      edge(node(r, c), node(r + 1, c), {});
      edge(node(r + 1, c), node(r + 1, c + 1), {});
    }
  // The edges of one spanning tree among the seven pairs of neighbouring trees.
  std::vector<std::pair<cv::Point2d, cv::Point2d>> bridges;
  for (int c = 1; c + 1 < kColumns; c += 2)
    bridges.emplace_back(node(0, c), node(0, c + 1)), bridges.emplace_back(node(3, c), node(3, c + 1));
  bridges.emplace_back(node(1, 2 * static_cast<int>(rng.below(3))), cv::Point2d());
  for (int c = 0; c < kColumns; c += 2)
    if (bridges.back().first == node(1, c)) bridges.back().second = node(2, c);
  for (const auto& [a, b] : bridges) {
    for (int t = kQuiet + 4 + static_cast<int>(rng.below(14)); t + 18 < scene.frames;) {
      const int end = t + 14 + static_cast<int>(rng.below(16));
      const Change comes = change_at(t, rng), goes = change_at(end, rng);
      const bool stays = end >= scene.frames - kQuiet;
      const SceneLine line = edge(a, b, stays ? from(comes) : Presence{comes, goes});
      tell(scene, comes.frame, EventType::connect, line, 0.5);
      if (!stays) tell(scene, goes.frame, EventType::disconnect, line, 0.5);
      t = end + 12 + static_cast<int>(rng.below(14));
    }
  }
}

/// Adds filaments that move to and fro and turn, touching and crossing each other, of different contrasts.
void add_filaments(LineScene& scene, core::Rng& rng) {
  constexpr int kFilaments = 9;
  for (int k = 0; k < kFilaments; ++k) {
    const double length = rng.uniform(45, 75), angle = rng.uniform(0, pi), spin = rng.uniform(-0.012, 0.012);
    const int column = k % 3, row = k / 3;
    const cv::Point2d middle(70 + 90 * column + rng.uniform(-12, 12), 64 + 56 * row + rng.uniform(-8, 8));
    const double heading = rng.uniform(0, 2 * pi), phase = rng.uniform(0, 2 * pi);
    const double turn = 2 * pi / rng.uniform(60, 110);
    const cv::Point2d way = rng.uniform(18, 32) * cv::Point2d(std::cos(heading), std::sin(heading));
    SceneLine line{{}, rng.uniform(45, 110), rng.uniform(1.4, 1.9), {}, {}};
    for (double s = -length / 2; s <= length / 2; s += 2) line.rest.push_back(middle);
    line.move = [=](double share, int t) {
      const double now = angle + spin * t, s = (share - 0.5) * length, bow = 0.0015 * s * s;
      const cv::Point2d along(std::cos(now), std::sin(now));
      return s * along + bow * cv::Point2d(-along.y, along.x) + std::sin(turn * t + phase) * way;
    };
    scene.lines.push_back(line);
  }
}

std::vector<cv::Mat> draw_sway(const cv::Mat& picture, const SceneOptions& options, const SceneFlow& flow,
                               const core::Context& context) {
  std::vector<cv::Mat> frames(static_cast<std::size_t>(options.frames));
  core::parallel_for(frames.size(), context, [&](std::size_t k) {
    cv::Mat map(picture.size(), CV_32FC2), frame;
    for (int y = 0; y < map.rows; ++y)
      for (int x = 0; x < map.cols; ++x) {
        const cv::Point2d from = cv::Point2d(x, y) - flow.at({double(x), double(y)}, static_cast<int>(k));
        map.at<cv::Vec2f>(y, x) = {static_cast<float>(from.x), static_cast<float>(from.y)};
      }
    cv::remap(picture, frame, map, {}, cv::INTER_CUBIC, cv::BORDER_REFLECT_101);
    core::Rng noise(options.seed, {103, static_cast<std::uint32_t>(k)});
    for (int y = 0; y < frame.rows; ++y)
      for (int x = 0; x < frame.cols; ++x)
        for (int c = 0; c < 3; ++c) {
          auto& value = frame.at<cv::Vec3b>(y, x)[c];
          value = cv::saturate_cast<std::uint8_t>(value + 2 * noise.normal());
        }
    frames[k] = frame;
  });
  return frames;
}

/// Returns the picture at 320 px across and an even height, in colour.
cv::Mat swaying_picture(const SceneOptions& options, const core::Context& context) {
  cv::Mat picture = options.picture;
  if (picture.empty()) {
    BuiltinOptions rust;
    rust.seed = options.seed, rust.frames = 60;
    picture = make_rust(rust, context).frames.back();
  }
  constexpr int kWidth = 320;
  const int height =
      2 * std::max(16, static_cast<int>(std::lround(picture.rows * (kWidth / 2.0) / picture.cols)));
  cv::Mat sized;
  cv::resize(picture, sized, {kWidth, height}, 0, 0,
             picture.cols > kWidth ? cv::INTER_AREA : cv::INTER_LINEAR);
  if (sized.channels() == 1) cv::cvtColor(sized, sized, cv::COLOR_GRAY2BGR);
  return sized;
}

MadeScene clip_of(std::vector<cv::Mat> frames, std::vector<graph::Event> truth) {
  MadeScene made;
  const cv::Mat& first = frames.front();
  made.clip.info = {.width = first.cols,
                    .height = first.rows,
                    .channels = first.channels(),
                    .depth = CV_8U,
                    .fps = 25,
                    .white = 255,
                    .frames = static_cast<std::int64_t>(frames.size())};
  made.clip.frames = std::move(frames);
  made.truth = std::move(truth);
  graph::sort_events(made.truth);
  return made;
}

}  // namespace

std::vector<SceneKind> all_scene_kinds() {
  using enum SceneKind;
  return {strokes, flames, folds, ripples, networks, filaments, sway};
}

std::string_view name(SceneKind kind) {
  constexpr std::array<std::string_view, 7> kNames{"strokes",  "flames",    "folds", "ripples",
                                                   "networks", "filaments", "sway"};
  return kNames.at(static_cast<std::size_t>(kind));
}

std::optional<SceneKind> scene_kind(std::string_view text) {
  for (const SceneKind kind : all_scene_kinds())
    if (name(kind) == text) return kind;
  return std::nullopt;
}

void SceneOptions::validate() const {
  core::check_range("SceneOptions.frames", frames, 60, 1000);
}

LineScene plan_line_scene(SceneKind kind, const SceneOptions& options) {
  options.validate();
  core::Rng rng(options.seed, {kPlanStream, static_cast<std::uint32_t>(kind)});
  const SceneFlow flow(rng, kind == SceneKind::ripples ? kStill : kSway);
  LineScene scene{.seed = options.seed + 1000 * static_cast<std::uint64_t>(kind),
                  .flow = flow,
                  .lines = {},
                  .events = {}};
  scene.frames = options.frames;
  switch (kind) {
    case SceneKind::flames:
      add_flames(scene, rng);
      break;
    case SceneKind::folds:
      add_folds(scene, rng);
      break;
    case SceneKind::ripples:
      add_ripples(scene, rng);
      break;
    case SceneKind::networks:
      add_networks(scene, rng);
      break;
    case SceneKind::filaments:
      add_filaments(scene, rng);
      break;
    default:
      throw core::InputError("scenes of " + std::string(name(kind)) + " are not made of lines");
  }
  graph::sort_events(scene.events);
  return scene;
}

MadeScene make_scene(SceneKind kind, const SceneOptions& options, const core::Context& context) {
  options.validate();
  if (kind == SceneKind::strokes) {
    BuiltinOptions cloth;
    cloth.scene = BuiltinScene::cloth, cloth.seed = options.seed, cloth.frames = options.frames;
    auto built = make_builtin(cloth, context);
    std::istringstream truth(built.truth_json);
    return {std::move(built.clip), graph::read_events(truth, "truth")};
  }
  if (kind == SceneKind::sway) {
    core::Rng rng(options.seed, {kPlanStream, static_cast<std::uint32_t>(kind)});
    const SceneFlow flow(rng, kSway);
    return clip_of(draw_sway(swaying_picture(options, context), options, flow, context), {});
  }
  LineScene scene = plan_line_scene(kind, options);
  return clip_of(draw_scene(scene, context), std::move(scene.events));
}

}  // namespace emberfold::apps
