// SPDX-License-Identifier: Apache-2.0
#include "apps/quilt_job.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <optional>

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "apps/clip_writer.hpp"
#include "apps/draw.hpp"
#include "apps/files.hpp"
#include "apps/interrupt.hpp"
#include "apps/output_folder.hpp"
#include "apps/quilt_picture.hpp"
#include "apps/quilt_report.hpp"
#include "apps/quilt_resume.hpp"
#include "apps/quilt_write.hpp"
#include "apps/summary.hpp"
#include "dytex/quilt_measures.hpp"

namespace emberfold::apps {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

/// Where things go: a folder with everything, or a clip with its map beside it.
struct Target {
  bool whole = true;  ///< a folder with pictures and report
  fs::path folder;
  std::string clip;     ///< name of the clip in it
  bool single = false;  ///< the clip is one PNG
  fs::path checkpoint;
};

Target target_of(const QuiltRequest& request) {
  const fs::path output = request.output;
  Target target;
  target.whole = output.extension().empty();
  target.folder = target.whole ? output : output.parent_path().empty() ? fs::path(".") : output.parent_path();
  if (!target.whole) target.clip = output.filename().string();
  target.checkpoint =
      target.whole ? target.folder / "quilt.part.json" : fs::path(output.string() + ".part.json");
  if (!target.whole && !fs::is_directory(target.folder))
    throw core::IoError("cannot write " + request.output + ": there is no folder " + target.folder.string());
  return target;
}

// The clip's name in a folder, and whether what is asked for can be what the name says.
void name_clip(Target& target, const QuiltRequest& request, const core::ClipInfo& info, std::int64_t frames) {
  const bool deep = info.depth != CV_8U;
  if (!target.whole) {
    const std::string extension = fs::path(target.clip).extension().string();
    target.single = extension == ".png";
    if (target.single && frames != 1)
      throw Misuse("-o " + request.output + " is one image, but there are " + std::to_string(frames) +
                   " frames; --frame N draws one of them");
    if (!target.single && deep)
      throw Misuse("-o " + request.output + ": videos hold 8 bits, but " + request.clips.front() +
                   " has 16; give a folder, where PNG holds them");
    return;
  }
  const std::string format = !request.format.empty() ? request.format : deep ? "png" : "mp4";
  if (format != "png" && deep)
    throw Misuse("--format is " + format + ", which holds 8 bits, but " + request.clips.front() +
                 " has 16; allowed is png");
  target.single = frames == 1;
  if (request.frame)
    target.clip = "frame_" + std::to_string(*request.frame) + ".png";
  else
    target.clip = target.single ? "quilt.png" : format == "png" ? "frames" : "quilt." + format;
}

struct Found {
  dytex::QuiltMap map;
  std::optional<dytex::QuiltResult> result;  ///< where it was sought
};

Found find_map(const QuiltClips& clips, QuiltRequest& request, const Target& target, Session& session) {
  cv::Mat guide;
  const auto sources = quilt_sources(clips, request, guide);
  const auto held = clips.held();
  QuiltCheckpoint checkpoint(target.checkpoint, request, held);
  const auto placed = request.resume ? checkpoint.read() : std::vector<dytex::QuiltChoice>{};
  if (!placed.empty())
    session.console.say(std::to_string(placed.size()) + " blocks were placed before, in " +
                        checkpoint.file().string());
  dytex::QuiltRun run;
  run.guide = guide;
  run.placed = placed;
  run.keep = [&](auto so_far) { checkpoint.keep(so_far); };
  Found found;
  found.result = dytex::quilt(sources, request.quilt, session.context, run);
  checkpoint.keep(found.result->choices, true);
  if (found.result->status == core::Status::cancelled)
    throw Interrupted{std::to_string(found.result->choices.size()) + " blocks are kept in " +
                      checkpoint.file().string() + "; --resume goes on"};
  found.map = found.result->map;
  return found;
}

dytex::QuiltMap read_map(const std::string& name, const std::vector<cv::Size>& sizes) {
  auto stream = open_file(name);
  try {
    return dytex::quilt_map(core::read_npy(stream), sizes);
  } catch (const core::IoError& error) {
    throw core::IoError(name + ": " + error.what());
  } catch (const core::InputError& error) {
    throw core::InputError(name + ": " + error.what());
  }
}

// How many frames the output has.
std::int64_t frames_of(const QuiltRequest& request, const QuiltClips& clips) {
  if (request.frame) return 1;
  if (request.frames) return *request.frames;
  if (clips.is_held()) return clips.held().front()->frames();
  return clips.info().frames.value_or(0);
}

void write_map(OutputFolder& output, const QuiltRequest& request, const dytex::QuiltMap& map,
               const dytex::TimeControl& control) {
  const auto array = dytex::to_array(map);
  if (request.map.empty()) {
    output.write("map.npy", [&](std::ostream& out) { core::write_npy(out, array); });
  } else {
    const fs::path part = request.map + ".part";
    std::ofstream out(part, std::ios::binary | std::ios::trunc);
    std::error_code error;
    if (out) core::write_npy(out, array);
    out.close();
    if (out) fs::rename(part, request.map, error);
    if (!out || error) throw core::IoError("cannot write " + request.map);
  }
  if (control.plain()) return;
  core::NpyArray times{
      {static_cast<std::size_t>(map.size.height), static_cast<std::size_t>(map.size.width), 2}, false, {}};
  std::vector<float> values;
  for (int y = 0; y < map.size.height; ++y)
    for (int x = 0; x < map.size.width; ++x) {
      values.push_back(control.rate.empty() ? 1.0F : control.rate.at<float>(y, x));
      values.push_back(control.offset.empty() ? 0.0F : control.offset.at<float>(y, x));
    }
  times.data = std::move(values);
  output.write("time.npy", [&](std::ostream& out) { core::write_npy(out, times); });
}

// Draws the clip; returns some of its frames for the report.
std::vector<std::pair<int, cv::Mat>> write_clip(OutputFolder& output, const Target& target,
                                                const QuiltRequest& request, const Found& found,
                                                const QuiltClips& clips, const dytex::TimeControl& control,
                                                std::int64_t& frames, Session& session) {
  const auto& info = clips.info();
  std::vector<std::pair<int, cv::Mat>> kept;
  std::unique_ptr<ClipWriter> writer;
  if (!target.single)
    writer = create_clip(output.staged(target.clip), found.map.size, info.fps, info.channels == 3);
  std::int64_t t = 0;
  render_frames(
      found.map, clips, control, request.frame.value_or(0), frames,
      [&](const cv::Mat& frame) {
        if (writer)
          writer->write(frame);
        else
          write_png(output.staged(target.clip), output.path() / target.clip, frame);
        if (t == 0 || t == frames / 2 || t == frames - 1)
          kept.emplace_back(static_cast<int>(t), to_colour_bytes(frame, info));
        ++t;
      },
      session);
  if (writer) writer->finish();
  frames = t;
  return kept;
}

Json quilt_json(const Found& found, const QuiltClips& clips) {
  Json out = Json::object();
  std::span<const dytex::QuiltChoice> choices;
  if (found.result) {
    choices = found.result->choices;
    double compared = 0, equals = 0;
    for (const auto& choice : choices)
      compared += static_cast<double>(choice.compared), equals += static_cast<double>(choice.equals);
    const double blocks = static_cast<double>(choices.size());
    out = {{"blocks", choices.size()},
           {"columns", found.result->columns},
           {"rows", found.result->rows},
           {"components", found.result->components},
           {"compared_mean", std::round(10 * compared / blocks) / 10},
           {"equals_mean", std::round(10 * equals / blocks) / 10}};
  }
  if (!clips.is_held()) return out;
  const auto held = clips.held();
  const auto measures = dytex::measure_quilt(found.map, choices, held);
  if (found.result) out["verbatim_blocks"] = measures.verbatim_blocks;
  out["largest_piece"] = measures.largest_piece;
  out["source_share"] = measures.source_share;
  out["seam_share"] = measures.seam_share;
  out["seam_step"] = measures.seam_step;
  out["other_step"] = measures.other_step;
  out["seam_ratio"] = measures.seam_ratio();
  return out;
}

QuiltPictures pictures_of(const Found& found, const QuiltClips& clips,
                          std::vector<std::pair<int, cv::Mat>> drawn) {
  QuiltPictures pictures;
  const auto sizes = clips.sizes();
  pictures.map = draw_quilt_map(found.map, sizes);
  pictures.seams = draw_seams(drawn[drawn.size() / 2].second, found.map);
  for (auto& [t, frame] : drawn) {
    const auto held = clips.held();
    const int shown = std::min(t, held.front()->frames() - 1);
    pictures.pairs.push_back({t, to_colour_bytes(frame_of(*held.front(), shown), clips.info()), frame});
  }
  return pictures;
}

}  // namespace

void run_quilt(QuiltRequest& request, Session& session) {
  Target target = target_of(request);
  Stages stages;
  stages.begin("read");
  QuiltClips clips(request, request.read, session);
  complete_request(request, clips.sizes().front());
  std::optional<Found> found;
  if (!request.apply.empty()) found = Found{read_map(request.apply, clips.sizes()), {}};
  const cv::Size size = found ? found->map.size : request.quilt.size;
  const auto control = make_control(request.control, size, request.quilt.block, request.quilt.seed);
  OutputFolder output(target.folder);
  const auto memory = static_cast<std::size_t>(request.memory) * 1'000'000;
  const bool streams =
      found && !target.whole && clips.info().frames.value_or(0) > 0 &&
      is_streamable(control, frames_of(request, clips) + request.frame.value_or(0), clips.info(), memory);
  if (!streams) clips.hold(target.folder, session);
  std::int64_t frames = frames_of(request, clips);
  name_clip(target, request, clips.info(), frames);
  if (!found) {
    stages.begin("quilt");
    found = find_map(clips, request, target, session);
  }
  stages.begin("render");
  write_map(output, request, found->map, control);
  auto drawn = write_clip(output, target, request, *found, clips, control, frames, session);
  stages.begin("write");
  Json summary = begin_summary("quilt", session);
  summary["clip"] =
      clip_json(request.clips.front(), clips.info(), static_cast<int>(clips.info().frames.value_or(0)));
  summary["clips"] = request.clips;
  summary["options"] = request_json(request);
  summary["options"]["reading"] = reading_json(request.read);
  summary["quilt"] = quilt_json(*found, clips);
  summary["output"] = {{"name", (target.folder / target.clip).string()},
                       {"width", size.width},
                       {"height", size.height},
                       {"frames", frames}};
  summary["warnings"] = session.warnings;
  if (target.whole) {
    const auto pictures = pictures_of(*found, clips, std::move(drawn));
    write_png(output.staged("map.png"), target.folder / "map.png", pictures.map);
    write_png(output.staged("seams.png"), target.folder / "seams.png", pictures.seams);
    output.write("report.html", [&](std::ostream& out) {
      out << make_quilt_report(request.clips.front(), pictures, summary);
    });
  }
  stages.end();
  summary["seconds"] = stages.seconds();
  summary["peak_memory_mb"] = peak_memory_mb();
  summary["mapped_mb"] = std::round(static_cast<double>(clips.mapped_bytes()) / 1e5) / 10;
  if (target.whole) output.write("summary.json", [&](std::ostream& out) { out << json_text(summary); });
  session.check_stop();
  output.commit();
  if (request.apply.empty()) {
    std::error_code ignored;
    fs::remove(target.checkpoint, ignored);
  }
  session.console.say(std::to_string(frames) + (frames == 1 ? " frame" : " frames") + " of " +
                      std::to_string(size.width) + "x" + std::to_string(size.height) + " quilted into " +
                      (target.folder / target.clip).string());
  if (session.common.json) session.print(json_text(summary));
}

}  // namespace emberfold::apps
