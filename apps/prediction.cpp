// SPDX-License-Identifier: Apache-2.0
#include "apps/prediction.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include <opencv2/core.hpp>

#include "apps/clip_part.hpp"
#include "apps/draw_graph_frames.hpp"
#include "apps/interrupt.hpp"
#include "apps/reconstruct.hpp"
#include "core/parallel.hpp"
#include "dytex/synthesize.hpp"

namespace emberfold::apps {

using Json = nlohmann::ordered_json;

namespace {

enum Way : std::size_t { kBefore, kMean, kTexture, kMotion, kSketch, kWays };
constexpr std::array<const char*, kWays> kNames{"frame_before", "mean_image", "linear_dynamic_texture",
                                                "motion_model", "own_sketch"};
constexpr int kBatch = 16;

// Mean square errors of one frame, by way.
using Errors = std::array<std::optional<double>, kWays>;

double mean_square(const cv::Mat& shown, const cv::Mat& truth) {
  const double distance = cv::norm(shown, truth, cv::NORM_L2);
  return distance * distance /
         static_cast<double>(truth.total() * static_cast<std::size_t>(truth.channels()));
}

// As a frame of bytes shows it.
cv::Mat shown(const cv::Mat& levels) {
  cv::Mat out;
  core::to_bytes(levels).convertTo(out, CV_32F);
  return out;
}

double decibel(double mse) {
  const double value = mse > 0 ? 10 * std::log10(255.0 * 255.0 / mse) : kMostPsnr;
  return std::round(std::min(kMostPsnr, value) * 1000) / 1000;
}

cv::Mat mean_image(core::FrameSource& source, int frames, const Session& session) {
  ClipPart part(source, 0, frames);
  cv::Mat sum;
  for (cv::Mat frame = part.next(); !frame.empty(); frame = part.next()) {
    session.check_stop();
    cv::Mat levels;
    core::to_levels(frame, source.info()).convertTo(levels, CV_64F);
    if (sum.empty())
      sum = levels;
    else
      sum += levels;
  }
  sum /= frames;
  cv::Mat mean;
  sum.convertTo(mean, CV_32F);
  return mean;
}

Errors frame_errors(const cv::Mat& before, const cv::Mat& truth, const cv::Mat& mean, int t,
                    const Predictors& predictors) {
  const auto drawn = [&](const graph::AttributeGraph& graph) {
    // Where there is no stroke, the mean level of the frame before is what is known.
    const auto level = cv::mean(core::luma(before))[0];
    cv::Mat out;
    const FrameLook look{truth.size(), truth.channels(), static_cast<float>(level), predictors.fill,
                         predictors.ground};
    draw_frame(graph, look).convertTo(out, CV_32F);
    return out;
  };
  Errors errors;
  errors[kBefore] = mean_square(shown(before), truth);
  errors[kMean] = mean_square(shown(mean), truth);
  if (predictors.texture != nullptr)
    errors[kTexture] = mean_square(shown(dytex::predict(*predictors.texture, before)), truth);
  const auto index = static_cast<std::size_t>(t);
  if (predictors.graphs != nullptr) errors[kMotion] = mean_square(drawn((*predictors.graphs)[index]), truth);
  if (predictors.sketches != nullptr)
    errors[kSketch] = mean_square(drawn((*predictors.sketches)[index]), truth);
  return errors;
}

Json figures(const std::vector<Errors>& all, int first) {
  Json methods = Json::object(), per_frame = Json::object();
  for (std::size_t way = 0; way < kWays; ++way) {
    if (all.empty() || !all.front()[way]) continue;
    double total = 0;
    Json each = Json::array();
    for (const auto& errors : all) {
      total += *errors[way];
      each.push_back(decibel(*errors[way]));
    }
    methods[kNames[way]] = {{"psnr", decibel(total / static_cast<double>(all.size()))}};
    per_frame[kNames[way]] = std::move(each);
  }
  return {{"first_frame", first},
          {"frames", all.size()},
          {"methods", std::move(methods)},
          {"per_frame", std::move(per_frame)}};
}

}  // namespace

Json measure_prediction(core::FrameSource& source, const Predictors& predictors, const Session& session) {
  const auto& info = source.info();
  const cv::Mat mean = mean_image(source, predictors.first, session);
  ClipPart part(source, predictors.first - 1, predictors.frames);
  std::vector<cv::Mat> levels;  // the last one of the batch before comes first
  std::vector<Errors> all;
  session.context.report("predict", 0);
  for (int t = predictors.first; t < predictors.frames;) {
    while (levels.size() < 1 + kBatch) {
      const cv::Mat frame = part.next();
      if (frame.empty()) break;
      levels.push_back(core::to_levels(frame, info));
      session.check_stop();
    }
    if (levels.size() < 2) break;
    std::vector<Errors> errors(levels.size() - 1);
    const auto status = core::parallel_for(errors.size(), session.context, [&](std::size_t i) {
      errors[i] = frame_errors(levels[i], levels[i + 1], mean, t + static_cast<int>(i), predictors);
    });
    if (status == core::Status::cancelled) throw Interrupted{};
    all.insert(all.end(), errors.begin(), errors.end());
    t += static_cast<int>(errors.size());
    levels.erase(levels.begin(), levels.end() - 1);
    session.context.report("predict", double(t - predictors.first) / (predictors.frames - predictors.first));
  }
  return figures(all, predictors.first);
}

}  // namespace emberfold::apps
