// SPDX-License-Identifier: Apache-2.0
#include "apps/runs/run_estimate.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <thread>

#include "apps/cli/console.hpp"
#include "core/text/format_number.hpp"
#include "core/text/size_text.hpp"
#include "sketch/extract.hpp"

namespace emberfold::apps {

namespace {

// What a stage takes, in units of the time of the first frame's sketch: of each frame, and of a model, which
// is learned from clips drawn of it and some frames of the clip, whatever its length. Measured on clips of
// 36,000 and 920,000 pixels (docs/benchmarks.md).
constexpr double kSketch = 1.0;
constexpr double kEvents = 0.7, kBottomUp = 0.35;
constexpr double kPictures = 0.5;
constexpr double kModel = 100;
// MB: of the program, of each pixel of a frame, of each patch in each frame.
constexpr double kProgramMb = 170, kPixelMb = 450e-6, kPatchMb = 1.6e-3;

double processor_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace

std::optional<RunEstimate> estimate_run(core::FrameSource& source, const pipeline::AnalyzeOptions& options,
                                        int threads) {
  const auto& info = source.info();
  if (!info.frames || *info.frames < 2 || options.sample || options.in_noise) return std::nullopt;
  source.rewind();
  const cv::Mat frame = source.next();
  source.rewind();
  if (frame.empty()) return std::nullopt;
  const cv::Mat levels = core::to_levels(frame, info);
  const double began = processor_seconds();
  const auto graph = sketch::extract(levels, options.sketch);
  const double one = std::max(1e-4, processor_seconds() - began);
  const double pixels = double(info.width) * info.height;
  RunEstimate found;
  found.frames = static_cast<double>(*info.frames);
  const auto stage = [&](const char* name, std::vector<std::string> reports, double sketches) {
    found.stages.push_back({name, std::move(reports), sketches * one});
    found.processor_seconds += found.stages.back().seconds;
  };
  stage("sketch", {}, kSketch * found.frames);
  stage("events", {"carry", "match", "events"}, (options.bottom_up ? kBottomUp : kEvents) * found.frames);
  stage("model", {"fit", "balance", "synthesize", "render"}, kModel);
  stage("pictures", {}, kPictures * found.frames);
  const double cores = std::max(1U, std::thread::hardware_concurrency());
  found.seconds = found.processor_seconds / std::clamp(threads > 0 ? double(threads) : cores, 1., cores);
  found.memory_mb = kProgramMb + kPixelMb * pixels * info.channels / 3 +
                    kPatchMb * static_cast<double>(graph.size()) * found.frames;
  return found;
}

std::string words_of(const RunEstimate& estimate, const core::ClipInfo& info) {
  constexpr double kLong = 120;
  const auto rounded = [](double value) { return core::number_text(core::round_significant(value, 2)); };
  std::string words = std::to_string(std::llround(estimate.frames)) + " frames of " +
                      core::size_text(info.width, info.height) + ": about " +
                      duration_text(estimate.seconds) + " and " + rounded(estimate.memory_mb) + " MB";
  if (estimate.seconds > kLong && info.width > 400) {
    constexpr double kQuick = 320;  // px across: what most clips show is seen at this size
    words += "; --scale " + core::number_text(core::round_significant(kQuick / info.width, 1)) +
             " takes a fraction";
  }
  return words;
}

}  // namespace emberfold::apps
