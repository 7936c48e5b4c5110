// SPDX-License-Identifier: Apache-2.0
#include "pipeline/figures/figure_graphs.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "core/clip/frame_stream.hpp"
#include "core/math/bilinear.hpp"
#include "core/math/luma.hpp"
#include "core/parallel.hpp"
#include "sketch/patches/patch_types.hpp"

namespace emberfold::pipeline {

using graph::Point;

namespace {

constexpr double kOutlineSpacing = 5;     // px of the frame, between patches
constexpr std::size_t kLeastPatches = 4;  // of a ring
constexpr int kAveraged = 3;              // px to either side, over which an outline of pixels is averaged
constexpr double kBesideOutline = 3;      // px, where levels inside and outside are read
constexpr double kSearch = 2;             // px, to either side, for the place of the outline
constexpr double kLeastBlur = 0.5, kMostBlur = 8;  // px
constexpr double kLinkReach = 2;                   // spacings that linked patches may be apart

double sample(const cv::Mat1f& image, Point p) {
  return core::sample_bilinear(image, p.x, p.y);
}

/// The parts of a frame that outlines are drawn from.
struct Frame {
  cv::Mat1f level, middle;  // of the view: luma; the level half way, of one polarity
  cv::Mat levels;           // of the frame, all channels
  cv::Mat1b inner;          // of the view: where outlines do not run along the border
  const FigureView& view;
  double sign = 1;   // of the polarity
  double noise = 1;  // SD, grey levels

  /// Returns the levels of the frame about a place of the view.
  [[nodiscard]] graph::Level levels_at(Point p) const {
    const Point q = view.in_frame(p.x, p.y);
    const int x = std::clamp(static_cast<int>(std::lround(q.x)), 0, levels.cols - 1),
              y = std::clamp(static_cast<int>(std::lround(q.y)), 0, levels.rows - 1);
    if (levels.channels() == 1) {
      const float v = levels.at<float>(y, x);
      return {v, v, v};
    }
    const auto& v = levels.at<cv::Vec3f>(y, x);
    return {v[0], v[1], v[2]};
  }
  [[nodiscard]] double amplitude(Point p) const { return sign * (sample(level, p) - sample(middle, p)); }
  [[nodiscard]] bool is_at_border(Point p) const {
    return inner(std::clamp(cvRound(p.y), 0, inner.rows - 1), std::clamp(cvRound(p.x), 0, inner.cols - 1)) ==
           0;
  }
};

/// Returns the outline of a region, a ring of points a pixel apart, so that its inside lies to the right.
std::vector<Point> traced(const cv::Mat1i& numbers, const FigureRegion& region, std::size_t index) {
  cv::Mat1b mask;
  cv::copyMakeBorder(cv::Mat(numbers(region.box) == static_cast<int>(index) + 1), mask, 1, 1, 1, 1,
                     cv::BORDER_CONSTANT, 0);
  std::vector<std::vector<cv::Point>> contours;
  cv::findContours(mask, contours, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE,
                   region.box.tl() - cv::Point(1, 1));
  std::vector<cv::Point>& ring =
      *std::ranges::max_element(contours, {}, [](const auto& c) { return c.size(); });
  double area = 0;  // positive: clockwise on the screen, the inside to the right
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const cv::Point &a = ring[i], &b = ring[(i + 1) % ring.size()];
    area += double(a.x) * b.y - double(b.x) * a.y;
  }
  if (area < 0) std::ranges::reverse(ring);
  std::vector<Point> smooth(ring.size());
  const auto n = static_cast<std::ptrdiff_t>(ring.size());
  const std::ptrdiff_t reach = std::min<std::ptrdiff_t>(kAveraged, n / 4);
  for (std::ptrdiff_t i = 0; i < n; ++i) {
    Point sum;
    for (std::ptrdiff_t k = -reach; k <= reach; ++k) {
      const cv::Point& p = ring[static_cast<std::size_t>((i + k + n) % n)];
      sum = sum + Point{double(p.x), double(p.y)};
    }
    smooth[static_cast<std::size_t>(i)] = sum * (1. / double(2 * reach + 1));
  }
  return smooth;
}

/// Returns the points of a ring that lie evenly spaced along it.
std::vector<std::size_t> spaced(const std::vector<Point>& ring, double spacing) {
  double length = 0;
  for (std::size_t i = 0; i < ring.size(); ++i) length += distance(ring[i], ring[(i + 1) % ring.size()]);
  const auto count =
      std::min(ring.size(), std::max(kLeastPatches, static_cast<std::size_t>(std::lround(length / spacing))));
  std::vector<std::size_t> places;
  double along = 0;
  for (std::size_t i = 0; i < ring.size() && places.size() < count; ++i) {
    if (along >= length * double(places.size()) / double(count) - 1e-9) places.push_back(i);
    along += distance(ring[i], ring[(i + 1) % ring.size()]);
  }
  return places;
}

/// Returns the patch of an outline at `p`, whose outward normal is `out`.
graph::Patch outline_patch(const Frame& frame, Point p, Point out) {
  graph::Patch patch;
  patch.type = graph::PatchType::step;
  const Point bright = out * -frame.sign;  // the right of the direction
  patch.theta = std::atan2(-bright.x, bright.y);
  const double factor = frame.view.factor;
  if (frame.is_at_border(p)) {
    patch.position = frame.view.in_frame(p.x, p.y);
    patch.left = patch.middle = patch.right = frame.levels_at(p - out * kBesideOutline);
    return patch;
  }
  // The outline is where the amplitude changes its sign, nearest to the edge of the outermost pixels.
  constexpr double kStep = 0.25;
  double place = 0.5, nearest = kSearch;
  for (double d = -kSearch; d < kSearch; d += kStep) {
    const double a = frame.amplitude(p + out * d), b = frame.amplitude(p + out * (d + kStep));
    if (a <= 0 || b > 0) continue;
    const double crossing = d + kStep * a / (a - b);
    if (std::abs(crossing - 0.5) < nearest) nearest = std::abs(crossing - 0.5), place = crossing;
  }
  p = p + out * place;
  patch.position = frame.view.in_frame(p.x, p.y);
  const Point inside = p - out * kBesideOutline, outside = p + out * kBesideOutline;
  const double step = std::abs(sample(frame.level, inside) - sample(frame.level, outside));
  const double slope = std::abs(sample(frame.level, p - out) - sample(frame.level, p + out)) / 2;
  const double blur = step / std::max(1e-6, slope * std::sqrt(2 * CV_PI));
  patch.blur = factor * std::clamp(std::sqrt(std::max(0., blur * blur - 1)), kLeastBlur, kMostBlur);
  patch.left = frame.levels_at(frame.sign > 0 ? outside : inside);
  patch.right = frame.levels_at(frame.sign > 0 ? inside : outside);
  for (std::size_t c = 0; c < 3; ++c) patch.middle[c] = (patch.left[c] + patch.right[c]) / 2;
  const auto luma = [](const graph::Level& l) { return core::luma(l[0], l[1], l[2]); };
  patch.contrast = luma(patch.right) - luma(patch.left);
  // Two levels in place of one, for the pixels that the patch stands for.
  const double pixels = kOutlineSpacing * 2 * kBesideOutline * factor;
  patch.gain = pixels * 0.5 *
               std::log1p(patch.contrast * patch.contrast / (4 * std::max(0.25, frame.noise * frame.noise)));
  patch.evidence = patch.gain;
  return patch;
}

/// A frame's outlines.
struct FrameFigures {
  graph::AttributeGraph graph;
  std::vector<std::size_t> region_of, polarity_of;
};

FrameFigures draw_frame(const cv::Mat& image, const core::ClipInfo& info, std::size_t t,
                        const FigureRegions& all, const FigureGround& ground) {
  FrameFigures drawn;
  std::vector<graph::Vertex> vertices;
  std::vector<graph::Edge> edges;
  Frame frame{figure_level(image, info, ground.view),
              {},
              core::to_levels(image, info),
              inner_part(ground, t),
              ground.view,
              1,
              ground.noise};
  for (std::size_t p = 0; p < all.of.size(); ++p) {
    const std::vector<FigureRegion>& regions = all.of[p].regions;
    frame.sign = kFigurePolarities[p];
    cv::Mat full;
    cv::resize(ground.levels[t][p], full, ground.view.size, 0, 0, cv::INTER_LINEAR);
    cv::extractChannel(full, frame.middle, 0);
    const cv::Mat1i numbers = region_numbers(all, p, t);
    for (const std::size_t index : all.of[p].of_component[t]) {
      if (index == kNoRegion || !regions[index].is_figure) continue;
      const auto ring = traced(numbers, regions[index], index);
      const auto places = spaced(ring, kOutlineSpacing / ground.view.factor);
      const auto first = static_cast<std::uint32_t>(vertices.size());
      for (std::size_t i = 0; i < places.size(); ++i) {
        const std::size_t n = ring.size();
        const Point along = ring[(places[i] + 2) % n] - ring[(places[i] + n - 2) % n];
        const double length = std::max(1e-9, norm(along));
        const Point out{along.y / length, -along.x / length};
        vertices.push_back({graph::VertexId{first + static_cast<std::uint32_t>(i)},
                            {},
                            outline_patch(frame, ring[places[i]], out)});
        const auto next = first + static_cast<std::uint32_t>((i + 1) % places.size());
        edges.push_back({vertices.back().id, graph::VertexId{next}});
        drawn.region_of.push_back(index), drawn.polarity_of.push_back(p);
      }
    }
  }
  drawn.graph = sketch::name_patch_types(std::move(vertices), std::move(edges));
  return drawn;
}

/// Links of one gap, by vertex index in the frames before and after.
class GapLinks {
 public:
  GapLinks(std::size_t before, std::size_t after) : next_(before), last_(after) {}
  [[nodiscard]] bool are_free(std::size_t u, std::size_t v) const {
    return next_[u].empty() && last_[v].empty();
  }
  /// Returns whether stars would be left.
  [[nodiscard]] bool is_allowed(std::size_t u, std::size_t v) const {
    const auto alone = [](const auto& links, const auto& back) {
      return std::ranges::all_of(links, [&](std::size_t i) { return back[i].size() == 1; });
    };
    return (last_[v].empty() && alone(next_[u], last_)) || (next_[u].empty() && alone(last_[v], next_));
  }
  void add(std::size_t u, std::size_t v) { next_[u].push_back(v), last_[v].push_back(u); }
  [[nodiscard]] const std::vector<std::size_t>& next(std::size_t u) const { return next_[u]; }

 private:
  std::vector<std::vector<std::size_t>> next_, last_;
};

/// Links the patches of linked regions of two neighbouring frames.
std::vector<graph::Link> linked(const DrawnFigures& drawn, std::size_t t, const FigureRegions& all,
                                const FigureGround& ground) {
  const auto &before = drawn.motion.sketch.frames[t - 1], &after = drawn.motion.sketch.frames[t];
  using Key = std::pair<std::size_t, std::size_t>;  // polarity and region
  std::map<Key, std::vector<std::size_t>> here, there;
  for (std::size_t u = 0; u < before.size(); ++u)
    here[{drawn.polarity_of[t - 1][u], drawn.region_of[t - 1][u]}].push_back(u);
  for (std::size_t v = 0; v < after.size(); ++v)
    there[{drawn.polarity_of[t][v], drawn.region_of[t][v]}].push_back(v);
  const double factor = ground.view.factor;
  using Pair = std::tuple<double, std::size_t, std::size_t>;  // distance, px of the frame; patches
  std::vector<Pair> near;
  std::vector<std::vector<Pair>> of_regions;  // for each pair of linked regions, all pairs of patches
  for (const auto& [key, targets] : there)
    for (const std::size_t a : all.of[key.first].regions[key.second].before) {
      const auto sources = here.find({key.first, a});
      if (sources == here.end()) continue;
      std::vector<Pair>& pairs = of_regions.emplace_back();
      for (const std::size_t v : targets) {
        const Point p = after.patch(v).position;
        const double x = (p.x + 0.5) / factor - 0.5, y = (p.y + 0.5) / factor - 0.5;
        const cv::Point2d to = moved(ground.from[t], ground.view.size, x, y);
        const Point back = ground.view.in_frame(to.x, to.y);
        for (const std::size_t u : sources->second) {
          pairs.emplace_back(distance(back, before.patch(u).position), u, v);
          if (std::get<0>(pairs.back()) < kLinkReach * kOutlineSpacing &&
              std::cos(before.patch(u).theta - after.patch(v).theta) > 0)
            near.push_back(pairs.back());
        }
      }
    }
  std::ranges::sort(near);
  GapLinks links(before.size(), after.size());
  for (const auto& [apart, u, v] : near)
    if (links.are_free(u, v)) links.add(u, v);
  for (auto& pairs : of_regions) {
    const auto is_linked = [&](const Pair& pair) {
      return std::ranges::find(links.next(std::get<1>(pair)), std::get<2>(pair)) !=
             links.next(std::get<1>(pair)).end();
    };
    if (std::ranges::any_of(pairs, is_linked)) continue;
    std::ranges::sort(pairs);
    const auto nearest = std::ranges::find_if(
        pairs, [&](const Pair& p) { return links.is_allowed(std::get<1>(p), std::get<2>(p)); });
    if (nearest != pairs.end()) links.add(std::get<1>(*nearest), std::get<2>(*nearest));
  }
  std::vector<graph::Link> result;
  for (std::size_t u = 0; u < before.size(); ++u)
    for (const std::size_t v : links.next(u))
      result.push_back({before.vertices()[u].id, after.vertices()[v].id});
  std::ranges::sort(result);
  return result;
}

}  // namespace

DrawnFigures draw_figures(core::FrameSource& source, const FigureRegions& all, const FigureGround& ground,
                          const core::Context& context) {
  DrawnFigures drawn;
  const core::ClipInfo info = source.info();
  drawn.motion.sketch = {info.width, info.height, info.fps, {}};
  const auto draw = [&](int t, const cv::Mat& frame) {
    return draw_frame(frame, info, static_cast<std::size_t>(t), all, ground);
  };
  core::stream_frames(source, "figures", info.frames, context, draw, [&](int, FrameFigures frame) {
    drawn.motion.sketch.append(frame.graph.kept_in(context.memory()));
    drawn.region_of.push_back(std::move(frame.region_of));
    drawn.polarity_of.push_back(std::move(frame.polarity_of));
  });
  drawn.motion.links.resize(drawn.motion.sketch.frames.size());
  core::parallel_for(drawn.motion.links.size() - 1, context,
                     [&](std::size_t t) { drawn.motion.links[t + 1] = linked(drawn, t + 1, all, ground); });
  drawn.motion = graph::identify(std::move(drawn.motion));
  return drawn;
}

}  // namespace emberfold::pipeline
