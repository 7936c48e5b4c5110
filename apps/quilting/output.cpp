// SPDX-License-Identifier: Apache-2.0
#include "apps/quilting/output.hpp"

#include <memory>
#include <utility>

#include <opencv2/core.hpp>

#include "apps/pictures/draw.hpp"
#include "core/io/clip_writer.hpp"
#include "core/npy.hpp"

namespace emberfold::apps {

namespace fs = std::filesystem;

QuiltTarget quilt_target(const QuiltRequest& request) {
  const fs::path output = request.output;
  QuiltTarget target;
  target.whole = output.extension().empty();
  target.folder = target.whole ? output : output.parent_path();
  if (target.folder.empty()) target.folder = ".";
  if (!target.whole) target.clip = output.filename().string();
  if (!target.whole && !fs::is_directory(target.folder))
    throw core::IoError("cannot write " + request.output + ": there is no folder " + target.folder.string());
  return target;
}

void name_clip(QuiltTarget& target, const QuiltRequest& request, const core::ClipInfo& info,
               std::int64_t frames) {
  const bool deep = info.depth != CV_8U;
  const std::string bits =
      ", but " + request.clips.front() + (info.depth == CV_32F ? " has floats" : " has 16");
  if (!target.whole) {
    target.single = fs::path(target.clip).extension() == ".png";
    if (target.single && frames != 1)
      throw Misuse("-o " + request.output + " is one image, but there are " + std::to_string(frames) +
                   " frames; --frame N draws one of them");
    if (!target.single && deep)
      throw Misuse("-o " + request.output + ": videos hold 8 bits" + bits +
                   "; give a folder, where PNG holds them");
    return;
  }
  const std::string format = !request.format.empty() ? request.format : deep ? "png" : "mp4";
  if (format != "png" && deep)
    throw Misuse("quilt.format " + format + " holds 8 bits" + bits + "; png holds them");
  target.single = frames == 1;
  if (request.frame)
    target.clip = "frame_" + std::to_string(*request.frame) + ".png";
  else
    target.clip = target.single ? "quilt.png" : format == "png" ? "frames" : "quilt." + format;
}

namespace {

core::NpyArray time_array(const dytex::TimeControl& control, cv::Size size) {
  std::vector<float> values;
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      values.push_back(control.rate.empty() ? 1.0F : control.rate.at<float>(y, x));
      values.push_back(control.offset.empty() ? 0.0F : control.offset.at<float>(y, x));
    }
  return {{static_cast<std::size_t>(size.height), static_cast<std::size_t>(size.width), 2},
          false,
          std::move(values)};
}

}  // namespace

bool keeps_map(const QuiltRequest& request, const QuiltTarget& target) {
  std::error_code none;
  return !request.apply.empty() && fs::equivalent(target.folder / "map.npy", request.apply, none);
}

void write_quilt_map(io::OutputFolder& output, const QuiltRequest& request, const QuiltTarget& target,
                     const dytex::QuiltMap& map, const dytex::TimeControl& control) {
  const auto array = dytex::to_array(map);
  if (!keeps_map(request, target))
    output.write("map.npy", [&](std::ostream& out) { core::write_npy(out, array); });
  if (control.plain()) return;
  const auto times = time_array(control, map.size);
  output.write("time.npy", [&](std::ostream& out) { core::write_npy(out, times); });
}

WrittenClip write_quilt_clip(io::OutputFolder& output, const QuiltTarget& target, const dytex::QuiltMap& map,
                             const QuiltClips& clips, const dytex::TimeControl& control,
                             const FramePlan& plan, Session& session) {
  const auto& info = clips.info();
  WrittenClip written;
  std::unique_ptr<io::VideoWriter> writer;
  if (!target.single)
    writer = io::create_video(output.staged(target.clip), map.size, info.fps, info.channels == 3);
  const auto take = [&](const cv::Mat& drawn) {
    cv::Mat frame = drawn;  // PNG stores floats as 16 bits
    if (info.depth == CV_32F) drawn.convertTo(frame, CV_16U, 65535 / info.white);
    if (writer)
      writer->write(frame);
    else
      write_png(output.staged(target.clip), target.path(), frame);
    const std::int64_t t = written.frames++;
    if (t == 0 || t == plan.count / 2 || t == plan.count - 1)
      written.some.push_back({static_cast<int>(plan.first + t), to_colour_bytes(drawn, info)});
  };
  render_frames(map, clips, control, plan.first, plan.count, plan.to_end, take, session);
  if (writer) writer->finish();
  return written;
}

}  // namespace emberfold::apps
