// SPDX-License-Identifier: Apache-2.0
#include "apps/cli/edit_options.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include <nlohmann/json.hpp>

#include "apps/cli/command_line.hpp"
#include "apps/cli/interrupt.hpp"
#include "core/io/mask_file.hpp"
#include "pipeline/edit_model.hpp"

namespace emberfold::apps {

namespace {

constexpr const char* kSynthGroup = "synth";
constexpr std::array<const char*, 6> kRates = {"births", "deaths",   "splits",
                                               "merges", "connects", "disconnects"};

graph::Point parse_wind(const std::string& text) {
  const auto comma = text.find(',');
  graph::Point wind;
  try {
    if (comma == std::string::npos) throw Misuse("");
    parse_number("--wind", text.substr(0, comma), wind.x);
    parse_number("--wind", text.substr(comma + 1), wind.y);
  } catch (const Misuse&) {
    throw Misuse("--wind is " + one_line(text) + "; give X,Y in px a frame, each -8 to 8");
  }
  return wind;
}

void add_looks(CLI::App& app, EditOptions& options) {
  auto& edit = options.edit;
  add_number(app, "--intensity", edit.intensity, "X",
             "Scale the force on strokes, 0 to 10; --wind X,Y adds a drift, px a frame");
  add_number(app, "--flicker", edit.flicker, "X",
             "Scale changes of contrast, 0 to 10; --contrast X the contrast, 0.1 to 10");
  // Described with the options above, so that the help fits on one screen.
  add_number(app, "--contrast", edit.contrast, "X", "Scale the strokes' contrast, 0.1 to 10")->group("");
  app.add_option("--wind", options.wind, "Let strokes drift so many px a frame, too, each -8 to 8")
      ->type_name("X,Y")
      ->group("");
  app.add_option("--birth-map", options.birth_map,
                 "Bear strokes where this is white; --strokes coarse or fine keeps a half")
      ->type_name("FILE");
  app.add_option("--strokes", options.strokes,
                 "Keep all strokes, or the wider (coarse) or narrower (fine) half")
      ->type_name("WHICH")
      ->check(CLI::IsMember({"all", "coarse", "fine"}).description(""))
      ->default_str(options.strokes)
      ->group("");
}

}  // namespace

void add_edit_options(CLI::App& app, EditOptions& options, Settings& settings) {
  auto& edit = options.edit;
  add_number(app, "--speed", edit.speed, "X",
             "Move X times as fast, 0.1 to 10; --reverse runs time backwards");
  app.add_flag("--reverse", edit.reverse, "Run time backwards")->group("");
  add_looks(app, options);
  for (std::size_t i = 0; i < kRates.size(); ++i)
    settings.add(kSynthGroup, kRates[i], &edit.rates[i], "X",
                 std::string("Multiply the rate of ") + kRates[i], "0 to 10");
}

void check(EditOptions& options) {
  using mcmc::StrokeChoice;
  auto& edit = options.edit;
  edit.strokes = options.strokes == "coarse" ? StrokeChoice::coarse
                 : options.strokes == "fine" ? StrokeChoice::fine
                                             : StrokeChoice::all;
  if (!options.wind.empty()) edit.wind = parse_wind(options.wind);
  try {
    edit.validate();
  } catch (const core::InputError& error) {
    const std::string message = without_struct_name(error.what());
    if (std::ranges::any_of(kRates, [&](const char* rate) { return message.starts_with(rate); }))
      misuse(message, {kRates.begin(), kRates.end()}, kSynthGroup);
    misuse(message, {"speed", "intensity", "flicker", "contrast", "wind"}, "");
  }
}

mcmc::MotionEdit read_edit(const EditOptions& options, const mcmc::MotionModel& model) {
  mcmc::MotionEdit edit = options.edit;
  if (!options.birth_map.empty()) {
    try {
      edit.birth_map = pipeline::birth_map(io::read_mask(options.birth_map), model);
    } catch (const core::InputError&) {
      throw Misuse("--birth-map " + options.birth_map + " is black: nothing would be born");
    }
  }
  return edit;
}

pipeline::ClipModel apply_edits(pipeline::ClipModel model, const EditOptions& options, Session& session) {
  const auto edit = read_edit(options, model.motion);
  auto edited = pipeline::edit_model(std::move(model), edit, session.common.seed, session.context);
  for (const auto& note : edited.notes) session.warn(note);
  return std::move(edited.model);
}

std::string stroke_option(const EditOptions& options) {
  const auto& edit = options.edit;
  if (edit.intensity != 1) return "--intensity";
  if (edit.flicker != 1) return "--flicker";
  if (edit.contrast != 1) return "--contrast";
  if (edit.wind != graph::Point{}) return "--wind";
  if (!options.birth_map.empty()) return "--birth-map";
  if (options.strokes != "all") return "--strokes";
  if (std::ranges::any_of(edit.rates, [](double rate) { return rate != 1; })) return "--set synth";
  return {};
}

bool changes(const EditOptions& options) {
  return options.edit != mcmc::MotionEdit{} || !options.birth_map.empty();
}

nlohmann::ordered_json edit_json(const EditOptions& options) {
  const auto& edit = options.edit;
  nlohmann::ordered_json json = {{"speed", edit.speed},         {"reverse", edit.reverse},
                                 {"intensity", edit.intensity}, {"flicker", edit.flicker},
                                 {"contrast", edit.contrast},   {"wind", {edit.wind.x, edit.wind.y}},
                                 {"strokes", options.strokes}};
  for (std::size_t i = 0; i < kRates.size(); ++i) json[kRates[i]] = edit.rates[i];
  json["birth_map"] =
      options.birth_map.empty() ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(options.birth_map);
  return json;
}

}  // namespace emberfold::apps
