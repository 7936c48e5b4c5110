// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/context.hpp"
#include "graph/attribute_graph.hpp"
#include "sketch/background/background.hpp"
#include "sketch/rendering/render.hpp"

namespace emberfold::sketch {

/// Holds a rendered frame: a part drawn by patches, the rest filled by diffusion.
struct RenderedLevels {
  cv::Mat levels;    ///< CV_32F, white = 255
  double share = 0;  ///< of the pixels that patches show, 0…1
  bool converged = true;
};

/// Fills the pixels that neither patches nor the still background (add_background_pixels) cover.
/// With nothing held the frame becomes `empty`, levels by channel. `opacity`: as for add_background_pixels.
RenderedLevels render_around(const sketch::Sketchable& part, const cv::Scalar& empty,
                             const BackgroundImage& background = {}, const cv::Mat& opacity = {});

/// Holds what all frames of a drawn clip have in common.
struct RenderOptions {
  cv::Size size;
  int channels = 3;       ///< 1 or 3
  float empty_level = 0;  ///< of a frame without patches and background, white = 255
  Background background = {};
  double blur_share = 1;     ///< of their fitted blur that patches are drawn with, 0…1 (Sharpening)
  double contrast_gain = 1;  ///< of their contrast, ≥ 1
  /// The patches come from a model and lie at new places: they take no level that the clip never shows there
  /// (LevelRange).
  bool new_places = false;
};

/// Holds by how much the patches of new clips are sharpened.
struct Sharpening {
  double blur_share = 1;     ///< of the fitted blur, 0.25…1
  double contrast_gain = 1;  ///< of the fitted contrast, 1…1.5
};

/// Holds the content of one frame.
struct FrameContent {
  graph::AttributeGraph graph;
  /// Opacity of each patch, 0…1, for patches that fade in or out (fade_in_out.hpp). Empty: all opaque.
  std::vector<float> opacity = {};
};

/// Returns the patches of opacity 0.5 and more, with the edges between them.
graph::AttributeGraph visible_patches(const FrameContent& content);

/// Draws frames with one set of options and keeps what the frames share.
class FrameRenderer {
 public:
  explicit FrameRenderer(const RenderOptions& options);
  /// Draws a frame, CV_8U. Patches are drawn from their attributes. Around them lies the still background,
  /// away from the patches, and a fill elsewhere.
  [[nodiscard]] cv::Mat draw(const FrameContent& content) const;

 private:
  RenderOptions options_;
  BackgroundImage still_;
};
/// Draws a single frame, CV_8U.
inline cv::Mat render_frame(const FrameContent& content, const RenderOptions& options) {
  return FrameRenderer(options).draw(content);
}
inline cv::Mat render_frame(const graph::AttributeGraph& graph, const RenderOptions& options) {
  return render_frame(FrameContent{graph}, options);
}

/// Draws the frames on several threads, CV_8U. Throws core::Cancelled.
std::vector<cv::Mat> render_frames(std::span<const FrameContent> content, const RenderOptions& options,
                                   const core::Context& context);
/// Draws graphs of opaque patches.
std::vector<cv::Mat> render_frames(std::span<const graph::AttributeGraph> graphs,
                                   const RenderOptions& options, const core::Context& context);

}  // namespace emberfold::sketch
