// SPDX-License-Identifier: Apache-2.0
#include "pipeline/footage/carried_prediction.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <map>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/clip/clip_range.hpp"
#include "core/error.hpp"
#include "core/math/cell_grid.hpp"
#include "core/parallel.hpp"
#include "pipeline/footage/turn.hpp"
#include "pipeline/mean_image.hpp"

namespace emberfold::pipeline {

namespace {

constexpr int kWeightCell = 16;    // px: side of the cells with weights of their own
constexpr int kMostLearned = 24;   // starts from which weights are learned
constexpr double kShared = 0.05;   // weight of the whole frame's moments relative to a cell's own
constexpr double kSmooth = 2;      // px: SD of the smoothed candidate
constexpr int kTracingRounds = 2;  // iterations to find where a pixel comes from
constexpr int kCandidates = 4;

using Candidates = std::array<cv::Mat, kCandidates>;  // levels less the mean image
using Moments = cv::Matx<double, kCandidates, kCandidates + 1>;

/// Returns the motion into the newest frame, at the places in that frame: px per frame, CV_32FC2.
cv::Mat motion_into(const cv::Mat& before, const cv::Mat& newest) {
  cv::Mat motion, a, b;
  before.convertTo(a, CV_8U);
  newest.convertTo(b, CV_8U);
  cv::resize(footage_motion(b, a), motion, newest.size(), 0, 0, cv::INTER_LINEAR);
  return -1 * motion;
}

/// Moves a frame forward by `steps` times its motion.
cv::Mat carry_on(const cv::Mat& frame, const cv::Mat& motion, int steps) {
  cv::Mat2f from(frame.size());
  for (int y = 0; y < from.rows; ++y)
    for (int x = 0; x < from.cols; ++x) from(y, x) = {static_cast<float>(x), static_cast<float>(y)};
  const cv::Mat2f places = from.clone();
  for (int round = 0; round < kTracingRounds; ++round) {
    cv::Mat there;
    cv::remap(motion, there, from, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
    cv::scaleAdd(there, -steps, places, from);
  }
  cv::Mat out;
  cv::remap(frame, out, from, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  return out;
}

Candidates make_candidates(const cv::Mat& before, const cv::Mat& newest, const cv::Mat& motion,
                           const cv::Mat& mean, int steps) {
  const cv::Mat carried = carry_on(newest, motion, steps);
  cv::Mat smooth;
  cv::GaussianBlur(carried, smooth, {}, kSmooth);
  return {cv::Mat(carried - mean), cv::Mat(smooth - mean), cv::Mat(newest - mean), cv::Mat(before - mean)};
}

/// Adds the products of the candidates with each other and with the truth, by cells.
void add_moments(const Candidates& candidates, const cv::Mat& truth, std::vector<Moments>& cells) {
  const int channels = truth.channels(), across = core::count_cells(truth.size(), kWeightCell).width;
  for (int y = 0; y < truth.rows; ++y) {
    std::array<const float*, kCandidates> rows{};
    for (std::size_t k = 0; k < kCandidates; ++k) rows[k] = candidates[k].ptr<float>(y);
    const auto* const wanted = truth.ptr<float>(y);
    for (int i = 0; i < truth.cols * channels; ++i) {
      const int cell = y / kWeightCell * across + i / channels / kWeightCell;
      auto& m = cells[static_cast<std::size_t>(cell)];
      for (int a = 0; a < kCandidates; ++a) {
        const double left{rows[static_cast<std::size_t>(a)][i]};
        for (int b = 0; b < kCandidates; ++b) m(a, b) += left * double{rows[static_cast<std::size_t>(b)][i]};
        m(a, kCandidates) += left * double{wanted[i]};
      }
    }
  }
}

/// Solves for each cell's weights, regularised a little towards those of the whole frame.
cv::Mat solve_weights(const std::vector<Moments>& cells, cv::Size grid) {
  Moments all = Moments::zeros();
  for (const auto& cell : cells) all += cell;
  const auto size = [](const Moments& m) {
    double sum = 1e-9;
    for (int k = 0; k < kCandidates; ++k) sum += m(k, k);
    return sum;
  };
  cv::Mat weights(grid, CV_32FC(kCandidates));
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const Moments m = cells[i] + all * (kShared * size(cells[i]) / size(all));
    cv::Matx<double, kCandidates, kCandidates> left = m.get_minor<kCandidates, kCandidates>(0, 0);
    const double ridge = 1e-6 * cv::trace(left) + 1e-9;
    for (int k = 0; k < kCandidates; ++k) left(k, k) += ridge;
    const cv::Matx<double, kCandidates, 1> solution = left.solve(m.col(kCandidates), cv::DECOMP_CHOLESKY);
    for (int k = 0; k < kCandidates; ++k)
      weights.ptr<float>()[static_cast<int>(i) * kCandidates + k] = static_cast<float>(solution(k));
  }
  return weights;
}

struct Start {
  cv::Mat before, newest, motion;
};

}  // namespace

double CarriedPrediction::parameters() const {
  auto count = static_cast<double>(mean.total()) * mean.channels();
  for (const auto& grid : weights) count += static_cast<double>(grid.total()) * kCandidates;
  return count;
}

CarriedPrediction learn_carried_prediction(core::FrameSource& source, std::span<const int> steps,
                                           const core::Context& context) {
  const auto [mean, counted] = mean_image(source, context);
  const int frames = counted;
  CarriedPrediction model{{steps.begin(), steps.end()}, mean, {}};
  const int most = frames - 2;  // the first start has a frame before it, the last one a frame behind
  if (steps.empty() || most < 1)
    throw core::InputError("a clip of " + std::to_string(frames) + " frames shows no motion to predict by");
  const cv::Size grid = core::count_cells(model.mean.size(), kWeightCell);
  std::vector<std::vector<Moments>> moments(
      steps.size(), std::vector<Moments>(static_cast<std::size_t>(grid.area()), Moments::zeros()));
  // Each half is learned from with the other's mean image: its own would be closer than the mean of the whole
  // part is to future frames.
  core::ClipRange first_half(source, 0, frames / 2), second_half(source, frames / 2, frames);
  const std::array<cv::Mat, 2> others{mean_image(second_half, context).levels,
                                      mean_image(first_half, context).levels};
  const int count = std::min(kMostLearned, most);
  std::map<int, Start> starts;
  for (int i = 0; i < count; ++i) starts[1 + i * most / count];
  cv::Mat before;
  source.rewind();
  for (int t = 0; t < frames; ++t) {
    const cv::Mat levels = core::to_levels(source.next(), source.info());
    context.check();
    std::erase_if(starts, [&](const auto& start) { return start.first + steps.back() < t; });
    core::parallel_for(steps.size(), context, [&](std::size_t s) {
      const auto start = starts.find(t - steps[s]);
      if (start == starts.end() || start->second.newest.empty()) return;
      const auto& [old, newest, motion] = start->second;
      const cv::Mat& other = others[start->first < frames / 2 ? 0 : 1];
      add_moments(make_candidates(old, newest, motion, other, steps[s]), levels - other, moments[s]);
    });
    if (const auto start = starts.find(t); start != starts.end())
      start->second = {before, levels, motion_into(before, levels)};
    before = levels;
  }
  for (const auto& cells : moments) model.weights.push_back(solve_weights(cells, grid));
  return model;
}

std::vector<cv::Mat> predict(const CarriedPrediction& model, std::span<const cv::Mat> past,
                             std::span<const int> steps) {
  const cv::Mat &newest = past.back(), &before = past[past.size() - 2];
  const cv::Mat motion = motion_into(before, newest);
  std::vector<cv::Mat> predicted;
  for (const int step : steps) {
    const auto at = static_cast<std::size_t>(std::ranges::find(model.steps, step) - model.steps.begin());
    const auto candidates = make_candidates(before, newest, motion, model.mean, step);
    const cv::Mat weights = core::spread_cells(model.weights[at], kWeightCell);
    cv::Mat out = model.mean.clone();
    const int channels = out.channels();
    for (int y = 0; y < out.rows; ++y) {
      const auto* const w = weights.ptr<float>(y);
      auto* const row = out.ptr<float>(y);
      for (int k = 0; k < kCandidates; ++k) {
        const auto* const candidate = candidates[static_cast<std::size_t>(k)].ptr<float>(y);
        for (int i = 0; i < out.cols * channels; ++i)
          row[i] += w[i / channels * kCandidates + k] * candidate[i];
      }
    }
    predicted.push_back(out);
  }
  return predicted;
}

}  // namespace emberfold::pipeline
