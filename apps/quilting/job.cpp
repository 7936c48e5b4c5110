// SPDX-License-Identifier: Apache-2.0
#include "apps/quilting/job.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <optional>
#include <utility>

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "apps/cli/interrupt.hpp"
#include "apps/cli/summary.hpp"
#include "apps/pictures/draw.hpp"
#include "apps/pictures/quilt_picture.hpp"
#include "apps/quilting/found_map.hpp"
#include "apps/quilting/output.hpp"
#include "apps/quilting/surface.hpp"
#include "apps/report/quilt_report.hpp"
#include "core/io/require_apart.hpp"
#include "core/text/format_number.hpp"
#include "core/text/size_text.hpp"

namespace emberfold::apps {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

// Returns whether one frame of the clip suffices: for a single frame of a map without time control.
bool reads_one_frame(const QuiltRequest& request) {
  return !request.apply.empty() && request.frame && request.control.is_plain();
}

io::ReadOptions reading_of(const QuiltRequest& request) {
  io::ReadOptions read = request.read;
  if (!reads_one_frame(request)) return read;
  read.first += std::int64_t{*request.frame} * read.every;
  if (read.last && read.first >= *read.last)
    throw Misuse("--frame is " + std::to_string(*request.frame) + ", but --range holds only " +
                 std::to_string(*request.read.last - request.read.first) + " frames");
  read.last = read.first + 1;
  return read;
}

FramePlan plan_of(const QuiltRequest& request, const QuiltClips& clips) {
  if (reads_one_frame(request)) return {0, 1, false};
  if (request.frame) return {*request.frame, 1, false};
  if (request.frames) return {0, *request.frames, false};
  if (clips.is_loaded()) return {0, clips.loaded().front()->frames(), false};
  return {0, clips.info().frames.value_or(0), true};
}

// Warns where the quilt visibly differs from its source.
void warn_of_seams(const QuiltRequest& request, const Json& quilt, Session& session) {
  constexpr double kSeen = 2.5;
  const double ratio = quilt.value("seam_ratio", 1.0);
  if (!request.apply.empty() || ratio <= kSeen) return;
  session.warn("seams show (levels step " + core::fixed_text(ratio, 1) +
               " times as much across them as elsewhere): " + request.clips.front() +
               " shows single things rather than a texture that could be laid from blocks" +
               (request.seams == "still" ? "; --set quilt.seams=moving may hide some" : ""));
}

Json summarise(const QuiltRequest& request, const QuiltTarget& target, const FoundMap& found,
               const QuiltClips& clips, std::int64_t frames, Session& session) {
  Json summary = begin_summary("quilt", session);
  const auto known = clips.info().frames.value_or(0);
  summary["clip"] = clip_json(request.clips.front(), clips.info(),
                              clips.is_loaded() ? clips.loaded().front()->frames() : static_cast<int>(known));
  summary["clips"] = request.clips;
  summary["options"] = request_json(request);
  summary["options"]["reading"] = reading_json(request.read);
  summary["quilt"] = found_map_json(found, clips);
  if (found.surface) summary["surface"] = surface_json(request.surface, found.surface->layout);
  warn_of_seams(request, summary["quilt"], session);
  summary["output"] = {{"name", target.path().string()},
                       {"width", found.map.size.width},
                       {"height", found.map.size.height},
                       {"frames", frames}};
  summary["warnings"] = session.warnings;
  return summary;
}

void write_pictures(io::OutputFolder& output, const QuiltRequest& request, const FoundMap& found,
                    const QuiltClips& clips, const std::vector<QuiltedFrame>& drawn, const Json& summary) {
  QuiltPictures pictures;
  const auto sizes = clips.sizes();
  const auto& source = *clips.loaded().front();
  const auto& middle = drawn[drawn.size() / 2];
  const auto shown = dytex::still_at(found.map, std::min(middle.frame, source.frames() - 1));
  pictures.map = draw_quilt_map(shown, sizes);
  pictures.seams = draw_seams(middle.picture, found.surface ? block_map(*found.surface) : shown);
  for (const auto& [frame, picture] : drawn)
    pictures.pairs.push_back(
        {frame, to_colour_bytes(frame_of(source, std::min(frame, source.frames() - 1)), clips.info()),
         picture});
  write_png(output.staged("map.png"), output.path() / "map.png", pictures.map);
  write_png(output.staged("seams.png"), output.path() / "seams.png", pictures.seams);
  const auto page = make_quilt_report(request.clips.front(), pictures, summary);
  output.write("report.html", [&](std::ostream& out) { out << page; });
}

// Returns whether frames can be drawn while reading the clip, since only the clip is written.
bool can_stream(const QuiltRequest& request, const QuiltTarget& target, const QuiltClips& clips,
                const dytex::TimeControl& control) {
  const FramePlan plan = plan_of(request, clips);
  return !request.apply.empty() && !target.whole && plan.count > 0 &&
         is_streamable(control, plan.first + plan.count, clips.info(),
                       static_cast<std::size_t>(request.memory) * 1'000'000);
}

// Lists all files that the request names; numbers and gradients are skipped.
std::vector<std::string> input_names(const QuiltRequest& request) {
  std::vector<std::string> names = request.clips;
  names.insert(names.end(), request.masks.begin(), request.masks.end());
  for (const auto& name :
       {request.guide, request.surface, request.apply, request.control.rate, request.control.offset}) {
    names.push_back(name);
    if (const auto colon = name.find(':'); colon != std::string::npos)
      names.push_back(name.substr(colon + 1));  // depth:IMAGE, distance:MASK
  }
  return names;
}

std::vector<io::OutputPath> output_paths(const QuiltRequest& request, const QuiltTarget& target) {
  std::vector<io::OutputPath> paths;
  const bool own_map = !keeps_map(request, target);
  if (!target.whole) {
    paths.push_back({request.output});
    if (own_map) paths.push_back({target.folder / "map.npy"});
    paths.push_back({target.folder / "time.npy"});
    return paths;
  }
  paths.push_back({target.folder, true});
  for (const char* name :
       {"quilt.mp4", "quilt.avi", "quilt.png", "frames", "map.png", "seams.png", "time.npy"})
    paths.push_back({target.folder / name});
  if (own_map) paths.push_back({target.folder / "map.npy"});
  return paths;
}

bool same_bytes(const fs::path& a, const fs::path& b) {
  std::ifstream first(a, std::ios::binary), second(b, std::ios::binary);
  using Bytes = std::istreambuf_iterator<char>;
  return first && second && std::equal(Bytes(first), Bytes(), Bytes(second), Bytes());
}

/// Checks before the work begins that nothing is replaced except an earlier quilt in its own folder, and a
/// copy of the map that is applied.
void require_replaceable(const QuiltRequest& request, const QuiltTarget& target,
                         const std::vector<io::OutputPath>& outputs) {
  std::vector<std::string> names;
  for (const auto& output : outputs) {
    if (output.is_folder || output.path.parent_path() != target.folder) continue;
    if (output.path.filename() == "map.npy" && same_bytes(output.path, request.apply)) continue;
    names.push_back(output.path.filename().string());
  }
  io::require_own(target.folder, names);
}

}  // namespace

void run_quilt(QuiltRequest& request, Session& session) {
  QuiltTarget target = quilt_target(request);
  const auto inputs = input_names(request);
  const auto outputs = output_paths(request, target);
  io::require_apart(inputs, outputs);
  if (!session.common.overwrite) require_replaceable(request, target, outputs);
  Stages stages;
  stages.begin("read");
  QuiltClips clips(request, reading_of(request), session);
  complete_request(request, clips.sizes().front());
  FoundMap found;
  if (!request.apply.empty()) found.map = read_map(request.apply, clips.sizes());
  if (!request.surface.empty()) found.surface.emplace(read_surface(request, session));
  const cv::Size size = request.apply.empty() ? request.quilt.size : found.map.size;
  const auto control = make_control(request.control, size, request.quilt.block, request.quilt.seed);
  // The files that may be replaced were checked: an applied map stays unchanged next to the clip.
  io::OutputFolder output(target.folder, io::Existing::all);
  output.protect(inputs);
  if (!can_stream(request, target, clips, control)) clips.load(target.folder, session);
  const FramePlan plan = plan_of(request, clips);
  name_clip(target, request, clips.info(), plan.count);
  if (request.apply.empty()) {
    stages.begin("quilt");
    seek_map(found, clips, request, session);
  }
  stages.begin("render");
  write_quilt_map(output, request, target, found.map, control);
  const auto written = write_quilt_clip(output, target, found.map, clips, control, plan, session);
  stages.begin("write");
  Json summary = summarise(request, target, found, clips, written.frames, session);
  if (target.whole) write_pictures(output, request, found, clips, written.some, summary);
  stages.end();
  summary["seconds"] = stages.seconds();
  summary["peak_memory_mb"] = peak_memory_mb();
  summary["mapped_mb"] = std::round(static_cast<double>(clips.mapped_bytes()) / 1e5) / 10;
  if (target.whole) write_summary(output, summary);
  session.check_stop();
  output.commit();
  session.console.say(std::to_string(written.frames) + (written.frames == 1 ? " frame" : " frames") + " of " +
                      core::size_text(size) + " quilted into " + target.path().string());
  if (session.common.json) session.print(json_text(summary));
}

}  // namespace emberfold::apps
