// SPDX-License-Identifier: Apache-2.0
#include "apps/synthesis/request.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <utility>

#include "apps/cli/command_line.hpp"
#include "core/io/clip_writer.hpp"
#include "core/text/size_text.hpp"
#include "pipeline/carried/carried_play.hpp"
#include "pipeline/strokes/stroke_play.hpp"

namespace emberfold::apps {

namespace fs = std::filesystem;

namespace {

/// Returns the given option that requires drawn strokes; empty where none was given.
std::string stroke_option(const SynthRequest& asked) {
  if (!asked.motion.empty()) return "--motion";
  if (!asked.overlay.empty()) return "--overlay";
  if (!asked.film.empty()) return "--film";
  if (asked.start != "data") return "--start";
  return stroke_option(asked.edit);
}

/// Returns the requested edit that is impossible with the clip's own strokes; empty where there is none.
std::string not_carried(const SynthRequest& asked) {
  return asked.start != "data" ? "--start" : pipeline::edit_not_carried(asked.edit.edit);
}

bool is_of_frames(const SynthRequest& asked) {
  return !asked.method || pipeline::shows_frames(*asked.method);
}

/// Chooses transferred strokes where an option needs strokes, drawn ones where it requires these, and rejects
/// options that exclude each other.
void choose_method(SynthRequest& asked) {
  using pipeline::SynthesisMethod;
  const auto option = stroke_option(asked);
  const bool is_texture = asked.method == SynthesisMethod::texture;
  if (!option.empty() && (asked.method == SynthesisMethod::footage || is_texture))
    throw Misuse(option + " is for clips with strokes (--method edit, strokes or diffusion), not " +
                 std::string(name(*asked.method)));
  if (is_texture && changes(asked.edit)) throw Misuse("--speed and --reverse are not for --method texture");
  const auto why = not_carried(asked);
  if (asked.method == SynthesisMethod::edit && !why.empty())
    throw Misuse("--method edit keeps the clip's own strokes; " + why + " needs drawn ones");
  const auto not_again = asked.start != "data" ? "--start" : pipeline::edit_not_repeated(asked.edit.edit);
  if (asked.method == SynthesisMethod::strokes && !not_again.empty())
    throw Misuse("--method strokes shows strokes as they lived in the clip; " + not_again +
                 " needs another --method");
  if (!option.empty() && !asked.method) {
    if (!why.empty())
      asked.drawn_since = why + " needs drawn strokes";
    else if (!pipeline::holds_footage_strokes(asked.model))
      asked.drawn_since = "strokes are drawn, since the model holds none of its clip's frames";
    asked.method = asked.drawn_since.empty() ? SynthesisMethod::edit : SynthesisMethod::diffusion;
  }
  if (asked.loop && !is_of_frames(asked))
    throw Misuse("--loop is for --method footage and edit, not " + std::string(name(*asked.method)) +
                 (asked.drawn_since.empty() ? "" : ": " + asked.drawn_since));
  if (asked.loop && *asked.loop < 2)
    throw Misuse("--loop is " + std::to_string(*asked.loop) + "; allowed is 2 or more");
  if (asked.loop && !asked.asked_frames) asked.frames = *asked.loop;
}

/// Checks the size and the opacity.
void check_pictures(const SynthRequest& asked) {
  constexpr int kMostSide = 16384;
  for (const auto& [side, what] : {std::pair(asked.width, "--width"), std::pair(asked.height, "--height")})
    if (side && (*side < 1 || *side > kMostSide))
      throw Misuse(std::string(what) + " is " + std::to_string(*side) + "; allowed is 1 to " +
                   std::to_string(kMostSide) + " px");
  if (!asked.alpha.empty() && !io::is_frame_folder(asked.output))
    throw Misuse("--alpha needs a folder of PNG (-o DIR) or of EXR (-o DIR/new_%05d.exr), not " +
                 asked.output);
}

}  // namespace

void check(SynthRequest& asked) {
  if (asked.frames < 1 || asked.frames > 1'000'000)
    throw Misuse("--frames is " + std::to_string(asked.frames) + "; allowed is 1 to 1000000");
  check(asked.edit);
  choose_method(asked);
  check_pictures(asked);
}

cv::Size output_size(const SynthRequest& asked, cv::Size frame) {
  if (!asked.width && !asked.height) return frame;
  const double shape = double(frame.width) / frame.height;
  cv::Size size(asked.width.value_or(0), asked.height.value_or(0));
  if (!asked.width) size.width = std::max(1, static_cast<int>(std::lround(*asked.height * shape)));
  if (!asked.height) size.height = std::max(1, static_cast<int>(std::lround(*asked.width / shape)));
  if (std::abs(size.width - size.height * shape) > std::max(2.0, 0.01 * size.width))
    throw Misuse("--width " + std::to_string(size.width) + " and --height " + std::to_string(size.height) +
                 " would distort frames of " + core::size_text(frame) + "; give one of them");
  return size;
}

}  // namespace emberfold::apps
