// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "apps/ground.hpp"
#include "core/context.hpp"
#include "graph/attribute_graph.hpp"
#include "sketch/fill.hpp"
#include "sketch/render.hpp"

namespace emberfold::apps {

/// A frame of which patches show a part and diffusion the rest.
struct DrawnFrame {
  cv::Mat levels;    ///< CV_32F, white = 255
  double share = 0;  ///< that patches show, 0…1
  bool converged = true;
};

/// Fills what `part` and the still ground (with_ground) leave open; with nothing held the frame becomes
/// `empty`, levels by channel.
DrawnFrame draw_around(const sketch::Sketchable& part, const cv::Scalar& empty,
                       const sketch::FillOptions& options, const WholeGround& ground = {},
                       const cv::Mat& presence = {});

/// What the frames of a clip of graphs have in common.
struct FrameLook {
  cv::Size size;
  int channels = 3;       ///< 1 or 3
  float empty_level = 0;  ///< of a frame without patches and ground, white = 255
  sketch::FillOptions fill = {};
  Ground ground = {};
  double blur_share = 1;     ///< of their fitted blur that patches are drawn with, 0…1 (sharpening.hpp)
  double contrast_gain = 1;  ///< of their contrast, ≥ 1
  /// Graphs drawn from a model, not seen: patches take the levels of where they are, those of a frame's
  /// ground (rest_on_ground.hpp), and none that the clip never had there (seen_levels.hpp).
  bool new_places = false;
};

/// A frame to be drawn: its strokes, and what lies between them.
struct FrameParts {
  graph::AttributeGraph graph;
  cv::Mat ground = {};  ///< CV_8U, as the frame: the strokes are joined into it; empty: the fill, look.ground
  /// How much of each patch is there, 0…1, for those that come and go: its levels lie between its own and
  /// what would be there without it. Empty: all of all.
  std::vector<float> presence = {};
  cv::Mat residual = {};  ///< CV_8S, as the frame: added to all but the backdrop
};

/// The patches of which at least half is there.
graph::AttributeGraph mostly_there(const FrameParts& parts);

/// Draws frames of one look, which it keeps what they share of.
class FramePainter {
 public:
  explicit FramePainter(const FrameLook& look);
  /// The frame that a graph tells of: patches drawn from their attributes; around them the given ground,
  /// which takes the strokes' levels beside them, or, without one, the still ground away from them and the
  /// rest filled. CV_8U.
  [[nodiscard]] cv::Mat draw(const FrameParts& parts) const;

 private:
  FrameLook look_;
  WholeGround still_;
};
inline cv::Mat draw_frame(const FrameParts& parts, const FrameLook& look) {
  return FramePainter(look).draw(parts);
}
inline cv::Mat draw_frame(const graph::AttributeGraph& graph, const FrameLook& look) {
  return draw_frame(FrameParts{graph}, look);
}

/// Draws these frames on several threads, CV_8U. Throws Interrupted.
std::vector<cv::Mat> draw_batch(std::span<const FrameParts> parts, const FrameLook& look,
                                const core::Context& context);
/// The same of graphs alone.
std::vector<cv::Mat> draw_batch(std::span<const graph::AttributeGraph> graphs, const FrameLook& look,
                                const core::Context& context);

}  // namespace emberfold::apps
