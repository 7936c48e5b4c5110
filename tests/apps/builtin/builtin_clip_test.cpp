// SPDX-License-Identifier: Apache-2.0
#include "apps/builtin/builtin_clip.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <set>

#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "apps/builtin/open_clip.hpp"
#include "apps/builtin/render.hpp"
#include "apps/builtin/scene.hpp"
#include "apps/builtin/truth.hpp"
#include "core/error.hpp"
#include "core/io/clip_reader.hpp"
#include "core/parallel.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/clip_fixture.hpp"
#include "tests/support/messages.hpp"

using namespace emberfold;
using namespace emberfold::apps;
using namespace emberfold::test;
using nlohmann::json;

namespace {

constexpr std::array<BuiltinScene, 3> scenes{BuiltinScene::fire, BuiltinScene::cloth, BuiltinScene::river};

/// A stroke or piece of one, as the truth lists it.
struct Piece {
  int id = 0;
  Line points;
};

double distance(const cv::Point2d& p, const Line& line) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < line.size(); ++i) {
    const cv::Point2d along = line[i] - line[i - 1];
    const double squared = along.dot(along);
    const double s = squared > 0 ? std::clamp((p - line[i - 1]).dot(along) / squared, 0.0, 1.0) : 0;
    least = std::min(least, cv::norm(p - line[i - 1] - s * along));
  }
  return least;
}

double distance(const Line& a, const Line& b) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& p : a) least = std::min(least, distance(p, b));
  for (const auto& p : b) least = std::min(least, distance(p, a));
  return least;
}

/// Mean distance of the points of a from b.
double mean_distance(const Line& a, const Line& b) {
  double sum = 0;
  for (const auto& p : a) sum += distance(p, b);
  return sum / static_cast<double>(a.size());
}

std::size_t root_of(std::vector<std::size_t>& parent, std::size_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

/// A frame of the truth, its pieces joined where they meet at a junction.
struct Frame {
  std::vector<Piece> pieces;
  std::vector<std::size_t> component;  ///< of each piece, the least piece in it
};

Frame frame_of(const json& truth, std::size_t t) {
  Frame frame;
  for (const auto& stroke : truth["strokes"][t]) {
    Piece piece{stroke["id"], {}};
    for (const auto& p : stroke["points"]) piece.points.emplace_back(p[0], p[1]);
    frame.pieces.push_back(std::move(piece));
  }
  std::vector<std::size_t> parent(frame.pieces.size());
  std::iota(parent.begin(), parent.end(), std::size_t{0});
  for (const auto& junction : truth["junctions"][t]) {
    const cv::Point2d at(junction[0], junction[1]);
    std::optional<std::size_t> first;
    for (std::size_t i = 0; i < frame.pieces.size(); ++i) {
      if (distance(at, frame.pieces[i].points) > 0.1) continue;
      if (first)
        parent[root_of(parent, i)] = root_of(parent, *first);
      else
        first = i;
    }
  }
  for (std::size_t i = 0; i < parent.size(); ++i) frame.component.push_back(root_of(parent, i));
  return frame;
}

struct Tally {
  int births = 0, deaths = 0, unions = 0, separations = 0;
  bool operator==(const Tally&) const = default;
};

/// Counts events between two frames from their pieces alone: those of one id that lie on each other are
/// linked, and components that links tie together make a cluster of p before and q after.
Tally count_events(const Frame& before, const Frame& after) {
  const std::size_t n = before.pieces.size();
  std::vector<std::size_t> parent(n + after.pieces.size());
  std::iota(parent.begin(), parent.end(), std::size_t{0});
  for (std::size_t i = 0; i < n; ++i) parent[root_of(parent, i)] = root_of(parent, before.component[i]);
  for (std::size_t j = 0; j < after.pieces.size(); ++j)
    parent[root_of(parent, n + j)] = root_of(parent, n + after.component[j]);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < after.pieces.size(); ++j) {
      const Piece &a = before.pieces[i], &b = after.pieces[j];
      if (a.id == b.id && std::min(mean_distance(a.points, b.points), mean_distance(b.points, a.points)) < 5)
        parent[root_of(parent, i)] = root_of(parent, n + j);
    }
  std::map<std::size_t, std::pair<std::set<std::size_t>, std::set<std::size_t>>> clusters;
  for (std::size_t i = 0; i < n; ++i) clusters[root_of(parent, i)].first.insert(before.component[i]);
  for (std::size_t j = 0; j < after.pieces.size(); ++j)
    clusters[root_of(parent, n + j)].second.insert(after.component[j]);
  Tally change;
  for (const auto& [root, sides] : clusters) {
    if (sides.first.empty()) ++change.births;
    if (sides.second.empty()) ++change.deaths;
    if (sides.first.empty() || sides.second.empty()) continue;
    change.unions += static_cast<int>(sides.first.size()) - 1;
    change.separations += static_cast<int>(sides.second.size()) - 1;
  }
  return change;
}

Tally told_events(const json& truth, int frame) {
  Tally change;
  for (const auto& event : truth["events"]) {
    if (event["frame"] != frame) continue;
    const std::string type = event["type"];
    change.births += type == "birth";
    change.deaths += type == "death";
    change.unions += type == "merge" || type == "connect";
    change.separations += type == "split" || type == "disconnect";
  }
  return change;
}

json truth_for(BuiltinScene scene, std::uint64_t seed) {
  BuiltinOptions options;
  options.scene = scene;
  options.seed = seed;
  return json::parse(truth_of(plan_scene(options)));
}

double at(const cv::Mat& field, const cv::Point2d& p) {
  cv::Mat value;
  cv::getRectSubPix(field, {1, 1}, cv::Point2f(static_cast<float>(p.x), static_cast<float>(p.y)), value);
  return static_cast<double>(value.at<float>(0, 0));
}

}  // namespace

TEST_CASE("a change is at or past half from its frame on, and never at half") {
  for (int fade = 1; fade <= 3; ++fade) {
    const Change change{10, fade};
    double before = 0;
    for (int t = 0; t < 20; ++t) {
      const double done = change.progress(t);
      CHECK(done >= before);
      CHECK((done > 0.5) == (t >= 10));
      CHECK(std::abs(done - 0.5) > 0.1);
      before = done;
    }
    CHECK(change.progress(10 - 3) == 0);
    CHECK(change.progress(10 + 3) == 1);
  }
}

TEST_CASE("the events told are those that the listed strokes and junctions show") {
  for (const auto scene : scenes)
    for (const std::uint64_t seed : {1U, 2U}) {
      const json truth = truth_for(scene, seed);
      REQUIRE(truth["strokes"].size() == 120);
      REQUIRE(truth["junctions"].size() == 120);
      Frame before = frame_of(truth, 0);
      CHECK(told_events(truth, 0) == Tally{});
      for (int t = 1; t < 120; ++t) {
        const Frame after = frame_of(truth, static_cast<std::size_t>(t));
        const Tally seen = count_events(before, after), told = told_events(truth, t);
        INFO(truth["kind"] << " seed " << seed << " frame " << t << ": seen " << seen.births << ' '
                           << seen.deaths << ' ' << seen.unions << ' ' << seen.separations << ", told "
                           << told.births << ' ' << told.deaths << ' ' << told.unions << ' '
                           << told.separations);
        CHECK(seen == told);
        before = after;
      }
    }
}

TEST_CASE("events lie on the strokes that they happen to, and what does not touch is apart") {
  for (const auto scene : scenes) {
    const json truth = truth_for(scene, 3);
    std::vector<Frame> frames;
    for (std::size_t t = 0; t < 120; ++t) frames.push_back(frame_of(truth, t));
    for (const auto& event : truth["events"]) {
      const std::string type = event["type"];
      const auto t = event["frame"].get<std::size_t>();
      // Strokes that vanish are in the frame before; a gap is absent while it is open.
      const bool earlier = type == "death" || type == "disconnect" || type == "split";
      double least = 1e9;
      for (const Piece& piece : frames[earlier ? t - 1 : t].pieces)
        least = std::min(least, distance(cv::Point2d(event["x"], event["y"]), piece.points));
      INFO(event.dump());
      CHECK(least < (type == "split" ? 4 : 0.5));
    }
    for (const Frame& frame : frames)
      for (std::size_t i = 0; i < frame.pieces.size(); ++i)
        for (std::size_t j = 0; j < i; ++j) {
          const Piece &a = frame.pieces[i], &b = frame.pieces[j];
          if (frame.component[i] != frame.component[j])
            CHECK(distance(a.points, b.points) >= (a.id == b.id ? 8 : 10));
        }
  }
}

TEST_CASE("strokes are long enough, stay in the picture and move as their auto-regression says") {
  for (const auto scene : scenes) {
    BuiltinOptions options;
    options.scene = scene;
    const Scene plan = plan_scene(options);
    const cv::Rect2d picture(4, 4, options.width - 8, options.height - 8);
    std::size_t looked = 0;
    for (const Body& body : plan.bodies) {
      for (int t = body.first; t < body.first + static_cast<int>(body.modes.size()); ++t)
        for (const auto& curve : body.curves) {
          const Line line = line_at(options, body, curve, t);
          CHECK(line_length(line) >= 30);
          CHECK(std::all_of(line.begin(), line.end(), [&](const auto& p) { return picture.contains(p); }));
        }
      CHECK(body.ar[1] > -1);
      CHECK(std::abs(body.ar[0]) < 1 - body.ar[1]);
      if (body.modes.size() < 60) continue;
      // Least squares of q_t on q_{t−1} and q_{t−2}; the modes weighted alike.
      cv::Matx22d normal = cv::Matx22d::zeros();
      cv::Vec2d right(0, 0);
      for (std::size_t m = 0; m < 3; ++m) {
        double power = 0;
        for (const auto& q : body.modes) power += q[m] * q[m];
        for (std::size_t t = 2; t < body.modes.size(); ++t) {
          const cv::Vec2d past(body.modes[t - 1][m], body.modes[t - 2][m]);
          normal += past * past.t() * (1 / power);
          right += past * (body.modes[t][m] / power);
        }
      }
      const cv::Vec2d found = normal.inv() * right;
      CHECK_THAT(found[0], Catch::Matchers::WithinAbs(body.ar[0], 0.12));
      CHECK_THAT(found[1], Catch::Matchers::WithinAbs(body.ar[1], 0.12));
      ++looked;
    }
    CHECK(looked >= 1);
  }
}

TEST_CASE("a clip has as many events as its kind should, of every type") {
  for (const auto scene : scenes)
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      const json truth = truth_for(scene, seed);
      std::set<std::string> types;
      for (const auto& event : truth["events"]) types.insert(event["type"].get<std::string>());
      const std::size_t events = truth["events"].size();
      INFO(truth["kind"] << " seed " << seed << ": " << events);
      CHECK(types.size() == 6);
      CHECK(events >= (scene == BuiltinScene::cloth ? 20 : 60));
      CHECK(events <= (scene == BuiltinScene::cloth ? 80 : 160));
    }
}

TEST_CASE("what is drawn on a centre line is the contrast that the plan tells, gaps and fades included") {
  for (const auto scene : scenes) {
    BuiltinOptions options;
    options.scene = scene;
    const Scene plan = plan_scene(options);
    std::size_t gap_points = 0, fading = 0;
    for (int t = 0; t < options.frames; t += 7) {
      const cv::Mat strokes = render_strokes(plan, t);
      for (const Body& body : plan.bodies) {
        const double there = body.life.contrast_at(t);
        if (there <= 0) continue;
        fading += there < 1;
        for (std::size_t c = 0; c < body.curves.size(); ++c) {
          const Line line = line_at(options, body, body.curves[c], t);
          for (std::size_t i = 2; i + 2 < line.size(); ++i) {
            const double left = c == 0 ? gap_contrast(body, static_cast<double>(i), t) : 1;
            const double full = body.contrast * contrast_profile(plan, body, i, line.size(), t);
            const double drawn = body.polarity * at(strokes, line[i]);
            if (left > 0.99) {
              CHECK(drawn > 0.82 * there * full);
              CHECK(drawn < 1.25 * std::max(there, 0.0) * full +
                                0.8 * body.contrast * (body.curves.size() > 1 || there < 1));
            } else if (left < 0.05) {
              CHECK(drawn < 0.5 * there * full);
              ++gap_points;
            }
          }
        }
      }
    }
    CHECK(gap_points > 10);
    CHECK(fading > 0);
  }
}

TEST_CASE("in the finished frame strokes stand out from both flanks as their polarity says") {
  for (const auto scene : scenes) {
    BuiltinOptions options;
    options.scene = scene;
    const Scene plan = plan_scene(options);
    const json truth = json::parse(truth_of(plan));
    std::size_t points = 0, clear = 0;
    for (const int t : {5, 40, 90}) {
      cv::Mat grey, levels;
      cv::cvtColor(render_frame(plan, t), grey, cv::COLOR_BGR2GRAY);
      grey.convertTo(levels, CV_32F);
      for (const auto& stroke : truth["strokes"][static_cast<std::size_t>(t)]) {
        const double off = 3 * stroke["sigma"].get<double>();
        for (std::size_t i = 3; i + 3 < stroke["points"].size(); ++i) {
          const auto point = [&](std::size_t k) {
            return cv::Point2d(stroke["points"][k][0], stroke["points"][k][1]);
          };
          const cv::Point2d along = point(i + 1) - point(i - 1), p = point(i);
          const cv::Point2d normal = off / cv::norm(along) * cv::Point2d(-along.y, along.x);
          const double flanks = 0.5 * (at(levels, p + normal) + at(levels, p - normal));
          clear += stroke["polarity"].get<double>() * (at(levels, p) - flanks) > 3 * builtin_noise;
          ++points;
        }
      }
    }
    INFO(truth["kind"] << ": " << clear << " of " << points);
    CHECK(points > 300);
    CHECK(static_cast<double>(clear) > 0.93 * static_cast<double>(points));
  }
}

TEST_CASE("a clip depends on its options alone, not on the threads") {
  for (const auto scene : scenes) {
    BuiltinOptions options{scene, 7, 120, 90, 12, 25};
    std::vector<BuiltinClip> clips;
    for (const std::size_t threads : {1U, 2U, 4U}) {
      const core::ThreadLimit limit(threads);
      clips.push_back(make_builtin(options));
    }
    for (const auto& made : clips) {
      CHECK(made.truth_json == clips[0].truth_json);
      CHECK(made.clip.info == core::ClipInfo{120, 90, 3, CV_8U, 25, 255, 12});
      REQUIRE(made.clip.frames.size() == 12);
      for (std::size_t t = 0; t < 12; ++t) CHECK(same_pixels(made.clip.frames[t], clips[0].clip.frames[t]));
    }
    options.seed = 8;
    const BuiltinClip other = make_builtin(options);
    CHECK(other.truth_json != clips[0].truth_json);
    CHECK_FALSE(same_pixels(other.clip.frames[0], clips[0].clip.frames[0]));
  }
}

TEST_CASE("pixel noise is as told") {
  BuiltinOptions options{BuiltinScene::river, 1, 160, 120, 2, 25};
  const Scene quiet = plan_scene(options);
  // Ground and strokes differ little between neighbouring pixels; second differences along rows leave the
  // noise.
  cv::Mat grey, levels;
  cv::cvtColor(render_frame(quiet, 0), grey, cv::COLOR_BGR2GRAY);
  grey.convertTo(levels, CV_64F);
  const cv::Mat strokes = render_strokes(quiet, 0);
  double sum = 0, count = 0;
  for (int y = 0; y < levels.rows; ++y)
    for (int x = 1; x + 1 < levels.cols; ++x)
      if (cv::norm(strokes(cv::Rect(x - 1, y, 3, 1)), cv::NORM_INF) == 0) {
        const double bend =
            levels.at<double>(y, x - 1) - 2 * levels.at<double>(y, x) + levels.at<double>(y, x + 1);
        sum += bend * bend / 6;
        ++count;
      }
  REQUIRE(count > 3000);
  CHECK_THAT(std::sqrt(sum / count), Catch::Matchers::WithinAbs(builtin_noise, 0.15));
}

TEST_CASE("options are checked before memory is taken") {
  const auto error_of = [](const std::function<void(BuiltinOptions&)>& set) {
    BuiltinOptions options;
    set(options);
    return message_of<core::InputError>([&] { make_builtin(options); });
  };
  CHECK(contains(error_of([](auto& o) { o.width = 63; }), "width is 63"));
  CHECK(contains(error_of([](auto& o) { o.height = 5000; }), "height is 5000"));
  CHECK(contains(error_of([](auto& o) { o.frames = 1; }), "frames is 1"));
  CHECK(contains(error_of([](auto& o) { o.fps = std::numeric_limits<double>::quiet_NaN(); }),
                 "fps is not finite"));
  CHECK(contains(error_of([](auto& o) { o.fps = 0; }), "fps is 0"));
  CHECK(contains(error_of([](auto& o) {
                   o.width = o.height = 4096;
                   o.frames = 10000;
                 }),
                 "MiB"));
  const std::string unknown = message_of<core::InputError>([] { apps::open_clip("builtin:smoke", {}, {}); });
  for (const char* name : {"smoke", "builtin:fire", "builtin:cloth", "builtin:river"})
    CHECK(contains(unknown, name));
}

TEST_CASE("a cancelled call makes nothing") {
  std::stop_source stop;
  stop.request_stop();
  CHECK_THROWS_AS(make_builtin({BuiltinScene::fire, 1, 64, 64, 5, 25}, core::Context(stop.get_token())),
                  core::Cancelled);
}

TEST_CASE("built-in clips are opened by name, with seed, range and scale") {
  io::ReadOptions options;
  options.seed = 5;
  options.first = 100;
  options.last = 102;
  const auto source = apps::open_clip("builtin:cloth", options, {});
  core::ClipInfo info{320, 240, 3, CV_8U, 25, 255, 2};
  info.origin = {0, 0, 4, "source"};
  CHECK(source->info() == info);
  BuiltinOptions same;
  same.scene = BuiltinScene::cloth;
  same.seed = 5;
  const Scene plan = plan_scene(same);
  CHECK(same_pixels(source->next(), render_frame(plan, 100)));
  CHECK(same_pixels(source->next(), render_frame(plan, 101)));
  CHECK(source->next().empty());
}
