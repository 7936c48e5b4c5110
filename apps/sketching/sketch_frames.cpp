// SPDX-License-Identifier: Apache-2.0
#include "apps/sketching/sketch_frames.hpp"

#include <memory>

#include "apps/pictures/draw.hpp"
#include "apps/pictures/overlay.hpp"
#include "apps/sketching/sketch_film.hpp"
#include "apps/sketching/sketch_progress.hpp"
#include "core/io/clip_writer.hpp"
#include "core/rng.hpp"
#include "graph/io/motion_io.hpp"
#include "pipeline/masked_sketch.hpp"

namespace emberfold::apps {

namespace {

struct Made {
  graph::AttributeGraph graph;
  SketchedFrame drawn;
  cv::Mat overlay, film;
};

// Returns the approximate share of sketching in a frame's time; only for the progress.
double sketch_part(const SketchRequest& request) {
  if (request.ground.kind != sketch::FillMethod::diffusion) return 0.02;
  return request.anchors > 0 ? 0.15 : 0.6;
}

// The videos of the run, each opened with its first frame.
class SketchVideos {
 public:
  SketchVideos(io::OutputFolder& output, const core::ClipInfo& info)
      : output_(output),
        fps_(info.fps),
        reconstruction_(io::create_video(output.staged("reconstruction.avi"), {info.width, info.height},
                                         info.fps, info.channels == 3)) {}
  void write(const Made& made) {
    reconstruction_->write(made.drawn.reconstruction.bytes);
    add(overlay_, "overlay.mp4", made.overlay);
    if (!made.film.empty()) add(film_, "film.mp4", made.film);
  }
  void finish() {
    for (auto* writer : {&reconstruction_, &overlay_, &film_})
      if (*writer) (*writer)->finish();
  }

 private:
  void add(std::unique_ptr<io::VideoWriter>& writer, const char* name, const cv::Mat& frame) {
    if (!writer) writer = io::create_video(output_.staged(name), frame.size(), fps_, true);
    writer->write(frame);
  }

  io::OutputFolder& output_;
  double fps_;
  std::unique_ptr<io::VideoWriter> reconstruction_, overlay_, film_;
};

}  // namespace

SketchedFrame draw_sketched(const cv::Mat& levels, const graph::AttributeGraph& graph, int t,
                            const SketchRequest& request, const core::Context& context) {
  constexpr std::uint32_t kStream = 0x66696c6c;  // separate from other draws with the seed
  const auto frame = static_cast<std::uint64_t>(request.first_frame + t);
  core::Rng rng(request.ground.seed,
                {static_cast<std::uint32_t>(frame), static_cast<std::uint32_t>(frame >> 32), kStream});
  sketch::NonsketchableFillOptions ground = request.ground;
  const std::uint64_t high = rng.bits();
  ground.seed = high << 32 | rng.bits();
  SketchedFrame result;
  result.graph = pipeline::add_anchors(graph, levels, request.patches, request.anchors);
  result.sketchable = pipeline::draw_patches(levels, result.graph, request.patches);
  context.check();
  result.reconstruction = pipeline::reconstruct(levels, result.sketchable, ground, context);
  result.anchor_share =
      static_cast<double>(result.graph.size() - graph.size()) / static_cast<double>(levels.total());
  result.patch_share = result.reconstruction.share - result.anchor_share;
  return result;
}

void FrameFigures::add(const SketchedFrame& frame, std::size_t patch_count, const SketchRequest& request) {
  patches.push_back(static_cast<double>(patch_count));
  patch_share.push_back(frame.patch_share);
  anchor_share.push_back(frame.anchor_share);
  psnr.push_back(frame.reconstruction.psnr);
  regions.push_back(frame.reconstruction.regions);
  histogram_distance.push_back(frame.reconstruction.histogram_distance);
  not_converged += frame.reconstruction.converged ? 0 : 1;
  without_room += request.anchors > 0 && frame.patch_share >= request.anchors ? 1 : 0;
}

SketchRun sketch_frames(core::FrameSource& source, const SketchRequest& request, std::ostream& lines,
                        io::OutputFolder& output, const Session& session) {
  const auto& info = source.info();
  graph::SketchWriter writer(lines, info.width, info.height, info.fps);
  SketchRun run;
  run.sketch.width = info.width, run.sketch.height = info.height, run.sketch.fps = info.fps;
  SketchVideos videos(output, info);
  const SketchFilm film({info.width, info.height}, request);
  const double part = sketch_part(request);
  FrameProgress progress(session.context, "sketch", info.frames);
  const sketch::ExtractOptions& extract = request.extract;
  pipeline::stream_sketches(
      source, "sketch", session.context, 0,
      [&](int t) {
        if (request.evidence != nullptr) request.evidence->read(t);
      },
      [&](int t, const cv::Mat& levels, const cv::Mat& mask) {
        const auto graph = request.evidence != nullptr
                               ? sketch::extract(levels, extract, request.evidence->take(t))
                               : sketch::extract(levels, extract);
        progress.report(t, part);
        Made made{pipeline::inside_mask(graph, mask), {}, {}, {}};
        const auto context = progress.step(t, part);
        context.report("sketch", 0);
        made.drawn = draw_sketched(levels, made.graph, t, request, context);
        const cv::Mat bytes = to_colour_bytes(levels);
        made.overlay = draw_types(bytes, made.graph, t);
        if (request.film) made.film = film.picture(bytes, made.graph, made.drawn, t);
        made.drawn.sketchable = {};
        progress.report(t, 1);
        return made;
      },
      [&](int, const Made& made) {
        videos.write(made);
        writer.add(request.keep_anchors ? made.drawn.graph : made.graph);
        run.sketch.append(made.graph);
        run.figures.add(made.drawn, made.graph.size(), request);
      });
  writer.finish();
  if (!run.sketch.frames.empty()) videos.finish();
  return run;
}

}  // namespace emberfold::apps
