// SPDX-License-Identifier: Apache-2.0
#include "pipeline/sketch_clip.hpp"

#include <utility>

#include "core/clip/frame_stream.hpp"

namespace emberfold::pipeline {

SketchedClip sketch_clip(core::FrameSource& source, const sketch::ExtractOptions& options,
                         const core::Context& context) {
  struct Frame {
    graph::AttributeGraph graph;
    sketch::FrameBackground ground;
  };
  const auto& info = source.info();
  SketchedClip clip;
  clip.sketch.width = info.width, clip.sketch.height = info.height, clip.sketch.fps = info.fps;
  core::stream_frames(
      source, "sketch", info.frames, context,
      [&](int, const cv::Mat& frame) {
        const cv::Mat levels = core::to_levels(frame, info);
        Frame made{sketch::extract(levels, options), {}};
        made.ground = sketch::measure_background(levels, made.graph);
        return made;
      },
      [&](int, Frame made) {
        clip.sketch.append(made.graph);
        clip.grounds.push_back(std::move(made.ground));
      });
  return clip;
}

}  // namespace emberfold::pipeline
