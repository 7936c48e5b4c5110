// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/context.hpp"
#include "graph/attribute_graph.hpp"
#include "sketch/background/still_background.hpp"
#include "sketch/inpainting/fill.hpp"
#include "sketch/rendering/render.hpp"

namespace emberfold::sketch {

/// A frame of which patches show a part and diffusion the rest.
struct RenderedLevels {
  cv::Mat levels;    ///< CV_32F, white = 255
  double share = 0;  ///< that patches show, 0…1
  bool converged = true;
};

/// Fills what `part` and the still ground (add_background_pixels) leave open; with nothing held the frame
/// becomes `empty`, levels by channel.
RenderedLevels render_around(const sketch::Sketchable& part, const cv::Scalar& empty,
                             const sketch::FillOptions& options, const BackgroundImage& background = {},
                             const cv::Mat& opacity = {});

/// What the frames of a clip of graphs have in common.
struct RenderOptions {
  cv::Size size;
  int channels = 3;       ///< 1 or 3
  float empty_level = 0;  ///< of a frame without patches and ground, white = 255
  sketch::FillOptions fill = {};
  Background background = {};
  double blur_share = 1;     ///< of their fitted blur that patches are drawn with, 0…1 (sharpening.hpp)
  double contrast_gain = 1;  ///< of their contrast, ≥ 1
  /// Graphs drawn from a model, not seen: patches take the levels of where they are, those of a frame's
  /// ground (rest_on_ground.hpp), and none that the clip never had there (seen_levels.hpp).
  bool new_places = false;
};

/// A frame to be drawn: its strokes, and what lies between them.
struct FrameContent {
  graph::AttributeGraph graph;
  cv::Mat background =
      {};  ///< CV_8U, as the frame: the strokes are joined into it; empty: the fill, look.ground
  /// How much of each patch is there, 0…1, for those that come and go: its levels lie between its own and
  /// what would be there without it. Empty: all of all.
  std::vector<float> opacity = {};
  cv::Mat residual = {};  ///< CV_8S, as the frame: added to all but the backdrop
};

/// The patches of which at least half is there.
graph::AttributeGraph visible_patches(const FrameContent& content);

/// Draws frames of one look, which it keeps what they share of.
class FrameRenderer {
 public:
  explicit FrameRenderer(const RenderOptions& options);
  /// The frame that a graph tells of: patches drawn from their attributes; around them the given ground,
  /// which takes the strokes' levels beside them, or, without one, the still ground away from them and the
  /// rest filled. CV_8U.
  [[nodiscard]] cv::Mat draw(const FrameContent& content) const;

 private:
  RenderOptions options_;
  BackgroundImage still_;
};
inline cv::Mat render_frame(const FrameContent& content, const RenderOptions& options) {
  return FrameRenderer(options).draw(content);
}
inline cv::Mat render_frame(const graph::AttributeGraph& graph, const RenderOptions& options) {
  return render_frame(FrameContent{graph}, options);
}

/// Draws these frames on several threads, CV_8U. Throws core::Cancelled.
std::vector<cv::Mat> render_frames(std::span<const FrameContent> content, const RenderOptions& options,
                                   const core::Context& context);
/// The same of graphs alone.
std::vector<cv::Mat> render_frames(std::span<const graph::AttributeGraph> graphs,
                                   const RenderOptions& options, const core::Context& context);

}  // namespace emberfold::sketch
