// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <sstream>

#include <nlohmann/json.hpp>

#include "apps/builtin/open_clip.hpp"
#include "apps/cli/interrupt.hpp"
#include "apps/cli/summary.hpp"
#include "apps/commands/dytex.hpp"
#include "apps/textures/texture_forecast.hpp"
#include "core/clip/clip_range.hpp"

namespace emberfold::apps {

namespace {

using Json = nlohmann::ordered_json;

struct Forecasting {
  std::string model, output;
  Reading reading;  // the clip is optional
  int steps = 25, after = 0;
  bool asked_after = false;
};

/// State of the model before the forecast begins.
struct Known {
  dytex::StateGuess state;
  std::int64_t frames = 0;  // of the clip that were filtered; 0: the model's own final state
  double log_likelihood = 0;
};

Known filter_clip(const Forecasting& asked, const dytex::LinearDynamicTexture& texture,
                  core::FrameSource& source, Session& session) {
  const auto told = source.info().frames;
  if (asked.asked_after && told && asked.after > *told)
    throw Misuse("--after is " + std::to_string(asked.after) + "; " + asked.reading.clip + " has " +
                 std::to_string(*told) + " frames, so allowed is 1 to " + std::to_string(*told));
  std::unique_ptr<core::ClipRange> part;
  if (asked.asked_after) part = std::make_unique<core::ClipRange>(source, 0, asked.after);
  core::FrameSource& seen = part ? *part : source;
  try {
    const auto observations = dytex::observe(texture, seen, {}, session.context);
    session.check_stop();
    const auto filtered = dytex::filter(dytex::state_space(texture), observations);
    return {dytex::last_state(filtered), observations.frames(), filtered.log_likelihood};
  } catch (const core::InputError& error) {
    throw core::InputError(asked.reading.clip + ": " + error.what());
  }
}

std::string described(const dytex::Forecast& forecast, const ForecastErrors& errors) {
  std::ostringstream said;
  said.precision(4);
  const auto last = forecast.error.size() - 1;
  said << "expected error " << forecast.error[0] << " levels one frame ahead, " << forecast.error[last] << " "
       << last + 1 << " ahead";
  if (!errors.forecast.empty())
    said << "; found " << errors.forecast.front() << " and, " << errors.forecast.size() << " ahead, "
         << errors.forecast.back();
  return said.str();
}

void run_forecast(const Forecasting& asked, Session& session) {
  if (asked.steps < 1 || asked.steps > 10000)
    throw Misuse("--steps is " + std::to_string(asked.steps) + "; allowed is 1 to 10000");
  if (asked.asked_after && asked.after < 1)
    throw Misuse("--after is " + std::to_string(asked.after) + "; must be at least 1");
  if (asked.asked_after && asked.reading.clip.empty())
    throw Misuse("--after is the number of frames of CLIP; there is no CLIP");
  const io::ReadOptions read = check_reading(asked.reading, session);
  const std::vector<std::string> inputs{asked.model, asked.reading.clip, asked.reading.options.mask};
  require_apart(inputs, asked.output, {"forecast.avi", "forecast.png", "deviation.png"}, session.common);
  io::OutputFolder output(asked.output, session.common.existing());
  output.protect(inputs);
  Stages stages;
  stages.begin("read");
  const auto texture = read_texture(asked.model);
  stages.begin("filter");
  std::unique_ptr<core::FrameSource> source;
  Known known;
  if (asked.reading.clip.empty()) {
    known.state = dytex::last_training_state(texture);
  } else {
    source = open_held_clip(asked.reading.clip, read, session);
    known = filter_clip(asked, texture, *source, session);
  }
  stages.begin("forecast");
  const auto forecast = dytex::forecast(texture, known.state, asked.steps);
  ForecastErrors errors;
  if (asked.asked_after) errors = forecast_errors(*source, known.frames, texture, forecast, session.context);
  stages.begin("write");
  const double white = write_forecast(output, texture, forecast, errors, session.context);
  stages.end();
  Json summary = begin_summary("dytex forecast", session);
  summary["model"] = asked.model;
  summary["clip"] =
      source ? clip_json(asked.reading.clip, source->info(), static_cast<int>(known.frames)) : Json(nullptr);
  summary["options"] = {{"steps", asked.steps},
                        {"after", asked.asked_after ? Json(asked.after) : Json(nullptr)},
                        {"reading", reading_json(read)}};
  summary["from"] =
      source ? "filtered state at the end of the frames read" : "last state of the training frames";
  if (source) summary["log_likelihood"] = known.log_likelihood;
  summary["deviation_white"] = white;
  summary["steps"] = forecast_json(forecast, errors);
  summary["files"] = {
      {"forecast.avi", "the frames that are expected"},
      {"deviation.png", "how far each value of the last one may miss (SD), white: deviation_white levels"},
      {"forecast.png", "errors against the step"},
      {"summary.json", "all figures"}};
  end_summary(summary, session, stages);
  write_summary(output, summary);
  session.check_stop();
  output.commit();
  session.console.say(described(forecast, errors));
  if (session.common.json) session.print(json_text(summary));
}

}  // namespace

void add_dytex_forecast(CLI::App& dytex, CommandLine& line) {
  auto* command =
      add_command(dytex, "forecast", "Predict the frames that follow a clip, and their errors", R"(
  emberfold dytex forecast out/flag -o out/next
  emberfold dytex forecast out/flag flag.avi -o out/next --steps 50
  emberfold dytex forecast out/flag flag.avi -o out/next --after 200 --steps 40)");
  const auto asked = std::make_shared<Forecasting>();
  add_texture_model(*command, asked->model);
  add_reading(*command, asked->reading);
  command->get_option("CLIP")->required(false);
  add_output(*command, asked->output);
  add_number(*command, "--steps", asked->steps, "N", "Predict this many frames");
  auto* after = add_number(*command, "--after", asked->after, "N",
                           "Use the first N frames of CLIP, and compare with those after them");
  after->default_str("");
  finish_command(*command, line, asked, run_forecast,
                 [asked, after] { asked->asked_after = after->count() > 0; });
}

}  // namespace emberfold::apps
