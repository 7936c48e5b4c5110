// SPDX-License-Identifier: Apache-2.0
#include "sketch/extract.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include <opencv2/core.hpp>

#include "core/clip.hpp"
#include "core/context.hpp"
#include "core/error.hpp"
#include "core/math/robust.hpp"
#include "core/parallel.hpp"
#include "core/text/check_range.hpp"
#include "sketch/candidates/same_edges.hpp"
#include "sketch/candidates/selection.hpp"
#include "sketch/candidates/zero_curves.hpp"
#include "sketch/detection/boundaries.hpp"
#include "sketch/detection/colour.hpp"
#include "sketch/detection/contrast_gaps.hpp"
#include "sketch/detection/crease_map.hpp"
#include "sketch/detection/creases.hpp"
#include "sketch/detection/crossings.hpp"
#include "sketch/detection/curve_tracing.hpp"
#include "sketch/detection/flanks.hpp"
#include "sketch/detection/given_curves.hpp"
#include "sketch/detection/junctions.hpp"
#include "sketch/detection/lobes.hpp"
#include "sketch/detection/scale_space.hpp"
#include "sketch/detection/weak_curves.hpp"
#include "sketch/patches/patch_placement.hpp"
#include "sketch/patches/patch_smoothing.hpp"
#include "sketch/refinement/coding_length.hpp"
#include "sketch/refinement/refine.hpp"
#include "sketch/tiling/tiles.hpp"

namespace emberfold::sketch {

namespace {

constexpr double kSignificance = 6;    // SD of the noise's response: a curve begins above it
constexpr double kHysteresis = 0.4;    // share of that response down to which a curve continues
constexpr double kLeastEvidence = 28;  // SD: root of the sum of squares along a curve

// Many faint points count as much as few strong ones.
double total_significance(const Chain& chain) {
  double squares = 0;
  for (const CreasePoint& p : chain.points) squares += p.significance * p.significance;
  return std::sqrt(squares);
}

// Limits that follow from the sensitivity; at 0.5 they are the constants above.
struct Limits {
  double significance, total_significance;  // of curves found point by point
  double of_flank, of_step;                 // see remove_flanks(), remove_flank_curves()
  double probability;                       // at which a curve that is given begins
  WeakCurveLimits weak;
};

Limits make_limits(const ExtractOptions& options) {
  constexpr double kEvidence = 6.5, kEvidenceOctaves = 6;  // nats at 0.5; factors of two from 0 to 1
  constexpr double kOctaves = 2;                           // of the significance below 0.5
  constexpr double kBegins = 2.8, kMoreSensitive = 1.6;    // SD of a response up to 0.5, and less above
  const double more = options.sensitivity - 0.5, strict = std::exp2(kOctaves * std::max(0.0, -more));
  // A line explains the steps on its flanks; the more sensitive, the less.
  constexpr double kExplains = 0.5;
  const double twice = std::max(0.0, options.sensitivity - kExplains) / (1 - kExplains),
               of_flank = std::lerp(1.6, 0.2, twice), of_step = std::lerp(0.45, 2.0, twice);
  return {
      strict * kSignificance,
      strict * kLeastEvidence,
      of_flank,
      of_step,
      std::clamp(1 - options.sensitivity, 0.02, 0.98),
      {kBegins - kMoreSensitive * std::max(0.0, more), options.min_contrast,
       kEvidence * std::exp2(-kEvidenceOctaves * more), 0.5 * options.min_length, options.edges, of_flank}};
}

// Every patch gets the evidence of its curve, a junction that of its best curve.
graph::AttributeGraph with_evidence_of_curves(const graph::AttributeGraph& graph) {
  std::vector<graph::Vertex> vertices(graph.vertices().begin(), graph.vertices().end());
  std::vector<double> best(vertices.size(), 0);
  for (const graph::Curve& curve : graph::curves(graph)) {
    double nats = 0;
    for (const auto v : curve) nats += graph.patch(v).evidence;
    for (const auto v : curve) best[v] = std::max(best[v], nats);
  }
  for (std::size_t v = 0; v < vertices.size(); ++v) vertices[v].patch.evidence = best[v];
  return {std::move(vertices), {graph.edges().begin(), graph.edges().end()}};
}

}  // namespace

void ExtractOptions::validate() const {
  core::check_fields("ExtractOptions", *this);
  if (boundaries && !edges)
    throw core::InputError(
        "ExtractOptions.boundaries is true; allowed is false where no steps are drawn, as boundaries are");
}

double estimate_noise(const cv::Mat& luma) {
  constexpr double kQuantisation = 0.29;
  if (luma.cols < 2 || luma.rows < 2) return kQuantisation;
  std::vector<float> detail;
  detail.reserve(static_cast<std::size_t>(luma.total() / 4));
  for (int y = 0; y + 1 < luma.rows; y += 2) {
    const float* upper = luma.ptr<float>(y);
    const float* lower = luma.ptr<float>(y + 1);
    for (int x = 0; x + 1 < luma.cols; x += 2)
      detail.push_back(std::abs(0.5F * (upper[x] - upper[x + 1] - lower[x] + lower[x + 1])));
  }
  return std::max(kQuantisation, core::kMadToSd * double{core::median_of_positive(std::move(detail))});
}

namespace {

void check_frame(const cv::Mat& levels) {
  if (levels.empty() || levels.depth() != CV_32F || (levels.channels() != 1 && levels.channels() != 3))
    throw core::InputError("extract: the frame must be CV_32F with 1 or 3 channels and not empty");
  if (!cv::checkRange(levels, true))
    throw core::InputError("extract: the frame holds a value that is not finite");
}

void append(std::vector<Chain>& chains, std::vector<Chain> more) {
  chains.insert(chains.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
}

// A frame as it is searched for curves.
struct Searched {
  std::vector<double> noise;  // SD of each channel
  ScaleSpace space;
  NoiseLevels ground;
  std::vector<CodingContext> axes;
  std::vector<double> usual;  // see find_weak_curves(); empty: of this frame
};

// Luma, and with `colour` the two axes of colour.
std::vector<cv::Mat1f> channels_of(const cv::Mat& levels, const ExtractOptions& options) {
  std::vector<cv::Mat1f> channels{core::luma(levels)};
  if (options.colour && levels.channels() == 3)
    for (cv::Mat1f& colour : compute_opponent_colours(levels)) channels.push_back(std::move(colour));
  return channels;
}

// Statistics of a whole frame; by channel, except for the averaged responses.
struct Statistics {
  std::vector<double> noise;
  NoiseLevels ground;
  std::vector<CodingContext> axes;  // with the channels themselves
  std::vector<double> usual;
};

Statistics begin_statistics(std::vector<cv::Mat1f> channels) {
  Statistics of;
  for (cv::Mat1f& channel : channels) {
    of.noise.push_back(estimate_noise(channel));
    of.axes.push_back(prepare_coding(std::move(channel), kColourAxes[of.axes.size()]));
  }
  return of;
}

ScaleSpace build_scale_space(const std::vector<CodingContext>& axes, const ExtractOptions& options) {
  ScaleSpace space;
  for (std::size_t c = 0; c < axes.size(); ++c)
    for (ScaleLevel& level :
         scale_space(axes[c].luma, options.finest_scale, options.scales, static_cast<int>(c)))
      space.push_back(std::move(level));
  return space;
}

Searched prepare(const cv::Mat& levels, const ExtractOptions& options) {
  Statistics of = begin_statistics(channels_of(levels, options));
  ScaleSpace space = build_scale_space(of.axes, options);
  DerivativeSamples samples;
  add_samples(space, whole_frame(levels.size()), samples);
  NoiseLevels ground = measure_noise_levels(std::move(samples), space, of.noise);
  return {std::move(of.noise), std::move(space), std::move(ground), std::move(of.axes), {}};
}

// A part of a frame that has these statistics.
Searched prepare(const cv::Mat& part, const ExtractOptions& options, const Statistics& of) {
  std::vector<CodingContext> axes = of.axes;
  std::vector<cv::Mat1f> channels = channels_of(part, options);
  for (std::size_t c = 0; c < axes.size(); ++c) axes[c].luma = std::move(channels[c]);
  ScaleSpace space = build_scale_space(axes, options);
  return {of.noise, std::move(space), of.ground, std::move(axes), of.usual};
}

// visit(i, the i-th tile's part of the frame), in parallel.
template <class Visit>
void visit_tiles(const std::vector<Tile>& tiles, const cv::Mat& levels, const Visit& visit) {
  core::parallel_for(tiles.size(), core::Context{},
                     [&](std::size_t i) { visit(i, levels(tiles[i].read).clone()); });
}

// Measures the statistics of a whole frame tile by tile.
Statistics measure_statistics(const cv::Mat& levels, const std::vector<Tile>& tiles,
                              const ExtractOptions& options) {
  Statistics of = begin_statistics(channels_of(levels, options));
  for (CodingContext& axis : of.axes) axis.luma.release();
  std::vector<DerivativeSamples> derivatives(tiles.size());
  std::vector<ResponseSamples> responses(tiles.size());
  ScaleSpace first;  // its kernels' noise
  visit_tiles(tiles, levels, [&](std::size_t i, const cv::Mat& part) {
    ScaleSpace space = prepare(part, options, of).space;
    const FramePart at{levels.size(), tiles[i].read.tl(), tiles[i].core};
    add_samples(space, at, derivatives[i]);
    if (!options.boundaries) add_samples(space, at, options.edges, responses[i]);
    if (i == 0) first = std::move(space);
  });
  const auto append = [](auto& to, const auto& from) {
    to.resize(std::max(to.size(), from.size()));
    for (std::size_t k = 0; k < from.size(); ++k) to[k].insert(to[k].end(), from[k].begin(), from[k].end());
  };
  for (std::size_t i = 1; i < tiles.size(); ++i) {
    append(derivatives[0].second, derivatives[i].second);
    append(derivatives[0].first, derivatives[i].first);
    append(responses[0], responses[i]);
  }
  of.ground = measure_noise_levels(std::move(derivatives[0]), first, of.noise);
  of.usual = usual_responses(std::move(responses[0]));
  return of;
}

// Curves whose points stand out one by one.
std::vector<Chain> find_strong_curves(const Searched& frame, const ExtractOptions& options,
                                      const Limits& limits) {
  const ScaleSpace& space = frame.space;
  const CreaseLimits low{kHysteresis * limits.significance, options.min_contrast};
  auto [ridges, valleys] = find_lines(space, frame.ground, low);
  thin_parallel_points(ridges, space);
  thin_parallel_points(valleys, space);
  if (space.back().channel > 0) {
    const CreaseMap all{ridges.kind, ridges.points, ridges.index.clone()};
    remove_coinciding(ridges, valleys, space);
    remove_coinciding(valleys, all, space);
  }
  const CreaseMap all_ridges = ridges;  // its index is that of what is left
  remove_lobes(ridges, valleys, space);
  remove_lobes(valleys, all_ridges, space);
  const TracingLimits begins{limits.significance};
  std::vector<Chain> chains = trace_curves(ridges, space, begins);
  append(chains, trace_curves(valleys, space, begins));
  if (options.edges) {
    CreaseMap steps = find_steps(space, frame.ground, {low.significance, 2 * low.contrast});
    remove_flanks(steps, ridges, space, limits.of_flank);
    remove_flanks(steps, valleys, space, limits.of_flank);
    thin_parallel_points(steps, space);
    append(chains, trace_curves(steps, space, begins));
  }
  return remove_lobe_curves(remove_hooks(std::move(chains)), space, ridges.index.size());
}

std::vector<Chain> find_curves(const Searched& frame, const cv::Mat& levels, const ExtractOptions& options,
                               const Limits& limits, const cv::Mat1f* given) {
  if (given != nullptr)
    return trace_given_curves(*given, frame.space, {limits.probability, false, options.scales});
  if (options.boundaries) {
    constexpr int kScales = 2;  // of the crests of such a map
    const cv::Mat1f found = find_boundaries(options.colour ? levels : cv::Mat(core::luma(levels)));
    return trace_given_curves(found, frame.space, {limits.probability, true, kScales});
  }
  std::vector<Chain> chains = find_strong_curves(frame, options, limits);
  // Crumbs at junctions and ends, where scales disagree: ends would meet them instead of each other.
  const auto without_crumbs = [&](std::vector<Chain>& from) {
    std::erase_if(from, [&](const Chain& c) {
      return arc_lengths(c).back() < 0.5 * options.min_length ||
             total_significance(c) < limits.total_significance;
    });
  };
  without_crumbs(chains);
  constexpr double kHalf = 0.5;  // a stroke is there as far as it shows at half of its contrast
  chains = cut_at_contrast_gaps(chains, frame.space, {kHalf, frame.noise[0]});
  chains = part_ends_at_gaps(std::move(chains), frame.space, {kHalf, frame.noise[0]});
  without_crumbs(chains);
  append(chains, find_weak_curves(chains, frame.space, frame.noise[0], limits.weak, frame.usual));
  return chains;
}

// Returns whether step edges are outlines that compete with lines.
bool uses_outlines(const ExtractOptions& options, const cv::Mat1f* given) {
  return options.edges && options.outlines && !options.boundaries && given == nullptr;
}

// Leaves out the edges of the finest level that the next one shows better: blurred ones. Two edges side by
// side dim each other, the more the coarser the level.
void keep_sharp_edges(std::vector<Chain>& finest, const ScaleLevel& next) {
  constexpr double kLeast = 0.9;  // of the contrast that the next level shows; an ideal step has 1 at either
  std::erase_if(finest, [&](const Chain& chain) {
    double here = 0, there = 0;
    for (const CreasePoint& p : chain.points) {
      const int x = std::clamp(static_cast<int>(std::lround(p.position.x)), 0, next.frame.cols - 1),
                y = std::clamp(static_cast<int>(std::lround(p.position.y)), 0, next.frame.rows - 1);
      here += p.contrast, there += norm(next.gradient(x, y)) * step_contrast(next.sigma);
    }
    return here < kLeast * there;
  });
}

constexpr int kScalesOfEdges = 2;  // beyond those of lines: edges blurred by up to 8 px

// Selects the lines and closed step edges that explain each channel. The scale space that they are
// in is added to `space`.
std::vector<Chain> find_explaining_curves(const Searched& frame, const cv::Mat& levels,
                                          const ExtractOptions& options, ScaleSpace& space) {
  constexpr double kVisibleStep = 6;    // grey levels: the least difference that people see at mid grey
  constexpr double kStillTraced = 0.5;  // of it: an edge may fade for a while
  constexpr double kNoise = 3;          // SD of a gradient; white noise exceeds it at one pixel in 90
  constexpr double kOctaves = 4;        // by which the exchange rate falls from sensitivity 0 to 1
  ExtractOptions of_lines = options;
  of_lines.edges = false;
  std::vector<std::vector<Chain>> lines(frame.axes.size());
  for (Chain& line : find_curves(frame, levels, of_lines, make_limits(of_lines), nullptr)) {
    const auto channel =
        static_cast<std::size_t>(frame.space[median_level(line.points, frame.space)].channel);
    for (CreasePoint& point : line.points)
      point.level = frame.space[static_cast<std::size_t>(point.level)].octave + 1;  // after the finer one
    lines[channel].push_back(std::move(line));
  }
  const double less = 0.5 - options.sensitivity, visible = kVisibleStep * std::exp2(2 * less);
  std::vector<Chain> all;
  for (std::size_t c = 0; c < frame.axes.size(); ++c) {
    ScaleSpace of_channel;
    std::ranges::copy_if(frame.space, std::back_inserter(of_channel),
                         [&](const ScaleLevel& level) { return level.channel == static_cast<int>(c); });
    of_channel = with_more_levels(std::move(of_channel), kScalesOfEdges);
    std::vector<std::vector<Chain>> edges;
    for (std::size_t k = 0; k < of_channel.size(); ++k) {
      const ScaleLevel& level = of_channel[k];
      edges.push_back(trace_edges(level, static_cast<int>(k),
                                  std::max(kNoise * frame.noise[c] * level.gradient_sd,
                                           kStillTraced * visible / step_contrast(level.sigma))));
    }
    // Edges finer than lines come last: they are for what the usual scales leave, the pixels of a mask for
    // instance.
    keep_sharp_edges(edges[0], of_channel[1]);
    std::rotate(edges.begin(), edges.begin() + 1, edges.end());
    auto chosen = select_curves(std::move(lines[c]), std::move(edges), of_channel, frame.axes[c].luma,
                                {frame.noise[c], visible, std::exp2(kOctaves * less)});
    chosen = without_same_edges(std::move(chosen), of_channel, all, levels.size());
    for (Chain& chain : chosen)
      for (CreasePoint& point : chain.points) point.level += static_cast<int>(space.size());
    append(all, std::move(chosen));
    std::ranges::move(of_channel, std::back_inserter(space));
  }
  return all;
}

// The strokes of a frame or a part, along the curves that are found or given.
graph::AttributeGraph find_strokes(const Searched& frame, const cv::Mat& levels,
                                   const ExtractOptions& options, const cv::Mat1f* given) {
  const bool outlines = uses_outlines(options, given);
  ScaleSpace space = outlines ? ScaleSpace{} : frame.space;
  std::vector<Chain> chains = outlines ? find_explaining_curves(frame, levels, options, space)
                                       : find_curves(frame, levels, options, make_limits(options), given);
  // Curves that were chosen by what they explain have paid for their ends. A short one is wanted where it is
  // thin; short steps of coarse scales are no strokes.
  const auto least = [&](const Chain& chain) {
    return outlines ? 0.5 * options.min_length * space[median_level(chain.points, space)].sigma /
                          options.finest_scale
                    : options.min_length;
  };
  const CurveNetwork network =
      prune_short_curves(merge_crossings(join_free_ends(std::move(chains), space)), least);
  return refine(
      smooth_patches(place_patches(network, space, levels, options.spacing, frame.noise[0]), frame.noise[0]),
      levels, frame.axes, {options.spacing});
}

// The strokes of a frame in parts, with the statistics of the whole.
graph::AttributeGraph find_strokes_in_tiles(const Statistics& of, const std::vector<Tile>& tiles,
                                            const cv::Mat& levels, const ExtractOptions& options,
                                            const cv::Mat1f* given) {
  std::vector<graph::AttributeGraph> sketches(tiles.size());
  visit_tiles(tiles, levels, [&](std::size_t i, const cv::Mat& part) {
    const cv::Mat1f curves = given != nullptr ? (*given)(tiles[i].read).clone() : cv::Mat1f();
    sketches[i] =
        find_strokes(prepare(part, options, of), part, options, given != nullptr ? &curves : nullptr);
  });
  return join_tiles(tiles, sketches, options.spacing);
}

std::vector<Tile> tiles_of(cv::Size frame, const ExtractOptions& options) {
  constexpr double kMargin = 128, kScales = 16;  // px; of the coarsest scale
  const int scales = options.scales + (uses_outlines(options, nullptr) ? kScalesOfEdges : 0);
  const double coarsest = options.finest_scale * std::exp2(0.5 * (scales - 1));
  return make_tiles(frame, options.tile, static_cast<int>(std::ceil(std::max(kMargin, kScales * coarsest))));
}

// The sketch of a frame, with the curves that are found or given.
graph::AttributeGraph extract(const cv::Mat& levels, const ExtractOptions& options, const cv::Mat1f* given) {
  graph::AttributeGraph strokes;
  if (levels.cols > options.tile || levels.rows > options.tile) {
    const std::vector<Tile> tiles = tiles_of(levels.size(), options);
    strokes =
        find_strokes_in_tiles(measure_statistics(levels, tiles, options), tiles, levels, options, given);
  } else {
    strokes = find_strokes(prepare(levels, options), levels, options, given);
  }
  if (given == nullptr && !options.boundaries && !uses_outlines(options, given))
    strokes = remove_flank_curves(strokes, make_limits(options).of_step);
  return with_evidence_of_curves(strokes);
}

}  // namespace

graph::AttributeGraph extract(const cv::Mat& levels, const ExtractOptions& options) {
  options.validate();
  check_frame(levels);
  return extract(levels, options, nullptr);
}

graph::AttributeGraph extract(const cv::Mat& levels, const ExtractOptions& options,
                              const cv::Mat1f& probability) {
  options.validate();
  check_frame(levels);
  if (probability.size() != levels.size())
    throw core::InputError("extract: the evidence has another size than the frame");
  if (!cv::checkRange(probability, true, nullptr, 0, std::nextafter(1.0F, 2.0F)))
    throw core::InputError("extract: the evidence must be from 0 to 1");
  return extract(levels, options, &probability);
}

}  // namespace emberfold::sketch
