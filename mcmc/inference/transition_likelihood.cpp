// SPDX-License-Identifier: Apache-2.0
#include "mcmc/inference/transition_likelihood.hpp"

#include <algorithm>
#include <numeric>
#include <span>
#include <string>

#include "core/error.hpp"
#include "mcmc/inference/event_likelihood.hpp"
#include "mcmc/inference/path_likelihood.hpp"

namespace emberfold::mcmc {

namespace {

void check_clip(const MotionModel& model, const graph::SketchSequence& sketch) {
  validate(model);
  const auto size = [](int width, int height) {
    return std::to_string(width) + "x" + std::to_string(height);
  };
  if (sketch.width != model.width || sketch.height != model.height)
    throw core::InputError("the graphs are of " + size(sketch.width, sketch.height) + " px, the model of " +
                           size(model.width, model.height) + "; both must be of one size");
  if (sketch.frames.size() < 2)
    throw core::InputError("a likelihood needs two frames or more; here are " +
                           std::to_string(sketch.frames.size()));
}

void add_motion(const MotionModel& model, const graph::MotionGraph& motion,
                std::vector<TransitionLikelihood>& gaps) {
  const auto tracks = detail::track_curves(motion);
  const auto neighbours = detail::find_track_neighbours(motion, tracks);
  const std::size_t frames = motion.sketch.frames.size();
  const auto displacement = detail::path_log_densities(
      tracks, neighbours, detail::followed_displacement(tracks, model), model.displacement, frames);
  const auto contrast = detail::path_log_densities(
      tracks, neighbours, detail::followed_contrast(tracks, model), model.contrast, frames);
  for (std::size_t i = 0; i < gaps.size(); ++i)
    gaps[i].displacement = displacement[i], gaps[i].contrast = contrast[i];
  for (const auto& track : tracks)
    for (int t = track.first + 1; t <= track.last(); ++t) ++gaps[static_cast<std::size_t>(t - 1)].places;
}

void add_events(const MotionModel& model, const graph::MotionGraph& motion,
                std::vector<TransitionLikelihood>& gaps, const core::Context& context) {
  const auto events = graph::stroke_events(motion);
  const auto& frames = motion.sketch.frames;
  detail::EventHistory history;
  auto next = events.begin();
  for (std::size_t t = 1; t < frames.size(); ++t) {
    context.check();
    const auto first = next;
    while (next != events.end() && next->frame == static_cast<int>(t)) ++next;
    const std::span now(first, next);
    history.forget(static_cast<double>(t));
    gaps[t - 1].events =
        detail::event_log_probabilities(model, frames[t - 1], frames[t], now, history, static_cast<int>(t));
    for (const auto& event : now) {
      ++gaps[t - 1].happened[static_cast<std::size_t>(event.type)];
      history.note(event);
    }
    context.report("likelihood", static_cast<double>(t) / static_cast<double>(gaps.size()));
  }
}

}  // namespace

double TransitionLikelihood::total() const {
  return std::accumulate(events.begin(), events.end(), motion());
}

std::vector<TransitionLikelihood> transition_likelihoods(const MotionModel& model,
                                                         const graph::MotionGraph& motion,
                                                         const core::Context& context) {
  check_clip(model, motion.sketch);
  std::vector<TransitionLikelihood> gaps(motion.sketch.frames.size() - 1);
  add_motion(model, motion, gaps);
  add_events(model, motion, gaps, context);
  return gaps;
}

MeanTransition mean_transition(const std::vector<TransitionLikelihood>& gaps) {
  if (gaps.empty()) throw core::InputError("a mean likelihood needs one gap between frames or more");
  MeanTransition mean;
  const double share = 1 / static_cast<double>(gaps.size());
  double motion = 0, places = 0;
  for (const auto& gap : gaps) {
    mean.displacement += share * gap.displacement, mean.contrast += share * gap.contrast;
    mean.total += share * gap.total();
    for (std::size_t i = 0; i < mean.events.size(); ++i) mean.events[i] += share * gap.events[i];
    motion += gap.motion(), places += static_cast<double>(gap.places);
  }
  mean.motion_per_place = places > 0 ? motion / places : 0;
  return mean;
}

}  // namespace emberfold::mcmc
