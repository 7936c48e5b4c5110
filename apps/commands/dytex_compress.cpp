// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <iomanip>
#include <memory>
#include <optional>
#include <sstream>

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "apps/builtin/open_clip.hpp"
#include "apps/cli/interrupt.hpp"
#include "apps/cli/summary.hpp"
#include "apps/commands/dytex.hpp"
#include "apps/pictures/curve_plot.hpp"
#include "apps/pictures/png.hpp"
#include "core/io/image_files.hpp"
#include "core/io/model_folder.hpp"
#include "core/io/require_apart.hpp"
#include "dytex/measures/psnr.hpp"
#include "dytex/model/compression.hpp"

namespace emberfold::apps {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using dytex::Precision;

struct Compress {
  std::string model, output, precision = "f16";
  Reading reading;
};

// A model with fewer components, in one precision.
struct Kept {
  Eigen::Index components = 0;
  Precision precision = Precision::f32;
  std::size_t bytes = 0;
  double psnr = 0;
  std::optional<double> measured;  // on the clip's frames, drawn in 8 bits
};

// Size of the training clip in bytes.
struct ClipSize {
  std::size_t raw = 0;
  std::optional<std::size_t> file;
};

// Returns round numbers up to the model's own order.
std::vector<Eigen::Index> orders(Eigen::Index most) {
  std::vector<Eigen::Index> found;
  for (const Eigen::Index n : {1, 2, 5, 10, 20, 30, 50, 75, 100, 150, 200, 300, 500, 750, 1000})
    if (n < most) found.push_back(n);
  found.push_back(most);
  return found;
}

std::vector<Kept> sweep(const dytex::LinearDynamicTexture& texture) {
  std::vector<Kept> all;
  for (const Precision precision : dytex::kPrecisions) {
    const Eigen::VectorXd errors = dytex::projection_errors(texture, precision);
    for (const Eigen::Index n : orders(texture.components()))
      all.push_back(
          {n, precision, dytex::stored_bytes(texture, n, precision), dytex::psnr(errors[n]), std::nullopt});
  }
  return all;
}

void measure(const Compress& asked, const io::ReadOptions& read, const dytex::LinearDynamicTexture& texture,
             std::vector<Kept>& all, Session& session) {
  const auto source = open_held_clip(asked.reading.clip, read, session);
  for (auto& kept : all) {
    if (kept.components != texture.components()) continue;
    try {
      const double error =
          dytex::measured_error(dytex::rounded(texture, kept.precision), *source, session.context);
      session.check_stop();
      kept.measured = dytex::psnr(error);
    } catch (const core::InputError& error) {
      throw core::IoError(asked.reading.clip + " is not what " + asked.model + " was learned from: " +
                          error.what() + "; read it as it was read then (--range, --scale, --grey)");
    }
  }
}

// Returns the bytes of a file, or of the images of a folder or pattern; none for built-in clips.
std::optional<std::size_t> file_bytes(const std::string& clip) {
  std::error_code error;
  std::vector<fs::path> files;
  if (fs::is_regular_file(clip, error))
    files = {clip};
  else if (fs::is_directory(clip, error))
    files = io::list_images(clip);
  else if (io::is_pattern(clip))
    files = io::match_images(clip);
  std::size_t sum = 0;
  for (const auto& file : files) {
    sum += fs::file_size(file, error);
    if (error) return std::nullopt;
  }
  return files.empty() ? std::nullopt : std::optional(sum);
}

ClipSize clip_size(const Compress& asked, const dytex::LinearDynamicTexture& texture) {
  const auto depth = static_cast<std::size_t>(CV_ELEM_SIZE1(texture.info.depth));
  ClipSize size{static_cast<std::size_t>(texture.pixels() * texture.states.cols()) * depth, std::nullopt};
  // A part of a file, or one rescaled, has no size in bytes of its own.
  const bool whole = asked.reading.is_whole();
  if (!asked.reading.clip.empty() && whole) size.file = file_bytes(asked.reading.clip);
  return size;
}

std::string table(const dytex::LinearDynamicTexture& texture, const std::vector<Kept>& all,
                  const ClipSize& clip, bool measured) {
  std::ostringstream out;
  out << std::fixed << std::setprecision(2);
  out << "the clip, uncompressed " << std::setw(14) << clip.raw << " bytes\n";
  if (clip.file) out << "its file               " << std::setw(14) << *clip.file << " bytes\n";
  out << "\ncomponents  kept in         bytes   of the clip    PSNR, dB" << (measured ? "    measured" : "")
      << '\n';
  for (const auto& kept : all) {
    const double share = static_cast<double>(kept.bytes) / static_cast<double>(clip.raw);
    out << std::setw(10) << kept.components << "  " << std::left << std::setw(7) << name(kept.precision)
        << std::right << std::setw(14) << kept.bytes << std::setw(12) << 100 * share << " %" << std::setw(12)
        << kept.psnr;
    if (kept.measured) out << std::setw(12) << *kept.measured;
    out << '\n';
    if (kept.components == texture.components() && kept.precision != Precision::u8) out << '\n';
  }
  return out.str();
}

Json compression_json(const std::vector<Kept>& all, const ClipSize& clip) {
  Json rows = Json::array();
  for (const auto& kept : all)
    rows.push_back({{"components", kept.components},
                    {"precision", name(kept.precision)},
                    {"bytes", kept.bytes},
                    {"share_of_clip", static_cast<double>(kept.bytes) / static_cast<double>(clip.raw)},
                    {"psnr", kept.psnr},
                    {"psnr_measured", kept.measured ? Json(*kept.measured) : Json(nullptr)}});
  return {{"clip_bytes", clip.raw},
          {"file_bytes", clip.file ? Json(*clip.file) : Json(nullptr)},
          {"kept", std::move(rows)}};
}

cv::Mat picture(const std::vector<Kept>& all) {
  CurvePlot plot{
      "training frames projected onto the model", "bytes of the model", "PSNR, dB", {}, true, false};
  for (const Precision precision : dytex::kPrecisions) {
    Curve curve{name(precision), {}, {}, true};
    for (const auto& kept : all)
      if (kept.precision == precision) {
        curve.x.push_back(static_cast<double>(kept.bytes));
        curve.y.push_back(kept.psnr);
      }
    plot.curves.push_back(std::move(curve));
  }
  return draw_curves(plot);
}

void run_compress(const Compress& asked, Session& session) {
  const auto precision = dytex::precision_of(asked.precision);
  if (!precision) throw Misuse("--precision is " + one_line(asked.precision) + "; allowed is f32, f16 or u8");
  const io::ReadOptions read = check_reading(asked.reading, session);
  std::optional<io::ModelFolder> folder;
  if (!asked.output.empty()) {
    std::error_code ignored;
    if (fs::equivalent(asked.output, asked.model, ignored))
      throw Misuse(
          "--output is the model itself; what f16 and u8 leave out would be lost: name another folder");
    io::require_apart({asked.model, asked.reading.clip}, {{asked.output}});
    folder.emplace(asked.output);
  }
  Stages stages;
  stages.begin("read");
  const auto texture = read_texture(asked.model);
  stages.begin("compress");
  std::vector<Kept> all = sweep(texture);
  if (!asked.reading.clip.empty()) {
    stages.begin("measure");
    measure(asked, read, texture, all, session);
  }
  const ClipSize clip = clip_size(asked, texture);
  stages.begin("write");
  Json summary = begin_summary("dytex compress", session);
  summary["model"] = asked.model;
  summary["options"] = {{"precision", asked.precision}, {"reading", reading_json(read)}};
  summary["compression"] = compression_json(all, clip);
  summary["warnings"] = session.warnings;
  if (folder) {
    io::write_model(folder->output(), "", dytex::to_archive(texture, *precision));
    write_png(folder->output(), "compression.png", picture(all));
    write_summary(folder->output(), summary);
    session.check_stop();
    folder->commit();
    session.console.say("the model in " + asked.precision + " is " + asked.output);
  }
  stages.end();
  summary["seconds"] = stages.seconds();
  session.print(session.common.json ? json_text(summary)
                                    : table(texture, all, clip, !asked.reading.clip.empty()));
}

}  // namespace

void add_dytex_compress(CLI::App& dytex, CommandLine& line) {
  auto* command = add_command(dytex, "compress", "Store a model in fewer bytes, and measure the loss", R"(
  emberfold dytex compress out/flag
  emberfold dytex compress out/flag flag.avi
  emberfold dytex compress out/flag -o out/small --precision u8)");
  const auto asked = std::make_shared<Compress>();
  add_texture_model(*command, asked->model);
  add_reading(*command, asked->reading);
  command->get_option("CLIP")->required(false)->description(
      "Measure the PSNR on this clip, which the model was learned from");
  command->add_option("-o,--output", asked->output, "Write the smaller model into this folder")
      ->type_name("DIR");
  command->add_option("--precision", asked->precision, "Store components and mean in this type")
      ->type_name("f32|f16|u8")
      ->default_str(asked->precision);
  finish_command(*command, line, asked, run_compress);
}

}  // namespace emberfold::apps
