// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <memory>

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "apps/builtin/open_clip.hpp"
#include "apps/cli/interrupt.hpp"
#include "apps/cli/summary.hpp"
#include "apps/commands/dytex.hpp"
#include "core/io/mask_file.hpp"
#include "core/io/require_apart.hpp"
#include "dytex/model/layers.hpp"
#include "dytex/synthesize.hpp"

namespace emberfold::apps {

namespace {

using Json = nlohmann::ordered_json;

struct Compose {
  Reading reading;
  std::vector<std::string> layers;
  std::string output, start = "stationary";
  double feather = 8;
  bool noise = false;
};

/// A model that moves independently, and where it shows.
struct Layer {
  std::string model, mask;  // mask: "" for where the model moves
  dytex::LinearDynamicTexture texture;
  cv::Mat opacity;
  std::unique_ptr<dytex::Synthesis> synthesis;  // refers to `texture`, which must not move in memory
};

/// Splits MODEL:MASK, unless a folder has the whole name.
std::pair<std::string, std::string> split_layer(const std::string& text) {
  const auto colon = text.rfind(':');
  std::error_code ignored;
  if (colon == std::string::npos || std::filesystem::is_directory(text, ignored)) return {text, ""};
  if (colon == 0 || colon + 1 == text.size())
    throw Misuse("--layer is " + one_line(text) + "; expected is MODEL or MODEL:MASK");
  return {text.substr(0, colon), text.substr(colon + 1)};
}

std::string shape_of(const core::ClipInfo& info) {
  return std::to_string(info.width) + " x " + std::to_string(info.height) +
         (info.channels == 3 ? ", colour" : ", grey");
}

std::unique_ptr<Layer> open_layer(const Compose& asked, std::size_t index, const core::ClipInfo& clip,
                                  const Session& session) {
  auto layer = std::make_unique<Layer>();
  std::tie(layer->model, layer->mask) = split_layer(asked.layers[index]);
  layer->texture = read_texture(layer->model);
  const core::ClipInfo& info = layer->texture.info;
  if (info.width != clip.width || info.height != clip.height || info.channels != clip.channels)
    throw core::IoError(layer->model + " draws " + shape_of(info) + "; " + asked.reading.clip + " is " +
                        shape_of(clip) + (info.channels < clip.channels ? " (read it with --grey)" : ""));
  try {
    const cv::Mat mask =
        layer->mask.empty() ? dytex::moving_region(layer->texture) : io::read_mask(layer->mask);
    if (mask.cols != clip.width || mask.rows != clip.height)
      throw core::IoError(layer->mask + " is " + std::to_string(mask.cols) + " x " +
                          std::to_string(mask.rows) + "; " + asked.reading.clip + " is " + shape_of(clip));
    layer->opacity = dytex::layer_opacity(mask, asked.feather);
  } catch (const core::InputError& error) {
    throw Misuse("--" + std::string(error.what()));
  }
  dytex::SynthesisOptions options;
  options.seed = session.common.seed + index;  // layers move independently
  options.pixel_noise = asked.noise;
  set_start(options, asked.start, layer->texture, layer->model);
  layer->synthesis = std::make_unique<dytex::Synthesis>(layer->texture, options);
  return layer;
}

int draw_frames(core::FrameSource& source, const std::vector<std::unique_ptr<Layer>>& layers,
                io::VideoWriter& writer, const Session& session) {
  const core::ClipInfo& info = source.info();
  int frames = 0;
  for (cv::Mat frame = source.next(); !frame.empty(); frame = source.next(), ++frames) {
    if (info.frames) session.context.report("compose", double(frames) / static_cast<double>(*info.frames));
    if (frame.depth() != CV_8U) frame = core::to_bytes(core::to_levels(frame, info));
    for (const auto& layer : layers) dytex::put_layer(frame, layer->synthesis->next(), layer->opacity);
    writer.write(frame);
    session.check_stop();
  }
  return frames;
}

Json compose_summary(const Compose& asked, const io::ReadOptions& read, const core::ClipInfo& info,
                     int frames, const std::vector<std::unique_ptr<Layer>>& layers, const Session& session) {
  Json summary = begin_summary("dytex compose", session);
  summary["clip"] = clip_json(asked.reading.clip, info, frames);
  summary["output"] = asked.output;
  Json list = Json::array();
  for (const auto& layer : layers)
    list.push_back({{"model", layer->model},
                    {"mask", layer->mask.empty() ? Json(nullptr) : Json(layer->mask)},
                    {"share", cv::mean(layer->opacity)[0]}});
  summary["layers"] = std::move(list);
  summary["options"] = {{"reading", reading_json(read)},
                        {"feather", asked.feather},
                        {"start", asked.start},
                        {"noise", asked.noise}};
  return summary;
}

void run_compose(const Compose& asked, Session& session) {
  const io::ReadOptions read = check_reading(asked.reading, session);
  std::vector<std::string> inputs{asked.reading.clip};
  for (const auto& layer : asked.layers) {
    const auto [model, mask] = split_layer(layer);
    inputs.push_back(model);
    inputs.push_back(mask);
  }
  io::require_apart(inputs, {{asked.output}});
  require_new({asked.output}, session.common);
  Stages stages;
  stages.begin("read");
  const auto source = open_held_clip(asked.reading.clip, read, session);
  const core::ClipInfo info = source->info();
  std::vector<std::unique_ptr<Layer>> layers;
  for (std::size_t i = 0; i < asked.layers.size(); ++i) layers.push_back(open_layer(asked, i, info, session));
  stages.begin("compose");
  const auto writer = create_output(asked.output, info);
  const int frames = draw_frames(*source, layers, *writer, session);
  if (frames == 0) throw core::IoError(asked.reading.clip + " holds no frame");
  writer->finish();
  stages.end();
  session.console.say(std::to_string(frames) + " frames with " + std::to_string(layers.size()) +
                      (layers.size() == 1 ? " layer" : " layers") + " drawn into " + asked.output);
  if (!session.common.json) return;
  Json summary = compose_summary(asked, read, info, frames, layers, session);
  end_summary(summary, session, stages);
  session.print(json_text(summary));
}

}  // namespace

void add_dytex_compose(CLI::App& dytex, CommandLine& line) {
  auto* command = add_command(dytex, "compose", "Draw parts of a clip anew from models of their own", R"(
  emberfold dytex learn river.mp4 -o out/water --mask water.png
  emberfold dytex edit out/water -o out/fast --speed 2
  emberfold dytex compose river.mp4 --layer out/fast:water.png -o river_fast.mp4
  emberfold dytex compose river.mp4 --layer out/fast --layer out/reeds:r.png --feather 4 -o two.avi)");
  const auto asked = std::make_shared<Compose>();
  add_reading(*command, asked->reading, false);
  add_clip_output(*command, asked->output);
  command
      ->add_option("--layer", asked->layers,
                   "Draw a model where MASK is white, or where it moves; may be repeated")
      ->type_name("MODEL[:MASK]")
      ->allow_extra_args(false)
      ->required();
  add_number(*command, "--feather", asked->feather, "PX", "Blend a layer over this distance inside its mask");
  add_start(*command, asked->start);
  command->add_flag("--noise", asked->noise, "Add the noise of what the components leave out");
  finish_command(*command, line, asked, run_compose);
}

}  // namespace emberfold::apps
