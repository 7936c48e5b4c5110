// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "apps/cli/command.hpp"
#include "apps/sketching/given_evidence.hpp"
#include "core/clip.hpp"
#include "core/io/staged_output.hpp"
#include "graph/motion_graph.hpp"
#include "pipeline/reconstruct.hpp"
#include "pipeline/sketch_clip.hpp"
#include "sketch/extract.hpp"
#include "sketch/texture/texture_fill.hpp"

// `emberfold sketch`: sketches and reconstructs the frames of a clip.
namespace emberfold::apps {

/// The request of `emberfold sketch`.
struct SketchRequest {
  sketch::ExtractOptions extract = pipeline::kPictureSketch;
  sketch::NonsketchableFillOptions ground;  ///< its seed is the clip's; every frame has its own stream
  pipeline::PatchDrawing patches = pipeline::PatchDrawing::fitted;
  double anchors = 0.2;       ///< 0…1: share of the frame in patches and anchors together; 0: no anchors
  bool keep_anchors = false;  ///< in sketch.jsonl
  bool film = false;          ///< film.mp4 and film.png
  std::optional<int> heat_frame = {};  ///< heat.mp4 of this frame
  GivenEvidence* evidence = nullptr;   ///< replaces the curves' own evidence
  std::int64_t first_frame = 0;        ///< start of the clip's part: streams are keyed by the clip's frame
};

/// The reconstruction of a frame.
struct SketchedFrame {
  double patch_share = 0, anchor_share = 0;  ///< of the pixels, 0…1
  graph::AttributeGraph graph;               ///< with the anchors
  sketch::Sketchable sketchable;             ///< patches and anchors
  pipeline::Reconstruction reconstruction;
};

/// Reconstructs a frame from its graph, with anchors on request. `levels`: CV_32F, white = 255; `t`: its
/// number in the clip's part. Throws core::Cancelled.
SketchedFrame draw_sketched(const cv::Mat& levels, const graph::AttributeGraph& graph, int t,
                            const SketchRequest& request, const core::Context& context);

/// The figures of each frame.
struct FrameFigures {
  std::vector<double> patches, patch_share, anchor_share, psnr, regions, histogram_distance;
  int not_converged = 0;
  int without_room = 0;  ///< frames whose patches alone reach the requested share
  void add(const SketchedFrame& frame, std::size_t patch_count, const SketchRequest& request);
};

/// The sketches, without anchors, and figures of a clip.
struct SketchRun {
  graph::SketchSequence sketch;
  FrameFigures figures;
};

/// Sketches the clip, several frames at once, and writes overlay.mp4, reconstruction.avi and, on request,
/// film.mp4; sketch.jsonl goes to `lines`. Throws core::Cancelled.
SketchRun sketch_frames(core::FrameSource& source, const SketchRequest& request, std::ostream& lines,
                        io::OutputFolder& output, const Session& session);

}  // namespace emberfold::apps
