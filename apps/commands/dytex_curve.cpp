// SPDX-License-Identifier: Apache-2.0
#include <iomanip>
#include <memory>
#include <sstream>

#include <nlohmann/json.hpp>

#include "apps/builtin/open_clip.hpp"
#include "apps/cli/interrupt.hpp"
#include "apps/cli/summary.hpp"
#include "apps/commands/dytex.hpp"
#include "apps/pictures/png.hpp"
#include "apps/textures/texture_forecast.hpp"

namespace emberfold::apps {

namespace {

using Json = nlohmann::ordered_json;

struct Curving {
  Reading reading;
  std::string output;
  dytex::CurveOptions options;
};

const std::vector<std::string> kFields{"components", "lengths", "targets", "longest", "tolerance"};

std::string with_option_names(std::string message) {
  for (const auto& field : kFields) message = with_option_name(message, field);
  return message;
}

void run_curve(const Curving& asked, Session& session) {
  const io::ReadOptions read = check_reading(asked.reading, session);
  try {
    asked.options.validate();
  } catch (const core::InputError& error) {
    throw Misuse(with_option_names(without_struct_name(error.what())));
  }
  require_apart({asked.reading.clip, asked.reading.options.mask}, asked.output, {"curve.png"},
                session.common);
  io::OutputFolder output(asked.output, session.common.existing());
  output.protect({asked.reading.clip});
  Stages stages;
  stages.begin("curve");
  const auto source = open_held_clip(asked.reading.clip, read, session);
  dytex::LearningCurve curve;
  try {
    curve = dytex::learning_curve(*source, asked.options, session.context);
  } catch (const core::InputError& error) {
    throw Misuse(asked.reading.clip + ": " + with_option_names(error.what()));
  }
  write_png(output, "curve.png", draw_learning_curve(curve, asked.options.components));
  stages.end();
  Json summary = begin_summary("dytex curve", session);
  summary["clip"] = clip_json(asked.reading.clip, source->info(), curve.targets.back() + 1);
  summary["options"] = {{"reading", reading_json(read)},    {"components", asked.options.components},
                        {"lengths", asked.options.lengths}, {"targets", asked.options.targets},
                        {"longest", asked.options.longest}, {"tolerance", asked.options.tolerance}};
  summary["curve"] = learning_curve_json(curve);
  summary["files"] = {{"curve.png", "the error of the next frame against the frames learned from"},
                      {"summary.json", "all figures"}};
  end_summary(summary, session, stages);
  write_summary(output, summary);
  session.check_stop();
  output.commit();
  std::ostringstream said;
  if (curve.critical)
    said << "critical length " << *curve.critical << " frames";
  else
    said << "the error has not come to rest: the clip is too short to tell";
  said << std::setprecision(3) << "; the next frame is predicted to " << curve.plateau << " levels at length";
  session.console.say(said.str());
  if (session.common.json) session.print(json_text(summary));
}

}  // namespace

void add_dytex_curve(CLI::App& dytex, CommandLine& line) {
  auto* command = add_command(
      dytex, "curve", "Measure how many frames must be learned: the error of the next frame against them", R"(
  emberfold dytex curve flag.avi -o out/curve
  emberfold dytex curve flag.avi -o out/curve -n 10 --lengths 60 --targets 20)");
  const auto asked = std::make_shared<Curving>();
  auto& options = asked->options;
  add_reading(*command, asked->reading);
  add_output(*command, asked->output);
  add_number(*command, "-n,--components", options.components, "N", "Learn this many components");
  add_number(*command, "--lengths", options.lengths, "N", "Try this many lengths");
  add_number(*command, "--targets", options.targets, "N",
             "Predict this many frames for each, in the last quarter");
  add_number(*command, "--longest", options.longest, "FRAMES", "Try no longer windows than this");
  add_number(*command, "--tolerance", options.tolerance, "SHARE",
             "Call a length critical if the error stays within this share of the last");
  finish_command(*command, line, asked, run_curve);
}

}  // namespace emberfold::apps
