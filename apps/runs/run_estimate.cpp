// SPDX-License-Identifier: Apache-2.0
#include "apps/runs/run_estimate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <ctime>
#include <thread>

#include "apps/cli/console.hpp"
#include "core/text/format_number.hpp"
#include "core/text/size_text.hpp"
#include "sketch/extract.hpp"

namespace emberfold::apps {

namespace {

// Seconds on the machine of the measurements, for clips of 230,000 to 920,000 pixels (docs/benchmarks.md).
// Other machines are assumed to be faster or slower by the same factor as in sketching a frame.
constexpr double kSketchPixel = 0.35e-6, kSketchPatch = 1.4e-4;  // per frame, for each pixel and patch
constexpr double kEventsPatch = 3e-4, kBottomUpPatch = 1.1e-4;
constexpr double kFiguresPixel = 7e-7;  // per frame, for each pixel of at most the view's (figure_view)
constexpr double kMostFigurePixels = 230e3;
constexpr double kPictures = 0.04, kPicturesPixel = 5e-8, kPicturesPatch = 7e-5;
// Cost of a model, in sketched frames: it is learned from clips drawn from it and some frames of the clip,
// whatever its length.
constexpr double kModel = 140;
// Speed-up by one more thread: two share a core.
constexpr double kFurtherThread = 0.6;
// MB of memory: of the program, per pixel of a frame, per patch in each frame; and of disk.
constexpr double kProgramMb = 170, kPixelMb = 380e-6, kPatchMb = 5e-5;
constexpr double kPatchDiskMb = 7e-4, kPatchTextMb = 8e-4;

double processor_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// The two sketched frames are a quarter into the part that may be read, and before its last quarter: many
// clips begin in the dark.
constexpr std::int64_t kMostRead = 200;

/// The average cost of a frame.
struct FrameCost {
  double seconds = 0, patches = 0;
};

FrameCost measure_frames(core::FrameSource& source, std::int64_t frames,
                         const sketch::ExtractOptions& options) {
  const std::int64_t read = std::min(frames, kMostRead);
  const std::array looked_at{read / 4, read - 1 - read / 4};
  FrameCost sum;
  double count = 0;
  source.rewind();
  for (std::int64_t t = 0; t <= looked_at.back(); ++t) {
    const cv::Mat frame = source.next();
    if (frame.empty()) break;
    if (std::ranges::find(looked_at, t) == looked_at.end()) continue;
    const cv::Mat levels = core::to_levels(frame, source.info());
    const double began = processor_seconds();
    const auto graph = sketch::extract(levels, options);
    sum.seconds += processor_seconds() - began;
    sum.patches += static_cast<double>(graph.size());
    ++count;
  }
  source.rewind();
  if (count == 0) return {};
  constexpr double kLeast = 1e-4;  // s
  return {std::max(kLeast, sum.seconds / count), sum.patches / count};
}

}  // namespace

std::optional<RunEstimate> estimate_run(core::FrameSource& source, const AnalyzeOptions& options,
                                        int threads) {
  const auto& info = source.info();
  if (!info.frames || *info.frames < 2) return std::nullopt;
  const auto [one, patches] = measure_frames(source, *info.frames, options.sketch);
  if (one == 0) return std::nullopt;
  const double pixels = double(info.width) * info.height;
  const double slowness = one / (kSketchPixel * pixels + kSketchPatch * patches);
  RunEstimate found;
  found.frames = static_cast<double>(*info.frames);
  const auto stage = [&](const char* name, std::vector<std::string> reports, double seconds) {
    found.stages.push_back({name, std::move(reports), seconds});
    found.processor_seconds += seconds;
  };
  stage("sketch", {}, one * found.frames);
  const bool figures = !options.bottom_up && !options.curve_events;
  stage("events", {"carry", "figures", "match", "events", "sample"},
        slowness * found.frames *
            (patches * (options.bottom_up ? kBottomUpPatch : kEventsPatch) +
             (figures ? kFiguresPixel * std::min(pixels, kMostFigurePixels) : 0)));
  stage("model", {"fit", "balance", "synthesize", "render"}, kModel * one);
  stage("pictures", {},
        slowness * found.frames * (kPictures + kPicturesPixel * pixels + kPicturesPatch * patches));
  const double cores = std::max(1U, std::thread::hardware_concurrency());
  const double used = std::clamp(threads > 0 ? double(threads) : cores, 1., cores);
  found.seconds = found.processor_seconds / (1 + kFurtherThread * (used - 1));
  found.memory_mb = kProgramMb + kPixelMb * pixels * info.channels / 3 + kPatchMb * patches * found.frames;
  found.disk_mb = (kPatchDiskMb + (options.jsonl ? kPatchTextMb : 0)) * patches * found.frames;
  return found;
}

std::string words_of(const RunEstimate& estimate, const core::ClipInfo& info) {
  constexpr double kLong = 120;
  const auto rounded = [](double value) { return core::number_text(core::round_significant(value, 2)); };
  std::string words = std::to_string(std::llround(estimate.frames)) + " frames of " +
                      core::size_text(info.width, info.height) + ": about " +
                      duration_text(estimate.seconds) + ", " + rounded(estimate.memory_mb) +
                      " MB of memory and " + rounded(estimate.disk_mb) + " MB of disk";
  if (estimate.seconds > kLong && info.width > 400) {
    constexpr double kQuick = 320;  // px across: the contents of most clips are visible at this size
    words += "; --scale " + core::number_text(core::round_significant(kQuick / info.width, 1)) +
             " takes a fraction";
  }
  return words;
}

}  // namespace emberfold::apps
