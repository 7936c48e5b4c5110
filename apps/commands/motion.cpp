// SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <iomanip>
#include <memory>
#include <sstream>
#include <string>
#include <utility>

#include <nlohmann/json.hpp>

#include "apps/cli/command_line.hpp"
#include "apps/cli/summary.hpp"
#include "apps/report/report_model.hpp"
#include "core/io/model_folder.hpp"
#include "pipeline/clip_model.hpp"
#include "pipeline/parameter_count.hpp"

namespace emberfold::apps {

namespace {

using Json = nlohmann::ordered_json;

struct MotionInfo {
  std::string model;
};

pipeline::ClipModel read_whole_model(const std::string& folder) {
  const auto archive = io::read_model(folder, io::kMotionFormat);
  try {
    return pipeline::clip_model(archive);
  } catch (const core::IoError& error) {
    throw core::IoError(folder + ": " + error.what());
  }
}

Json model_json(const pipeline::ClipModel& model) {
  const auto& motion = model.motion;
  Json methods = {"diffusion"};
  if (model.footage)
    for (const char* of_frames : {"footage", "texture"}) methods.push_back(of_frames);
  if (model.footage && !model.footage->strokes.sketch.frames.empty())
    for (const char* own : {"edit", "strokes"}) methods.push_back(own);
  Json out = {{"width", motion.width},
              {"height", motion.height},
              {"fps", motion.fps},
              {"learned_from_frames", motion.frames},
              {"parameters", pipeline::parameter_count(motion)},
              {"methods", std::move(methods)}};
  out.update(motion_model_figures(motion));
  return out;
}

std::string model_table(const Json& model) {
  std::ostringstream out;
  const auto row = [&](const char* name) -> std::ostringstream& {
    out << "\n  " << std::left << std::setw(22) << name << std::right;
    return out;
  };
  const auto words = [](const Json& list) {
    std::string text;
    for (const auto& one : list) text += (text.empty() ? "" : ", ") + one.get<std::string>();
    return text;
  };
  out << "motion model";
  row("frames") << model["width"] << " x " << model["height"] << ", " << model["fps"] << " a second";
  row("learned from") << model["learned_from_frames"] << " frames";
  row("parameters") << std::int64_t(model["parameters"].get<double>()) << ", of the strokes";
  row("drawn as") << words(model["methods"]);
  row("strokes") << model["first_strokes"] << " in the first frame, " << model["exemplars"]
                 << " that can be born";
  const auto& rates = model["rates"];
  row("births") << rates["birth_per_frame"] << " a frame";
  row("splits, merges") << rates["split"] << " a patch, " << rates["merge"] << " a pair of ends";
  row("connects, disconnects") << rates["connect"] << " a pair of strokes, " << rates["disconnect"]
                               << " an arm";
  row("sway") << "SD " << model["sway"]["deviation"] << " px, largest growth " << model["sway"]["radius"];
  row("largest drift") << model["largest_drift"] << " px a frame";
  out << '\n';
  return out.str();
}

void run_motion_info(const MotionInfo& asked, const Session& session) {
  const Json model = model_json(read_whole_model(asked.model));
  session.print(session.common.json ? json_text(model) : model_table(model));
}

void add_info(CLI::App& motion, CommandLine& line) {
  auto* command = add_command(motion, "info", "Print the figures of a motion model", R"(
  emberfold motion info out/fire/model
  emberfold motion info out/fire/model --json | jq .parameters)");
  const auto asked = std::make_shared<MotionInfo>();
  command->add_option("MODEL", asked->model, "Read the model from this folder, DIR/model of analyze")
      ->required()
      ->type_name("");
  finish_command(*command, line, asked, run_motion_info);
}

}  // namespace

void add_motion(CLI::App& app, CommandLine& line) {
  auto* command =
      add_command(app, "motion", "Describe motion models, judge clips by them, and morph graphs", R"(
  emberfold motion info out/fire/model
  emberfold motion likelihood out/fire/model out/fire
  emberfold motion morph a.png b.png -o out/morph)");
  command->require_subcommand(0, 1);
  add_info(*command, line);
  add_motion_likelihood(*command, line);
  add_morph(*command, line);
}

}  // namespace emberfold::apps
