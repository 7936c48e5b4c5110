// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include <opencv2/core/types.hpp>

#include "mcmc/simulation/edit_model.hpp"
#include "mcmc/simulation/synthesize.hpp"
#include "sketch/background/level_clamp.hpp"
#include "sketch/rendering/fade_in_out.hpp"

namespace emberfold::apps {

/// Holds what drawing a frame needs, like sketch::RenderOptions.
struct PageLook {
  int channels = 3;  ///< 1 or 3
  double blur_share = 1, contrast_gain = 1;
  int range_columns = 0, range_rows = 0, range_channels = 1;
  std::vector<std::uint8_t> range_low, range_high;  ///< cells of the range of levels; may be empty
  std::vector<float> still_levels;                  ///< `channels` per pixel; may be empty
  std::vector<std::uint8_t> still, fixed;           ///< pixels, 255 where static, and where nothing covers it
};

/// Draws the frames of a motion model one by one: graphs, and the pixels of strokes and the static
/// background. The page fills the rest.
class DrawnFrames {
 public:
  DrawnFrames(const mcmc::MotionModel& model, const PageLook& look, std::uint64_t seed);

  void next();

  /// Returns the frame's pixels, four bytes each: red, green, blue, and the coverage, 0…255.
  [[nodiscard]] const std::vector<std::uint8_t>& pixels() const { return pixels_; }
  /// Returns the graph, without patches that are fading in or out.
  [[nodiscard]] const graph::AttributeGraph& graph() const { return ahead_.front().graph; }
  /// Returns the frame's births, deaths, splits, merges, connects and disconnects.
  [[nodiscard]] const std::array<int, 6>& operators() const { return ahead_.front().operators; }

 private:
  struct Frame {
    graph::AttributeGraph graph;
    std::array<int, 6> operators{};
  };
  void draw(const sketch::FadedGraph& faded);

  PageLook look_;
  cv::Size size_;
  mcmc::Synthesis strokes_;
  sketch::FadeInOut fader_;
  std::deque<Frame> ahead_;  // this frame and later ones
  bool begun_ = false;
  std::vector<std::uint8_t> pixels_;
};

}  // namespace emberfold::apps
