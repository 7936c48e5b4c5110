// SPDX-License-Identifier: Apache-2.0
#include "pipeline/residual_texture.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/context.hpp"
#include "core/error.hpp"
#include "core/math/cell_grid.hpp"
#include "core/model_arrays.hpp"
#include "core/parallel.hpp"
#include "sketch/inpainting/fill.hpp"

namespace emberfold::pipeline {

namespace {

constexpr std::size_t kMostPairs = 20, kLeastPairs = 3;
constexpr double kPixels = 5e6;         // of all frames together: enough for the texture, with bounded memory
constexpr int kMargin = 3;              // px around a patch that its own misfit may reach
constexpr double kCoarse = 4;           // px, SD: coarser levels are left to diffusion and strokes
constexpr double kLeastStrength = 0.5;  // grey levels: anything weaker is rounding
constexpr double kSeenShare = 0.02;     // of a cell's pixels over all frames, to estimate its strength

/// Difference of a frame from its drawing, and where it is valid.
struct Residual {
  cv::Mat values;  // CV_32F
  cv::Mat seen;    // CV_8U
};

cv::Mat in_channels(const cv::Mat& plane, int channels) {
  cv::Mat all;
  cv::merge(std::vector<cv::Mat>(static_cast<std::size_t>(channels), plane), all);
  return all;
}

/// Subtracts the local mean of the valid part.
cv::Mat fine_part(const Residual& residual) {
  cv::Mat weights, sums;
  residual.seen.convertTo(weights, CV_32F, 1 / 255.0);
  weights = in_channels(weights, residual.values.channels());
  cv::GaussianBlur(residual.values.mul(weights), sums, {}, kCoarse);
  cv::GaussianBlur(weights, weights, {}, kCoarse);
  return residual.values - sums / cv::max(weights, 1e-3);
}

Residual residual_of(const cv::Mat& frame, const core::ClipInfo& info, const graph::AttributeGraph& graph,
                     const sketch::FrameRenderer& painter, const sketch::RenderOptions& look) {
  cv::Mat drawn, patches;
  painter.draw({graph}).convertTo(drawn, CV_32F);
  const int side = 2 * kMargin + 1;
  cv::dilate(sketch::draw_fitted(graph, look.size, 1).mask, patches, cv::Mat::ones(side, side, CV_8U));
  Residual residual{core::to_levels(frame, info) - drawn, patches == 0};
  const cv::Mat& backdrop = look.background.static_pixels.still;
  if (!backdrop.empty()) residual.seen.setTo(0, backdrop);
  residual.values = fine_part(residual);
  return residual;
}

/// Reads pairs of neighbouring frames, spread over the clip, in one pass; returns the first of a pair, then
/// the second.
std::vector<Residual> read_pairs(core::FrameSource& source, std::span<const graph::AttributeGraph> graphs,
                                 const sketch::RenderOptions& look, const core::Context& context) {
  const auto affordable = static_cast<std::size_t>(kPixels / (2.0 * look.size.area()));
  const std::size_t gaps = graphs.size() - 1,
                    pairs = std::min(std::clamp(affordable, kLeastPairs, kMostPairs), gaps);
  std::vector<cv::Mat> frames;
  std::vector<std::size_t> times;
  source.rewind();
  std::size_t t = 0;
  const auto next = [&] {
    context.check();
    ++t;
    return source.next();
  };
  cv::Mat frame = next();
  const auto keep = [&] {
    times.push_back(t - 1);
    frames.push_back(frame);
  };
  for (std::size_t i = 0; i < pairs; ++i) {
    while (t - 1 < i * gaps / pairs) frame = next();
    keep();
    frame = next();
    keep();
  }
  const sketch::FrameRenderer painter(look);
  std::vector<Residual> residuals(frames.size());
  core::parallel_for(frames.size(), context, [&](std::size_t k) {
    residuals[k] = residual_of(frames[k], source.info(), graphs[times[k]], painter, look);
    frames[k].release();
  });
  return residuals;
}

/// Interpolates linearly between the centres of cells.
cv::Mat spread(const cv::Mat& values, cv::Size frame) {
  return core::spread_cells(values, sketch::kBackgroundCell)(cv::Rect({0, 0}, frame)).clone();
}

/// Multiplies each pixel's channels by a square matrix.
cv::Mat transform_channels(const cv::Mat& values, const cv::Mat& table) {
  cv::Mat result;
  cv::transform(values, result, table);
  return result;
}

/// Returns the SD by cell; hardly visible cells take it from neighbours. Empty where nothing is visible.
cv::Mat measure_strength(std::span<const Residual> residuals, cv::Size frame) {
  cv::Mat squares = cv::Mat::zeros(core::count_cells(frame, sketch::kBackgroundCell), CV_32F),
          counts = squares.clone();
  for (const Residual& residual : residuals) {
    cv::Mat seen, square;
    residual.seen.convertTo(seen, CV_32F, 1 / 255.0);
    const int channels = residual.values.channels();
    cv::transform(residual.values.mul(residual.values), square,
                  cv::Mat(1, channels, CV_32F, cv::Scalar(1.0 / channels)));
    squares += core::cell_means(square.mul(seen), sketch::kBackgroundCell);
    counts += core::cell_means(seen, sketch::kBackgroundCell);
  }
  const cv::Mat known = counts > kSeenShare * static_cast<double>(residuals.size());
  if (cv::countNonZero(known) == 0) return {};
  cv::Mat strength;
  cv::sqrt(squares / cv::max(counts, 1e-6), strength);
  return sketch::fill(strength, known).levels;
}

/// Divides the residuals by their strength.
void normalise(std::span<Residual> residuals, const cv::Mat& strength, const sketch::RenderOptions& look) {
  const cv::Mat unit = in_channels(cv::max(spread(strength, look.size), kLeastStrength), look.channels);
  for (Residual& residual : residuals) residual.values /= unit;
}

/// Returns the principal components of the colours.
cv::Mat measure_colours(std::span<const Residual> residuals, int channels) {
  cv::Mat products = cv::Mat::zeros(channels, channels, CV_64F), strengths, colours;
  for (const Residual& residual : residuals) {
    cv::Mat values = residual.values.clone(), product;
    values.setTo(0, residual.seen == 0);
    cv::mulTransposed(values.reshape(1, static_cast<int>(values.total())), product, true, cv::noArray(), 1,
                      CV_64F);
    products += product;
  }
  cv::eigen(products, strengths, colours);
  colours.convertTo(colours, CV_32F);
  return colours;
}

}  // namespace

ResidualTexture measure_residual(core::FrameSource& source, std::span<const graph::AttributeGraph> graphs,
                                 const sketch::RenderOptions& look, const core::Context& context) {
  if (graphs.size() < 2) return {};
  auto residuals = read_pairs(source, graphs, look, context);
  ResidualTexture residual;
  residual.strength = measure_strength(residuals, look.size);
  if (residual.strength.empty()) return {};
  normalise(residuals, residual.strength, look);
  residual.colours = measure_colours(residuals, look.channels);
  std::vector<dytex::GaussianTextureLearner> learners;
  for (int i = 0; i < look.channels; ++i) learners.emplace_back(look.size);
  for (std::size_t k = 0; k + 1 < residuals.size(); k += 2) {
    const Residual &now = residuals[k], &next = residuals[k + 1];
    std::array<std::vector<cv::Mat>, 2> components;
    cv::split(transform_channels(now.values, residual.colours), components[0]);
    cv::split(transform_channels(next.values, residual.colours), components[1]);
    core::parallel_for(learners.size(), context, [&](std::size_t i) {
      learners[i].add(components[0][i], now.seen, components[1][i], next.seen);
    });
  }
  for (const auto& learner : learners) residual.textures.push_back(learner.learned());
  return residual;
}

ResidualFrames::ResidualFrames(const ResidualTexture& residual, cv::Size frame, std::uint64_t seed,
                               double speed)
    : colours_(residual.colours.t()),
      strength_(in_channels(spread(residual.strength, frame), static_cast<int>(residual.textures.size()))) {
  for (std::size_t i = 0; i < residual.textures.size(); ++i)
    frames_.emplace_back(residual.textures[i], frame, seed, static_cast<std::uint32_t>(i), speed);
}

cv::Mat ResidualFrames::next() {
  std::vector<cv::Mat> components;
  for (auto& frames : frames_) components.push_back(frames.next());
  cv::Mat all, bytes;
  cv::merge(components, all);
  cv::Mat(transform_channels(all, colours_).mul(strength_)).convertTo(bytes, CV_8S);
  return bytes;
}

void add_residual(core::ModelArchive& archive, const ResidualTexture& residual) {
  if (residual.empty()) return;
  std::vector<cv::Mat> within, ahead;
  for (const auto& texture : residual.textures) {
    within.push_back(texture.within);
    ahead.push_back(texture.ahead);
  }
  cv::Mat all_within, all_ahead;
  cv::merge(within, all_within);
  cv::merge(ahead, all_ahead);
  archive.arrays["residual_within"] = core::float_array(all_within);
  archive.arrays["residual_ahead"] = core::float_array(all_ahead);
  archive.arrays["residual_colours"] = core::float_array(residual.colours);
  archive.arrays["residual_strength"] = core::float_array(residual.strength);
  if (residual.speed != 1) archive.arrays["residual_speed"] = {{1}, false, std::vector{residual.speed}};
}

namespace {

double read_speed(const core::ModelArchive& archive) {
  const auto found = archive.arrays.find("residual_speed");
  if (found == archive.arrays.end()) return 1;
  const auto* const values = std::get_if<std::vector<double>>(&found->second.data);
  if (values == nullptr || values->size() != 1 || !(std::abs(values->front()) <= 100) || values->front() == 0)
    throw core::IoError("motion model: residual_speed.npy is no speed, −100…100 and not 0");
  return values->front();
}

}  // namespace

ResidualTexture read_residual(const core::ModelArchive& archive, cv::Size frame) {
  if (!archive.arrays.contains("residual_within")) return {};
  const cv::Size lags(dytex::kTextureLags, dytex::kTextureLags);
  const int count = core::channels_of(archive, "residual_within");
  std::vector<cv::Mat> within, ahead;
  cv::split(core::read_floats(archive, "residual_within", lags, count), within);
  cv::split(core::read_floats(archive, "residual_ahead", lags, count), ahead);
  ResidualTexture residual;
  for (std::size_t i = 0; i < within.size(); ++i) residual.textures.push_back({within[i], ahead[i]});
  residual.colours = core::read_floats(archive, "residual_colours", {count, count}, 1);
  residual.strength =
      core::read_floats(archive, "residual_strength", core::count_cells(frame, sketch::kBackgroundCell), 1);
  double least = 0;
  cv::minMaxIdx(residual.strength, &least);
  if (least < 0) throw core::IoError("motion model: residual_strength.npy holds a number below 0");
  residual.speed = read_speed(archive);
  return residual;
}

}  // namespace emberfold::pipeline
