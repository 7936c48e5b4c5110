// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <memory>
#include <sstream>
#include <string>

#include <nlohmann/json.hpp>

#include "apps/builtin/open_clip.hpp"
#include "apps/cli/command_line.hpp"
#include "apps/cli/interrupt.hpp"
#include "apps/cli/summary.hpp"
#include "apps/commands/dytex.hpp"
#include "apps/commands/dytex_em.hpp"
#include "apps/pictures/png.hpp"
#include "apps/textures/texture_modes.hpp"
#include "apps/textures/texture_picture.hpp"
#include "core/clip.hpp"
#include "core/io/mask_file.hpp"
#include "core/io/model_folder.hpp"
#include "core/io/require_apart.hpp"
#include "core/io/staged_output.hpp"
#include "dytex/learn.hpp"
#include "dytex/learning/learn_by_blocks.hpp"
#include "dytex/model/archive.hpp"
#include "dytex/model/layers.hpp"

namespace emberfold::apps {

namespace {

using Json = nlohmann::ordered_json;

/// Request of `dytex learn`.
struct TextureLearning {
  Reading reading;
  std::string output, mask;
  dytex::LearnOptions options;
  bool asked_components = false, asked_energy = false, asked_order = false;
  double energy = 0.95;
  EmRequest em;
  int block = 0;  ///< frames decomposed at a time; 0: all, or a size that suits a long clip
  std::string order, method = "closed-form";
};

// The words of an option and their values.
template <class Value>
using Words = std::vector<std::pair<std::string, Value>>;

const Words<dytex::Order> kOrders{{"auto", dytex::Order::held_out},
                                  {"gavish-donoho", dytex::Order::gavish_donoho},
                                  {"held-out", dytex::Order::held_out}};
const Words<dytex::Method> kMethods{{"closed-form", dytex::Method::closed_form},
                                    {"n4sid", dytex::Method::n4sid}};
template <class Value>
Value value_of(const Words<Value>& words, const std::string& word) {
  return std::ranges::find(words, word, &Words<Value>::value_type::first)->second;
}

/// Reduces the default number of components for a short clip. Throws IoError for a clip of one frame, Misuse
/// where more are requested than possible.
void fit_to_length(TextureLearning& asked, const core::ClipInfo& info, const Session& session) {
  if (!info.frames) return;
  const auto most = *info.frames - 1;
  if (most < 1)
    throw core::IoError(asked.reading.clip + " holds one frame; a dynamic texture needs at least two");
  if (asked.asked_energy || asked.asked_order || asked.options.components <= most) return;
  if (asked.asked_components)
    throw Misuse("--components is " + std::to_string(asked.options.components) + "; " + asked.reading.clip +
                 " has " + std::to_string(*info.frames) + " frames, so allowed is 1 to " +
                 std::to_string(most));
  asked.options.components = static_cast<int>(most);
  session.console.say(asked.reading.clip + " has " + std::to_string(*info.frames) +
                      " frames: " + std::to_string(most) + " components are learned");
}

const char* transition_name(dytex::Transition transition) {
  constexpr std::array<const char*, 3> kNames{"least_squares", "yule_walker", "n4sid"};
  return kNames[static_cast<std::size_t>(transition)];
}

Json learn_summary(const TextureLearning& asked, const io::ReadOptions& read, const core::ClipInfo& info,
                   const dytex::LearnResult& learned, const Session& session) {
  Json summary = begin_summary("dytex learn", session);
  const auto& texture = learned.texture;
  summary["clip"] = clip_json(asked.reading.clip, info, static_cast<int>(texture.states.cols()));
  Json options = {{"components", asked.options.components}};
  options["energy"] = asked.options.energy ? Json(*asked.options.energy) : Json(nullptr);
  options.update({{"order", asked.asked_order ? Json(asked.order) : Json(nullptr)},
                  {"method", asked.method},
                  {"noise_rank", asked.options.noise_rank},
                  {"block", asked.block}});
  options["mask"] = asked.mask.empty() ? Json(nullptr) : Json(asked.mask);
  summary["options"] = {{"reading", reading_json(read)}, {"learn", std::move(options)}};
  summary["texture"] = texture_json(texture);
  Json held_out = Json::array();
  for (const auto& [n, error] : learned.held_out) held_out.push_back({n, error});
  summary["learning"] = {{"transition", transition_name(learned.transition)},
                         {"least_squares_radius", learned.least_squares_radius},
                         {"held_out_errors", std::move(held_out)},
                         {"passes", learned.passes}};
  summary["files"] = {{"model.json", "what the model is"},
                      {"components.png", "its mean, first components and the courses of their states"},
                      {"summary.json", "all figures"}};
  return summary;
}

void check_options(const dytex::LearnOptions& options) {
  try {
    options.validate();
  } catch (const core::InputError& error) {
    auto message = without_struct_name(error.what());
    for (const char* field : {"components", "energy"}) message = with_option_name(message, field);
    if (message.starts_with("noise_rank")) message = "learn." + message;
    throw Misuse(message);
  }
}

bool is_by_blocks(const TextureLearning& asked, const core::ClipInfo& info) {
  return asked.block > 0 || dytex::needs_blocks(info);
}

dytex::LearnResult learn_frames(const TextureLearning& asked, core::FrameSource& source,
                                const core::Context& context) {
  if (!is_by_blocks(asked, source.info())) return dytex::learn(source, asked.options, context);
  return dytex::learn_by_blocks(source, asked.options, static_cast<std::size_t>(asked.block), context);
}

/// Learns only from the region inside the mask, if there is one.
dytex::LearnResult learn_region(const TextureLearning& asked, core::FrameSource& source,
                                const core::Context& context) {
  if (asked.mask.empty()) return learn_frames(asked, source, context);
  const cv::Mat mask = io::read_mask(asked.mask);
  std::unique_ptr<dytex::RegionSource> region;
  try {
    region = std::make_unique<dytex::RegionSource>(source, mask);
  } catch (const core::InputError& error) {
    throw Misuse("--mask: " + asked.mask + ": " + error.what());
  }
  auto learned = learn_frames(asked, *region, context);
  dytex::confine(learned.texture, mask);
  return learned;
}

dytex::LearnResult learn_texture(const TextureLearning& asked, core::FrameSource& source, Session& session) {
  try {
    return learn_region(asked, source, session.context);
  } catch (const Misuse&) {
    throw;
  } catch (const core::InputError& error) {
    throw Misuse(asked.reading.clip + ": " + with_option_name(error.what(), "components"));
  }
}

void take_words(TextureLearning& asked) {
  dytex::LearnOptions& options = asked.options;
  if (asked.asked_energy) options.energy = asked.energy;
  if (asked.asked_order) options.order = value_of(kOrders, asked.order);
  options.method = value_of(kMethods, asked.method);
  if (asked.block < 0)
    throw Misuse("learn.block is " + std::to_string(asked.block) + "; allowed is at least 0");
}

/// Checks the options and parses the textual ones into `options`. Throws Misuse.
io::ReadOptions check_learning(TextureLearning& asked, const Session& session) {
  take_words(asked);
  io::ReadOptions read = check_reading(asked.reading, session);
  check_options(asked.options);
  check_em(asked.em, asked.options);
  return read;
}

void say_learned(const TextureLearning& asked, const dytex::LinearDynamicTexture& texture,
                 const Session& session) {
  std::ostringstream said;
  said.precision(4);
  said << texture.components() << " components with "
       << 100 * share_of_variance(texture, texture.components()) << " % of the variance of "
       << texture.states.cols() << " frames; the model is " << asked.output;
  session.console.say(said.str());
}

void run_learn(TextureLearning asked, Session& session) {
  const io::ReadOptions read = check_learning(asked, session);
  io::require_apart({asked.reading.clip, asked.mask, asked.em.missing}, {{asked.output}, {asked.em.filled}});
  require_new({asked.em.filled}, session.common);
  io::ModelFolder folder(asked.output);
  Stages stages;
  stages.begin("learn");
  const auto source = open_held_clip(asked.reading.clip, read, session);
  fit_to_length(asked, source->info(), session);
  check_options(asked.options);
  if (asked.em.is_needed() && is_by_blocks(asked, source->info()))
    throw Misuse(std::string(asked.em.em ? "--em" : "--missing") +
                 " needs all frames at once: at most 5000, and no learn.block");
  EmStage em(asked.em, *source, read, session);
  auto learned = learn_texture(asked, em.source(), session);
  for (const auto& note : learned.notes) session.warn(asked.em.is_needed() ? "closed form: " + note : note);
  em.improve(learned.texture);
  stages.begin("write");
  io::write_model(folder.output(), "", dytex::archive_view(learned.texture));
  write_png(folder.output(), "components.png", draw_components(learned.texture));
  stages.end();
  em.write_filled(learned.texture);
  Json summary = learn_summary(asked, read, source->info(), learned, session);
  summary["learning"]["em"] = em.figures();
  end_summary(summary, session, stages);
  write_summary(folder.output(), summary);
  session.check_stop();
  folder.commit();
  say_learned(asked, learned.texture, session);
  if (session.common.json) session.print(json_text(summary));
}

template <class Value>
CLI::Option* add_words(CLI::App& command, const std::string& name, std::string& word,
                       const Words<Value>& words, const std::string& about) {
  std::vector<std::string> all;
  for (const auto& one : words) all.push_back(one.first);
  return command.add_option(name, word, about)
      ->type_name("NAME")
      ->check(CLI::IsMember(all).description(""))
      ->default_str(word);
}

void add_model_options(CLI::App& command, Settings& settings, TextureLearning& asked) {
  add_words(command, "--method", asked.method, kMethods,
            "Fit the motion by closed-form, or for noisy states n4sid");
  settings.add("learn", "noise_rank", &asked.options.noise_rank, "N",
               "Drive the model by so many noises, the strongest; 0: all", "0 to the number of components");
  settings.add(
      "learn", "block", &asked.block, "N",
      "Decompose blocks of N frames and merge them; 0: all at once, blocks of up to 1024 beyond 5000 frames",
      "at least 0");
}

}  // namespace

void add_dytex_learn(CLI::App& dytex, CommandLine& line) {
  auto* command = add_command(dytex, "learn", "Learn a linear dynamic texture from a clip", R"(
  emberfold dytex learn flag.avi -o out/flag
  emberfold dytex learn flag.avi -o out/flag -n 20 --range 0:100
  emberfold dytex learn smoke.mp4 -o out/smoke --order auto
  emberfold dytex learn flag.avi -o out/flag --missing hidden.avi --filled flag_filled.mp4)");
  const auto asked = std::make_shared<TextureLearning>();
  add_reading(*command, asked->reading, false);
  add_output(*command, asked->output);
  auto* components =
      add_number(*command, "-n,--components", asked->options.components, "N", "Learn this many components");
  auto* energy = add_number(*command, "--energy", asked->energy, "SHARE",
                            "Use the fewest components with this share of the variance");
  energy->default_str("");
  energy->excludes(components);
  auto* order = add_words(*command, "--order", asked->order, kOrders,
                          "Find the number of components: auto, gavish-donoho or held-out");
  order->excludes(components)->excludes(energy);
  auto* mask = command->add_option("--mask", asked->mask, "Learn only where this image is not 0");
  mask->type_name("MASK");
  const auto settings = add_settings(*command, line);
  add_model_options(*command, *settings, *asked);
  add_em_options(*command, asked->em);
  finish_command(*command, line, asked, run_learn, [asked, components, energy, order] {
    asked->asked_components = components->count() > 0;
    asked->asked_energy = energy->count() > 0;
    asked->asked_order = order->count() > 0;
  });
}

}  // namespace emberfold::apps
