// SPDX-License-Identifier: Apache-2.0
#include "pipeline/prediction.hpp"

#include <algorithm>
#include <optional>

#include <opencv2/core.hpp>

#include "core/clip/clip_range.hpp"
#include "core/context.hpp"
#include "core/error.hpp"
#include "core/parallel.hpp"
#include "dytex/measures/psnr.hpp"
#include "dytex/measures/ssim.hpp"
#include "pipeline/clip_measures.hpp"

namespace emberfold::pipeline {

using Json = nlohmann::ordered_json;

namespace {

constexpr int kMostMoments = 32, kBatch = 8, kPast = 2;

// What one way says of one frame.
struct Nearness {
  double error = 0, similarity = 0;
};
// By way and step; the last column: the frame itself shown again.
using MomentNearness = std::vector<std::vector<std::optional<Nearness>>>;

// As a frame of bytes shows it.
cv::Mat shown(const cv::Mat& frame) {
  cv::Mat out;
  (frame.depth() == CV_8U ? frame : core::to_bytes(frame)).convertTo(out, CV_32F);
  return out;
}

Nearness nearness(const cv::Mat& made, const cv::Mat& truth) {
  const cv::Mat levels = shown(made);
  return {dytex::mean_square_error(levels, truth),
          dytex::structural_similarity(core::luma(levels), core::luma(truth))};
}

cv::Mat mean_image(core::FrameSource& source, int frames, const core::Context& context) {
  core::ClipRange part(source, 0, frames);
  cv::Mat sum, mean;
  for (cv::Mat frame = part.next(); !frame.empty(); frame = part.next()) {
    context.check();
    cv::Mat levels;
    core::to_levels(frame, source.info()).convertTo(levels, CV_64F);
    sum = sum.empty() ? levels : cv::Mat(sum + levels);
  }
  sum /= frames;
  sum.convertTo(mean, CV_32F);
  return mean;
}

// The models, and before them two ways that need none.
std::vector<ComparedModel> all_ways(const cv::Mat& mean, std::span<const ComparedModel> models) {
  std::vector<ComparedModel> ways(2);
  ways[0].key = "frame_before";
  ways[0].foretell = [](const Moment& moment, std::span<const int> steps) {
    return std::vector<cv::Mat>(steps.size(), moment.past.back());
  };
  ways[1].key = "mean_image";
  ways[1].foretell = [mean](const Moment&, std::span<const int> steps) {
    return std::vector<cv::Mat>(steps.size(), mean);
  };
  ways.insert(ways.end(), models.begin(), models.end());
  return ways;
}

// The frames of a clip about its moments, held as long as one needs them.
class Window {
 public:
  Window(core::FrameSource& source, int first, int frames, const core::Context& context)
      : part_(source, first, frames), info_(source.info()), first_(first), context_(context) {}

  /// Frames before `from` are dropped, those up to `to` read.
  void move(int from, int to) {
    while (first_ < from && !levels_.empty()) levels_.erase(levels_.begin()), ++first_;
    while (first_ + static_cast<int>(levels_.size()) <= to) {
      const cv::Mat frame = part_.next();
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
  core::ClipRange part_;
  core::ClipInfo info_;
  int first_;
  std::vector<cv::Mat> levels_;
  const core::Context& context_;
};

MomentNearness measure_moment(int t, int frames, std::span<const int> steps, const Window& window,
                              std::span<const ComparedModel> ways) {
  const Moment moment{t, window.frames(std::max(0, t + 1 - kPast), t)};
  const auto within = steps.first(
      static_cast<std::size_t>(std::ranges::count_if(steps, [&](int step) { return t + step < frames; })));
  MomentNearness found(ways.size());
  for (std::size_t w = 0; w < ways.size(); ++w) {
    const auto told = ways[w].foretell(moment, within);
    found[w].resize(steps.size() + 1);
    for (std::size_t s = 0; s < told.size(); ++s)
      found[w][s] = nearness(told[s], window.frames(t + steps[s], t + steps[s]).front());
    if (ways[w].reconstruct) found[w].back() = nearness(ways[w].reconstruct(moment), moment.past.back());
  }
  return found;
}

// {"psnr", "ssim"} of one way and column over all moments; null where there is none.
Json mean_json(const std::vector<MomentNearness>& all, std::size_t way, std::size_t column) {
  Nearness sum;
  int count = 0;
  for (const auto& moment : all)
    if (const auto& one = moment[way][column])
      sum.error += one->error, sum.similarity += one->similarity, ++count;
  if (count == 0) return nullptr;
  return {{"psnr", rounded(dytex::psnr(sum.error / count))}, {"ssim", rounded(sum.similarity / count)}};
}

Prediction figures(const std::vector<MomentNearness>& all, int first, std::span<const int> steps,
                   std::span<const ComparedModel> ways) {
  Json methods = Json::object(), per_frame = Json::object(), reconstruction = Json::object();
  for (std::size_t w = 0; w < ways.size(); ++w) {
    Json method = mean_json(all, w, 0), psnr = Json::array(), ssim = Json::array(), each = Json::array();
    for (std::size_t s = 0; s < steps.size(); ++s) {
      const Json one = mean_json(all, w, s);
      psnr.push_back(one.is_null() ? Json(nullptr) : one["psnr"]);
      ssim.push_back(one.is_null() ? Json(nullptr) : one["ssim"]);
    }
    for (const auto& moment : all) each.push_back(rounded(dytex::psnr(moment[w][0]->error)));
    method["by_step"] = {{"psnr", std::move(psnr)}, {"ssim", std::move(ssim)}};
    methods[ways[w].key] = std::move(method);
    per_frame[ways[w].key] = std::move(each);
    if (const Json own = mean_json(all, w, steps.size()); !own.is_null()) reconstruction[ways[w].key] = own;
  }
  return {{{"first_frame", first},
           {"moments", all.size()},
           {"steps", steps},
           {"methods", std::move(methods)},
           {"per_frame", std::move(per_frame)}},
          std::move(reconstruction)};
}

}  // namespace

std::vector<int> prediction_steps(int most) {
  std::vector<int> steps;
  for (int step = 1; step < most; step *= 2) steps.push_back(step);
  steps.push_back(most);
  return steps;
}

Prediction measure_prediction(core::FrameSource& source, int first, int frames, std::span<const int> steps,
                              std::span<const ComparedModel> models, const core::Context& context) {
  const auto ways = all_ways(mean_image(source, first, context), models);
  // A frame is foretold from the one before it.
  const int count = std::min(kMostMoments, frames - first);
  const auto moment_at = [&](int i) {
    return first - 1 + static_cast<int>(static_cast<std::int64_t>(i) * (frames - first) / count);
  };
  Window window(source, std::max(0, first - kPast), frames, context);
  std::vector<MomentNearness> all(static_cast<std::size_t>(count));
  context.report("predict", 0);
  for (int i = 0; i < count; i += kBatch) {
    const int end = std::min(count, i + kBatch);
    window.move(std::max(0, moment_at(i) + 1 - kPast),
                std::min(frames - 1, moment_at(end - 1) + steps.back()));
    core::parallel_for(static_cast<std::size_t>(end - i), context, [&](std::size_t k) {
      all[static_cast<std::size_t>(i) + k] =
          measure_moment(moment_at(i + static_cast<int>(k)), frames, steps, window, ways);
    });
    context.report("predict", static_cast<double>(end) / count);
  }
  return figures(all, first, steps, ways);
}

}  // namespace emberfold::pipeline
