// SPDX-License-Identifier: Apache-2.0
#include "pipeline/readings.hpp"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <string>
#include <utility>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "core/rng.hpp"
#include "pipeline/masked_sketch.hpp"
#include "sketch/background/still_background.hpp"

namespace emberfold::pipeline {

namespace {

constexpr std::uint32_t kNoiseStream = 0x73746172;  // separate from all other draws with the seed
constexpr double kCopyNoise = 2;                    // levels: SD, in luma, of the noise of copies

std::size_t copies(const std::vector<StartReading>& readings) {
  return static_cast<std::size_t>(
      std::ranges::count_if(readings, [](const auto& copy) { return copy.has_value(); }));
}

}  // namespace

void StartOptions::validate() const {
  core::check_fields("StartOptions", *this);
}

std::vector<StartReading> readings(const StartOptions& options) {
  options.validate();
  std::vector<StartReading> result;
  std::size_t copy = 0;
  for (int k = 0; k < options.chains; ++k) {
    result.push_back(k % 2 == 0 ? std::nullopt : std::optional(copy++));
  }
  return result;
}

cv::Mat add_noise(const cv::Mat& levels, double sd, std::uint64_t seed, std::uint32_t copy,
                  std::uint32_t frame) {
  cv::Mat result = levels.clone();
  const int channels = result.channels();
  // Luma is a sum of independent channels with weights 0.299, 0.587 and 0.114.
  const double scale = channels == 1 ? sd : sd / std::sqrt(0.299 * 0.299 + 0.587 * 0.587 + 0.114 * 0.114);
  core::Rng rng(seed, {kNoiseStream, copy, frame});
  for (int y = 0; y < result.rows; ++y) {
    auto* row = result.ptr<float>(y);
    for (int x = 0; x < result.cols * channels; ++x) row[x] += static_cast<float>(scale * rng.normal());
  }
  return result;
}

StartSketches sketch_starts(core::FrameSource& source, const sketch::ExtractOptions& extract,
                            const StartOptions& options, std::uint64_t seed, const core::Context& context) {
  const std::size_t count = copies(readings(options));
  extract.validate();
  struct Frame {
    std::vector<graph::AttributeGraph> graphs;  // of the clip, then of the noisy copies
    sketch::FrameBackground ground;
  };
  const auto& info = source.info();
  StartSketches starts;
  auto& own = starts.clip.sketch;
  own.width = info.width, own.height = info.height, own.fps = info.fps;
  starts.perturbed = std::vector<graph::SketchSequence>(count, own);
  stream_sketches(
      source, "sketch", context, 0, [](int) {},
      [&](int t, const cv::Mat& levels, const cv::Mat& mask) {
        Frame made;
        made.graphs.push_back(inside_mask(sketch::extract(levels, extract), mask));
        made.ground = sketch::measure_background(levels, made.graphs.front());
        for (std::uint32_t copy = 0; copy < count; ++copy) {
          const cv::Mat noisy = add_noise(levels, kCopyNoise, seed, copy, static_cast<std::uint32_t>(t));
          made.graphs.push_back(inside_mask(sketch::extract(noisy, extract), mask));
        }
        return made;
      },
      [&](int, Frame made) {
        own.append(made.graphs.front().kept_in(context.memory()));
        starts.clip.grounds.push_back(std::move(made.ground));
        for (std::size_t copy = 0; copy < count; ++copy)
          starts.perturbed[copy].append(made.graphs[copy + 1].kept_in(context.memory()));
      });
  return starts;
}

std::vector<graph::MotionGraph> match_starts(const StartSketches& sketches, const graph::MatchOptions& match,
                                             const StartOptions& options, const core::Context& context) {
  match.validate();
  const auto wanted = readings(options);
  if (sketches.perturbed.size() != copies(wanted)) {
    throw core::InputError("starts: " + std::to_string(sketches.perturbed.size()) + " copies in noise for " +
                           std::to_string(options.chains) + " chains, which want " +
                           std::to_string(copies(wanted)));
  }
  const auto first_alike = [&](std::size_t k) { return wanted[k] ? k : 0; };
  std::vector<graph::MotionGraph> starts(wanted.size());
  const core::Context quiet = context.with_progress({});  // progress is reported by one thread at a time
  std::mutex reporting;
  std::size_t done = 0;
  context.report("match", 0);
  core::parallel_for(starts.size(), context, [&](std::size_t k) {
    const StartReading& reading = wanted[k];
    if (first_alike(k) == k) {
      starts[k] = graph::match(reading ? sketches.perturbed[*reading] : sketches.clip.sketch, match, quiet);
    }
    const std::scoped_lock lock(reporting);
    context.report("match", static_cast<double>(++done) / static_cast<double>(starts.size()));
  });
  context.check();
  for (std::size_t k = 0; k < starts.size(); ++k) {
    if (first_alike(k) != k) starts[k] = starts[first_alike(k)];
  }
  return starts;
}

}  // namespace emberfold::pipeline
