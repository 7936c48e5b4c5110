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

}  // namespace

std::optional<ComparedModel> footage_model(const TrainingInput& input, const KnownModels& known) {
  return learn_or_warn("no footage", input.context, [&] {
    core::ClipRange learned_part(input.source, 0, input.learned_frames);
    const auto prediction = std::make_shared<const CarriedPrediction>(
        learn_carried_prediction(learned_part, input.steps, input.context));
    // Like those of the other models, this clip is drawn from the whole clip where models of it are known.
    core::ClipRange drawn_part(input.source, 0,
                               known.motion_model != nullptr ? input.frames : input.learned_frames);
    const auto frames = std::make_shared<const std::vector<cv::Mat>>(
        decode(gather_footage(drawn_part, {}, input.context), input.context));
    ComparedModel model{"footage", "clip's footage"};
    model.parameters = static_cast<double>(frames->size()) * static_cast<double>(frames->front().total()) *
                           frames->front().channels() +
                       prediction->parameters();
    model.begin_clip = [frames, seed = input.seed, context = input.context]() -> ComparedModel::NextFrames {
      const auto synthesis =
          std::make_shared<FootageSynthesis>(*frames, FootageSynthesisOptions{.seed = seed}, context);
      return [synthesis, context](int count) {
        std::vector<cv::Mat> drawn;
        synthesis->each(
            count, [&](cv::Mat frame) { drawn.push_back(std::move(frame)); }, context);
        return drawn;
      };
    };
    model.predict = [prediction](const PastFrames& past, std::span<const int> steps) {
      return predict(*prediction, past.levels, steps);
    };
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
  model.parameters = static_cast<double>(frames.size()) * static_cast<double>(frames.front().total()) *
                     frames.front().channels();
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
