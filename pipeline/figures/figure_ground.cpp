// SPDX-License-Identifier: Apache-2.0
#include "pipeline/figures/figure_ground.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "core/clip/frame_stream.hpp"
#include "core/clip/masked_source.hpp"
#include "core/math/robust.hpp"
#include "core/parallel.hpp"
#include "dytex/measures/optical_flow.hpp"
#include "sketch/extract.hpp"

namespace emberfold::pipeline {

namespace {

constexpr double kSmoothing = 1;        // px, SD
constexpr double kViewPixels = 153600;  // 480 × 320
constexpr double kVectors = 1 << 14;    // of a motion
constexpr float kDark = 16;             // grey levels
// The least difference of levels that people see at mid grey, and that stands out from noise.
constexpr double kVisible = 6, kNoiseMultiple = 8;
constexpr double kNearest = 4;  // px, SD of the nearest window of edges; each is twice as wide as the last
constexpr int kWindows = 5;
constexpr double kFade = 0.3;     // weight of a window relative to the one half as wide
constexpr double kCarried = 0.9;  // share of a frame's edges that counts in the next one
constexpr double kAbout = 12;     // px, SD of the surroundings that an edge is brighter or darker than
constexpr double kSharp = 12;     // nats, for each SD of the surroundings' levels
constexpr double kEven = 0.3;     // SD: a step lies at the mean of its surroundings and counts for both
// SD of white noise of SD 1 after the smoothing, and of its gradient for that.
constexpr double kSmoothedNoise = 0.282, kGradientOfNoise = 0.2 / kSmoothedNoise;
constexpr double kHalfOfSd =
    1.73;  // √3: levels across an edge, weighted by slope, are even: SD contrast / √12
constexpr float kBeyond = 1.5F;  // amplitudes are cut there

cv::Mat smoothed(const cv::Mat& image, double sd) {
  cv::Mat out;
  cv::GaussianBlur(image, out, {0, 0}, sd, sd, cv::BORDER_REFLECT);
  return out;
}

cv::Mat resized(const cv::Mat& image, cv::Size size, int method) {
  cv::Mat out;
  cv::resize(image, out, size, 0, 0, method);
  return out;
}

double least_contrast(double noise) {
  return std::max(kVisible, kNoiseMultiple * noise);
}

cv::Size cells_of(cv::Size view) {
  return {std::max(1, view.width / kFigureCell), std::max(1, view.height / kFigureCell)};
}

/// Sums over edges of weight, weight · level and weight · level², by cell.
using EdgeSums = cv::Mat3f;

/// Returns the edges of a frame that bound figures of one polarity.
EdgeSums edge_sums(const cv::Mat1f& level, double noise, int polarity) {
  cv::Mat1f gx, gy, slope;
  cv::Sobel(level, gx, CV_32F, 1, 0, 3, 1. / 8, 0, cv::BORDER_REFLECT);
  cv::Sobel(level, gy, CV_32F, 0, 1, 3, 1. / 8, 0, cv::BORDER_REFLECT);
  cv::magnitude(gx, gy, slope);
  slope = cv::max(0, cv::Mat1f(slope - 3 * noise * kGradientOfNoise)) + 1e-6F;
  const double least = least_contrast(noise);
  const cv::Size cells = cells_of(level.size());
  const auto about = [&](const cv::Mat1f& image) {
    const cv::Mat small = smoothed(resized(image, cells, cv::INTER_AREA), kAbout / kFigureCell);
    return cv::Mat1f(resized(small, level.size(), cv::INTER_LINEAR));
  };
  const cv::Mat1f mean = about(level), square = about(cv::Mat(level.mul(level)));
  const cv::Mat1f half_way = cv::Mat(smoothed(cv::Mat(slope.mul(level)), 2) / smoothed(slope, 2));
  cv::Mat3f sums(level.size());
  for (int y = 0; y < level.rows; ++y)
    for (int x = 0; x < level.cols; ++x) {
      const double spread = std::max(0.F, square(y, x) - mean(y, x) * mean(y, x)) + least * least / 16;
      const double side = polarity * double(half_way(y, x) - mean(y, x)) / std::sqrt(spread);
      const auto weight = static_cast<float>(slope(y, x) / (1 + std::exp(-kSharp * (side + kEven))));
      const float v = level(y, x);
      sums(y, x) = {weight, weight * v, weight * v * v};
    }
  return resized(sums, cells, cv::INTER_AREA);
}

/// Returns a neighbouring frame's sums as they arrive along `motion` (this frame → that one).
EdgeSums carried(const EdgeSums& sums, const FigureMotion& motion) {
  cv::Mat2f map(sums.size());
  for (int y = 0; y < map.rows; ++y)
    for (int x = 0; x < map.cols; ++x)
      map(y, x) =
          cv::Vec2f(static_cast<float>(x), static_cast<float>(y)) + motion.vectors(y, x) / kFigureCell;
  EdgeSums out;
  cv::remap(sums, out, map, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  return cv::Mat(out.mul(cv::Scalar(1, 1 / motion.gain, 1 / (motion.gain * motion.gain))));
}

/// Returns the level half way and half of the contrast for sums over edges.
cv::Mat2f levels_of(const EdgeSums& edges) {
  EdgeSums near(edges.size(), cv::Vec3f(0, 0, 0));
  double weight = 1;
  for (int k = 0; k < kWindows; ++k, weight *= kFade)
    near += weight * smoothed(edges, kNearest / kFigureCell * (1 << k));
  cv::Mat2f levels(edges.size());
  for (int y = 0; y < levels.rows; ++y)
    for (int x = 0; x < levels.cols; ++x) {
      const cv::Vec3f s = near(y, x);
      const double middle = s[0] > 0 ? s[1] / s[0] : 0;
      const double spread = s[0] > 0 ? std::max(0., s[2] / s[0] - middle * middle) : 0;
      levels(y, x) = {static_cast<float>(middle), static_cast<float>(kHalfOfSd * std::sqrt(spread))};
    }
  return levels;
}

/// Measurements of a frame, kept until all frames have been read.
struct FirstLook {
  cv::Mat1f luma;                 // small
  std::array<EdgeSums, 2> edges;  // by polarity
  double noise = 0;               // SD after smoothing
};

/// Returns how much lighter the next frame is: the median, over places that are not dark, of the ratio of
/// levels; 1 where half of the ratios differ from it by more than it does from 1.
double gain_between(const cv::Mat1f& luma, const cv::Mat1f& next, const FigureMotion& motion, cv::Size view) {
  const double across = double(luma.cols) / view.width, down = double(luma.rows) / view.height;
  std::vector<double> ratios;
  for (int y = 0; y < luma.rows; ++y)
    for (int x = 0; x < luma.cols; ++x) {
      const cv::Point2d to = moved(motion, view, (x + 0.5) / across - 0.5, (y + 0.5) / down - 0.5);
      const cv::Point at(cvRound((to.x + 0.5) * across - 0.5), cvRound((to.y + 0.5) * down - 0.5));
      if (!cv::Rect({0, 0}, luma.size()).contains(at) || luma(y, x) < kDark || next(at) < kDark) continue;
      ratios.push_back(next(at) / luma(y, x));
    }
  if (ratios.empty()) return 1;
  const double gain = core::median(ratios);
  for (double& ratio : ratios) ratio = std::abs(ratio - gain);
  return core::median(std::move(ratios)) < std::abs(gain - 1) ? gain : 1;
}

void measure_motion(const std::vector<cv::Mat1f>& lumas, FigureGround& ground, const core::Context& context) {
  const cv::Size view = ground.view.size;
  ground.to.resize(lumas.size()), ground.from.resize(lumas.size());
  std::vector<ImageBlocks> blocks(lumas.size());
  // On the grid of cells: the finer one would take most of the memory.
  const auto kept = [&](const cv::Mat2f& vectors, std::size_t t) {
    const cv::Mat on_cells = resized(vectors, cells_of(view), cv::INTER_AREA);
    return FigureMotion{kept_image(on_cells, context.memory(), blocks[t])};
  };
  core::parallel_for(lumas.size() - 1, context, [&](std::size_t t) {
    const cv::Scalar scale(double(view.width) / lumas[t].cols, double(view.height) / lumas[t].rows);
    const cv::Mat2f on = cv::Mat(dytex::optical_flow(lumas[t], lumas[t + 1], kVectors).mul(scale)),
                    back = cv::Mat(dytex::optical_flow(lumas[t + 1], lumas[t], kVectors).mul(scale));
    ground.to[t] = kept(on, t);
    ground.from[t + 1] = kept(back, t);
    // Both senses of time alike.
    const double on_gain = gain_between(lumas[t], lumas[t + 1], ground.to[t], view),
                 back_gain = gain_between(lumas[t + 1], lumas[t], ground.from[t + 1], view);
    ground.to[t].gain = std::sqrt(on_gain / back_gain), ground.from[t + 1].gain = 1 / ground.to[t].gain;
  });
  for (ImageBlocks& block : blocks) std::ranges::move(block, std::back_inserter(ground.blocks));
}

/// Joins the edges of all frames, carried forwards and backwards alike.
std::vector<cv::Mat2f> joined_levels(const std::vector<EdgeSums>& edges, FigureGround& ground,
                                     const core::LargeMemory& memory) {
  const std::size_t frames = edges.size();
  std::vector<EdgeSums> before(frames);
  ImageBlocks blocks;
  for (std::size_t t = 0; t < frames; ++t)
    before[t] = kept_image(
        t > 0 ? cv::Mat(edges[t] + kCarried * carried(before[t - 1], ground.from[t])) : cv::Mat(edges[t]),
        memory, blocks);
  std::vector<cv::Mat2f> levels(frames);
  EdgeSums after;
  for (std::size_t t = frames; t-- > 0;) {
    after = t + 1 < frames ? EdgeSums(edges[t] + kCarried * carried(after, ground.to[t])) : edges[t];
    levels[t] = kept_image(levels_of(cv::Mat(before[t] + after - edges[t])), memory, ground.blocks);
  }
  return levels;
}

}  // namespace

FigureView figure_view(const core::ClipInfo& info) {
  const double pixels = double(info.width) * info.height;
  const int factor = std::max(1, static_cast<int>(std::lround(std::sqrt(pixels / kViewPixels))));
  return {factor, {std::max(1, info.width / factor), std::max(1, info.height / factor)}};
}

cv::Mat1f distance_from_edges(const graph::AttributeGraph& graph, const FigureView& view) {
  cv::Mat1b away(view.size, std::uint8_t{255});
  const auto pixel = [&](graph::VertexId id) {
    const graph::Point p = view.in_view(graph.patch(graph.index_of(id)).position);
    return cv::Point(cvRound(p.x), cvRound(p.y));
  };
  for (const graph::Edge& edge : graph.edges()) cv::line(away, pixel(edge.a), pixel(edge.b), 0);
  cv::Mat1f distance;
  cv::distanceTransform(away, distance, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  return distance;
}

cv::Mat1f figure_level(const cv::Mat& frame, const core::ClipInfo& info, const FigureView& view) {
  const cv::Mat luma = core::luma(frame, info);
  const cv::Mat seen = luma(cv::Rect({0, 0}, view.size * view.factor));
  return smoothed(view.factor > 1 ? resized(seen, view.size, cv::INTER_AREA) : seen, kSmoothing);
}

cv::Point2d moved(const FigureMotion& motion, cv::Size view, double x, double y) {
  const cv::Mat2f& vectors = motion.vectors;
  const int column = std::clamp(static_cast<int>((x + 0.5) * vectors.cols / view.width), 0, vectors.cols - 1);
  const int row = std::clamp(static_cast<int>((y + 0.5) * vectors.rows / view.height), 0, vectors.rows - 1);
  const cv::Vec2f d = vectors(row, column);
  return {x + d[0], y + d[1]};
}

FigureGround measure_figure_ground(core::FrameSource& source, const core::Context& context) {
  const core::ClipInfo info = source.info();
  FigureGround ground;
  ground.view = figure_view(info);
  const cv::Size view = ground.view.size;
  const double reduced = std::min(1., std::sqrt(kVectors / view.area()));
  const cv::Size small(std::max(1, static_cast<int>(view.width * reduced)),
                       std::max(1, static_cast<int>(view.height * reduced)));
  std::vector<cv::Mat1f> lumas;
  std::array<std::vector<EdgeSums>, 2> edges;
  std::vector<double> noises;
  ImageBlocks blocks;  // of lumas and edges
  const auto kept = [&](const cv::Mat& image) { return kept_image(image, context.memory(), blocks); };
  const auto keep_mask = [&](int, const cv::Mat&) {
    const cv::Mat mask = core::mask_of(source);
    if (mask.empty()) return;
    const cv::Mat seen = mask(cv::Rect({0, 0}, view * ground.view.factor));
    const cv::Mat counts = cv::Mat(resized(seen, view, cv::INTER_NEAREST) != 0) / 255;
    ground.masks.emplace_back(kept_image(counts, context.memory(), ground.blocks));
  };
  const auto look = [&](int, const cv::Mat& frame) {
    const cv::Mat1f level = figure_level(frame, info, ground.view);
    FirstLook first;
    first.luma = resized(level, small, cv::INTER_AREA);
    first.noise = kSmoothedNoise / ground.view.factor * sketch::estimate_noise(core::luma(frame, info));
    for (std::size_t p = 0; p < kFigurePolarities.size(); ++p)
      first.edges[p] = edge_sums(level, first.noise, kFigurePolarities[p]);
    return first;
  };
  core::stream_frames(source, "figures", info.frames, context, keep_mask, look, [&](int, FirstLook first) {
    lumas.emplace_back(kept(first.luma));
    noises.push_back(first.noise);
    for (std::size_t p = 0; p < kFigurePolarities.size(); ++p) edges[p].emplace_back(kept(first.edges[p]));
  });
  ground.noise = core::median(noises);
  ground.least_half = least_contrast(ground.noise) / 2;
  measure_motion(lumas, ground, context);
  ground.levels.resize(lumas.size());
  for (std::size_t p = 0; p < kFigurePolarities.size(); ++p) {
    auto joined = joined_levels(edges[p], ground, context.memory());
    for (std::size_t t = 0; t < joined.size(); ++t) ground.levels[t][p] = std::move(joined[t]);
  }
  return ground;
}

cv::Mat1f figure_amplitude(const FigureGround& ground, std::size_t frame, std::size_t polarity,
                           const cv::Mat1f& level) {
  const cv::Mat2f levels = resized(ground.levels[frame][polarity], level.size(), cv::INTER_LINEAR);
  cv::Mat1f amplitude(level.size());
  const auto sign = static_cast<float>(kFigurePolarities[polarity]);
  const auto least = static_cast<float>(ground.least_half);
  for (int y = 0; y < level.rows; ++y)
    for (int x = 0; x < level.cols; ++x) {
      const float h = levels(y, x)[1];
      const float a = sign * (level(y, x) - levels(y, x)[0]) / std::max(h, 1e-3F);
      const float faint = std::max(0.F, 1 - h / least) * 4;
      amplitude(y, x) = std::clamp(a - faint, -kBeyond, kBeyond);
    }
  if (!ground.masks.empty()) amplitude.setTo(-kBeyond, ground.masks[frame] == 0);
  return amplitude;
}

}  // namespace emberfold::pipeline
