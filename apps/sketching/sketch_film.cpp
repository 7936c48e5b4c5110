// SPDX-License-Identifier: Apache-2.0
#include "apps/sketching/sketch_film.hpp"

#include <array>
#include <ostream>
#include <string>

#include <opencv2/core.hpp>

#include "apps/cli/interrupt.hpp"
#include "apps/pictures/draw.hpp"
#include "apps/pictures/overlay.hpp"
#include "apps/pictures/png.hpp"
#include "core/clip/clip_range.hpp"
#include "core/text/format_number.hpp"

namespace emberfold::apps {

namespace {

PanelRow panel_row(cv::Size frame) {
  const cv::Mat blank(frame, CV_8UC3);
  // The graph is drawn enlarged; its height is that of all panels.
  const cv::Size graph = enlarge(blank, enlargement(frame, OverlayOptions{}.shorter_side)).size();
  return PanelRow(std::array{frame, graph, frame, frame});
}

const char* fill_label(sketch::FillMethod fill) {
  if (fill == sketch::FillMethod::julesz) return "Julesz texture";
  return fill == sketch::FillMethod::efros_leung ? "Efros-Leung texture" : "diffusion";
}

}  // namespace

SketchFilm::SketchFilm(cv::Size frame, const SketchRequest& request)
    : row_(panel_row(frame)), anchors_(request.anchors > 0), fill_(fill_label(request.ground.kind)) {}

cv::Mat SketchFilm::picture(const cv::Mat& frame, const graph::AttributeGraph& graph,
                            const SketchedFrame& drawn, int t) const {
  const std::array pictures{frame, draw_type_curves(frame, graph), draw_sketchable(drawn.sketchable),
                            drawn.reconstruction.bytes};
  const auto percent = [](double share) { return core::fixed_text(100 * share, 1) + " %"; };
  const std::string part =
      anchors_ ? "Patches " + percent(drawn.patch_share) + ", anchors " + percent(drawn.anchor_share)
               : "Sketchable part, " + percent(drawn.patch_share);
  const std::array<std::string, 4> labels{
      "Input", "Graph", part,
      "Reconstruction, " + fill_ + ", " + core::fixed_text(drawn.reconstruction.psnr, 1) + " dB"};
  const cv::Mat row = row_.compose(pictures, labels);
  const cv::Mat legend = draw_legend(row.cols, frame_label(t), type_legend());
  cv::Mat whole;
  cv::vconcat(row, legend, whole);
  return whole;
}

cv::Mat draw_sketchable(const sketch::Sketchable& held) {
  cv::Mat bytes = core::to_bytes(held.levels);
  bytes.setTo(cv::Scalar::all(kOpenLevel), held.mask == 0);
  return bytes;
}

void write_film_picture(core::FrameSource& source, const SketchRequest& request, const SketchRun& run,
                        io::OutputFolder& output, const Session& session) {
  session.context.report("picture", 0);
  const auto t = static_cast<int>(run.sketch.frames.size() / 2);
  const auto& info = source.info();
  const auto& graph = run.sketch.frames[static_cast<std::size_t>(t)];
  const cv::Mat frame = core::ClipRange(source, t, t + 1).next();
  const auto context = session.context.with_progress(
      [&](std::string_view, double share) { session.context.report("picture", share); });
  const auto drawn = draw_sketched(core::to_levels(frame, info), graph, t, request, context);
  const SketchFilm film({info.width, info.height}, request);
  write_png(output, "film.png", film.picture(to_colour_bytes(frame, info), graph, drawn, t));
}

}  // namespace emberfold::apps
