// SPDX-License-Identifier: Apache-2.0
#include "apps/cli/edit_options.hpp"

#include <algorithm>
#include <array>

#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "apps/cli/command_line.hpp"
#include "apps/cli/interrupt.hpp"
#include "core/io/mask_file.hpp"

namespace emberfold::apps {

namespace {

constexpr const char* kSynthGroup = "synth";
constexpr std::array<const char*, 6> kRates = {"births", "deaths",   "splits",
                                               "merges", "connects", "disconnects"};

/// Returns the mean brightness of the picture, fitted to the frame, in each cell of the model's grid.
mcmc::CellMap read_birth_map(const std::string& path, const mcmc::MotionModel& model) {
  cv::Mat picture = io::read_mask(path), fitted;
  picture.convertTo(picture, CV_32F);
  cv::resize(picture, fitted, {model.width, model.height}, 0, 0,
             picture.cols > model.width ? cv::INTER_AREA : cv::INTER_LINEAR);
  mcmc::CellMap map = model.rates.birth;
  std::vector<double> counts(map.values.size());
  std::ranges::fill(map.values, 0.0);
  for (int y = 0; y < model.height; ++y)
    for (int x = 0; x < model.width; ++x) {
      const auto cell = map.index({double(x), double(y)});
      map.values[cell] += double{fitted.at<float>(y, x)};
      ++counts[cell];
    }
  double sum = 0;
  for (std::size_t c = 0; c < counts.size(); ++c) sum += map.values[c] /= std::max(1.0, counts[c]);
  if (!(sum > 0)) throw Misuse("--birth-map " + path + " is black: nothing would be born");
  return map;
}

}  // namespace

void add_edit_options(CLI::App& app, Settings& settings, EditOptions& options) {
  auto& edit = options.edit;
  app.add_option("--start", options.start_name,
                 "Begin as in the clip (data) or as the model usually is (stationary)")
      ->type_name("KIND")
      ->check(CLI::IsMember({"data", "stationary"}).description(""))
      ->default_str(options.start_name);
  add_number(app, "--speed", edit.speed, "X", "Move X times as fast, 0.1 to 10");
  app.add_flag("--reverse", edit.reverse, "Run time backwards");
  add_number(app, "--intensity", edit.intensity, "X", "Scale the force that displaces strokes, 0 to 10");
  add_number(app, "--flicker", edit.flicker, "X", "Scale the changes of contrast, 0 to 10");
  app.add_option("--birth-map", options.birth_map, "Let strokes be born where this picture is white")
      ->type_name("FILE");
  app.add_option("--strokes", options.strokes,
                 "Keep all strokes, or the wider (coarse) or narrower (fine) half")
      ->type_name("WHICH")
      ->check(CLI::IsMember({"all", "coarse", "fine"}).description(""))
      ->default_str(options.strokes);
  for (std::size_t i = 0; i < kRates.size(); ++i)
    settings.add(kSynthGroup, kRates[i], edit.rates[i], "X", std::string("Multiply the rate of ") + kRates[i],
                 [] { return "0 to 10"; });
}

void check(EditOptions& options) {
  using mcmc::StrokeChoice;
  auto& edit = options.edit;
  edit.strokes = options.strokes == "coarse" ? StrokeChoice::coarse
                 : options.strokes == "fine" ? StrokeChoice::fine
                                             : StrokeChoice::all;
  try {
    edit.validate();
  } catch (const core::InputError& error) {
    std::string message = without_struct_name(error.what());
    for (const std::string field : {"speed", "intensity", "flicker"})
      message = with_option_name(message, field);
    for (const std::string field : kRates)
      if (message.starts_with(field)) message = std::string(kSynthGroup) + "." + message;
    throw Misuse(message);
  }
}

mcmc::MotionModel apply_edits(mcmc::MotionModel model, const EditOptions& options, Session& session) {
  mcmc::MotionEdit edit = options.edit;
  if (!options.birth_map.empty()) edit.birth_map = read_birth_map(options.birth_map, model);
  auto result = mcmc::edit_motion(model, edit, session.common.seed, session.context);
  for (const auto& note : result.notes) session.warn(note);
  return std::move(result.model);
}

nlohmann::ordered_json edit_json(const EditOptions& options) {
  const auto& edit = options.edit;
  nlohmann::ordered_json json = {{"start", options.start_name}, {"speed", edit.speed},
                                 {"reverse", edit.reverse},     {"intensity", edit.intensity},
                                 {"flicker", edit.flicker},     {"strokes", options.strokes}};
  for (std::size_t i = 0; i < kRates.size(); ++i) json[kRates[i]] = edit.rates[i];
  json["birth_map"] =
      options.birth_map.empty() ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(options.birth_map);
  return json;
}

}  // namespace emberfold::apps
