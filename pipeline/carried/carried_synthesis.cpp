// SPDX-License-Identifier: Apache-2.0
#include "pipeline/carried/carried_synthesis.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/clip/frame_stream.hpp"
#include "core/error.hpp"
#include "core/parallel.hpp"
#include "graph/events/events.hpp"
#include "mcmc/simulation/linked_frames.hpp"
#include "pipeline/footage/between_frames.hpp"
#include "pipeline/footage/turn.hpp"

namespace emberfold::pipeline {

namespace {

constexpr int kMostRounds = 12;  // of a loop, until its strokes at the end agree with those at the beginning

/// Returns the edit in terms of played moments: speed and sense of time belong to the play.
mcmc::MotionEdit played_edit(mcmc::MotionEdit edit) {
  edit.wind = edit.wind * (1 / edit.speed);
  edit.speed = 1, edit.reverse = false;
  return edit;
}

/// Returns the graph at a share of the way from one moment to the next: that of the nearer one, with its
/// patches at interpolated places.
graph::AttributeGraph graph_between(const graph::AttributeGraph& before, const graph::AttributeGraph& after,
                                    double share) {
  const bool is_after = share >= 0.5;
  const auto& base = is_after ? after : before;
  const auto& other = is_after ? before : after;
  std::vector<graph::Vertex> vertices(base.vertices().begin(), base.vertices().end());
  for (graph::Vertex& vertex : vertices)
    if (const auto there = other.index_of(vertex.id); there < other.size()) {
      const graph::Point way = other.patch(there).position - vertex.patch.position;
      vertex.patch.position = vertex.patch.position + way * (is_after ? 1 - share : share);
    }
  return {std::move(vertices), {base.edges().begin(), base.edges().end()}};
}

}  // namespace

CarriedSynthesis::CarriedSynthesis(std::vector<cv::Mat> footage, graph::MotionGraph strokes,
                                   const CarriedSynthesisOptions& options, const core::Context& context)
    : clip_(played_clip(std::move(footage), std::move(strokes), options.edit.reverse)),
      options_(options),
      moments_(compare_moments(clip_->frames(), context)),
      order_(moments_, {.seed = options.seed, .loop = played_loop()}),
      play_(clip_, played_edit(options.edit), options.gaps, options.seed, played_loop()) {
  if (options.loop) play_rounds(context);
}

/// Returns the number of moments of a loop, rounded.
std::optional<int> CarriedSynthesis::played_loop() const {
  if (!options_.loop) return std::nullopt;
  if (*options_.loop < 2)
    throw core::InputError("CarriedSynthesisOptions.loop is " + std::to_string(*options_.loop) +
                           "; allowed is 2 or more");
  return std::max(2, static_cast<int>(std::lround(*options_.loop * options_.edit.speed)));
}

/// Plays rounds of a loop until one equals the one before, at most kMostRounds, and keeps the last.
void CarriedSynthesis::play_rounds(const core::Context& context) {
  const int moments = *played_loop();
  std::vector<CarriedMoment> before;
  for (int round = 0; round < kMostRounds; ++round) {
    round_.clear();
    for (int m = 0; m < moments; ++m) {
      context.check();
      round_.push_back(play_.next(shown_frame(order_.at(m))));
    }
    const auto same = [](const CarriedMoment& a, const CarriedMoment& b) { return a.strokes == b.strokes; };
    if (std::ranges::equal(before, round_, same)) return;
    before = round_;
  }
}

int CarriedSynthesis::batch() const {
  const auto& frame = clip_->frame(0);
  const auto most = core::frames_at_once(frame.cols, frame.rows, frame.channels());
  return std::max(1, static_cast<int>(static_cast<double>(most) / std::max(1.0, options_.edit.speed)));
}

/// Returns the moment that a frame shows, or a time between two.
double CarriedSynthesis::time(std::int64_t frame) const {
  const double step = options_.loop ? double(*played_loop()) / *options_.loop : options_.edit.speed;
  return step * static_cast<double>(frame);
}

CarriedSynthesis::Moment CarriedSynthesis::next_moment() {
  const auto number = next_moment_++;
  Moment moment{order_.at(number), {}, {}};
  moment.turning = turning_.at(clip_->frames(), moment.shown);
  moment.carried = round_.empty() ? play_.next(shown_frame(moment.shown))
                                  : round_[static_cast<std::size_t>(number) % round_.size()];
  statistics_.add(moment.carried.graph, moment.carried.operators);
  statistics_.edited = statistics_.edited.value_or(0) + (moment.carried.strokes.empty() ? 0 : 1);
  return moment;
}

cv::Mat CarriedSynthesis::draw(const Moment& moment) const {
  cv::Mat frame = draw_moment(clip_->frames(), moment.shown, moment.turning).clone();
  for (const auto& stroke : moment.carried.strokes) draw_carried(frame, clip_->frames(), stroke);
  return frame;
}

/// Draws the moments up to `last` that are not drawn yet.
void CarriedSynthesis::draw_moments(std::int64_t last, const core::Context& context) {
  if (last < next_moment_) return;
  const auto first = next_moment_;
  const auto room = static_cast<std::size_t>(batch());
  std::vector<Moment> moments(room);
  std::vector<cv::Mat> frames(room);
  core::parallel_stream(static_cast<std::size_t>(last - first + 1), room, context,
                        {[&](std::size_t i) { moments[i % room] = next_moment(); },
                         [&](std::size_t i) { frames[i % room] = draw(moments[i % room]); },
                         [&](std::size_t i) {
                           drawn_[first + static_cast<std::int64_t>(i)].frame = std::move(frames[i % room]);
                         }});
}

/// Finds the motion from each moment after which one of the next `count` frames is due.
void CarriedSynthesis::find_motion(std::int64_t count, const core::Context& context) {
  std::set<std::int64_t> missing;
  for (auto n = next_frame_; n < next_frame_ + count; ++n)
    if (const double moment = std::floor(time(n)); moment < time(n)) missing.insert(std::int64_t(moment));
  std::erase_if(missing, [&](std::int64_t k) { return !drawn_.at(k).motion.empty(); });
  const std::vector<std::int64_t> all(missing.begin(), missing.end());
  core::parallel_for(all.size(), context, [&](std::size_t i) {
    DrawnMoment& from = drawn_.at(all[i]);
    from.motion = footage_motion(from.frame, drawn_.at(all[i] + 1).frame);
  });
}

cv::Mat CarriedSynthesis::frame_at(std::int64_t frame) const {
  const auto moment = static_cast<std::int64_t>(std::floor(time(frame)));
  const double share = time(frame) - static_cast<double>(moment);
  const DrawnMoment& from = drawn_.at(moment);
  if (share <= 0) return from.frame.clone();
  const cv::Mat& to = drawn_.at(moment + 1).frame;
  return draw_between(std::array<MovingFrame, 2>{{{&from.frame, &from.motion}, {&to, nullptr}}}, share,
                      cv::Mat1f(to.size(), 0.F));
}

void CarriedSynthesis::each(int count, const std::function<void(cv::Mat)>& take,
                            const core::Context& context) {
  while (count > 0) {
    const int some = std::min(count, batch());
    draw_moments(static_cast<std::int64_t>(std::ceil(time(next_frame_ + some - 1))), context);
    find_motion(some, context);
    std::vector<cv::Mat> frames(static_cast<std::size_t>(some));
    core::parallel_for(frames.size(), context,
                       [&](std::size_t i) { frames[i] = frame_at(next_frame_ + std::int64_t(i)); });
    for (cv::Mat& frame : frames) {
      take(std::move(frame));
      ++next_frame_;
    }
    count -= some;
    drawn_.erase(drawn_.begin(),
                 drawn_.lower_bound(static_cast<std::int64_t>(std::floor(time(next_frame_)))));
  }
}

graph::MotionGraph CarriedSynthesis::motion(int count, const core::Context& context) const {
  PlayOrder order(moments_, {.seed = options_.seed, .loop = played_loop()});
  // A loop continues from the round that is shown.
  CarriedPlay play =
      round_.empty() ? CarriedPlay(clip_, played_edit(options_.edit), options_.gaps, options_.seed) : play_;
  mcmc::detail::LinkedFrames linked;
  std::int64_t played = 0;
  std::array<graph::AttributeGraph, 2> newest;  // graphs of the two moments played last
  for (int n = 0; n < count; ++n) {
    context.check();
    for (; static_cast<double>(played) <= std::ceil(time(n)); ++played) {
      newest[0] = newest[1];
      newest[1] = play.next(shown_frame(order.at(played))).graph;
    }
    const double share = time(n) - std::floor(time(n));
    linked.append(share > 0 ? graph_between(newest[0], newest[1], share) : newest[1]);
  }
  const auto& frame = clip_->frame(0);
  linked.motion.sketch.width = frame.cols, linked.motion.sketch.height = frame.rows;
  linked.motion.sketch.fps = clip_->fps();
  return graph::identify(std::move(linked.motion));
}

}  // namespace emberfold::pipeline
