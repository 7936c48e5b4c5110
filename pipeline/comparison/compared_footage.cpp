// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "core/clip.hpp"
#include "core/clip/clip_range.hpp"
#include "pipeline/comparison/compared_models.hpp"
#include "pipeline/footage/carried_prediction.hpp"
#include "pipeline/footage/footage.hpp"
#include "pipeline/footage/footage_synthesis.hpp"
#include "pipeline/footage/like_moments.hpp"
#include "pipeline/parameter_count.hpp"
#include "pipeline/strokes/stroke_synthesis.hpp"

namespace emberfold::pipeline {

namespace {

/// Returns the first and last frame of the loop whose jump back costs least, among loops of at least a third
/// of the frames.
std::pair<int, int> find_loop(const LikeMoments& moments) {
  const int n = moments.frames;
  std::pair<int, int> best{0, n - 1};
  float least = std::numeric_limits<float>::infinity();
  for (int first = 0; first < n; ++first)
    for (int last = first + std::max(1, n / 3); last < n; ++last)
      if (moments.cost(last, first) < least) {
        least = moments.cost(last, first);
        best = {first, last};
      }
  return best;
}

/// Numbers in these frames.
double numbers(const std::vector<cv::Mat>& frames) {
  return static_cast<double>(frames.size()) * static_cast<double>(frames.front().total()) *
         frames.front().channels();
}

/// Draws clips by the method that make() returns.
template <class Make>
std::function<ComparedModel::NextFrames()> drawn_by(Make make, const core::Context& context) {
  return [make = std::move(make), context]() -> ComparedModel::NextFrames {
    return [method = make(), context](int count) {
      std::vector<cv::Mat> drawn;
      method->each(
          count, [&](cv::Mat frame) { drawn.push_back(std::move(frame)); }, context);
      return drawn;
    };
  };
}

}  // namespace

SharedFrames drawn_footage(const TrainingInput& input, const KnownModels& known) {
  // Clips of the known models are drawn from the whole clip, too.
  core::ClipRange part(input.source, 0, known.motion_model != nullptr ? input.frames : input.learned_frames);
  return std::make_shared<const std::vector<cv::Mat>>(
      decode(gather_footage(part, {}, input.context), input.context));
}

std::optional<ComparedModel> footage_model(const TrainingInput& input, const SharedFrames& footage) {
  return learn_or_warn("no footage", input.context, [&] {
    core::ClipRange learned_part(input.source, 0, input.learned_frames);
    const auto prediction = std::make_shared<const CarriedPrediction>(
        learn_carried_prediction(learned_part, input.steps, input.context));
    ComparedModel model{"footage", "clip's footage"};
    model.parameters = numbers(*footage) + prediction->parameters();
    model.begin_clip = drawn_by(
        [footage, seed = input.seed, context = input.context] {
          return std::make_shared<FootageSynthesis>(*footage, FootageSynthesisOptions{.seed = seed}, context);
        },
        input.context);
    model.predict = [prediction](const PastFrames& past, std::span<const int> steps) {
      return predict(*prediction, past.levels, steps);
    };
    return model;
  });
}

std::optional<ComparedModel> strokes_model(const TrainingInput& input, const SharedFrames& footage,
                                           graph::MotionGraph strokes) {
  return learn_or_warn("no strokes", input.context, [&] {
    const auto motion = std::make_shared<const graph::MotionGraph>(std::move(strokes));
    ComparedModel model{"strokes", "clip's strokes"};
    model.parameters = numbers(*footage) + parameter_count(motion->sketch);
    model.begin_clip = drawn_by(
        [footage, motion, seed = input.seed, context = input.context] {
          return std::make_shared<StrokeSynthesis>(*footage, *motion, StrokeSynthesisOptions{.seed = seed},
                                                   context);
        },
        input.context);
    return model;
  });
}

ComparedModel loop_model(const TrainingInput& input) {
  core::ClipRange learned_part(input.source, 0, input.learned_frames);
  std::vector<cv::Mat> frames;
  for (cv::Mat frame = learned_part.next(); !frame.empty(); frame = learned_part.next()) {
    frames.push_back(core::to_bytes(core::to_levels(frame, input.source.info())));
    input.context.check();
  }
  const auto [first, last] = find_loop(compare_moments(frames, input.context));
  frames.erase(frames.begin() + last + 1, frames.end());
  frames.erase(frames.begin(), frames.begin() + first);
  ComparedModel model{"video_loop", "video-texture loop"};
  model.has_strokes = false;
  model.parameters = numbers(frames);
  model.begin_clip = [frames = std::make_shared<const std::vector<cv::Mat>>(
                          std::move(frames))]() -> ComparedModel::NextFrames {
    return [frames, t = std::size_t{0}](int count) mutable {
      std::vector<cv::Mat> drawn;
      for (int i = 0; i < count; ++i) drawn.push_back((*frames)[t++ % frames->size()].clone());
      return drawn;
    };
  };
  return model;
}

}  // namespace emberfold::pipeline
