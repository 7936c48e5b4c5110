// SPDX-License-Identifier: Apache-2.0
#include "pipeline/sketch_clip.hpp"

#include <utility>

#include "pipeline/masked_sketch.hpp"
#include "sketch/background/still_background.hpp"

namespace emberfold::pipeline {

SketchedClip sketch_clip(core::FrameSource& source, const sketch::ExtractOptions& options,
                         const core::Context& context, SketchedClip begun, const KeepSketch& keep) {
  struct Frame {
    graph::AttributeGraph graph;
    sketch::FrameBackground ground;
  };
  const auto& info = source.info();
  SketchedClip clip = std::move(begun);
  std::size_t kept = clip.grounds.size();
  const std::size_t at_once = core::frames_at_once(info.width, info.height, info.channels);
  clip.sketch.width = info.width, clip.sketch.height = info.height, clip.sketch.fps = info.fps;
  stream_sketches(
      source, "sketch", context, static_cast<int>(kept), [](int) {},
      [&](int, const cv::Mat& levels, const cv::Mat& mask) {
        auto graph = inside_mask(sketch::extract(levels, options), mask);
        auto ground = sketch::measure_background(levels, graph);
        return Frame{std::move(graph), std::move(ground)};
      },
      [&](int, Frame made) {
        clip.sketch.append(made.graph.kept_in(context.memory()));
        clip.grounds.push_back(std::move(made.ground));
        if (!keep || clip.grounds.size() - kept < at_once) return;
        keep(clip, kept);
        kept = clip.grounds.size();
      });
  if (keep && kept < clip.grounds.size()) keep(clip, kept);
  return clip;
}

}  // namespace emberfold::pipeline
