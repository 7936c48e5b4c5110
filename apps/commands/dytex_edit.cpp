// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <memory>
#include <sstream>

#include <nlohmann/json.hpp>

#include "apps/cli/summary.hpp"
#include "apps/commands/dytex.hpp"
#include "apps/textures/texture_edits.hpp"
#include "apps/textures/texture_modes.hpp"
#include "core/io/model_folder.hpp"
#include "core/io/require_apart.hpp"
#include "dytex/editing/edit.hpp"
#include "dytex/model/archive.hpp"

namespace emberfold::apps {

namespace {

using Json = nlohmann::ordered_json;

/// The edits that the command line gives, one by one.
struct Editing {
  std::string model, output;
  std::vector<dytex::Edit> edits;
  bool keep_contrast = true;  // by later edits
  std::string weights_file;   // of --weights, which may be numbers too

  template <class What>
  void add(const What& what) {
    edits.push_back({what, keep_contrast});
  }
  void add_preset(const std::string& name) {
    for (const dytex::Edit& edit : dytex::preset(name)) edits.push_back(edit);
  }
};

/// Rewrites "speed is 4, allowed …", which names a field, with the option's name.
Misuse option_misuse(const std::string& message) {
  constexpr std::array kOptions{"speed",  "flow", "intensity", "directions", "coarse",
                                "medium", "fine", "weights",   "preset"};
  for (const char* option : kOptions)
    if (message.starts_with(option)) return Misuse("--" + message);
  return Misuse(message);
}

dytex::EditResult apply_edits(const Editing& asked, dytex::LinearDynamicTexture texture) {
  try {
    return dytex::edit(std::move(texture), asked.edits);
  } catch (const core::InputError& error) {
    throw option_misuse(error.what());
  }
}

void check_edits(const Editing& asked) {
  if (asked.edits.empty())
    throw Misuse("nothing to edit: give --speed, --intensity, --preset or others, see --help");
  try {
    for (const dytex::Edit& edit : asked.edits) dytex::validate(edit);
  } catch (const core::InputError& error) {
    throw option_misuse(error.what());
  }
}

/// Returns the SD of the model's output, levels: √(tr W P W / m).
double amplitude(const dytex::LinearDynamicTexture& texture) {
  if (texture.components() == 0) return 0;
  const Eigen::VectorXd variances = dytex::stationary_covariance(texture.A, texture.B).diagonal();
  return std::sqrt(texture.weights.cwiseAbs2().dot(variances.head(texture.components())) /
                   static_cast<double>(texture.pixels()));
}

Json edit_summary(const Editing& asked, const std::vector<std::string>& history, double before,
                  const dytex::EditResult& result, const Session& session) {
  Json summary = begin_summary("dytex edit", session);
  summary["model"] = asked.model;
  summary["edits"] = history;
  summary["dropped_poles"] = result.dropped;
  summary["amplitude"] = {{"before", before}, {"after", amplitude(result.texture)}};
  summary["texture"] = texture_json(result.texture);
  summary["files"] = {{"model.json", "what the model is, and its edits"}, {"summary.json", "all figures"}};
  return summary;
}

void run_edit(const Editing& asked, Session& session) {
  check_edits(asked);
  io::require_apart({asked.model, asked.weights_file}, {{asked.output}});
  io::ModelFolder folder(asked.output);
  Stages stages;
  stages.begin("read");
  auto [texture, history] = read_texture_and_edits(asked.model);
  stages.begin("edit");
  const double before = amplitude(texture);
  const dytex::EditResult result = apply_edits(asked, std::move(texture));
  for (const std::string& note : result.notes) session.warn(note);
  history.push_back(edit_words(asked.edits));
  stages.begin("write");
  core::ModelView view = dytex::archive_view(result.texture);
  view.text = with_edit_history(view.text, history);
  io::write_model(folder.output(), "", view);
  stages.end();
  Json summary = edit_summary(asked, history, before, result, session);
  end_summary(summary, session, stages);
  write_summary(folder.output(), summary);
  session.check_stop();
  folder.commit();
  std::ostringstream said;
  said.precision(3);
  said << "edited: " << history.back() << "; amplitude " << before << " to " << amplitude(result.texture)
       << " levels; the model is " << asked.output;
  session.console.say(said.str());
  if (session.common.json) session.print(json_text(summary));
}

/// Adds an option that appends an edit each time it is given.
template <class Take>
void add_edit(CLI::App& command, const std::string& name, const std::string& unit, const std::string& about,
              const std::string& group, const Take& take) {
  command.add_option_function<std::string>(name, take, about)
      ->trigger_on_parse()
      ->type_name(unit)
      ->group(group);
}

template <class Make>
void add_factor(CLI::App& command, const std::shared_ptr<Editing>& asked, const std::string& name,
                const std::string& about, const std::string& group, const Make& make) {
  add_edit(command, name, "X", about, group, [asked, name, make](const std::string& text) {
    double value = 0;
    parse_number(name, text, value);
    asked->add(make(value));
  });
}

void add_motion_options(CLI::App& command, const std::shared_ptr<Editing>& asked) {
  const std::string group = "Motion";
  add_factor(command, asked, "--speed", "Multiply the poles' phases, -3 to 3; lifetimes stay", group,
             [](double x) { return dytex::Speed{x}; });
  add_factor(command, asked, "--flow", "Multiply the speed of time, 0.01 to 100: A to this power; 0: at rest",
             group, [](double x) { return dytex::Flow{x}; });
  command
      .add_flag_function(
          "--reverse", [asked](std::int64_t) { asked->add(dytex::Reverse{}); }, "Run time backwards")
      ->trigger_on_parse()
      ->group(group);
}

void add_strength_options(CLI::App& command, const std::shared_ptr<Editing>& asked) {
  const std::string group = "Strength";
  add_factor(command, asked, "--intensity", "Multiply the variance of noise and motion, 0 to 3", group,
             [](double x) { return dytex::Intensity{x}; });
  add_edit(command, "--directions", "X,X,...", "Multiply each eigenvalue of the noise, the largest first",
           group, [asked](const std::string& text) { asked->add(dytex::Directions{parse_numbers(text)}); });
  add_factor(command, asked, "--coarse", "Multiply components 1 to 5, 0 to 10", group, [](double x) {
    return dytex::Scales{x, 1, 1};
  });
  add_factor(command, asked, "--medium", "Multiply components 6 to 15", group, [](double x) {
    return dytex::Scales{1, x, 1};
  });
  add_factor(command, asked, "--fine", "Multiply components from 16 on", group, [](double x) {
    return dytex::Scales{1, 1, x};
  });
  add_edit(command, "--weights", "X,X,...|FILE", "Multiply each component by its number", group,
           [asked](const std::string& text) {
             asked->weights_file = text;
             asked->add(dytex::Weights{parse_numbers(text)});
           });
  const std::string about = "Apply a preset: hazy, rough-sea, fire-slow ...; '--preset list' names all";
  add_edit(command, "--preset", "NAME", about, group, [asked](const std::string& name) {
    try {
      asked->add_preset(name);
    } catch (const core::InputError& error) {
      throw option_misuse(error.what());
    }
  });
}

void add_manner_options(CLI::App& command, const std::shared_ptr<Editing>& asked) {
  const std::string group = "For the edits after it";
  for (const bool keep : {false, true})
    command
        .add_flag_function(
            keep ? "--contrast" : "--no-contrast",
            [asked, keep](std::int64_t) { asked->keep_contrast = keep; },
            keep ? "Let the edits after it keep the contrast again"
                 : "Let speed and flow after it keep the noise, not the contrast")
        ->trigger_on_parse()
        ->group(group);
}

}  // namespace

void add_dytex_edit(CLI::App& dytex, CommandLine& line) {
  auto* command = add_command(
      dytex, "edit", "Change how a linear dynamic texture moves; edits are applied in their order", R"(
  emberfold dytex edit out/flag -o out/slow --speed 0.5
  emberfold dytex edit out/sea -o out/storm --preset rough-sea --flow 1.5
  emberfold dytex edit out/fire -o out/odd --reverse --coarse 0.5 --fine 2 --intensity 1.5)");
  const auto asked = std::make_shared<Editing>();
  add_texture_model(*command, asked->model);
  command->add_option("-o,--output", asked->output, "Write the edited model into this folder")
      ->type_name("MODEL2")
      ->required();
  add_motion_options(*command, asked);
  add_strength_options(*command, asked);
  add_manner_options(*command, asked);
  finish_command(*command, line, asked, run_edit);
}

}  // namespace emberfold::apps
