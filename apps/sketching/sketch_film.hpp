// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <opencv2/core/mat.hpp>

#include "apps/pictures/side_by_side.hpp"
#include "apps/sketching/sketch_frames.hpp"
#include "graph/attribute_graph.hpp"

namespace emberfold::apps {

/// The level of what a picture of the sketchable part leaves open.
constexpr double kOpenLevel = 128;

/// The pictures of film.mp4: input, graph, sketchable part on grey, reconstruction, with the frame's figures
/// (Guo, Zhu & Wu 2007, Figs. 2 and 3). All of a clip have the same size.
class SketchFilm {
 public:
  SketchFilm(cv::Size frame, const SketchRequest& request);
  /// `frame`: CV_8UC3.
  [[nodiscard]] cv::Mat picture(const cv::Mat& frame, const graph::AttributeGraph& graph,
                                const SketchedFrame& drawn, int t) const;

 private:
  PanelRow row_;
  bool anchors_;
  std::string fill_;
};

/// What is held, on grey; CV_8U.
cv::Mat draw_held(const sketch::Sketchable& held);

/// Writes film.png, the picture of the clip's middle frame, which is read and drawn again.
void write_film_picture(core::FrameSource& source, const SketchRequest& request, const SketchRun& run,
                        io::OutputFolder& output, const Session& session);

}  // namespace emberfold::apps
