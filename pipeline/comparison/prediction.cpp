// SPDX-License-Identifier: Apache-2.0
#include "pipeline/comparison/prediction.hpp"

#include <algorithm>
#include <iterator>
#include <optional>

#include <opencv2/core.hpp>

#include "core/clip/clip_range.hpp"
#include "core/context.hpp"
#include "core/error.hpp"
#include "core/parallel.hpp"
#include "dytex/measures/psnr.hpp"
#include "dytex/measures/ssim.hpp"
#include "pipeline/comparison/clip_measures.hpp"
#include "pipeline/comparison/compared_models.hpp"
#include "pipeline/mean_image.hpp"

namespace emberfold::pipeline {

namespace {

constexpr int kMostStarts = 32;   // from which frames are predicted: bounds the time
constexpr int kStartsAtOnce = 8;  // starts in one parallel batch
constexpr int kPast = 2;          // frames that a model gets

struct FrameError {
  double square = 0, similarity = 0;
};
// By method and step; the last column: the newest frame itself, reconstructed.
using StartErrors = std::vector<std::vector<std::optional<FrameError>>>;

// Rounds levels to bytes.
cv::Mat round_to_bytes(const cv::Mat& frame) {
  cv::Mat out;
  (frame.depth() == CV_8U ? frame : core::to_bytes(frame)).convertTo(out, CV_32F);
  return out;
}

FrameError frame_error(const cv::Mat& made, const cv::Mat& truth) {
  const cv::Mat levels = round_to_bytes(made);
  return {dytex::mean_square_error(levels, truth),
          dytex::structural_similarity(core::luma(levels), core::luma(truth))};
}

// Returns the models, preceded by two methods without a model.
std::vector<ComparedModel> add_baselines(const cv::Mat& mean, std::span<const ComparedModel> models) {
  std::vector<ComparedModel> methods(2);
  methods[0].key = "frame_before";
  methods[0].predict = [](const PastFrames& past, std::span<const int> steps) {
    return std::vector<cv::Mat>(steps.size(), past.levels.back());
  };
  methods[1].key = "mean_image";
  methods[1].predict = [mean](const PastFrames&, std::span<const int> steps) {
    return std::vector<cv::Mat>(steps.size(), mean);
  };
  std::ranges::copy_if(models, std::back_inserter(methods),
                       [](const ComparedModel& model) { return model.predict != nullptr; });
  return methods;
}

// Holds the frames of a clip around the current starts.
class FrameWindow {
 public:
  FrameWindow(core::FrameSource& source, int first, int frames, const core::Context& context)
      : range_(source, first, frames), info_(source.info()), first_(first), context_(context) {}

  /// Drops the frames before `from` and reads those up to `to`.
  void move(int from, int to) {
    while (first_ < from && !levels_.empty()) levels_.erase(levels_.begin()), ++first_;
    while (first_ + static_cast<int>(levels_.size()) <= to) {
      const cv::Mat frame = range_.next();
      context_.check();
      if (frame.empty()) throw core::IoError("the clip has become shorter while it was read");
      const cv::Mat levels = core::to_levels(frame, info_);
      if (levels_.empty() && first_ < from)
        ++first_;
      else
        levels_.push_back(levels);
    }
  }
  [[nodiscard]] std::span<const cv::Mat> frames(int from, int to) const {
    return std::span(levels_).subspan(static_cast<std::size_t>(from - first_),
                                      static_cast<std::size_t>(to - from + 1));
  }

 private:
  core::ClipRange range_;
  core::ClipInfo info_;
  int first_;
  std::vector<cv::Mat> levels_;
  const core::Context& context_;
};

StartErrors measure_start(int t, int frames, std::span<const int> steps, const FrameWindow& window,
                          std::span<const ComparedModel> methods) {
  const PastFrames past{t, window.frames(std::max(0, t + 1 - kPast), t)};
  const auto held_out = steps.first(
      static_cast<std::size_t>(std::ranges::count_if(steps, [&](int step) { return t + step < frames; })));
  StartErrors errors(methods.size());
  for (std::size_t m = 0; m < methods.size(); ++m) {
    const auto predicted = methods[m].predict(past, held_out);
    errors[m].resize(steps.size() + 1);
    for (std::size_t s = 0; s < predicted.size(); ++s)
      errors[m][s] = frame_error(predicted[s], window.frames(t + steps[s], t + steps[s]).front());
    if (methods[m].reconstruct)
      errors[m].back() = frame_error(methods[m].reconstruct(past), past.levels.back());
  }
  return errors;
}

// Returns the mean of one method and column over all starts.
std::optional<FrameQuality> mean_quality(const std::vector<StartErrors>& all, std::size_t method,
                                         std::size_t column) {
  FrameError sum;
  int count = 0;
  for (const auto& start : all)
    if (const auto& one = start[method][column])
      sum.square += one->square, sum.similarity += one->similarity, ++count;
  if (count == 0) return std::nullopt;
  return FrameQuality{dytex::psnr(sum.square / count), sum.similarity / count};
}

MethodPrediction summarize(const std::vector<StartErrors>& all, std::size_t method, std::size_t steps,
                           const std::string& key) {
  MethodPrediction out{key, {}, {}, mean_quality(all, method, steps)};
  for (std::size_t s = 0; s < steps; ++s) out.by_step.push_back(mean_quality(all, method, s));
  for (const auto& start : all) out.next_frame_psnr.push_back(dytex::psnr(start[method][0]->square));
  return out;
}

}  // namespace

std::vector<int> prediction_steps(int most) {
  std::vector<int> steps;
  for (int step = 1; step < most; step *= 2) steps.push_back(step);
  steps.push_back(most);
  return steps;
}

PredictionMeasures measure_prediction(core::FrameSource& source, int first, int frames,
                                      std::span<const int> steps, std::span<const ComparedModel> models,
                                      const core::Context& context) {
  core::ClipRange first_part(source, 0, first);
  const auto methods = add_baselines(mean_image(first_part, context).levels, models);
  // A frame is predicted from the one before it.
  const int count = std::min(kMostStarts, frames - first);
  const auto start_frame = [&](int i) {
    return first - 1 + static_cast<int>(static_cast<std::int64_t>(i) * (frames - first) / count);
  };
  FrameWindow window(source, std::max(0, first - kPast), frames, context);
  std::vector<StartErrors> all(static_cast<std::size_t>(count));
  context.report("predict", 0);
  for (int i = 0; i < count; i += kStartsAtOnce) {
    const int end = std::min(count, i + kStartsAtOnce);
    window.move(std::max(0, start_frame(i) + 1 - kPast),
                std::min(frames - 1, start_frame(end - 1) + steps.back()));
    core::parallel_for(static_cast<std::size_t>(end - i), context, [&](std::size_t k) {
      all[static_cast<std::size_t>(i) + k] =
          measure_start(start_frame(i + static_cast<int>(k)), frames, steps, window, methods);
    });
    context.report("predict", static_cast<double>(end) / count);
  }
  PredictionMeasures out{first, count, {steps.begin(), steps.end()}, {}};
  for (std::size_t m = 0; m < methods.size(); ++m)
    out.methods.push_back(summarize(all, m, steps.size(), methods[m].key));
  return out;
}

}  // namespace emberfold::pipeline
