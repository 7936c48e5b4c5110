// SPDX-License-Identifier: Apache-2.0
#include "apps/sketch_film.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <ostream>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "apps/clip_part.hpp"
#include "apps/draw.hpp"
#include "apps/interrupt.hpp"
#include "apps/overlay.hpp"

namespace emberfold::apps {

namespace {

PanelRow panels(cv::Size frame, const SketchRequest& request) {
  const cv::Mat blank(frame, CV_8UC3);
  // The graph is drawn enlarged; its size decides how high all of them are.
  const cv::Size graph = enlarge(blank, enlargement(frame, OverlayOptions{}.shorter_side)).size();
  const std::array sizes{frame, graph, frame, frame};
  const char* fill = "Reconstruction (diffusion)";
  if (request.ground.kind == sketch::GroundFill::julesz) fill = "Reconstruction (Julesz)";
  if (request.ground.kind == sketch::GroundFill::efros_leung) fill = "Reconstruction (Efros-Leung)";
  return {{"Input", "Graph", request.anchors > 0 ? "Patches and anchors" : "Sketchable part", fill}, sizes};
}

std::string figures(double patch_share, double anchor_share, double psnr, bool anchors) {
  std::array<char, 96> text{};
  if (anchors)
    std::snprintf(text.data(), text.size(), "   patches %04.1f %%   anchors %04.1f %%   PSNR %05.2f dB   ",
                  100 * patch_share, 100 * anchor_share, psnr);
  else
    std::snprintf(text.data(), text.size(), "   patches %04.1f %%   PSNR %05.2f dB   ", 100 * patch_share,
                  psnr);
  return text.data();
}

}  // namespace

SketchFilm::SketchFilm(cv::Size frame, const SketchRequest& request)
    : row_(panels(frame, request)), anchors_(request.anchors > 0) {
  const std::string widest = frame_label(10000000) + figures(1, 1, kMostPsnr, anchors_);
  footer_ = draw_legend(row_.size().width, widest, type_legend()).rows;
}

cv::Mat SketchFilm::picture(const cv::Mat& frame, const graph::AttributeGraph& graph,
                            const SketchedFrame& drawn, int t) const {
  const std::array pictures{frame, draw_type_curves(frame, graph), draw_held(drawn.held),
                            drawn.reconstruction.bytes};
  const cv::Mat row = row_.compose(pictures);
  const auto text =
      frame_label(t) + figures(drawn.patch_share, drawn.anchor_share, drawn.reconstruction.psnr, anchors_);
  const cv::Mat legend = draw_legend(row.cols, text, type_legend());
  cv::Mat whole(row.rows + footer_, row.cols, CV_8UC3, cv::Scalar(246, 248, 250));
  row.copyTo(whole(cv::Rect({}, row.size())));
  const int rows = std::min(footer_, legend.rows);
  legend.rowRange(0, rows).copyTo(whole(cv::Rect(0, row.rows, row.cols, rows)));
  return whole;
}

cv::Mat draw_held(const sketch::Sketchable& held) {
  cv::Mat bytes = core::to_bytes(held.levels);
  bytes.setTo(cv::Scalar::all(kOpenLevel), held.mask == 0);
  return bytes;
}

void write_film_picture(core::FrameSource& source, const SketchRequest& request, const SketchRun& run,
                        OutputFolder& output, const Session& session) {
  session.context.report("picture", 0);
  const auto t = static_cast<int>(run.sketch.frames.size() / 2);
  const auto& info = source.info();
  const auto& graph = run.sketch.frames[static_cast<std::size_t>(t)];
  const cv::Mat frame = ClipPart(source, t, t + 1).next();
  const auto context = session.context.with_progress(
      [&](std::string_view, double share) { session.context.report("picture", share); });
  const auto drawn = draw_sketched(core::to_levels(frame, info), graph, t, request, context);
  const SketchFilm film({info.width, info.height}, request);
  std::vector<unsigned char> png;
  if (!cv::imencode(".png", film.picture(to_colour_bytes(frame, info), graph, drawn, t), png))
    throw core::IoError("cannot encode film.png");
  output.write("film.png", [&](std::ostream& out) {
    out.write(reinterpret_cast<const char*>(png.data()), static_cast<std::streamsize>(png.size()));
  });
}

}  // namespace emberfold::apps
