// SPDX-License-Identifier: Apache-2.0
#include "pipeline/footage/played_frames.hpp"

#include <cstddef>
#include <utility>
#include <vector>

#include "core/parallel.hpp"
#include "pipeline/footage/turn.hpp"

namespace emberfold::pipeline {

PlayedFrames::PlayedFrames(std::shared_ptr<const std::vector<cv::Mat>> footage, PlayOrder order)
    : footage_(std::move(footage)), order_(std::move(order)) {}

/// Finds the turning places of turns that begin; all moments of a turn share them.
void PlayedFrames::find_turning_places(const std::vector<Moment*>& moments, const core::Context& context) {
  std::map<Turn, cv::Mat1f> places;
  std::vector<std::pair<const PlayedMoment*, cv::Mat1f*>> missing;
  for (const auto* moment : moments) {
    if (moment->shown.half == 0) continue;
    const auto [at, added] = places.try_emplace(turn_of(moment->shown));
    if (!added) continue;
    if (const auto known = turning_places_.find(at->first); known != turning_places_.end())
      at->second = known->second;
    else
      missing.emplace_back(&moment->shown, &at->second);
  }
  core::parallel_for(missing.size(), context, [&](std::size_t i) {
    *missing[i].second = turning_places(*footage_, *missing[i].first);
  });
  turning_places_ = std::move(places);
}

void PlayedFrames::prepare(std::int64_t first, std::int64_t last, const core::Context& context) {
  moments_.erase(moments_.begin(), moments_.lower_bound(first));
  std::vector<Moment*> moving, still;
  std::vector<const Moment*> after;
  for (std::int64_t n = first; n <= last; ++n) {
    auto& moment = moments_[n];
    if (moment.frame.empty()) {
      moment.shown = order_.at(n);
      still.push_back(&moment);
    }
  }
  const auto& frames = *footage_;
  find_turning_places(still, context);
  core::parallel_for(still.size(), context, [&](std::size_t i) {
    const auto& shown = still[i]->shown;
    still[i]->frame = shown.half > 0 ? draw_turn(frames, shown, turning_places_.at(turn_of(shown)))
                                     : frames[static_cast<std::size_t>(shown.frame)];
  });
  for (std::int64_t n = first; n < last; ++n) {
    auto& moment = moments_.at(n);
    if (!moment.motion.empty()) continue;
    moving.push_back(&moment);
    after.push_back(&moments_.at(n + 1));
  }
  core::parallel_for(moving.size(), context, [&](std::size_t i) {
    moving[i]->motion = footage_motion(moving[i]->frame, after[i]->frame);
  });
}

}  // namespace emberfold::pipeline
