// SPDX-License-Identifier: Apache-2.0
#include "core/io/clip_writer.hpp"

#include <algorithm>
#include <cctype>
#include <memory>
#include <sstream>
#include <string>

#include "core/error.hpp"
#include "core/io/writing/frame_sequence.hpp"
#include "core/io/writing/video_file.hpp"

namespace emberfold::io {

namespace fs = std::filesystem;

bool is_frame_folder(const fs::path& path) {
  return !path.empty() && sequence_name(path).has_value();
}

std::unique_ptr<VideoWriter> create_video(const fs::path& path, cv::Size size, double fps, bool colour) {
  const auto refuse = [&](const auto& value, const char* what, const char* allowed) {
    std::ostringstream line;
    line << what << " " << value << " is out of range: " << allowed;
    throw core::InputError(line.str());
  };
  if (size.width < 1 || size.width > 16384) refuse(size.width, "a clip's width", "1 to 16384 pixels");
  if (size.height < 1 || size.height > 16384) refuse(size.height, "a clip's height", "1 to 16384 pixels");
  if (!(fps > 0 && fps <= 1e6)) refuse(fps, "a clip's frame rate", "above 0, at most 1e6 a second");
  if (fps < 1 || fps > 1000) fps = 25;  // players would show a slide show or nothing
  if (path.empty()) throw core::InputError("the name of the clip to write is empty");

  const auto sequence = sequence_name(path);
  const fs::path target = sequence ? sequence->folder : fs::absolute(path).lexically_normal();
  const fs::path folder = target.parent_path();
  if (!fs::is_directory(folder))
    throw core::IoError("cannot write " + path.string() + ": there is no folder " + folder.string());
  if (sequence) return create_sequence(*sequence, size, colour);
  std::string extension = target.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (extension == ".mp4" || extension == ".avi")
    return create_video_file(target, extension == ".mp4", size, fps, colour);
  throw core::InputError("cannot write a clip as " + target.extension().string() +
                         "; give a name in .mp4 (H.264), .avi (lossless), without extension (a folder of "
                         "PNG), or a pattern (frames/new_%05d.png or .exr)");
}

void write_video(const fs::path& path, core::FrameSource& source, int frames, const core::Context& context) {
  const auto& info = source.info();
  if (info.depth != CV_8U)
    throw core::InputError("cannot write " + path.string() + ": its frames must have 8 bits a channel");
  const auto writer = create_video(path, {info.width, info.height}, info.fps, info.channels == 3);
  for (int t = 0; t < frames; ++t) {
    context.check();
    const cv::Mat frame = source.next();
    if (frame.empty()) break;
    writer->write(frame);
    context.report("write", static_cast<double>(t + 1) / frames);
  }
  writer->finish();
}

}  // namespace emberfold::io
