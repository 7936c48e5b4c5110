// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

#include "core/clip.hpp"
#include "dytex/linear_dynamic_texture.hpp"

/// A part of a scene that moves by its own model (2003, section 4.1: "different portions or 'layers'"):
/// learned from the clip with all else held still, edited as any model is, and put back onto the clip.
namespace emberfold::dytex {

/// Throws InputError unless the mask has one channel, the frames' size and a pixel that is not 0.
void check_mask(const cv::Mat& mask, const core::ClipInfo& info);

/// Returns a layer's opacity, 0 … 1, CV_32F: mask / its type's largest value, feathered at the mask's edge.
/// It rises from 0 at the edge to its whole value `feather` px inside, smoothly (3 s² − 2 s³). The picture's
/// border is no edge. `mask`: CV_8U, CV_16U or CV_32F (0 … 1), one channel; feather 0 … 10⁴ px; else
/// InputError.
cv::Mat layer_opacity(const cv::Mat& mask, double feather);

/// A source whose pixels outside the mask stay as in the first frame, so that they do not affect learning.
/// Inside is where the mask is not 0.
class RegionSource final : public core::FrameSource {
 public:
  /// `source` must outlive it and is rewound. InputError as check_mask().
  RegionSource(core::FrameSource& source, const cv::Mat& mask);
  [[nodiscard]] const core::ClipInfo& info() const override { return source_.info(); }
  cv::Mat next() override;
  void rewind() override { source_.rewind(); }

 private:
  core::FrameSource& source_;
  cv::Mat outside_, first_;
};

/// Makes a model that was learned from a RegionSource still outside the mask, to the bit: no components
/// there, and the noise, r on average, all inside. InputError as RegionSource's. O(m n).
void confine(LinearDynamicTexture& texture, const cv::Mat& mask);

/// Returns the region in which a model moves: 255 where a pixel has components, else 0; CV_8U. O(m n).
cv::Mat moving_region(const LinearDynamicTexture& texture);

/// Blends a layer into a frame: frame + opacity (layer − frame), rounded. An opacity of 0 leaves the frame's
/// bytes, 1 gives the layer's. `frame`, changed in place, and `layer`: CV_8U of one size and number of
/// channels; opacity: CV_32F of that size; else InputError. O(m).
void put_layer(cv::Mat& frame, const cv::Mat& layer, const cv::Mat& opacity);

}  // namespace emberfold::dytex
