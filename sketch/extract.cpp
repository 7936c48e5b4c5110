// SPDX-License-Identifier: Apache-2.0
#include "sketch/extract.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include <opencv2/core.hpp>

#include "core/clip.hpp"
#include "core/error.hpp"
#include "core/math/robust.hpp"
#include "core/text/check_range.hpp"
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
#include "sketch/refinement/pursuit.hpp"
#include "sketch/refinement/refine.hpp"

namespace emberfold::sketch {

namespace {

constexpr double kVisible = 1;  // grey level: what differs by less looks the same

// Many faint points count as much as few strong ones.
double total_significance(const Chain& chain) {
  double squares = 0;
  for (const CreasePoint& p : chain.points) squares += p.significance * p.significance;
  return std::sqrt(squares);
}

// Limits that follow from the sensitivity; at 0.5 they are those of the options.
struct Limits {
  double significance, total_significance;  // of curves found point by point
  double of_flank, of_step;                 // see remove_flanks(), remove_flank_curves()
  double probability;                       // at which a curve that is given begins
  WeakCurveLimits weak;
};

Limits make_limits(const ExtractOptions& options) {
  constexpr double kEvidence = 7, kEvidenceOctaves = 6;  // nats at 0.5; factors of two from 0 to 1
  constexpr double kOctaves = 2;                         // of the significance below 0.5
  constexpr double kBegins = 2.8, kMoreSensitive = 1.6;  // SD of a response up to 0.5, and less above
  const double more = options.sensitivity - 0.5, strict = std::exp2(kOctaves * std::max(0.0, -more));
  // A line explains the steps on its flanks; the more sensitive, the less.
  constexpr double kExplains = 0.5;
  const double twice = std::max(0.0, options.sensitivity - kExplains) / (1 - kExplains),
               of_flank = std::lerp(1.6, 0.2, twice), of_step = std::lerp(0.45, 2.0, twice);
  return {
      strict * options.significance,
      strict * options.min_evidence,
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

// The two axes of colour as further channels of both.
void add_colour(ScaleSpace& space, NoiseLevels& ground, const cv::Mat& levels,
                const ExtractOptions& options) {
  int channel = 0;
  for (const cv::Mat1f& colour : compute_opponent_colours(levels)) {
    ScaleSpace more = scale_space(colour, options.finest_scale, options.scales, ++channel);
    const NoiseLevels own = measure_noise_levels(more, estimate_noise(colour));
    space.insert(space.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
    ground.second.insert(ground.second.end(), own.second.begin(), own.second.end());
    ground.first.insert(ground.first.end(), own.first.begin(), own.first.end());
  }
}

}  // namespace

void ExtractOptions::validate() const {
  core::check_range("ExtractOptions.sensitivity", sensitivity, 0, 1);
  core::check_range("ExtractOptions.finest_scale", finest_scale, 0.7, 20);
  core::check_range("ExtractOptions.scales", scales, 1, 12);
  core::check_above("ExtractOptions.significance", significance, 0);
  core::check_above("ExtractOptions.hysteresis", hysteresis, 0, 1);
  core::check_at_least("ExtractOptions.min_contrast", min_contrast, 0);
  core::check_at_least("ExtractOptions.min_length", min_length, 0);
  core::check_at_least("ExtractOptions.min_evidence", min_evidence, 0);
  core::check_range("ExtractOptions.spacing", spacing, 2, 100);
  core::check_range("ExtractOptions.budget", budget, 0, 1);
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
  const ScaleSpace& space;
  const NoiseLevels& ground;
  double noise;
};

// Curves whose points stand out one by one.
std::vector<Chain> find_strong_curves(const Searched& frame, const ExtractOptions& options,
                                      const Limits& limits) {
  const ScaleSpace& space = frame.space;
  const CreaseLimits low{options.hysteresis * limits.significance, options.min_contrast};
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
  chains = cut_at_contrast_gaps(chains, frame.space, {kHalf, frame.noise});
  without_crumbs(chains);
  append(chains, find_weak_curves(chains, frame.space, frame.noise, limits.weak));
  return chains;
}

// The sketch of a frame, with the curves that are found or given.
graph::AttributeGraph extract(const cv::Mat& levels, const ExtractOptions& options,
                              const cv::Mat1f* probability) {
  const Limits limits = make_limits(options);
  const cv::Mat1f luma = core::luma(levels);
  const double noise = estimate_noise(luma);
  ScaleSpace space = scale_space(luma, options.finest_scale, options.scales);
  NoiseLevels ground = measure_noise_levels(space, noise);
  if (options.colour && levels.channels() == 3) add_colour(space, ground, levels, options);
  std::vector<Chain> chains = find_curves({space, ground, noise}, levels, options, limits, probability);
  const CurveNetwork network =
      prune_short_curves(merge_crossings(join_free_ends(std::move(chains), space)), options.min_length);
  std::vector<CodingContext> axes{prepare_coding(luma, kColourAxes[0])};
  if (space.back().channel > 0)
    for (cv::Mat1f& colour : compute_opponent_colours(levels))
      axes.push_back(prepare_coding(std::move(colour), kColourAxes[axes.size()]));
  graph::AttributeGraph strokes =
      refine(smooth_patches(place_patches(network, space, levels, options.spacing, noise), noise), levels,
             axes, {options.spacing, options.blobs, nullptr});
  if (probability == nullptr && !options.boundaries) strokes = remove_flank_curves(strokes, limits.of_step);
  strokes = with_evidence_of_curves(strokes);
  if (options.budget > 0) return pursue(strokes, levels, {std::max(noise, kVisible), options.budget, true});
  if (options.blobs) return pursue(strokes, levels, {axes[0].noise, 1, true});
  return strokes;
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
