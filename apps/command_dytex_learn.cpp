// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <memory>
#include <sstream>

#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "apps/command_dytex.hpp"
#include "apps/interrupt.hpp"
#include "apps/mask_file.hpp"
#include "apps/model_folder.hpp"
#include "apps/summary.hpp"
#include "apps/texture_modes.hpp"
#include "apps/texture_picture.hpp"
#include "dytex/archive.hpp"
#include "dytex/layers.hpp"
#include "dytex/learn.hpp"

namespace emberfold::apps {

namespace {

using Json = nlohmann::ordered_json;

struct Learn {
  Reading reading;
  std::string output, mask;
  dytex::LearnOptions options;
  bool asked_components = false, asked_energy = false;
  double energy = 0.95;
};

// Fifty components are the default for a long clip; a short one has fewer.
void fit_to_length(Learn& asked, const core::ClipInfo& info, const Session& session) {
  if (!info.frames || asked.asked_energy) return;
  const auto most = *info.frames - 1;
  if (most < 1)
    throw core::IoError(asked.reading.clip + " holds one frame; a dynamic texture needs at least two");
  if (asked.options.components <= most) return;
  if (asked.asked_components)
    throw Misuse("--components is " + std::to_string(asked.options.components) + "; " + asked.reading.clip +
                 " has " + std::to_string(*info.frames) + " frames, so allowed is 1 to " +
                 std::to_string(most));
  asked.options.components = static_cast<int>(most);
  session.console.say(asked.reading.clip + " has " + std::to_string(*info.frames) +
                      " frames: " + std::to_string(most) + " components are learned");
}

Json learn_summary(const Learn& asked, const ReadOptions& read, const core::ClipInfo& info,
                   const dytex::LearnResult& learned, const Session& session) {
  Json summary = begin_summary("dytex learn", session);
  const auto& texture = learned.texture;
  summary["clip"] = clip_json(asked.reading.clip, info, static_cast<int>(texture.states.cols()));
  Json options = {{"components", asked.options.components}};
  options["energy"] = asked.options.energy ? Json(*asked.options.energy) : Json(nullptr);
  options["mask"] = asked.mask.empty() ? Json(nullptr) : Json(asked.mask);
  summary["options"] = {{"reading", reading_json(read)}, {"learn", std::move(options)}};
  summary["texture"] = texture_json(texture);
  summary["learning"] = {
      {"transition",
       learned.transition == dytex::Transition::least_squares ? "least_squares" : "yule_walker"},
      {"least_squares_radius", learned.least_squares_radius},
      {"passes", learned.passes}};
  summary["files"] = {{"model.json", "what the model is"},
                      {"components.png", "its mean, first components and the courses of their states"},
                      {"summary.json", "all figures"}};
  summary["warnings"] = session.warnings;
  return summary;
}

void write_picture(OutputFolder& output, const dytex::LinearDynamicTexture& texture) {
  std::vector<unsigned char> bytes;
  if (!cv::imencode(".png", draw_components(texture), bytes))
    throw core::IoError("cannot write " + (output.path() / "components.png").string() + " as PNG");
  output.write("components.png", [&](std::ostream& out) {
    out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  });
}

void check_learning(const dytex::LearnOptions& options) {
  try {
    options.validate();
  } catch (const core::InputError& error) {
    const auto message = without_struct_name(error.what());
    throw Misuse(with_option_name(with_option_name(message, "components"), "energy"));
  }
}

/// Learns from the region inside the mask alone, where there is one.
dytex::LearnResult learn_region(const Learn& asked, core::FrameSource& source, const core::Context& context) {
  if (asked.mask.empty()) return dytex::learn(source, asked.options, context);
  const cv::Mat mask = read_mask(asked.mask);
  std::unique_ptr<dytex::RegionSource> region;
  try {
    region = std::make_unique<dytex::RegionSource>(source, mask);
  } catch (const core::InputError& error) {
    throw Misuse("--mask: " + asked.mask + ": " + error.what());
  }
  auto learned = dytex::learn(*region, asked.options, context);
  if (learned.status == core::Status::done) dytex::confine(learned.texture, mask);
  return learned;
}

dytex::LearnResult learn_texture(const Learn& asked, core::FrameSource& source, Session& session) {
  try {
    auto learned = learn_region(asked, source, session.context);
    if (learned.status == core::Status::cancelled) throw Interrupted{};
    return learned;
  } catch (const Misuse&) {
    throw;
  } catch (const core::InputError& error) {
    throw Misuse(asked.reading.clip + ": " +
                 with_option_name(without_struct_name(error.what()), "components"));
  }
}

void run_learn(Learn asked, Session& session) {
  if (asked.asked_energy) asked.options.energy = asked.energy;
  const ReadOptions read = check_reading(asked.reading, session);
  check_learning(asked.options);
  ModelFolder folder(asked.output);
  Stages stages;
  stages.begin("learn");
  const auto source =
      open_clip(asked.reading.clip, read, [&](const std::string& text) { session.warn(text); });
  fit_to_length(asked, source->info(), session);
  const auto learned = learn_texture(asked, *source, session);
  for (const auto& note : learned.notes) session.warn(note);
  stages.begin("write");
  write_model(folder.output(), "", dytex::archive_view(learned.texture));
  write_picture(folder.output(), learned.texture);
  stages.end();
  Json summary = learn_summary(asked, read, source->info(), learned, session);
  summary["seconds"] = stages.seconds();
  summary["peak_memory_mb"] = peak_memory_mb();
  folder.output().write("summary.json", [&](std::ostream& out) { out << json_text(summary); });
  session.check_stop();
  folder.commit();
  std::ostringstream said;
  said.precision(4);
  said << learned.texture.components() << " components with "
       << 100 * share_of_variance(learned.texture, learned.texture.components()) << " % of the variance of "
       << learned.texture.states.cols() << " frames; the model is " << asked.output;
  session.console.say(said.str());
  if (session.common.json) session.print(json_text(summary));
}

}  // namespace

void add_dytex_learn(CLI::App& dytex, Chosen& chosen) {
  auto* command = dytex.add_subcommand("learn", "Learn a linear dynamic texture from a clip");
  command->footer(
      "  emberfold dytex learn flag.avi -o out/flag\n"
      "  emberfold dytex learn flag.avi -o out/flag -n 20 --range 0:100\n"
      "  emberfold dytex learn flag.avi -o out/flag --energy 0.95");
  const auto asked = std::make_shared<Learn>();
  add_reading(*command, asked->reading);
  add_output(*command, asked->output);
  auto* components =
      add_number(*command, "-n,--components", asked->options.components, "N", "Order: how many components");
  auto* energy = add_number(*command, "--energy", asked->energy, "SHARE",
                            "Instead: the fewest components with this share of the variance");
  energy->default_str("");
  energy->excludes(components);
  auto* mask = command->add_option("--mask", asked->mask, "Learn the part inside alone: an image, white inside");
  mask->type_name("MASK");
  for (auto* option : {components, energy, mask}) option->group("Learning");
  add_common(*command, chosen.common, "Print the content of summary.json");
  command->callback([asked, components, energy, &chosen] {
    asked->asked_components = components->count() > 0;
    asked->asked_energy = energy->count() > 0;
    chosen.run = [asked](Session& session) { run_learn(*asked, session); };
  });
}

}  // namespace emberfold::apps
