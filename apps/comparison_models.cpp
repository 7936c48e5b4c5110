// SPDX-License-Identifier: Apache-2.0
#include "apps/comparison_models.hpp"

#include <algorithm>
#include <span>

#include "apps/clip_part.hpp"
#include "apps/interrupt.hpp"
#include "core/error.hpp"
#include "mcmc/fit.hpp"
#include "mcmc/predict.hpp"

namespace emberfold::apps {

namespace {

graph::MotionGraph match(graph::SketchSequence sketch, const graph::MatchOptions& options,
                         const Session& session) {
  auto matched = graph::match(std::move(sketch), options, session.context);
  if (matched.status == core::Status::cancelled) throw Interrupted{};
  return std::move(matched.motion);
}

std::optional<mcmc::MotionModel> fit(const graph::MotionGraph& motion, const std::string& what,
                                     Session& session) {
  try {
    mcmc::FitOptions options;
    options.seed = session.common.seed;
    auto fitted = mcmc::fit(motion, options, session.context);
    if (fitted.status == core::Status::cancelled) throw Interrupted{};
    for (const auto& note : fitted.notes) session.warn("motion model of " + what + ": " + note);
    return std::move(fitted.model);
  } catch (const core::InputError& error) {
    session.warn("no motion model of " + what + ": " + error.what());
    return std::nullopt;
  }
}

std::optional<dytex::LinearDynamicTexture> learn(core::FrameSource& source, int frames,
                                                 dytex::LearnOptions options, const std::string& what,
                                                 Session& session) {
  try {
    options.components = std::min(options.components, std::max(1, frames / 3));
    auto learned = dytex::learn(source, options, session.context);
    if (learned.status == core::Status::cancelled) throw Interrupted{};
    for (const auto& note : learned.notes) session.warn("linear dynamic texture of " + what + ": " + note);
    return std::move(learned.texture);
  } catch (const core::InputError& error) {
    session.warn("no linear dynamic texture of " + what + ": " + error.what());
    return std::nullopt;
  }
}

graph::SketchSequence first_frames(const graph::SketchSequence& sketch, int count) {
  graph::SketchSequence first = sketch;
  first.frames.resize(static_cast<std::size_t>(count));
  return first;
}

}  // namespace

void need_frames(const std::string& clip, std::int64_t frames) {
  if (frames <= 0) throw core::IoError(clip + " holds no frame");
  if (frames < kFewestFrames)
    throw core::IoError(clip + " holds " + std::to_string(frames) + (frames == 1 ? " frame" : " frames") +
                        "; a comparison needs at least " + std::to_string(kFewestFrames));
}

ComparedModels learn_models(core::FrameSource& source, const std::string& clip, const CompareOptions& options,
                            const KnownModels& known, Session& session) {
  SketchedClip own;
  if (known.sketched == nullptr) own = sketch_clip(source, options.sketch, session);
  const auto& [sketch, grounds] = known.sketched != nullptr ? *known.sketched : own;
  ComparedModels models;
  models.frames = static_cast<int>(sketch.frames.size());
  need_frames(clip, models.frames);
  models.half = models.frames / 2;
  models.ground = still_ground(grounds);
  models.half_ground = still_ground(std::span(grounds).first(static_cast<std::size_t>(models.half)));

  if (known.motion_model != nullptr)
    models.motion = *known.motion_model;
  else if (known.motion != nullptr)
    models.motion = fit(*known.motion, "the clip", session);
  else
    models.motion = fit(match(sketch, options.match, session), "the clip", session);
  const auto first = match(first_frames(sketch, models.half), options.match, session);
  if (const auto half_model = fit(first, "its first half", session)) {
    // Steadying takes back what later frames show to be flicker; whoever foretells cannot know them.
    auto causal = options.match;
    causal.flicker = 0;
    models.predicted = mcmc::predict(*half_model, match(sketch, causal, session));
  }
  models.sketches = sketch.frames;

  models.texture = known.texture != nullptr
                       ? *known.texture
                       : learn(source, models.frames, options.learn, "the clip", session);
  ClipPart part(source, 0, models.half);
  models.half_texture = learn(part, models.half, options.learn, "its first half", session);
  return models;
}

}  // namespace emberfold::apps
