// SPDX-License-Identifier: Apache-2.0
#include "pipeline/rate_correction.hpp"

#include <utility>

#include <nlohmann/json.hpp>

#include "core/error.hpp"
#include "core/text/json_reader.hpp"
#include "pipeline/calibration.hpp"
#include "pipeline/clip_model.hpp"
#include "pipeline/frame_synthesis.hpp"
#include "sketch/rendering/sharpening.hpp"

namespace emberfold::sketch {
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE_WITH_DEFAULT(ExtractOptions, sensitivity, finest_scale, scales,
                                                min_contrast, min_length, spacing, edges, outlines,
                                                boundaries, colour, budget, tile)
}  // namespace emberfold::sketch

namespace emberfold::graph {
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE_WITH_DEFAULT(MatchOptions, max_motion, flicker)
}  // namespace emberfold::graph

namespace emberfold::mcmc {
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(EventStatistics, strokes, events, patches)
}  // namespace emberfold::mcmc

namespace emberfold::pipeline {

namespace {

constexpr const char* kName = "correction";

}  // namespace

void add_rate_correction(core::ModelArchive& archive, const RateCorrection& correction) {
  auto text = nlohmann::ordered_json::parse(archive.text);
  nlohmann::json made = {{"rounds", correction.rounds}, {"seed", correction.seed},
                         {"source", correction.source}, {"observed", correction.observed},
                         {"sketch", correction.sketch}, {"match", correction.match}};
  text[kName] = std::move(made);
  archive.text = text.dump(1) + "\n";
}

std::optional<RateCorrection> read_rate_correction(const core::ModelArchive& archive) {
  const auto text = core::parse_json(archive.text);
  const auto found = text.find(kName);
  if (found == text.end()) return std::nullopt;
  try {
    RateCorrection correction{found->at("rounds"),   found->at("seed"),   found->at("source"),
                              found->at("observed"), found->at("sketch"), found->at("match")};
    CalibrateOptions{correction.rounds}.validate();
    correction.sketch.validate(), correction.match.validate();
    return correction;
  } catch (const nlohmann::json::exception&) {
    throw core::IoError("motion model: \"correction\" in model.json lacks numbers");
  } catch (const core::InputError& error) {
    throw core::IoError("motion model: \"correction\" in model.json: " + std::string(error.what()));
  }
}

std::vector<mcmc::EventStatistics> correct_rates(ClipModel& model, const core::Context& context) {
  if (!model.correction) return {};
  const RateCorrection& task = *model.correction;
  const auto look =
      sketch::apply_sharpening(render_options(model.motion, model.background), model.sharpening);
  mcmc::FitResult fitted;
  fitted.model = model.motion, fitted.observed = task.observed;
  auto seen =
      calibrate(fitted, task.source, {task.sketch, task.match, look}, {task.rounds}, task.seed, context);
  model.motion = std::move(fitted.model);
  model.correction.reset();
  return seen;
}

}  // namespace emberfold::pipeline
