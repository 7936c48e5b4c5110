// SPDX-License-Identifier: Apache-2.0
#include "apps/quilting/write.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>

#include <opencv2/imgcodecs.hpp>

#include "apps/cli/interrupt.hpp"
#include "core/parallel.hpp"

namespace emberfold::apps {

namespace {

double bytes_of_frame(cv::Size size, const core::ClipInfo& info) {
  return static_cast<double>(size.width) * size.height * info.channels *
         static_cast<double>(CV_ELEM_SIZE1(info.depth));
}

void render_held(const dytex::QuiltMap& map, const QuiltClips& clips, const dytex::TimeControl& control,
                 std::int64_t first, std::int64_t count, const std::function<void(const cv::Mat&)>& take,
                 Session& session) {
  const auto held = clips.loaded();
  // Two batches are in memory: one being drawn, one being handed on.
  const auto batch =
      static_cast<std::int64_t>(std::clamp(96e6 / bytes_of_frame(map.size, held.front()->info()), 1.0,
                                           static_cast<double>(held.front()->chunk_frames())));
  std::vector<cv::Mat> drawn, ready;
  for (std::int64_t at = 0; at < count || !drawn.empty(); at += batch) {
    ready.swap(drawn);
    const auto now = static_cast<int>(std::clamp<std::int64_t>(count - at, 0, batch));
    core::parallel_for(2, {}, [&](std::size_t task) {
      if (task == 0)
        for (const auto& frame : ready) take(frame);
      else
        drawn = dytex::render_quilt(map, held, control, first + at, now);
    });
    session.check_stop();
    session.context.report("render", std::min(1.0, static_cast<double>(at) / static_cast<double>(count)));
  }
}

}  // namespace

bool is_streamable(const dytex::TimeControl& control, std::int64_t frames, const core::ClipInfo& info,
                   std::size_t memory) {
  const auto held = dytex::streamable(control, frames);
  return held && static_cast<double>(*held) * bytes_of_frame({info.width, info.height}, info) <
                     std::max(64e6, static_cast<double>(memory) / 2);
}

void render_frames(const dytex::QuiltMap& map, const QuiltClips& clips, const dytex::TimeControl& control,
                   std::int64_t first, std::int64_t count, bool to_end,
                   const std::function<void(const cv::Mat&)>& take, Session& session) {
  session.context.report("render", 0);
  if (clips.is_loaded()) {
    render_held(map, clips, control, first, count, take, session);
    return;
  }
  dytex::QuiltStream stream(map, clips.sources(), control);
  for (std::int64_t t = 0; t < first + count; ++t) {
    const cv::Mat frame = stream.next();
    if (to_end && stream.ended()) break;
    if (t >= first) take(frame);
    session.check_stop();
    session.context.report("render", static_cast<double>(t + 1) / static_cast<double>(first + count));
  }
}

void write_png(const std::filesystem::path& path, const std::filesystem::path& shown,
               const cv::Mat& picture) {
  std::vector<unsigned char> bytes;
  if (!cv::imencode(".png", picture, bytes))
    throw core::IoError("cannot write " + shown.string() + " as PNG");
  errno = 0;
  std::ofstream out(path, std::ios::binary | std::ios::trunc);
  out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  out.close();
  if (!out)
    throw core::IoError("cannot write " + shown.string() + ": " +
                        (errno != 0 ? std::strerror(errno) : "the disk may be full"));
}

}  // namespace emberfold::apps
