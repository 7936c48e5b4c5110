// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <opencv2/core/mat.hpp>

#include "apps/pictures/side_by_side.hpp"
#include "apps/sketching/sketch_frames.hpp"
#include "graph/attribute_graph.hpp"

namespace emberfold::apps {

/// The grey level of pixels outside the sketchable part: the middle of 0…255.
constexpr double kOpenLevel = 128;

/// Draws the pictures of film.mp4: input, graph, sketchable part on grey, reconstruction, with the frame's
/// figures (Guo, Zhu & Wu 2007, Figs. 2 and 3). All pictures of a clip have one size.
class SketchFilm {
 public:
  SketchFilm(cv::Size frame, const SketchRequest& request);
  /// Draws the picture of frame t. `frame`: CV_8UC3.
  [[nodiscard]] cv::Mat picture(const cv::Mat& frame, const graph::AttributeGraph& graph,
                                const SketchedFrame& drawn, int t) const;

 private:
  PanelRow row_;
  bool anchors_;
  std::string fill_;
};

/// Draws the sketchable part on grey, CV_8U.
cv::Mat draw_sketchable(const sketch::Sketchable& held);

/// Reads the clip's middle frame again and writes its picture, film.png.
void write_film_picture(core::FrameSource& source, const SketchRequest& request, const SketchRun& run,
                        io::OutputFolder& output, const Session& session);

}  // namespace emberfold::apps
