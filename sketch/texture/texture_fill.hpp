// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include <opencv2/core/mat.hpp>

#include "core/context.hpp"
#include "sketch/inpainting/fill.hpp"
#include "sketch/rendering/render.hpp"
#include "sketch/texture/efros_leung.hpp"
#include "sketch/texture/julesz.hpp"
#include "sketch/texture/texture_regions.hpp"

namespace emberfold::sketch {

/// How the non-sketchable part of a frame is drawn from the sketchable.
enum class FillMethod {
  diffusion,   ///< heat at rest: smooth
  julesz,      ///< texture with the observed filter histograms, beginning with the diffusion
  efros_leung  ///< texture of copied pixels, each from where it looks alike
};

struct NonsketchableFillOptions {
  FillMethod kind = FillMethod::diffusion;
  FillOptions fill = {};
  TextureOptions texture = {};  ///< not for the diffusion
  JuleszOptions julesz = {};
  EfrosLeungOptions efros_leung = {};
  std::uint64_t seed = 1;  ///< instead of those of texture, julesz and efros_leung
  void validate() const;
};

struct NonsketchableFillResult {
  cv::Mat levels;                 ///< CV_32F, channels as given
  bool converged = true;          ///< the diffusion, which is the begin of all
  int regions = 0;                ///< textures found; 0 with the diffusion
  double histogram_distance = 0;  ///< of the result from the observed frame, 0…1; only with julesz
};

/// Draws what lies between the patches. `observed`: the frame, CV_32F, 1 or 3 channels, finite: the textures'
/// source; the diffusion only takes its mean where nothing is drawn. `drawn`: of the same size and type; its
/// pixels come back bit for bit. InputError otherwise. Anchors belong into `drawn` too: see add_anchors.
/// Throws core::Cancelled.
NonsketchableFillResult fill_nonsketchable(const cv::Mat& observed, const Sketchable& drawn,
                                           const NonsketchableFillOptions& options = {},
                                           const core::Context& context = {});

/// The patches and, where `mask` (CV_8U) is set and no patch lies, the frame's own pixels.
Sketchable add_anchors(const Sketchable& drawn, const cv::Mat& observed, const cv::Mat& mask);

}  // namespace emberfold::sketch
