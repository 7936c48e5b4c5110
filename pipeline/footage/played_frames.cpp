// SPDX-License-Identifier: Apache-2.0
#include "pipeline/footage/played_frames.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <utility>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "core/parallel.hpp"
#include "pipeline/footage/turn.hpp"

namespace emberfold::pipeline {

namespace {

constexpr int kAhead = 4;  // moments that a seam looks ahead, to avoid sudden moves

}  // namespace

PlayedFrames::PlayedFrames(std::shared_ptr<const std::vector<cv::Mat>> footage,
                           std::vector<std::shared_ptr<PlayOrder>> orders, std::shared_ptr<const Seams> seams,
                           std::optional<int> loop)
    : footage_(std::move(footage)), orders_(std::move(orders)), seams_(std::move(seams)), loop_(loop) {}

double PlayedFrames::jump_cost() const {
  double sum = 0;
  for (const auto& order : orders_) sum += order->relative_cost();
  return sum / static_cast<double>(orders_.size());
}

bool PlayedFrames::plays_back() const {
  return std::ranges::any_of(orders_, [](const auto& order) { return order->plays_back(); });
}

SeamLines PlayedFrames::next_seams(std::int64_t n, const SeamLines& before) {
  std::vector<std::vector<int>> shown(kAhead + 1);
  for (int d = 0; d <= kAhead; ++d)
    for (const auto& order : orders_)
      shown[static_cast<std::size_t>(d)].push_back(shown_frame(order->at(n + d)));
  return seams_->next(shown, before);
}

/// Returns the seams of moment n, which is not before that of the last call. Loops use the second round,
/// which continues from the end of the first.
SeamLines PlayedFrames::seams_at(std::int64_t n) {
  if (orders_.size() < 2) return {};
  if (loop_ && loop_seams_.empty())
    for (int t = 0; t < 2 * *loop_; ++t) {
      newest_seams_ = next_seams(t, newest_seams_);
      if (t >= *loop_) loop_seams_.push_back(newest_seams_);
    }
  if (loop_) return loop_seams_[static_cast<std::size_t>(n % *loop_)];
  while (seams_next_ <= n) newest_seams_ = next_seams(seams_next_++, newest_seams_);
  return newest_seams_;
}

cv::Mat PlayedFrames::draw(const Moment& moment) const {
  std::vector<cv::Mat> frames;
  for (const auto& shown : moment.shown)
    frames.push_back(
        draw_moment(*footage_, shown, shown.half > 0 ? turning_places_.at(turn_of(shown)) : cv::Mat1f()));
  return frames.size() == 1 ? frames.front() : seams_->join(frames, moment.seams);
}

/// Finds the turning places of transitions that begin; all moments of a transition share them.
void PlayedFrames::find_turning_places(const std::vector<Moment*>& moments, const core::Context& context) {
  std::map<Turn, cv::Mat1f> places;
  std::vector<std::pair<const PlayedMoment*, cv::Mat1f*>> missing;
  const auto find = [&](const PlayedMoment& shown) {
    if (shown.half == 0) return;
    const auto [at, added] = places.try_emplace(turn_of(shown));
    if (!added) return;
    if (const auto known = turning_places_.find(at->first); known != turning_places_.end())
      at->second = known->second;
    else
      missing.emplace_back(&shown, &at->second);
  };
  for (const auto* moment : moments)
    for (const auto& shown : moment->shown) find(shown);
  core::parallel_for(missing.size(), context, [&](std::size_t i) {
    *missing[i].second = turning_places(*footage_, *missing[i].first);
  });
  turning_places_ = std::move(places);
}

/// Returns the frames that each play shows in two moments, if these are neighbours in the footage: their
/// motion is the same whenever they are played. Empty where a play is at a jump.
std::vector<std::pair<int, int>> PlayedFrames::shown_pairs(const Moment& moment, const Moment& next) {
  std::vector<std::pair<int, int>> pairs;
  for (std::size_t i = 0; i < moment.shown.size(); ++i) {
    const PlayedMoment &from = moment.shown[i], &to = next.shown[i];
    if (from.half > 0 || to.half > 0 || std::abs(to.frame - from.frame) > 1) return {};
    pairs.emplace_back(from.frame, to.frame);
  }
  return pairs;
}

void PlayedFrames::prepare(std::int64_t first, std::int64_t last, const core::Context& context) {
  moments_.erase(moments_.begin(), moments_.lower_bound(first));
  std::vector<Moment*> still;
  for (std::int64_t n = first; n <= last; ++n) {
    auto& moment = moments_[n];
    if (moment.frame.empty()) {
      for (const auto& order : orders_) moment.shown.push_back(order->at(n));
      moment.seams = seams_at(n);
      still.push_back(&moment);
    }
  }
  find_turning_places(still, context);
  core::parallel_for(still.size(), context, [&](std::size_t i) { still[i]->frame = draw(*still[i]); });
  find_motion(first, last, context);
}

/// Finds the motion of the moments from `first` up to `last`. At a jump it is measured between the drawn
/// frames, elsewhere between neighbouring frames of the footage, once for every time that they are played.
void PlayedFrames::find_motion(std::int64_t first, std::int64_t last, const core::Context& context) {
  std::vector<std::pair<Moment*, const Moment*>> jumping, playing;
  std::map<std::pair<int, int>, cv::Mat> missing;
  for (std::int64_t n = first; n < last; ++n) {
    auto& moment = moments_.at(n);
    if (!moment.motion.empty()) continue;
    const auto pairs = shown_pairs(moment, moments_.at(n + 1));
    (pairs.empty() ? jumping : playing).emplace_back(&moment, &moments_.at(n + 1));
    for (const auto& pair : pairs)
      if (!motions_.contains(pair)) missing.try_emplace(pair);
  }
  std::vector<std::map<std::pair<int, int>, cv::Mat>::value_type*> found;
  for (auto& one : missing) found.push_back(&one);
  core::parallel_for(jumping.size() + found.size(), context, [&](std::size_t i) {
    if (i < jumping.size()) {
      auto& [moment, next] = jumping[i];
      moment->motion = footage_motion(moment->frame, next->frame);
    } else {
      auto& [pair, motion] = *found[i - jumping.size()];
      motion = footage_motion((*footage_)[static_cast<std::size_t>(pair.first)],
                              (*footage_)[static_cast<std::size_t>(pair.second)]);
    }
  });
  motions_.merge(missing);
  for (auto& [moment, next] : playing) moment->motion = joined(shown_pairs(*moment, *next), moment->seams);
}

/// Joins the motions between each play's frames, each in its play's part of the frame.
cv::Mat PlayedFrames::joined(const std::vector<std::pair<int, int>>& pairs, const SeamLines& seams) const {
  if (pairs.size() == 1) return motions_.at(pairs.front());
  cv::Mat motion = motions_.at(pairs.front()).clone(), plays;
  cv::resize(seams_->plays_by_cell(seams), plays, motion.size(), 0, 0, cv::INTER_NEAREST);
  for (std::size_t i = 1; i < pairs.size(); ++i)
    motions_.at(pairs[i]).copyTo(motion, plays == static_cast<double>(i));
  return motion;
}

}  // namespace emberfold::pipeline
