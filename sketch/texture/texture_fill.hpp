// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include <opencv2/core/mat.hpp>

#include "core/context.hpp"
#include "sketch/rendering/render.hpp"
#include "sketch/texture/efros_leung.hpp"
#include "sketch/texture/julesz.hpp"
#include "sketch/texture/texture_regions.hpp"

namespace emberfold::sketch {

/// The methods that fill the non-sketchable part of a frame from the sketchable.
enum class FillMethod {
  diffusion,   ///< heat diffusion to equilibrium: smooth
  julesz,      ///< a sample with the observed filter histograms, begun from the diffusion
  efros_leung  ///< texture of copied pixels with similar surroundings
};

/// Holds the method of fill_nonsketchable() and its settings.
struct NonsketchableFillOptions {
  FillMethod kind = FillMethod::diffusion;
  TextureOptions texture = {};  ///< unused by the diffusion
  JuleszOptions julesz = {};
  EfrosLeungOptions efros_leung = {};
  std::uint64_t seed = 1;  ///< replaces the seeds of texture, julesz and efros_leung
  void validate() const;
};

/// Holds a filled frame and how it was reached.
struct NonsketchableFillResult {
  cv::Mat levels;                 ///< CV_32F, channels as given
  bool converged = true;          ///< whether the diffusion, which comes first, converged
  int regions = 0;                ///< number of textures; 0 with the diffusion
  double histogram_distance = 0;  ///< from the observed frame, 0…1; only with julesz
};

/// Fills the pixels between the patches. `observed`: the frame, CV_32F, 1 or 3 channels, finite: the source
/// of the textures; the diffusion uses only its mean, where nothing is drawn. `drawn`: of the same size and
/// type; its pixels come back bit for bit. Throws core::InputError otherwise, and core::Cancelled.
NonsketchableFillResult fill_nonsketchable(const cv::Mat& observed, const Sketchable& drawn,
                                           const NonsketchableFillOptions& options = {},
                                           const core::Context& context = {});

}  // namespace emberfold::sketch
