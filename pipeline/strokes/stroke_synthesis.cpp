// SPDX-License-Identifier: Apache-2.0
#include "pipeline/strokes/stroke_synthesis.hpp"

#include <utility>

#include "core/clip.hpp"
#include "core/clip/frame_stream.hpp"
#include "core/error.hpp"
#include "core/parallel.hpp"
#include "mcmc/simulation/linked_frames.hpp"
#include "pipeline/footage/motion_scale.hpp"
#include "pipeline/strokes/stroke_strips.hpp"
#include "sketch/inpainting/fill.hpp"

namespace emberfold::pipeline {

namespace {
constexpr double kStripJoint = 8;  // px over which the frame between strips takes their levels
}  // namespace

StrokeSynthesis::StrokeSynthesis(std::vector<cv::Mat> footage, graph::MotionGraph strokes,
                                 const StrokeSynthesisOptions& options, const core::Context& context)
    : clip_(played_clip(std::move(footage), std::move(strokes), options.edit.reverse)),
      options_(options),
      moments_(compare_moments(clip_->frames(), context)),
      play_(clip_, moments_, options.edit, options.seed),
      copied_(clip_->frames(), moving_pixels(clip_->frames())) {}

int StrokeSynthesis::batch() const {
  const auto& frame = clip_->frame(0);
  return static_cast<int>(core::frames_at_once(frame.cols, frame.rows, frame.channels()));
}

StrokeSynthesis::Moment StrokeSynthesis::next_moment() {
  Moment moment{play_.next(), {}};
  moment.turning = turning_.at(clip_->frames(), moment.strokes.shown);
  statistics_.add(moment.strokes.graph, moment.strokes.operators);
  return moment;
}

cv::Mat StrokeSynthesis::draw(const Moment& moment) const {
  const cv::Mat head = draw_moment(clip_->frames(), moment.strokes.shown, moment.turning);
  const auto strips = draw_strips(*clip_, play_.families(), moment.strokes, head);
  cv::Mat levels, ground;
  strips.levels.convertTo(levels, CV_32F);
  head.convertTo(ground, CV_32F);
  return core::to_bytes(sketch::fill_onto(levels, strips.mask, ground, kStripJoint).levels);
}

void StrokeSynthesis::each(int count, const std::function<void(cv::Mat)>& take,
                           const core::Context& context) {
  const auto room = static_cast<std::size_t>(batch());
  std::vector<Moment> moments(room);
  std::vector<cv::Mat> frames(room);
  core::parallel_stream(static_cast<std::size_t>(count), room, context,
                        {[&](std::size_t i) { moments[i % room] = next_moment(); },
                         [&](std::size_t i) { frames[i % room] = draw(moments[i % room]); },
                         [&](std::size_t i) {
                           cv::Mat& frame = frames[i % room];
                           if (drawn_++ % CopiedShare::kEvery == 0) {
                             copied_.add(frame);
                             statistics_.copied_share = copied_.mean();
                           }
                           take(std::move(frame));
                         }});
}

graph::MotionGraph StrokeSynthesis::motion(int count, const core::Context& context) const {
  StrokePlay play(clip_, moments_, options_.edit, options_.seed);
  mcmc::detail::LinkedFrames linked;
  for (int n = 0; n < count; ++n) {
    context.check();
    linked.append(play.next().graph);
  }
  const auto& frame = clip_->frame(0);
  linked.motion.sketch.width = frame.cols, linked.motion.sketch.height = frame.rows;
  linked.motion.sketch.fps = clip_->fps();
  return graph::identify(std::move(linked.motion));
}

}  // namespace emberfold::pipeline
