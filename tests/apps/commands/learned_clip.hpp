// SPDX-License-Identifier: Apache-2.0
// What the tests of synth draw from: a made clip and the model that analyze makes of it.
#pragma once

#include <fstream>
#include <string>

#include <opencv2/core.hpp>

#include "apps/builtin/open_clip.hpp"
#include "core/io/clip_reader.hpp"
#include "core/io/clip_writer.hpp"
#include "tests/apps/commands/command_check.hpp"
#include "tests/support/read_clip.hpp"

namespace emberfold::test {

/// A clip of strokes that move, and what analyze makes of it.
struct LearnedClip {
  TempFolder temp;
  std::string clip, model;

  explicit LearnedClip(int frames = 24, bool colour = true) {
    const auto strokes = made_strokes(8, 160, 120, frames);
    const auto writer = io::create_video(temp / "clip", {160, 120}, 25, colour);
    for (int t = 0; t < frames; ++t) {
      cv::Mat picture = made_picture(strokes, 160, 120, t);
      if (!colour) cv::extractChannel(picture, picture, 1);
      writer->write(picture);
    }
    writer->finish();
    clip = (temp / "clip").string();
    model = (temp / "a/model").string();
    const auto result = run_command({"analyze", clip, "-o", (temp / "a").string(), "-q"});
    INFO(result.err);
    REQUIRE(result.exit == 0);
  }
};

inline void replace_in(const std::filesystem::path& file, const std::string& from, const std::string& to) {
  std::string text = bytes_of(file);
  const auto at = text.find(from);
  REQUIRE(at != std::string::npos);
  text.replace(at, from.size(), to);
  std::ofstream(file, std::ios::binary) << text;
}

}  // namespace emberfold::test
