// SPDX-License-Identifier: Apache-2.0
#include "apps/report/report_strip.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "apps/pictures/draw.hpp"
#include "apps/report/report.hpp"
#include "core/io/clip_writer.hpp"
#include "core/io/files.hpp"

namespace emberfold::apps {

namespace {

int round_to_even(double length) {
  return 2 * std::max(1, static_cast<int>(std::lround(length / 2)));
}

cv::Mat resize_to(const cv::Mat& frame, cv::Size size) {
  cv::Mat out;
  const bool reduced = size.area() < frame.size().area();
  cv::resize(frame, out, size, 0, 0, reduced ? cv::INTER_AREA : cv::INTER_LINEAR);
  return out;
}

// Writes the strip and returns its number of frames.
int write_strip(std::span<const NamedSource> clips, cv::Size cell, int most_frames,
                const std::filesystem::path& path, const Session& session) {
  const auto count = static_cast<int>(clips.size());
  for (const auto& clip : clips) clip.source->rewind();
  const auto writer =
      io::create_video(path, {cell.width * count, cell.height}, clips.front().source->info().fps, true);
  int frames = 0;
  for (; frames < most_frames; ++frames) {
    session.check_stop();
    cv::Mat strip(cell.height, cell.width * count, CV_8UC3);
    for (int i = 0; i < count; ++i) {
      auto& source = *clips[static_cast<std::size_t>(i)].source;
      const cv::Mat frame = source.next();
      if (frame.empty()) {
        writer->finish();
        return frames;
      }
      resize_to(to_colour_bytes(frame, source.info()), cell)
          .copyTo(strip(cv::Rect(i * cell.width, 0, cell.width, cell.height)));
    }
    writer->write(strip);
  }
  writer->finish();
  return frames;
}

std::vector<unsigned char> read_file_bytes(const std::filesystem::path& path) {
  auto stream = io::open_file(path);
  return {std::istreambuf_iterator<char>(stream), {}};
}

}  // namespace

ReportClips make_strip(std::span<const NamedSource> clips, const io::OutputFolder& output,
                       const Session& session) {
  constexpr double kLongest = 400, kLeast = 96;
  const auto& info = clips.front().source->info();
  const double side = std::max(info.width, info.height);
  const auto path = output.staged("strip.mp4");
  ReportClips strip;
  for (const auto& clip : clips) strip.names.push_back(clip.name);
  strip.fps = info.fps;
  int most_frames = 250;
  for (double longest = std::min(kLongest, std::max(side, 16.0));;) {
    strip.width = round_to_even(info.width * longest / side);
    strip.height = round_to_even(info.height * longest / side);
    strip.frames = write_strip(clips, {strip.width, strip.height}, most_frames, path, session);
    strip.mp4 = read_file_bytes(path);
    std::error_code ignored;
    std::filesystem::remove(path, ignored);
    if (strip.mp4.size() <= kClipBytes || strip.frames <= 2) return strip;
    if (longest > kLeast)
      longest = std::max(kLeast, longest * 0.92 * std::sqrt(double(kClipBytes) / double(strip.mp4.size())));
    else
      most_frames = strip.frames / 2;
  }
}

}  // namespace emberfold::apps
