// SPDX-License-Identifier: Apache-2.0
#include "pipeline/carried/carried_synthesis.hpp"

#include <algorithm>
#include <utility>

#include "core/clip/frame_stream.hpp"
#include "core/error.hpp"
#include "core/parallel.hpp"
#include "graph/events/events.hpp"
#include "graph/matching/time_reversal.hpp"
#include "mcmc/simulation/linked_frames.hpp"
#include "pipeline/footage/turn.hpp"

namespace emberfold::pipeline {

namespace {

/// The clip as it is played: backwards where the edit asks for that.
std::shared_ptr<const SeenClip> played_clip(std::vector<cv::Mat> frames, graph::MotionGraph strokes,
                                            bool reverse) {
  if (reverse) {
    std::ranges::reverse(frames);
    strokes = graph::reverse_time(strokes);
  }
  return std::make_shared<const SeenClip>(std::move(frames), std::move(strokes));
}

}  // namespace

CarriedSynthesis::CarriedSynthesis(std::vector<cv::Mat> footage, graph::MotionGraph strokes,
                                   const CarriedSynthesisOptions& options, const core::Context& context)
    : clip_(played_clip(std::move(footage), std::move(strokes), options.edit.reverse)),
      options_(options),
      moments_(compare_moments(clip_->frames(), context)),
      order_(moments_, {.seed = options.seed}),
      play_(clip_, options.edit, options.gaps, options.seed) {}

int CarriedSynthesis::batch() const {
  const auto& frame = clip_->frame(0);
  return static_cast<int>(core::frames_at_once(frame.cols, frame.rows, frame.channels()));
}

CarriedSynthesis::Drawn CarriedSynthesis::next() {
  Drawn drawn{order_.at(next_++), {}, {}};
  if (drawn.shown.half > 0) {
    const Turn turn = turn_of(drawn.shown);
    if (turning_.empty() || turn != turn_) turning_ = turning_places(clip_->frames(), drawn.shown);
    turn_ = turn;
    drawn.turning = turning_;
  }
  drawn.moment = play_.next(shown_frame(drawn.shown));
  statistics_.patches.push_back(drawn.moment.graph.size());
  statistics_.strokes.push_back(graph::components(drawn.moment.graph).count);
  for (std::size_t k = 0; k < statistics_.operators.size(); ++k)
    statistics_.operators[k] += static_cast<std::size_t>(drawn.moment.operators[k]);
  return drawn;
}

cv::Mat CarriedSynthesis::draw(const Drawn& drawn) const {
  cv::Mat frame = drawn.shown.half > 0 ? draw_turn(clip_->frames(), drawn.shown, drawn.turning)
                                       : clip_->frame(drawn.shown.frame).clone();
  for (const auto& stroke : drawn.moment.strokes) draw_carried(frame, clip_->frames(), stroke);
  return frame;
}

void CarriedSynthesis::each(int count, const std::function<void(cv::Mat)>& take,
                            const core::Context& context) {
  const auto room = static_cast<std::size_t>(batch());
  std::vector<Drawn> moments(room);
  std::vector<cv::Mat> frames(room);
  core::parallel_stream(static_cast<std::size_t>(count), room, context,
                        {[&](std::size_t i) { moments[i % room] = next(); },
                         [&](std::size_t i) { frames[i % room] = draw(moments[i % room]); },
                         [&](std::size_t i) { take(std::move(frames[i % room])); }});
}

graph::MotionGraph CarriedSynthesis::motion(int count, const core::Context& context) const {
  PlayOrder order(moments_, {.seed = options_.seed});
  CarriedPlay play(clip_, options_.edit, options_.gaps, options_.seed);
  mcmc::detail::LinkedFrames linked;
  for (int n = 0; n < count; ++n) {
    context.check();
    linked.append(play.next(shown_frame(order.at(n))).graph);
  }
  const auto& frame = clip_->frame(0);
  linked.motion.sketch.width = frame.cols, linked.motion.sketch.height = frame.rows;
  linked.motion.sketch.fps = clip_->fps();
  return graph::identify(std::move(linked.motion));
}

}  // namespace emberfold::pipeline
