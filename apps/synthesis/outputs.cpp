// SPDX-License-Identifier: Apache-2.0
#include "apps/synthesis/outputs.hpp"

#include <filesystem>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "apps/pictures/draw.hpp"
#include "apps/pictures/overlay.hpp"
#include "core/io/image_files.hpp"
#include "core/io/model_folder.hpp"
#include "core/text/size_text.hpp"
#include "graph/io/motion_io.hpp"

namespace emberfold::apps {

namespace {

namespace fs = std::filesystem;

std::unique_ptr<io::VideoWriter> create_output(const std::string& path, const core::ClipInfo& info) {
  try {
    return io::create_video(path, {info.width, info.height}, info.fps, info.channels == 3);
  } catch (const core::InputError& error) {
    throw Misuse(error.what());
  }
}

/// Reads the training frames of the model; none where it holds none.
pipeline::Footage clip_of(const std::string& folder, const core::ClipInfo& info) {
  auto clip = pipeline::read_footage(io::read_model(folder, io::kMotionFormat), {info.width, info.height});
  return clip.channels == info.channels ? clip : pipeline::Footage{};
}

cv::Mat resized(const cv::Mat& frame, cv::Size size) {
  if (frame.size() == size) return frame;
  cv::Mat out;
  cv::resize(frame, out, size, 0, 0, size.width < frame.cols ? cv::INTER_AREA : cv::INTER_LANCZOS4);
  return out;
}

/// Reads the picture of --alpha, of the size of the model's frames or of the new clip's.
cv::Mat read_ground(const std::string& path, cv::Size frame, cv::Size written) {
  const auto picture = io::read_image(path).pixels;
  if (picture.size() != frame && picture.size() != written)
    throw Misuse("--alpha " + path + " is " + core::size_text(picture.size()) + "; the clip is " +
                 core::size_text(frame));
  if (picture.depth() == CV_32F) throw Misuse("--alpha " + path + " holds floats; give 8 or 16 bits");
  core::ClipInfo info;
  info.white = picture.depth() == CV_16U ? 65535 : 255;
  info.depth = picture.depth(), info.channels = picture.channels();
  return to_colour_bytes(picture, info);
}

/// Returns the background that becomes transparent.
pipeline::Ground ground_of(const SynthRequest& asked, const core::ClipInfo& info, cv::Size written,
                           const pipeline::Footage& clip) {
  const cv::Size frame(info.width, info.height);
  pipeline::Ground ground;
  if (asked.alpha == "black" || asked.alpha == "white") {
    ground.levels = cv::Mat(frame, CV_8U, cv::Scalar(asked.alpha == "white" ? 255 : 0));
  } else if (asked.alpha == "ground") {
    if (clip.empty())
      throw Misuse("--alpha ground needs the clip's frames, which " + asked.model +
                   " does not hold; give black, white or a picture");
    ground = pipeline::still_ground(pipeline::decode(clip));
  } else {
    ground.levels = read_ground(asked.alpha, frame, written);
  }
  ground.levels = resized(ground.levels, written);
  return ground;
}

}  // namespace

SynthOutputs::SynthOutputs(const SynthRequest& asked, const pipeline::ClipSynthesis& frames)
    : asked_(asked), info_(frames.info()), written_(info_) {
  const cv::Size size = output_size(asked, {info_.width, info_.height});
  written_.width = size.width, written_.height = size.height;
  const bool with_clip = asked.alpha == "ground" || !asked.film.empty();
  const auto clip = with_clip ? clip_of(asked.model, info_) : pipeline::Footage{};
  if (!asked.alpha.empty()) {
    ground_ = ground_of(asked, info_, size, clip);
    if (fs::path(asked.output).extension() == ".exr") light_ = pipeline::Light::linear;
  }
  clip_ = create_output(asked.output, written_);
  if (!asked.motion.empty()) motion_file_.emplace(asked.motion);
  const bool with_graphs = !asked.motion.empty() || !asked.overlay.empty() || !asked.film.empty();
  if (with_graphs) motion_ = frames.motion(asked.frames);
  if (!asked.overlay.empty()) events_ = graph::stroke_events(*motion_);
  if (asked.film.empty()) return;
  try {
    film_.emplace(asked.film, clip, info_, asked.frames);
  } catch (const core::InputError& error) {
    throw Misuse(error.what());
  }
}

cv::Mat SynthOutputs::written_frame(const cv::Mat& frame) const {
  const cv::Mat sized = resized(frame, {written_.width, written_.height});
  return ground_ ? pipeline::with_opacity(sized, *ground_, light_) : sized;
}

void SynthOutputs::write(const cv::Mat& frame) {
  clip_->write(written_frame(frame));
  const int t = frames_++;
  if (film_) film_->add(frame, motion_->sketch.frames[static_cast<std::size_t>(t)]);
  if (asked_.overlay.empty()) return;
  const cv::Mat shown = draw_overlay(to_colour_bytes(frame, info_),
                                     motion_->sketch.frames[static_cast<std::size_t>(t)], t, events_);
  if (!overlay_) {
    core::ClipInfo info = info_;
    info.width = shown.cols, info.height = shown.rows, info.channels = 3;
    overlay_ = create_output(asked_.overlay, info);
  }
  overlay_->write(shown);
}

void SynthOutputs::finish() {
  if (motion_file_) {
    motion_->sketch.frames.resize(static_cast<std::size_t>(frames_));
    motion_->links.resize(static_cast<std::size_t>(frames_));
    motion_file_->write([&](std::ostream& out) { graph::write_motion(out, *motion_); });
  }
  if (overlay_) overlay_->finish();
  if (film_) film_->finish();
  if (motion_file_) motion_file_->finish();
  clip_->finish();
}

}  // namespace emberfold::apps
