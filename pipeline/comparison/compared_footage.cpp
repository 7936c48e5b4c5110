// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <utility>

#include "core/clip/clip_range.hpp"
#include "pipeline/comparison/compared_models.hpp"
#include "pipeline/footage/carried_prediction.hpp"
#include "pipeline/footage/footage.hpp"
#include "pipeline/footage/footage_synthesis.hpp"

namespace emberfold::pipeline {

std::optional<ComparedModel> footage_model(const TrainingInput& input, const KnownModels& known) {
  return learn_or_warn("no footage", input.context, [&] {
    core::ClipRange learned_part(input.source, 0, input.learned_frames);
    const auto prediction = std::make_shared<const CarriedPrediction>(
        learn_carried_prediction(learned_part, input.steps, input.context));
    // Like the other models' clips, this one is drawn from the whole clip where models of it are known.
    core::ClipRange drawn_part(input.source, 0,
                               known.motion_model != nullptr ? input.frames : input.learned_frames);
    const auto frames = std::make_shared<const std::vector<cv::Mat>>(
        decode(gather_footage(drawn_part, input.context), input.context));
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

}  // namespace emberfold::pipeline
