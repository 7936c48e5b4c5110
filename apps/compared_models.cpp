// SPDX-License-Identifier: Apache-2.0
#include "apps/compared_models.hpp"

#include <algorithm>
#include <map>
#include <memory>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "apps/clip_part.hpp"
#include "apps/draw_graph_frames.hpp"
#include "apps/interrupt.hpp"
#include "core/error.hpp"
#include "dytex/star.hpp"
#include "dytex/synthesize.hpp"
#include "mcmc/fit.hpp"
#include "mcmc/predict.hpp"
#include "mcmc/synthesize.hpp"

namespace emberfold::apps {

namespace {

graph::MotionGraph match(graph::SketchSequence sketch, const graph::MatchOptions& options,
                         const Session& session) {
  auto matched = graph::match(std::move(sketch), options, session.context);
  if (matched.status == core::Status::cancelled) throw Interrupted{};
  return std::move(matched.motion);
}

graph::SketchSequence first_frames(const graph::SketchSequence& sketch, int count) {
  graph::SketchSequence first = sketch;
  first.frames.resize(static_cast<std::size_t>(count));
  return first;
}

template <class Result>
void check_learned(const Result& result, const char* what, Session& session) {
  if (result.status == core::Status::cancelled) throw Interrupted{};
  for (const auto& note : result.notes) session.warn(std::string(what) + ": " + note);
}

// What the motion model's functions share.
struct Strokes {
  mcmc::MotionModel model, drawn;                            // learned; drawn from
  Ground ground, drawn_ground;                               // likewise
  std::vector<graph::AttributeGraph> sketches;               // of every frame
  std::map<int, std::vector<graph::AttributeGraph>> ahead;   // by steps: of every frame, foretold
  sketch::FillOptions fill;
  core::ClipInfo info;
  float level = 0;  // of a drawn frame with nothing in it
};

// Where there is no stroke, the mean level of the newest frame is what is known.
cv::Mat drawn_at(const graph::AttributeGraph& graph, const Moment& moment, const Strokes& strokes) {
  const auto level = static_cast<float>(cv::mean(core::luma(moment.past.back()))[0]);
  return draw_frame(graph, {{strokes.info.width, strokes.info.height}, strokes.info.channels, level,
                            strokes.fill, strokes.ground});
}

ComparedModel::Frames draw_strokes(const std::shared_ptr<const Strokes>& strokes, const Session& session) {
  const auto synthesis = std::make_shared<mcmc::Synthesis>(strokes->drawn, session.common.seed);
  const FrameLook look{{strokes->info.width, strokes->info.height},
                       strokes->info.channels,
                       strokes->level,
                       strokes->fill,
                       strokes->drawn_ground};
  return [strokes, synthesis, look, context = session.context](int count) {
    std::vector<graph::AttributeGraph> graphs;
    for (int i = 0; i < count; ++i) graphs.push_back(synthesis->next());
    return draw_batch(graphs, look, context);
  };
}

float mean_level(core::FrameSource& source) {
  source.rewind();
  return static_cast<float>(cv::mean(core::luma(source.next(), source.info()))[0]);
}

std::optional<Strokes> learn_strokes(const ModelInput& input, const KnownModels& known) {
  const auto& [sketch, grounds] = input.sketched;
  auto& session = input.session;
  Strokes strokes;
  strokes.fill = input.options.fill, strokes.info = input.source.info();
  strokes.ground = still_ground(std::span(grounds).first(static_cast<std::size_t>(input.first)));
  strokes.drawn_ground = known.motion_model != nullptr ? still_ground(grounds) : strokes.ground;
  strokes.sketches = sketch.frames;
  strokes.level = mean_level(input.source);
  try {
    mcmc::FitOptions options;
    options.seed = session.common.seed;
    // Balance serves drawing alone.
    options.balance = known.motion_model == nullptr;
    auto fitted = mcmc::fit(match(first_frames(sketch, input.first), input.options.match, session), options,
                            session.context);
    check_learned(fitted, "motion model", session);
    strokes.model = std::move(fitted.model);
  } catch (const core::InputError& error) {
    session.warn(std::string("no motion model: ") + error.what());
    return std::nullopt;
  }
  strokes.drawn = known.motion_model != nullptr ? *known.motion_model : strokes.model;
  if (input.first < input.frames) {
    // Steadying takes back what later frames show to be flicker; whoever foretells cannot know them.
    auto causal = input.options.match;
    causal.flicker = 0;
    const auto motion = match(sketch, causal, session);
    for (const int step : input.steps) strokes.ahead[step] = mcmc::predict(strokes.model, motion, step);
  }
  return strokes;
}

cv::Mat resized(const cv::Mat& frame, cv::Size size) {
  if (frame.size() == size) return frame;
  cv::Mat out;
  const bool reduced = size.area() < frame.size().area();
  cv::resize(frame, out, size, 0, 0, reduced ? cv::INTER_AREA : cv::INTER_LINEAR);
  return out;
}

// The frames of a source, as levels, reduced.
class ReducedSource final : public core::FrameSource {
 public:
  ReducedSource(core::FrameSource& source, double scale) : source_(source), info_(source.info()) {
    info_.width = std::max(1, cvRound(info_.width * scale)),
    info_.height = std::max(1, cvRound(info_.height * scale));
    info_.depth = CV_32F, info_.white = 255;
  }
  [[nodiscard]] const core::ClipInfo& info() const override { return info_; }
  cv::Mat next() override {
    const cv::Mat frame = source_.next();
    return frame.empty() ? frame
                         : resized(core::to_levels(frame, source_.info()), {info_.width, info_.height});
  }
  void rewind() override { source_.rewind(); }

 private:
  core::FrameSource& source_;
  core::ClipInfo info_;
};

std::vector<cv::Mat> enlarged(std::vector<cv::Mat> frames, cv::Size size) {
  for (auto& frame : frames) frame = resized(frame, size);
  return frames;
}

}  // namespace

std::optional<ComparedModel> sketch_model(const ModelInput& input, const KnownModels& known) {
  auto learned = learn_strokes(input, known);
  if (!learned) return std::nullopt;
  const auto strokes = std::make_shared<const Strokes>(std::move(*learned));
  ComparedModel model{"motion_model", "motion model", "synthesized_motion.avi"};
  model.parameters =
      parameter_count(strokes->model) +
      static_cast<double>(strokes->ground.levels.total()) * std::max(1, strokes->ground.levels.channels());
  model.draw = [strokes, &session = input.session] { return draw_strokes(strokes, session); };
  model.foretell = [strokes](const Moment& moment, int steps) {
    return drawn_at(strokes->ahead.at(steps)[static_cast<std::size_t>(moment.frame + steps)], moment,
                    *strokes);
  };
  model.reconstruct = [strokes](const Moment& moment) {
    return drawn_at(strokes->sketches[static_cast<std::size_t>(moment.frame)], moment, *strokes);
  };
  return model;
}

std::optional<ComparedModel> texture_model(const ModelInput& input, const KnownModels& known, int components,
                                           double scale) {
  auto& session = input.session;
  ClipPart part(input.source, 0, input.first);
  ReducedSource reduced(part, scale);
  core::FrameSource& source = scale < 1 ? static_cast<core::FrameSource&>(reduced) : part;
  dytex::LinearDynamicTexture learned;
  try {
    auto options = input.options.learn;
    options.components = std::min(components, std::max(1, input.first / 3));
    auto result = dytex::learn(source, options, session.context);
    check_learned(result, "linear dynamic texture", session);
    learned = std::move(result.texture);
  } catch (const core::InputError& error) {
    session.warn(std::string("no linear dynamic texture: ") + error.what());
    return std::nullopt;
  }
  const cv::Size size(input.source.info().width, input.source.info().height),
      inner(source.info().width, source.info().height);
  const auto texture = std::make_shared<const dytex::LinearDynamicTexture>(std::move(learned));
  ComparedModel model{"linear_dynamic_texture", "linear dynamic texture", "synthesized_dytex.avi"};
  model.parameters = static_cast<double>(texture->mean.size() + texture->C.size() + texture->A.size() +
                                         texture->B.size());
  const auto drawn = known.texture != nullptr && scale >= 1
                         ? std::shared_ptr<const dytex::LinearDynamicTexture>(known.texture, [](auto*) {})
                         : texture;
  model.draw = [drawn, size, seed = session.common.seed]() -> ComparedModel::Frames {
    dytex::SynthesisOptions options;
    options.seed = seed;
    return [drawn, size, synthesis = std::make_shared<dytex::Synthesis>(*drawn, options)](int count) {
      std::vector<cv::Mat> frames;
      for (int i = 0; i < count; ++i) frames.push_back(synthesis->next());
      return enlarged(std::move(frames), size);
    };
  };
  model.foretell = [texture, size, inner](const Moment& moment, int steps) {
    Eigen::VectorXd state = dytex::expected_state(
        *texture, dytex::project(*texture, resized(moment.past.back(), inner)));
    for (int i = 0; i < steps; ++i) state = texture->A * state;
    return resized(dytex::draw(*texture, state), size);
  };
  model.reconstruct = [texture, size, inner](const Moment& moment) {
    return resized(dytex::draw(*texture, dytex::project(*texture, resized(moment.past.back(), inner))), size);
  };
  return model;
}

std::optional<ComparedModel> star_model(const ModelInput& input, int reach) {
  auto& session = input.session;
  ClipPart part(input.source, 0, input.first);
  dytex::StarResult learned;
  try {
    dytex::StarOptions options;
    options.reach = reach;
    learned = dytex::learn_star(part, options, session.context);
    check_learned(learned, "STAR", session);
  } catch (const core::InputError& error) {
    session.warn(std::string("no auto-regression: ") + error.what());
    return std::nullopt;
  }
  const auto star = std::make_shared<const dytex::Star>(std::move(learned.star));
  ComparedModel model{"star", "STAR", "synthesized_star.avi"};
  const auto channels = static_cast<double>(star->info.channels);
  model.parameters =
      static_cast<double>(star->mean.size() + star->coefficients.size()) + channels * (channels + 1) / 2;
  model.draw = [star, seed = session.common.seed]() -> ComparedModel::Frames {
    return [star, synthesis = std::make_shared<dytex::StarSynthesis>(*star, seed)](int count) {
      std::vector<cv::Mat> frames;
      for (int i = 0; i < count; ++i) frames.push_back(synthesis->next());
      return frames;
    };
  };
  model.foretell = [star](const Moment& moment, int steps) {
    return dytex::predict(*star, moment.past, steps).back();
  };
  return model;
}

std::vector<ComparedModel> learn_models(const ModelInput& input, const KnownModels& known) {
  std::vector<ComparedModel> models;
  const auto add = [&](std::optional<ComparedModel> model) {
    if (model) models.push_back(std::move(*model));
  };
  add(sketch_model(input, known));
  add(texture_model(input, known, input.options.learn.components));
  add(star_model(input, dytex::StarOptions{}.reach));
  return models;
}

double parameter_count(const mcmc::MotionModel& model) {
  // Place, direction, width, blur, contrast, three levels of three channels; type. An edge: its two ends.
  constexpr double kPatch = 16, kEdge = 2, kScalars = 6 + 6 + 16 + 8;
  const auto numbers = [](const graph::AttributeGraph& graph) {
    return kPatch * static_cast<double>(graph.size()) + kEdge * static_cast<double>(graph.edges().size());
  };
  double sum = kScalars + numbers(model.first) + 2.0 * mcmc::kSizes;
  for (const auto& exemplar : model.exemplars) sum += numbers(exemplar.graph) + 3;
  for (const auto* map : {&model.sway_share, &model.drift_x, &model.drift_y, &model.rates.birth,
                          &model.rates.death, &model.rates.parting, &model.density})
    sum += static_cast<double>(map->values.size());
  return sum;
}

}  // namespace emberfold::apps
