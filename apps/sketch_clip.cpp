// SPDX-License-Identifier: Apache-2.0
#include "apps/sketch_clip.hpp"

#include <utility>

#include "apps/stream_frames.hpp"

namespace emberfold::apps {

SketchedClip sketch_clip(core::FrameSource& source, const sketch::ExtractOptions& options,
                         const Session& session) {
  struct Frame {
    graph::AttributeGraph graph;
    FrameGround ground;
  };
  const auto& info = source.info();
  SketchedClip clip;
  clip.sketch.width = info.width, clip.sketch.height = info.height, clip.sketch.fps = info.fps;
  stream_frames(
      source, "sketch", info.frames, session.context,
      [&](int, const cv::Mat& frame) {
        const cv::Mat levels = core::to_levels(frame, info);
        Frame made{sketch::extract(levels, options), {}};
        made.ground = measure_ground(levels, made.graph);
        return made;
      },
      [&](int, Frame made) {
        clip.sketch.append(made.graph);
        clip.grounds.push_back(std::move(made.ground));
      });
  return clip;
}

}  // namespace emberfold::apps
